// SPDX-License-Identifier: Apache-2.0
//
// The table of products: each row is one of a kind, and agrees with the planes that it names.
#include "estimators/products.h"

#include <gmock/gmock.h>

#include <set>

#include "support/error_matchers.h"

namespace ssdo::test::products_test {
namespace {

int count(const ProductSet& set) {
  int members = 0;
  for (const Product& product : kProducts) members += product.in && set.*product.in;
  return members;
}

TEST(Products, EachRowHasItsOwnNameAndPlane) {
  std::set<std::string_view> names;
  int sets = 0, planes = 0;
  for (const Product& product : kProducts) {
    EXPECT_TRUE(names.insert(product.name).second) << product.name << " twice";
    EXPECT_EQ(&find_product(product.name), &product);
    if (!product.in) continue;
    ++sets;
    ProductSet alone;
    alone.*product.in = true;
    EXPECT_EQ(count(alone), 1) << product.name << " shares its place with another";
    EXPECT_TRUE(contains(product.made_of, alone)) << product.name;
  }
  Products products;
  for_each_plane(
      [&](const Product& product, auto& plane) {
        EXPECT_TRUE(product.in) << product.name << " has a plane";
        EXPECT_EQ(product.channels.size() * sizeof(float), sizeof(plane[0])) << product.name;
        EXPECT_TRUE(plane.empty()) << product.name << " shares its plane with another";
        plane = std::decay_t<decltype(plane)>(1, 1);
        ++planes;
      },
      products);
  EXPECT_EQ(planes, sets);
  // A plane or a place in a set without a row would be larger than all rows together.
  EXPECT_EQ(sizeof(ProductSet), std::size_t(sets));
  EXPECT_EQ(sizeof(Products), std::size_t(planes) * sizeof(Plane<float>) + sizeof(LightVisibility) +
                                  sizeof(Products::lights) + sizeof(Products::lit) +
                                  sizeof(Products::lit_without));
}

TEST(Products, AreFoundByNameOrListed) {
  const Error error = error_of([] { find_product("normals"); });
  EXPECT_THAT(error,
              IsError(ExitCode::usage, "product 'normals': no such product; there are ao, bent"));
  EXPECT_THAT(error, IsError(ExitCode::usage, "composite, and all"));
  EXPECT_EQ(product_names(),
            "ao, bent, reflection, direct, unshadowed, shadow, bounce, shadow_of, specular, error, "
            "guessed, composite");
}

TEST(ProductSet, HasTheOperationsOfASet) {
  const ProductSet a{.ao = true, .error = true}, b{.direct = true, .error = true};
  EXPECT_EQ(a | b, (ProductSet{.ao = true, .direct = true, .error = true}));
  EXPECT_EQ(a & b, (ProductSet{.error = true}));
  EXPECT_TRUE(contains(a | b, a));
  EXPECT_FALSE(contains(a, b));
  EXPECT_TRUE(contains(a, {}));
}

TEST(ForEachPlane, VisitsTheSamePlaneOfEachArgument) {
  Products a, b;
  a.bent = Plane<glm::vec3>(2, 1, glm::vec3(1));
  b.bent = Plane<glm::vec3>(2, 1, glm::vec3(2));
  b.ao = Plane<float>(2, 1, 3.0f);
  std::vector<std::string> visited;
  for_each_plane(
      [&](const Product& product, const auto& one, auto& other) {
        if (!other.empty()) visited.emplace_back(product.name);
        if (!one.empty()) other = one;
      },
      a, b);
  EXPECT_THAT(visited, testing::ElementsAre("ao", "bent"));
  EXPECT_EQ(b.bent[1], glm::vec3(1));
  EXPECT_EQ(b.ao[1], 3);
}

}  // namespace
}  // namespace ssdo::test::products_test
