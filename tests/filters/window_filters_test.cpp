// SPDX-License-Identifier: Apache-2.0
//
// Box, Gaussian, normal and depth filter, each against its source's sum, and where they cross
// edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "filters/filter_products.h"
#include "filters/registry.h"
#include "support/analytic_scene.h"
#include "support/random_frame.h"

namespace ssdo::test::window_filters_test {
namespace {

constexpr int kPattern = 4;

const char* const kFilters[] = {"box", "gaussian", "normal", "depth"};

Products filtered(std::string_view name, const Products& in, const Geometry& g) {
  return filter_products(find_filter(name), in, g.surfaces, kPattern);
}

using Weight = std::function<double(const Surfel& p, const Surfel& q, int dx, int dy)>;

/// A sum of its source, pixel by pixel in double.
Plane<glm::dvec3> slow_pass(const Plane<glm::dvec3>& in, const Geometry& g, int reach_x,
                            int reach_y, const Weight& weight) {
  Plane<glm::dvec3> out = in;
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x) {
      if (!g.is_surface(in.index(x, y))) continue;
      glm::dvec3 sum(0);
      double weights = 0;
      for (int dy = -reach_y; dy <= reach_y; ++dy) {
        for (int dx = -reach_x; dx <= reach_x; ++dx) {
          const int qx = x + dx, qy = y + dy;
          if (qx < 0 || qy < 0 || qx >= in.width || qy >= in.height) continue;
          if (!g.is_surface(in.index(qx, qy))) continue;
          const double w = weight(g.surfaces(x, y), g.surfaces(qx, qy), dx, dy);
          sum += w * in(qx, qy);
          weights += w;
        }
      }
      out(x, y) = sum / weights;
    }
  }
  return out;
}

double cosine(const Surfel& p, const Surfel& q) {
  return glm::dot(glm::dvec3(p.normal), glm::dvec3(q.normal));
}

/// The filter by the formulas at the top of its file; `unit` makes directions of the averages.
Plane<glm::dvec3> slow(std::string_view name, Plane<glm::dvec3> plane, const Geometry& g,
                       bool unit) {
  const auto pass = [&](int reach_x, int reach_y, const Weight& weight) {
    plane = slow_pass(plane, g, reach_x, reach_y, weight);
    for (std::size_t i = 0; unit && i < plane.size(); ++i) {
      if (g.is_surface(i)) plane[i] = glm::normalize(plane[i]);
    }
  };
  if (name == "box") {
    pass(2, 2,
         [](const Surfel&, const Surfel&, int dx, int dy) { return dx < 2 && dy < 2 ? 1.0 : 0.0; });
  } else if (name == "gaussian") {
    const Weight weight = [](const Surfel& p, const Surfel& q, int dx, int dy) {
      const bool same = cosine(p, q) >= 0.8 && std::abs(p.position.z - q.position.z) <= 2;
      return same ? std::exp(-(dx * dx + dy * dy) / (2 * 2.5 * 2.5)) : 0.0;
    };
    for (int round = 0; round < 3; ++round) pass(5, 0, weight), pass(0, 5, weight);
  } else if (name == "depth") {
    const Weight weight = [](const Surfel& p, const Surfel& q, int dx, int dy) {
      const double gaussian[] = {0.15317, 0.144893, 0.122649, 0.092902, 0.06297};
      const int offset = std::abs(dx + dy);
      if (offset % 2 != 0) return 0.0;
      const double apart = std::abs(double(p.position.z) - double(q.position.z)) / 300;
      return (offset > 0 ? 0.3 + gaussian[offset / 2] : gaussian[0]) *
             std::max(0.0, 1 - 2000 * apart);
    };
    pass(8, 0, weight), pass(0, 8, weight);
  } else {
    const Weight weight = [](const Surfel& p, const Surfel& q, int dx, int dy) {
      const double taps[] = {0.37004405286, 0.31718061674, 0.19823788546, 0.11453744493};
      const double t = std::clamp((cosine(p, q) - 0.8) / 0.2, 0.0, 1.0);
      return taps[std::abs(dx + dy)] * t * t * (3 - 2 * t);
    };
    pass(3, 0, weight), pass(0, 3, weight);
  }
  return plane;
}

Plane<glm::dvec3> in_double(const Plane<glm::vec3>& from) {
  Plane<glm::dvec3> to(from.width, from.height);
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[i];
  return to;
}

Plane<glm::dvec3> in_double(const Plane<float>& from) {
  Plane<glm::dvec3> to(from.width, from.height);
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = glm::dvec3(double(from[i]));
  return to;
}

glm::dvec3 value(const Plane<glm::vec3>& plane, std::size_t i) { return plane[i]; }
glm::dvec3 value(const Plane<float>& plane, std::size_t i) { return glm::dvec3(double(plane[i])); }

class WindowFilter : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, WindowFilter, testing::ValuesIn(kFilters),
                         [](const auto& which) { return std::string(which.param); });

TEST_P(WindowFilter, IsTheSumOfItsSource) {
  for (const Size size : kSizes) {
    SCOPED_TRACE(testing::Message() << size.width << " x " << size.height);
    const Geometry g = random_geometry(size.width, size.height, 1);
    const Products in = random_products(g, 2), out = filtered(GetParam(), in, g);
    const auto check = [&](const auto& before, const auto& after, bool unit) {
      const auto expected = slow(GetParam(), in_double(before), g, unit);
      for (std::size_t i = 0; i < before.size(); ++i) {
        if (!g.is_surface(i)) {
          EXPECT_EQ(after[i], before[i]);
        } else {
          EXPECT_LT(difference(value(after, i), expected[i]), 1e-5);
        }
      }
    };
    check(in.ao, out.ao, false);
    check(in.reflection, out.reflection, false);
    check(in.error, out.error, false);
    check(in.direct, out.direct, false);
    check(in.bounce, out.bounce, false);
    check(in.bent, out.bent, true);
  }
}

TEST_P(WindowFilter, LeavesAFlatFieldAsItIsToTheLastBit) {
  const Geometry g = random_geometry(67, 41, 7);
  Products flat;
  flat.ao = Plane<float>(67, 41, 0.7f);
  flat.error = Plane<float>(67, 41, -0.1f);
  flat.direct = Plane<glm::vec3>(67, 41, glm::vec3(0.1f, 1 / 3.0f, 12345.678f));
  flat.bent = Plane<glm::vec3>(67, 41, glm::vec3(0, 0, 1));
  const Products out = filtered(GetParam(), flat, g);
  EXPECT_EQ(out.ao.pixels, flat.ao.pixels);
  EXPECT_EQ(out.error.pixels, flat.error.pixels);
  EXPECT_EQ(out.direct.pixels, flat.direct.pixels);
  EXPECT_EQ(out.bent.pixels, flat.bent.pixels);
  EXPECT_TRUE(out.bounce.empty());
}

const Window kWindow{0, 0, 64, 48};

/// 1 where `here` holds, 0 elsewhere.
Products step(const Geometry& g, const std::function<bool(const Surfel&)>& here) {
  Products p;
  p.ao = Plane<float>(g.surfaces.width, g.surfaces.height);
  for (std::size_t i = 0; i < p.ao.size(); ++i) p.ao[i] = here(g.surfaces[i]) ? 1.0f : 0.0f;
  return p;
}

std::size_t pixels_that_changed(std::string_view name, const Products& before, const Geometry& g) {
  const Products after = filtered(name, before, g);
  std::size_t count = 0;
  for (std::size_t i = 0; i < before.ao.size(); ++i) count += after.ao[i] != before.ao[i];
  return count;
}

/// A floor, and a box of this height that covers its left half.
Geometry raised_half(double height, double distance) {
  const Surface floor = plane({}, {0, 0, 1}), top = cut(plane({0, 0, height}, {0, 0, 1}),
                                                        [](const glm::dvec3&p) { return p.x < 0; });
  return geometry_of(all_of({floor, top}),
                     look_at(camera_from_fov(40, kWindow, 1), {0, 0, distance}, {}, {0, 1, 0}),
                     kWindow);
}

TEST(WindowFilters, CrossAnEdgeOfDepthAsTheirSourcesDo) {
  for (const auto& [height, gaussian_crosses] : {std::pair{2.1, false}, std::pair{1.9, true}}) {
    const Geometry g = raised_half(height, 8);
    const float middle = float(height / 2 - 8);
    const Products in = step(g, [&](const Surfel& s) { return s.position.z > middle; });
    EXPECT_GE(pixels_that_changed("box", in, g), 3u * 48) << "three columns of each row bleed";
    EXPECT_GE(pixels_that_changed("normal", in, g), 3u * 48) << "depth does not count";
    EXPECT_EQ(pixels_that_changed("gaussian", in, g) > 0, gaussian_crosses) << height;
  }
}

TEST(DepthFilter, CrossesEdgesOfLessThanItsReachInDepth) {
  for (const auto& [height, crosses] : {std::pair{0.16, false}, std::pair{0.14, true}}) {
    const Geometry g = raised_half(height, 8);
    const float middle = float(height / 2 - 8);
    const Products in = step(g, [&](const Surfel& s) { return s.position.z > middle; });
    EXPECT_EQ(pixels_that_changed("depth", in, g) > 0, crosses) << height;
  }
}

TEST(WindowFilters, CrossAnEdgeOfNormalsAsTheirSourcesDo) {
  const Geometry corner =
      geometry_of(all_of({plane({}, {0, 0, 1}), plane({}, {0, -1, 0})}),
                  look_at(camera_from_fov(40, kWindow, 1), {0, -4, 4}, {}, {0, 0, 1}), kWindow);
  const Products in = step(corner, [](const Surfel& s) { return s.normal.y > 0.5f; });
  EXPECT_GE(pixels_that_changed("box", in, corner), 3u * 64);
  EXPECT_GE(pixels_that_changed("depth", in, corner), 3u * 64) << "normals do not count";
  EXPECT_EQ(pixels_that_changed("normal", in, corner), 0u);
  EXPECT_EQ(pixels_that_changed("gaussian", in, corner), 0u);
}

TEST(BoxFilter, RemovesThePatternAndMovesThePictureByHalfAPixel) {
  const Geometry g = raised_half(0, 5);
  Products p;
  p.ao = p.error = Plane<float>(kWindow.width(), kWindow.height());
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x < kWindow.width(); ++x) {
      p.ao(x, y) = float(((y % 4) * 4 + x % 4) * 7 % 16) / 15;
      p.error(x, y) = float(x);
    }
  }
  const Products out = filtered("box", p, g);
  for (int y = 2; y < kWindow.height() - 1; ++y) {
    for (int x = 2; x < kWindow.width() - 1; ++x) {
      EXPECT_NEAR(out.ao(x, y), 0.5, 1e-6);
      EXPECT_NEAR(out.error(x, y), x - 0.5, 1e-5);
    }
  }
}

}  // namespace
}  // namespace ssdo::test::window_filters_test
