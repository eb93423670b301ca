// SPDX-License-Identifier: Apache-2.0
//
// Every hard case through every method and every filter: finite numbers, ao and reflection in
// 0..1, background open and dark, the same bits from any number of threads, and an open plane
// that reads 1 with the default method.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "filters/filter_products.h"
#include "filters/registry.h"
#include "filters/temporal.h"
#include "hard/every_method.h"
#include "parallel/tiles.h"
#include "plan/make_plan.h"
#include "relight/estimate.h"
#include "support/estimate_light.h"
#include "support/random_frame.h"

namespace ssdo::test::hard_test {
namespace {

bool is_sane(float v) { return std::isfinite(v); }
bool is_sane(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The first fault of one product.
template <class Value, class Fine>
std::string fault_of(std::string_view name, const Plane<Value>& plane, const Geometry& g,
                     const Value& background, const Fine& is_fine) {
  if (plane.empty()) return "";
  if (plane.size() != g.surfaces.size()) return fmt::format("{} has another size", name);
  std::size_t wrong = 0, first = 0;
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const bool fine = g.is_surface(i) ? is_fine(plane[i]) : plane[i] == background;
    if (!fine && wrong++ == 0) first = i;
  }
  if (wrong == 0) return "";
  return fmt::format("{} is wrong in {} pixels, first in {} ({}): {}", name, wrong, first,
                     g.is_surface(first) ? "surface" : "background",
                     testing::PrintToString(*reinterpret_cast<const float*>(&plane[first])));
}

bool is_fine(float v, ProductKind kind) {
  return kind == ProductKind::share ? v >= 0 && v <= 1 : is_sane(v);
}
bool is_fine(const glm::vec3& v, ProductKind kind) {
  const bool unit = v == glm::vec3(0) || std::abs(glm::length(v) - 1) < 1e-4f;
  return is_sane(v) && (kind != ProductKind::direction || unit);
}

/// What is wrong with products of this geometry, in words; empty if nothing is.
std::string find_fault(const Products& products, const Geometry& g) {
  std::string fault;
  for_each_plane(
      [&](const Product& product, const auto& plane) {
        using Value = std::decay_t<decltype(plane[0])>;
        if (fault.empty())
          fault = fault_of(product.name, plane, g, Value(product.background),
                           [&](const Value& v) { return is_fine(v, product.kind); });
      },
      products);
  return fault;
}

/// Rays are slow; few show as much of what breaks.
std::vector<std::string> settings_of(const Method& method) {
  return method.is_reference ? std::vector<std::string>{"samples=16"} : std::vector<std::string>{};
}

/// ssao-fade with the filter of its source, which is at half resolution.
Products fade_with_its_filter(const HardFrame& frame) {
  const Scene scene = scene_of(frame.geometry, frame.environment);
  ModelOptions model;
  model.method = "ssao-fade";
  model.radius = frame.radius;
  model.filter = kPublishedFilter;
  OutputOptions output;
  output.products = {"ao", "direct"};
  return estimate_light(scene, make_plan(model, output, scene, {}, "")).products;
}

class HardCases : public testing::TestWithParam<HardCase> {
 protected:
  const HardFrame frame_ = GetParam().make();
};

TEST_P(HardCases, ThroughEveryMethod) {
  for (const Method& method : methods()) {
    SCOPED_TRACE(fmt::format("method {}", method.name));
    std::optional<Products> first;
    for (const int threads : {1, 2, 7}) {
      const ThreadLimit limit(threads);
      Products products = run_method(method, frame_, settings_of(method));
      if (first) {
        EXPECT_TRUE(same_bits(products, *first)) << threads << " threads give other bits";
      } else {
        EXPECT_EQ(find_fault(products, frame_.geometry), "");
        first = std::move(products);
      }
    }
    if (!frame_.open_plane || method.name != "bitmask") continue;
    float least = 1;
    for (const float ao : first->ao.pixels) least = std::min(least, ao);
    EXPECT_GE(least, 1 - 1e-4f) << "an open plane hides itself";
  }
}

TEST_P(HardCases, ThroughEveryFilter) {
  const Products noisy = random_products(frame_.geometry, 1);
  Products clean = noisy;  // as methods leave the background
  for_each_plane(
      [&](const Product& product, auto& plane) {
        for (std::size_t i = 0; i < plane.size(); ++i) {
          if (!frame_.geometry.is_surface(i))
            plane[i] = std::decay_t<decltype(plane[i])>(product.background);
        }
      },
      clean);
  const auto check = [&](std::string_view name, const std::function<Products()>& filter) {
    SCOPED_TRACE(fmt::format("filter {}", name));
    std::optional<Products> first;
    for (const int threads : {1, 2, 7}) {
      const ThreadLimit limit(threads);
      Products products = filter();
      if (!first) {
        first = std::move(products);
      } else {
        EXPECT_TRUE(same_bits(products, *first)) << threads << " threads give other bits";
      }
    }
    EXPECT_EQ(find_fault(*first, frame_.geometry), "");
  };
  for (const Filter& filter : filters())
    check(filter.name, [&] { return filter_products(filter, clean, frame_.geometry.surfaces, 4); });
  check(kPublishedFilter, [&] { return fade_with_its_filter(frame_); });
  check("temporal", [&] {
    History history = accumulate(nullptr, frame_.geometry, clean);
    history.geometry = frame_.geometry;
    return products_of(accumulate(&history, frame_.geometry, clean));
  });
}

/// What was read from a file.
class HardFiles : public HardCases {};

TEST_P(HardFiles, ShowWhatTheSceneShows) {
  const Geometry& g = frame_.geometry;
  std::size_t missing = 0, moved = 0, turned = 0;
  double farthest = 0;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    const Surfel &found = g.surfaces[i], &shown = frame_.shown[i];
    missing += found.is_surface() != shown.is_surface();
    if (!found.is_surface() || !shown.is_surface()) continue;
    const double distance = glm::distance(glm::dvec3(found.position), glm::dvec3(shown.position));
    farthest = std::max(farthest, distance);
    moved += distance > frame_.position_error;
    // A half has normals to within 1e-3; what is rebuilt from P is worse where the scene bends.
    turned += glm::dot(found.normal, shown.normal) < 0.99f;
  }
  EXPECT_EQ(missing, 0u);
  EXPECT_EQ(moved, 0u) << "by " << farthest << " at most";
  EXPECT_LE(turned, g.surfaces.size() / 20);
}

std::string name_of(const testing::TestParamInfo<HardCase>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Scenes, HardCases, testing::ValuesIn(scene_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(Files, HardCases, testing::ValuesIn(file_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(Cases, HardFiles, testing::ValuesIn(faithful_file_cases()), name_of);

}  // namespace
}  // namespace ssdo::test::hard_test
