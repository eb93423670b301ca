// SPDX-License-Identifier: Apache-2.0
#include "product_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "error.h"
#include "estimators/registry.h"
#include "io/image_file.h"

namespace ssdo {
namespace {

using Names = std::vector<std::string>;

class ProductChoice {
 public:
  ProductChoice(const Method& method, const OutputOptions& output, const Scene& scene,
                const GBuffer& gbuffer, const std::string& file)
      : method_(method),
        output_(output),
        layers_{{"", true},
                {"albedo", !scene.senders.albedo.empty()},
                {"roughness", !scene.roughness.empty()}},
        ambient_(!gbuffer.ambient.empty()),
        file_(file) {}

  void choose(Plan& plan) const {
    const auto is_picture = [](const std::string& path) { return is_display_image(path); };
    const auto pictures = std::count_if(output_.files.begin(), output_.files.end(), is_picture);
    const bool only_saves = output_.files.empty() && !output_.saves.empty();
    if (std::size_t(pictures) < output_.files.size() || (output_.files.empty() && !only_saves)) {
      plan.write = of_exr();
      explain_left_out(plan);
    }
    Names wanted = output_.products;
    std::erase(wanted, kAllProducts);
    wanted.insert(wanted.end(), plan.write.begin(), plan.write.end());
    for (const SaveRequest& save : output_.saves) wanted.push_back(save.product);
    if (pictures > 0) wanted.push_back(plan.show = of_picture());
    for (const std::string& name : wanted) check(find_product(name));
    for (const Product& product : kProducts) {
      if (contains(wanted, product.name)) plan.make.emplace_back(product.name);
    }
    if (plan.error) wanted.emplace_back("error");
    plan.request.products = asked_of_method(wanted);
  }

 private:
  bool from_ambient(const Product& product) const {
    return &made_of(product, ambient_) == &product.made_of_ambient;
  }
  bool has_layers(const Product& product) const {
    return from_ambient(product) || layers_.at(product.needs);
  }

  /// What of the planes the wanted products are made of the method makes, and the layers allow.
  ProductSet asked_of_method(const Names& wanted) const {
    ProductSet asked, possible;
    for (const Product& product : kProducts) {
      if (product.in) possible.*product.in = has_layers(product);
      if (!contains(wanted, product.name)) continue;
      asked = asked | made_of(product, ambient_);
      if (!from_ambient(product)) asked = asked | product.with;
    }
    return asked & possible & method_.products;
  }

  Names of_exr() const {
    Names names;
    for (const Product& product : kProducts) {
      const bool possible =
          makes(method_, product, ambient_) && has_layers(product) && layers_.at(product.all_needs);
      const bool if_possible =
          output_.products.empty() ? product.usual : contains(output_.products, kAllProducts);
      if (contains(output_.products, product.name) || (if_possible && possible))
        names.emplace_back(product.name);
    }
    return names;
  }

  void explain_left_out(Plan& plan) const {
    if (!output_.products.empty()) return;
    std::map<std::string_view, Names> left_out;  // by the layer that is not there
    for (const Product& product : kProducts) {
      if (product.usual && !has_layers(product))
        left_out[product.needs].push_back(fmt::format("no {}", product.name));
    }
    for (const auto& [layer, products] : left_out)
      plan.reasons.push_back(
          fmt::format("{}: there is no {}", fmt::join(products, " and "), layer));
  }

  /// What a picture shows: the composite, or the only product that the user names.
  std::string of_picture() const {
    if (output_.products.empty() || contains(output_.products, "composite") ||
        contains(output_.products, kAllProducts)) {
      return "composite";
    }
    if (output_.products.size() == 1) return output_.products[0];
    throw Error(ExitCode::usage,
                "a picture shows one product, and --products names several without "
                "the composite; give each a file with --save PRODUCT=FILE");
  }

  void check(const Product& product) const {
    if (!makes(method_, product, ambient_)) {
      Names others;
      for (const Method& method : methods()) {
        if (makes(method, product, ambient_)) others.emplace_back(method.name);
      }
      throw Error(ExitCode::usage, fmt::format("method {} makes no {}; these do: {}", method_.name,
                                               product.name, fmt::join(others, ", ")));
    }
    if (!has_layers(product)) {
      throw Error(ExitCode::layer,
                  fmt::format("{}: {} needs a layer for {} and none was found by name; name one "
                              "with --aov {}=LAYER, or another product with --save PRODUCT=FILE",
                              file_, product.name, product.needs, product.needs));
    }
  }

  const Method& method_;
  const OutputOptions& output_;
  const std::map<std::string_view, bool> layers_;  ///< by role: whether the frame has it
  const bool ambient_;                             ///< whether the frame has its ambient light
  const std::string& file_;
};

}  // namespace

void choose_products(Plan& plan, const OutputOptions& output, const Scene& scene,
                     const GBuffer& gbuffer, const std::string& file) {
  ProductChoice(*plan.method, output, scene, gbuffer, file).choose(plan);
}

}  // namespace ssdo
