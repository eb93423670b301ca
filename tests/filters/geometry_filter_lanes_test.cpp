// SPDX-License-Identifier: Apache-2.0
//
// The vector loops of the filter against a slow reference, and what must hold for each product.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "filters/filter_products.h"
#include "filters/registry.h"
#include "support/random_frame.h"

namespace ssdo::test::geometry_filter_lanes_test {
namespace {

std::optional<Surfel> surface_at(const Geometry& g, int x, int y) {
  if (x < 0 || y < 0 || x >= g.surfaces.width || y >= g.surfaces.height) return std::nullopt;
  const Surfel s = g.surfaces(x, y);
  return s.is_surface() ? std::optional(s) : std::nullopt;
}

/// w of the pixel (dx, dy) from (x, y), which shows a surface.
double reference_weight(const Geometry& g, int x, int y, int dx, int dy) {
  const auto ramp = [](double t) { return std::clamp(2 - 2 * t, 0.0, 1.0); };
  const Surfel p = g.surfaces(x, y);
  const auto q = surface_at(g, x + dx, y + dy), o = surface_at(g, x - dx, y - dy);
  if (!q) return 0;
  const glm::dvec3 n(p.normal);
  const auto above = [&](const Surfel& s) {
    return glm::dot(glm::dvec3(s.position) - glm::dvec3(p.position), n);
  };
  const double distance = glm::length(glm::dvec3(q->position) - glm::dvec3(p.position)),
               rounding = p.rounding + q->rounding, turn = 1 - glm::dot(n, glm::dvec3(q->normal));
  double height = std::max(0.0, std::abs(above(*q)) - rounding);
  if (o) height = std::min(height, std::max(0.0, std::abs(above(*q) + above(*o)) - 2 * rounding));
  return ramp(distance > 0 ? height / (0.3 * distance) : 0) * ramp(turn / 0.2);
}

/// v of the pixel (dx, dy) from (x, y); both show a surface.
double reference_resemblance(const Geometry& g, int x, int y, int dx, int dy) {
  const Surfel p = g.surfaces(x, y), q = g.surfaces(x + dx, y + dy);
  const glm::dvec3 n(p.normal), n_q(q.normal),
      to_q = glm::dvec3(q.position) - glm::dvec3(p.position);
  const double distance = glm::length(to_q),
               off = std::max(std::abs(glm::dot(to_q, n)), std::abs(glm::dot(to_q, n_q))),
               sine = distance > 0 ? off / distance : 0;
  return std::clamp(glm::dot(n, n_q), 0.0, 1.0) * (1 - sine);
}

double brightness(double v) { return v; }
double brightness(const glm::dvec3& v) { return (v.x + v.y + v.z) / 3; }

/// How a product is finished, and whether steps in it are edges of shadows.
struct Kind {
  bool unit = false, shadowed = false;
};

/// The sums at the top of geometry_filter.cpp, in double.
template <class Value, class T>
Value reference(const Plane<T>& in, const Geometry& g, int pattern_size, int x, int y, Kind kind) {
  const auto finished = [&](const Value& v) {
    return kind.unit ? v / std::sqrt(glm::dot(v, v)) : v;
  };
  if (pattern_size > 4) {
    const auto mean = [&](int qx, int qy) { return reference<Value>(in, g, 4, qx, qy, kind); };
    const Value own = mean(x, y);
    Value sum = own;
    for (const int qy : {y - 2, y + 2}) {
      for (const int qx : {x - 2, x + 2}) {
        if (!surface_at(g, qx, qy)) continue;
        double weight = reference_weight(g, x, y, qx - x, qy - y) / 4;
        if (kind.shadowed) {
          const double p = brightness(own), q = brightness(mean(qx, qy)),
                       step = std::abs(q - p) / std::max(p + q + 0.5, 0.25);
          weight *= std::clamp(2 - 2 * step / 0.15, 0.0, 1.0);
        }
        sum += weight * (mean(qx, qy) - own);
      }
    }
    return finished(sum);
  }
  const int half = pattern_size / 2;
  const auto window_sum = [&](const auto& weight, Value& sum) {
    double weights = 0;
    for (int dy = -half; dy <= half; ++dy) {
      for (int dx = -half; dx <= half; ++dx) {
        if (!surface_at(g, x + dx, y + dy)) continue;
        const double border = (std::abs(dx) == half ? 0.5 : 1) * (std::abs(dy) == half ? 0.5 : 1),
                     w = border * weight(g, x, y, dx, dy);
        weights += w;
        sum += w * Value(in(x + dx, y + dy));
      }
    }
    return weights;
  };
  Value sum(0), resembling(0);
  const double weights = window_sum(reference_weight, sum),
               more = window_sum(reference_resemblance, resembling),
               e = 1.5 * std::max(1 / weights - 8.0 / (3 * pattern_size * pattern_size), 0.0);
  return finished((sum + e * resembling) / (weights + e * more));
}

/// Bounce light, which a second pass holds to what ao leaves.
glm::dvec3 reference_bounce(const Products& in, const Geometry& g, int pattern_size, int x, int y) {
  const glm::dvec3 mean = reference<glm::dvec3>(in.bounce, g, pattern_size, x, y, {});
  if (pattern_size <= 4) return mean;
  const double e = 1e-3, open = reference<double>(in.ao, g, pattern_size, x, y, {}),
               own_open = reference<double>(in.ao, g, 4, x, y, {}),
               ao = reference<double>(in.ao, g, pattern_size, x, y, {.shadowed = true});
  const glm::dvec3 own = reference<glm::dvec3>(in.bounce, g, 4, x, y, {});
  return (mean + e * own) / (1 - open + e * (1 - own_open)) * (1 - ao);
}

TEST(GeometryFilterLanes, AreTheReference) {
  for (const Size size : kSizes) {
    const Geometry g = random_geometry(size.width, size.height, 1);
    const Products in = random_products(g, 2);
    for (const int pattern_size : {2, 4, 8}) {
      const Products out = filter_products(find_filter("geometry"), in, g.surfaces, pattern_size);
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          SCOPED_TRACE(testing::Message() << size.width << "x" << size.height << " T "
                                          << pattern_size << " at " << x << ", " << y);
          if (!g.is_surface(g.surfaces.index(x, y))) {
            EXPECT_EQ(out.ao(x, y), in.ao(x, y));
            EXPECT_EQ(out.error(x, y), in.error(x, y));
            EXPECT_EQ(out.direct(x, y), in.direct(x, y));
            EXPECT_EQ(out.bent(x, y), in.bent(x, y));
            continue;
          }
          const auto expected3 = [&](const Plane<glm::vec3>& plane, Kind kind = {}) {
            return reference<glm::dvec3>(plane, g, pattern_size, x, y, kind);
          };
          const auto expected = [&](const Plane<float>& plane, Kind kind = {}) {
            return reference<double>(plane, g, pattern_size, x, y, kind);
          };
          const Kind shadowed{.shadowed = true};
          EXPECT_NEAR(out.ao(x, y), expected(in.ao, shadowed), 1e-4);
          EXPECT_NEAR(out.reflection(x, y), expected(in.reflection, shadowed), 1e-4);
          EXPECT_NEAR(out.error(x, y), expected(in.error), 1e-4);
          EXPECT_LT(difference(out.direct(x, y), expected3(in.direct, shadowed)), 1e-4);
          EXPECT_LT(difference(out.visibility.sky(x, y), expected3(in.visibility.sky, shadowed)),
                    1e-4);
          for (std::size_t k = 0; k < 2; ++k)
            EXPECT_NEAR(out.visibility.sources[k](x, y),
                        expected(in.visibility.sources[k], shadowed), 1e-4);
          EXPECT_LT(difference(out.bounce(x, y), reference_bounce(in, g, pattern_size, x, y)),
                    1e-4);
          EXPECT_LT(difference(out.bent(x, y), expected3(in.bent, {.unit = true})), 1e-4);
          EXPECT_NEAR(glm::length(out.bent(x, y)), 1, 1e-6);
        }
      }
    }
  }
}

TEST(GeometryFilter, IsOddInTheErrorAndLinear) {
  const Geometry g = random_geometry(40, 30, 7);
  Products a, b, minus, sum;
  a.error = random_products(g, 8).error;
  b.error = random_products(g, 9).error;
  minus = sum = a;
  for (float& e : minus.error.pixels) e = -e;
  for (std::size_t i = 0; i < sum.error.size(); ++i) sum.error[i] += b.error[i];
  const Products of_a = filter_products(find_filter("geometry"), a, g.surfaces, 4),
                 of_b = filter_products(find_filter("geometry"), b, g.surfaces, 4),
                 of_minus = filter_products(find_filter("geometry"), minus, g.surfaces, 4),
                 of_sum = filter_products(find_filter("geometry"), sum, g.surfaces, 4);
  for (std::size_t i = 0; i < a.error.size(); ++i) {
    EXPECT_EQ(of_minus.error[i], -of_a.error[i]);
    EXPECT_NEAR(of_sum.error[i], of_a.error[i] + of_b.error[i], 1e-5);
  }
  EXPECT_TRUE(of_a.ao.empty() && of_a.direct.empty() && of_a.bounce.empty() && of_a.bent.empty());
}

TEST(GeometryFilter, LeavesNoDirectionWithoutLength) {
  const Geometry g = random_geometry(40, 30, 10);
  Products p;
  p.bent = Plane<glm::vec3>(40, 30);
  const Products out = filter_products(find_filter("geometry"), p, g.surfaces, 4);
  for (const glm::vec3& bent : out.bent.pixels) EXPECT_EQ(bent, glm::vec3(0));
}

}  // namespace
}  // namespace ssdo::test::geometry_filter_lanes_test
