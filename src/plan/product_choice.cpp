// SPDX-License-Identifier: Apache-2.0
#include "plan/product_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>

#include "error.h"
#include "estimators/registry.h"
#include "io/images/image_file.h"
#include "plan/composite_choice.h"
#include "scene/light/light_group.h"

namespace ssdo {
namespace {

using Names = std::vector<std::string>;

/// Stands for a layer that --shadow-of makes.
constexpr std::string_view kOfObjects = "shadow-of";

class ProductChoice {
 public:
  ProductChoice(Plan& plan, const OutputOptions& output, const Scene& scene, const GBuffer& gbuffer,
                const std::string& file)
      : plan_(plan),
        method_(*plan.method),
        output_(output),
        scene_(scene),
        gbuffer_(gbuffer),
        layers_{{"", true},
                {"albedo", !scene.senders.albedo.empty()},
                {"ambient", !gbuffer.ambient.empty()},
                {"roughness", !scene.roughness.empty()},
                {kOfObjects, scene.without != nullptr}},
        file_(file) {
    check_lights(scene.light, gbuffer, file);
    row("composite") = composite_row(plan.composition, gbuffer);
  }

  void choose() {
    const auto is_picture = [](const std::string& path) { return is_display_image(path); };
    const auto pictures = std::count_if(output_.files.begin(), output_.files.end(), is_picture);
    const bool only_saves = output_.files.empty() && !output_.saves.empty();
    if (std::size_t(pictures) < output_.files.size() || (output_.files.empty() && !only_saves)) {
      plan_.write = of_exr();
      explain_left_out();
    }
    Names wanted = output_.products;
    std::erase(wanted, kAllProducts);
    wanted.insert(wanted.end(), plan_.write.begin(), plan_.write.end());
    for (const SaveRequest& save : output_.saves) wanted.push_back(save.product);
    if (pictures > 0) wanted.push_back(plan_.show = of_picture());
    for (const std::string& name : wanted) check(row(name));
    for (const Product& product : table_) {
      if (contains(wanted, product.name)) plan_.make.emplace_back(product.name);
    }
    if (plan_.error) wanted.emplace_back("error");
    plan_.request.products = asked_of_method(wanted);
    if (output_.per_light) choose_layers_of_lights();
    if (contains(plan_.make, kComposite) && needs_lights(plan_.composition, scene_, gbuffer_))
      plan_.request.by_light.direct = plan_.request.products.direct;
  }

 private:
  /// Errors: those of find_product.
  Product& row(std::string_view name) { return table_[&find_product(name) - kProducts.data()]; }

  bool has_layers(const Product& product) const { return layers_.at(product.needs); }

  /// Whether --compose or a layer of ambient light asks for the composite.
  bool is_asked_for(const Product& product) const {
    return product.name == kComposite &&
           (output_.compose || plan_.composition.compose != Compose::relight);
  }

  /// The planes that the wanted products need, if the method makes them and the layers allow it.
  ProductSet asked_of_method(const Names& wanted) const {
    ProductSet asked, possible;
    for (const Product& product : table_) {
      if (product.in) possible.*product.in = has_layers(product);
      if (contains(wanted, product.name)) asked = asked | product.made_of | product.with;
    }
    return asked & possible & method_.products;
  }

  /// What --per-light adds.
  void choose_layers_of_lights() {
    plan_.composition.per_light = true;
    const ProductSet& asked = plan_.request.products;
    const bool direct = contains(plan_.make, "direct") || contains(plan_.make, "shadow");
    plan_.request.by_light = {.direct = asked.direct && direct,
                              .bounce = asked.bounce && contains(plan_.make, "bounce")};
    if (plan_.request.by_light.bounce && !scene_.senders.radiance.empty()) {
      throw Error(ExitCode::usage,
                  fmt::format("{}: --per-light: the layer of radiance says what surfaces send, but "
                              "not by which light: leave --aov radiance out, or bounce out of "
                              "--products",
                              file_));
    }
    Names names, products;
    for (const LightGroup& light : light_groups_of(scene_.light)) {
      if (contains(names, light.name) || (light.name == kEnvironmentName && !names.empty())) {
        throw Error(ExitCode::usage,
                    fmt::format("light '{}': the layers of {} have this name; give it another for "
                                "--per-light",
                                light.name,
                                light.name == kEnvironmentName ? "the environment" : "two lights"));
      }
      names.push_back(light.name);
    }
    for (const Product& product : kProducts)
      if (product.by_light && contains(plan_.make, product.name))
        products.emplace_back(product.name);
    if (!products.empty())
      plan_.reasons.push_back(
          fmt::format("per light: {} of {}", fmt::join(products, ", "), fmt::join(names, ", ")));
  }

  Names of_exr() const {
    Names names;
    for (const Product& product : table_) {
      const bool possible =
          is_asked_for(product) ||
          (makes(method_, product) && has_layers(product) && layers_.at(product.all_needs));
      const bool if_possible = output_.products.empty()
                                   ? product.usual || product.all_needs == kOfObjects
                                   : contains(output_.products, kAllProducts);
      if (contains(output_.products, product.name) || (if_possible && possible))
        names.emplace_back(product.name);
    }
    return names;
  }

  void explain_left_out() {
    if (!output_.products.empty()) return;
    std::map<std::string_view, Names> left_out;  // by the layer that is not there
    for (const Product& product : table_) {
      if (product.usual && !has_layers(product))
        left_out[product.needs].push_back(fmt::format("no {}", product.name));
    }
    for (const auto& [layer, products] : left_out)
      plan_.reasons.push_back(
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
    if (product.name == kComposite)
      check_rendered_layers(plan_.composition.compose, gbuffer_, file_);
    if (!makes(method_, product)) {
      Names others;
      for (const Method& method : methods()) {
        if (makes(method, product)) others.emplace_back(method.name);
      }
      throw Error(ExitCode::usage, fmt::format("method {} makes no {}; these do: {}", method_.name,
                                               missing_of(product), fmt::join(others, ", ")));
    }
    if (product.all_needs == kOfObjects && !scene_.without) {
      throw Error(ExitCode::usage,
                  fmt::format("{}: {} is that of some objects; say which with --shadow-of SEL",
                              file_, product.name));
    }
    if (!has_layers(product)) {
      throw Error(ExitCode::layer,
                  fmt::format("{}: {} needs a layer for {} and none was found by name; name one "
                              "with --aov {}=LAYER, or another product with --save PRODUCT=FILE",
                              file_, product.name, product.needs, product.needs));
    }
  }

  /// Names what the method cannot make: the product itself, or a part that it is composed of.
  std::string missing_of(const Product& product) const {
    for (const Product& part : kProducts) {
      if (part.in && product.made_of.*part.in && !(method_.products.*part.in) && !product.in)
        return fmt::format("{} for the {}", part.name, product.name);
    }
    return std::string(product.name);
  }

  Plan& plan_;
  const Method& method_;
  const OutputOptions& output_;
  const Scene& scene_;
  const GBuffer& gbuffer_;
  const std::map<std::string_view, bool> layers_;  ///< by role: whether the frame has it
  const std::string& file_;
  std::array<Product, kProducts.size()> table_ = kProducts;  ///< as it is in this frame
};

}  // namespace

void choose_products(Plan& plan, const OutputOptions& output, const Scene& scene,
                     const GBuffer& gbuffer, const std::string& file) {
  ProductChoice(plan, output, scene, gbuffer, file).choose();
}

}  // namespace ssdo
