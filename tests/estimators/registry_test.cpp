// SPDX-License-Identifier: Apache-2.0
//
// The rows of the table of methods against what the methods do.
#include "estimators/registry.h"

#include <gmock/gmock.h>

#include <set>

#include "estimators/view_space/point_method_request.h"
#include "support/error_matchers.h"

namespace ssdo::test {
namespace {

using testing::HasSubstr;

class EveryMethod : public testing::TestWithParam<const Method*> {
 protected:
  const Method& method() const { return *GetParam(); }
};
std::vector<const Method*> all_methods() {
  std::vector<const Method*> all;
  for (const Method& method : methods()) all.push_back(&method);
  return all;
}
INSTANTIATE_TEST_SUITE_P(All, EveryMethod, testing::ValuesIn(all_methods()), [](const auto& which) {
  std::string name(which.param->name);
  std::erase(name, '-');
  return name;
});

TEST_P(EveryMethod, MakesWhatItsRowSaysAndNothingElse) {
  const Window window{0, 0, 40, 30};
  // The ball alone leaves background in the corners of the picture.
  const Geometry g =
      geometry_of(sphere({0, 0, 0}, 1.5), tilted(camera_from_fov(40, window, 1), 55), window);
  const Rung& cheapest = method().ladder.rungs.front();
  Request request{.products = method().products,
                  .radius = 1,
                  .bounces = method().products.bounce,
                  .parameters = resolve_parameters(method(), {})};
  for (const auto& [name, value] : cheapest.values) {
    if (!method().takes.march) request.parameters[std::string(name)] = value;
  }
  const Scene scene = scene_of(g, Environment::constant(glm::vec3(1)), 0.5f);
  const Products made = method().estimate(scene, request, {});
  int background = 0;
  for_each_plane(
      [&](const Product& product, const auto& plane) {
        EXPECT_EQ(!plane.empty(), method().products.*product.in) << product.name;
        using Value = std::decay_t<decltype(plane[0])>;
        for (std::size_t i = 0; i < plane.size(); ++i) {
          if (g.is_surface(i)) continue;
          EXPECT_EQ(plane[i], Value(product.background)) << product.name;
          ++background;
        }
      },
      made);
  EXPECT_GT(background, 0);
}

TEST_P(EveryMethod, HasParametersWithinTheirRangesAndALadderOfThem) {
  std::set<std::string_view> names;
  for (const Parameter& p : method().parameters) {
    EXPECT_TRUE(names.insert(p.name).second) << p.name << " twice";
    EXPECT_NO_THROW(check_value(p, p.value, "")) << p.name;
  }
  EXPECT_FALSE(method().ladder.rungs.empty());
  std::vector<Rung> rungs = method().ladder.rungs;
  rungs.push_back(method().ladder.limit);
  for (const Rung& rung : rungs) {
    for (const auto& [name, value] : rung.values) {
      if (method().takes.march) {
        EXPECT_TRUE(name == "slices" || name == "steps") << name;
        continue;
      }
      const Parameter* parameter = find_parameter(method(), name);
      ASSERT_TRUE(parameter) << name;
      EXPECT_NO_THROW(check_value(*parameter, value, ""));
    }
  }
}

TEST(Methods, AreFoundByNameAndOneIsTheReference) {
  for (const Method& method : methods()) EXPECT_EQ(&find_method(method.name), &method);
  EXPECT_EQ(methods().front().name, "bitmask") << "the default";
  EXPECT_EQ(reference_method().name, "trace");
  EXPECT_THAT(error_of([] { find_method("vxao"); }), IsError(ExitCode::usage, "there is bitmask"));
}

TEST(Methods, AreListedWithTheirProducts) {
  EXPECT_THAT(describe_methods(),
              HasSubstr("\n  products: ao, bent, reflection, direct, bounce, error, guessed\n"));
  EXPECT_THAT(describe_methods(), HasSubstr("\n  products: ao, bent, reflection, direct\n"));
}

TEST(Parameters, OutOfRangeAreRefusedAsTheyWereWritten) {
  const Method& gtao = find_method("gtao");
  const auto refused = [&](const std::string& setting) {
    return error_of([&] { resolve_parameters(gtao, {setting}); });
  };
  EXPECT_THAT(refused("slices=65"),
              IsError(ExitCode::usage, "--set slices=65: slices takes whole numbers from 1 to 64"));
  EXPECT_THAT(refused("slices=1.5"), IsError(ExitCode::usage, "whole numbers"));
  EXPECT_THAT(refused("slices=x"), IsError(ExitCode::usage, "--set slices=x"));
  EXPECT_THAT(refused("slices"), IsError(ExitCode::usage, "has the parameters slices, steps"));
  EXPECT_THAT(refused("speed=1"), IsError(ExitCode::usage, "has the parameters slices, steps"));
  EXPECT_EQ(resolve_parameters(gtao, {"slices=3", "slices=4"}).at("slices"), 4);
  EXPECT_EQ(find_parameter(gtao, "speed"), nullptr);
}

}  // namespace
}  // namespace ssdo::test
