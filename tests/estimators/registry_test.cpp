// SPDX-License-Identifier: Apache-2.0
//
// The rows of the table of methods against what the methods do.
#include "estimators/registry.h"

#include <gmock/gmock.h>

#include <set>

#include "estimators/obscurance_request.h"
#include "support/error_matchers.h"

namespace ssdo::test::registry_test {
namespace {

using testing::HasSubstr;

class EveryMethod : public testing::TestWithParam<const Method*> {
 protected:
  const Method& method() const { return *GetParam(); }

  /// All products, at the lowest quality.
  Request cheapest_request() const {
    Request request{.products = method().products,
                    .radius = 1,
                    .bounces = method().products.bounce,
                    .parameters = resolve_parameters(method(), {})};
    for (const auto& [name, value] : method().ladder.rungs.front().values) {
      if (!method().supports.march)
        request.parameters[std::string(name)] = value;
      else
        (name == "slices" ? request.slices : request.steps) = value;
    }
    return request;
  }
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
  const Scene scene = scene_of(g, Environment::constant(glm::vec3(1)), 0.5f);
  const Products made = method().estimate(scene, cheapest_request(), {});
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

/// The mean over the seeds from `first` on of the ao of a still life.
Plane<double> mean_ao(const Method& method, const Scene& scene, Request request, unsigned first,
                      int count) {
  request.products = {.ao = true};
  Plane<double> mean(scene.geometry.window.width(), scene.geometry.window.height(), 0);
  for (request.seed = first; request.seed < first + unsigned(count); ++request.seed) {
    const Products made = method.estimate(scene, request, {});
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += double(made.ao[i]) / count;
  }
  return mean;
}

double rms(const Plane<double>& a, const Plane<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / double(a.size()));
}

TEST_P(EveryMethod, HasAPatternForEverySeedAndTheirMeanConverges) {
  const Window window{0, 0, 64, 48};
  const Geometry g = geometry_of(
      still_life(), look_at(camera_from_fov(50, window, 1), {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}),
      window);
  const Scene scene = scene_of(g, Environment::constant(glm::vec3(1)), 0.5f);
  Request request = cheapest_request();
  const bool has_noise = method().ladder.seeds > 1;
  std::vector<Products> made;
  for (request.seed = 0; request.seed < 2; ++request.seed)
    made.push_back(method().estimate(scene, request, {}));
  for (const Product& product : kProducts) {
    if (!product.in || !(method().products.*product.in)) continue;
    const bool same = std::visit(
        [&](const auto& plane) {
          if constexpr (std::is_same_v<std::decay_t<decltype(plane)>, std::monostate>)
            return false;
          else
            return (made[0].*plane).pixels == (made[1].*plane).pixels;
        },
        product.plane);
    EXPECT_EQ(same, !has_noise) << product.name;
  }
  if (!has_noise) return;
  // Of independent patterns, the mean of 16 is 4 times nearer to their limit, and 3.6 times nearer
  // to a mean of 64 that stands for it.
  const auto ao = [&](unsigned first, int count) {
    return mean_ao(method(), scene, request, first, count);
  };
  const Plane<double> limit = ao(0, 64);
  double one = 0;
  for (unsigned seed = 1001; seed < 1005; ++seed) one += rms(ao(seed, 1), limit) / 4;
  const double sixteen = rms(ao(1001, 16), limit);
  EXPECT_GT(one, 3 * sixteen) << one << " and " << sixteen;
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
      if (method().supports.march) {
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
  EXPECT_THAT(
      describe_methods(),
      HasSubstr("\n  products: ao, bent, reflection, direct, bounce, specular, error, guessed\n"));
  EXPECT_THAT(describe_methods(), HasSubstr("\n  products: ao, bent, reflection, direct\n"));
}

TEST(Methods, AreListedWithTheFiltersOfTheirSources) {
  EXPECT_THAT(describe_methods(), HasSubstr("products: ao, direct\n  source filter: box\n"));
  EXPECT_THAT(describe_methods(),
              HasSubstr("products: ao, direct\n  source filter: gaussian, on the map at half "
                        "resolution before it goes up\n"));
}

TEST(Parameters, AreWrittenByTheirWordsWhereTheyHaveSome) {
  const Method& hbao = find_method("hbao");
  EXPECT_EQ(resolve_parameters(hbao, {}).at("horizon"), 1);
  EXPECT_EQ(resolve_parameters(hbao, {"horizon=max"}).at("horizon"), 1);
  EXPECT_EQ(resolve_parameters(hbao, {"horizon=taps"}).at("horizon"), 0);
  EXPECT_EQ(resolve_parameters(hbao, {"horizon=1"}).at("horizon"), 1) << "as plans write it";
  for (const std::string wrong : {"mean", "0.5", "2", ""}) {
    EXPECT_THAT(error_of([&] { resolve_parameters(hbao, {"horizon=" + wrong}); }),
                IsError(ExitCode::usage, "--set horizon=" + wrong + ": horizon takes taps or max"));
  }
  EXPECT_THAT(describe_methods(), testing::ContainsRegex("horizon +max  taps or max  "));
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
}  // namespace ssdo::test::registry_test
