// SPDX-License-Identifier: Apache-2.0
#include "estimators/products.h"

#include <fmt/format.h>

#include <algorithm>

#include "error.h"
#include "nearest_name.h"

namespace ssdo {
namespace {

/// The set of the products for which `has(place in a set)` holds.
template <class Has>
ProductSet set_of(const Has& has) {
  ProductSet set;
  for (const Product& product : kProducts) {
    if (product.in) set.*product.in = has(product.in);
  }
  return set;
}

}  // namespace

const Product& find_product(std::string_view name) {
  std::vector<std::string> names;
  for (const Product& product : kProducts) {
    if (product.name == name) return product;
    names.emplace_back(product.name);
  }
  throw Error(ExitCode::usage,
              fmt::format("product '{}': no such product; {}there are {}, and {}", name,
                          did_you_mean(name, names), product_names(), kAllProducts));
}

std::string product_names() {
  std::string names;
  for (const Product& product : kProducts)
    names += (names.empty() ? "" : ", ") + std::string(product.name);
  return names;
}

bool contains(const ProductSet& larger, const ProductSet& smaller) {
  for (const Product& product : kProducts) {
    if (product.in && smaller.*product.in && !(larger.*product.in)) return false;
  }
  return true;
}

ProductSet operator|(const ProductSet& a, const ProductSet& b) {
  return set_of([&](bool ProductSet::*in) { return a.*in || b.*in; });
}

ProductSet operator&(const ProductSet& a, const ProductSet& b) {
  return set_of([&](bool ProductSet::*in) { return a.*in && b.*in; });
}

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace ssdo
