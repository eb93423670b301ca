// SPDX-License-Identifier: Apache-2.0
//
// What method ssdo makes of directional light and of senders, against the listing's sums in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "estimators/ssdo_request.h"
#include "estimators/view_space/half_ball.h"
#include "math/frame.h"
#include "support/analytic_scene.h"

namespace ssdo::test::ssdo_light_test {
namespace {

const Window kWindow{0, 0, 96, 72};

/// A floor up to a wall, and a ball.
Geometry floor_wall_and_ball() {
  const Surface scene =
      all_of({cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) { return p.y < 0; }),
              cut(plane({}, {0, -1, 0}), [](const glm::dvec3& p) { return p.z > 0; }),
              sphere({0.4, -0.5, 0.3}, 0.3)});
  return geometry_of(
      scene, look_at(camera_from_fov(40, kWindow, 1), {0, -4, 3}, {0, -0.3, 0.3}, {0, 0, 1}),
      kWindow);
}

/// Red light from behind the wall, blue light from the side of the viewer, and a little from
/// everywhere.
Environment two_coloured_lamps() {
  auto map = std::make_shared<Plane<glm::vec3>>(48, 24);
  const EnvironmentFrame z_up{.up = UpAxis::z};
  const Environment places(std::make_shared<Plane<glm::vec3>>(48, 24, glm::vec3(1)), z_up);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 48; ++x) {
      const glm::dvec3 d(places.texel_direction(x, y));
      const double red = std::pow(std::max(0.0, d.y), 3), blue = std::pow(std::max(0.0, -d.y), 2);
      (*map)(x, y) = {0.1 + 4 * red, 0.2 + 0.5 * std::max(0.0, d.z), 0.1 + 2 * blue};
    }
  }
  return Environment(map, z_up);
}

/// The method's direct light, point by point in double.
class SlowDirect {
 public:
  struct Parameters {
    double bias = 0.001, singularity = 1, strength = 1;
    std::vector<std::string> set() const {
      return {"bias=" + std::to_string(bias), "singularity=" + std::to_string(singularity),
              "strength=" + std::to_string(strength)};
    }
  };

  SlowDirect(const Geometry& g, const Environment& sky, double radius, Parameters parameters)
      : g_(g), radius_(radius), parameters_(parameters) {
    for (int y = 0; y < sky.map()->height; ++y) {
      for (int x = 0; x < sky.map()->width; ++x)
        texels_.push_back({glm::dvec3(sky.texel_direction(x, y)), glm::dvec3((*sky.map())(x, y)),
                           double(sky.texel_solid_angle(y))});
    }
  }

  bool doubtful = false;  ///< whether rounding may have moved a point of the latest pixel
  double ao = 1;
  glm::dvec3 open{0}, direct{0};  ///< direct light without occluders and with them

  void look_from(int x, int y) {
    doubtful = false;
    const Surfel& s = g_.surfaces(x, y);
    const glm::dmat3 frame(frame_about(s.normal));
    double visible = 0;
    glm::dvec3 lit(0), light(0);
    for (const HalfBallSample& point : pattern_[std::size_t((y % 4) * 4 + x % 4)]) {
      const glm::dvec3 direction = frame * glm::dvec3(point.direction);
      const double cosine = point.direction.z;
      const bool hidden = hides(s, direction * (radius_ * double(point.length)));
      const double share = hidden ? 1 - parameters_.strength : 1;
      const glm::dvec3 arriving = around(direction, 2 * glm::pi<double>() / kPoints) * cosine;
      visible += 2.0 / kPoints * share * cosine;
      light += arriving, lit += arriving * share;
    }
    ao = std::clamp(visible, 0.0, 1.0);
    open = around(glm::dvec3(s.normal), glm::pi<double>());
    direct = open * glm::max(lit, glm::dvec3(0)) / light;
  }

 private:
  static constexpr int kPoints = 16;

  struct Texel {
    glm::dvec3 direction, radiance;
    double solid_angle;
  };

  /// Whether the surface that is seen at the point hides it.
  bool hides(const Surfel& s, const glm::dvec3& to_point) {
    const glm::dvec3 p(s.position), point = p + to_point;
    const glm::dvec2 at = g_.camera.project(point);
    for (const double place : {at.x, at.y}) doubtful |= std::abs(place - std::round(place)) < 1e-3;
    if (!g_.window.contains(int(std::floor(at.x)), int(std::floor(at.y)))) return false;
    const Surfel& q = g_.surfaces(int(at.x), int(at.y));
    if (!q.is_surface()) return false;
    const glm::dvec3 from_q = point - glm::dvec3(q.position);
    const double below = -glm::dot(from_q, glm::dvec3(q.normal)) -
                         (parameters_.bias * radius_ + double(s.rounding)),
                 room = parameters_.singularity * radius_ - std::abs(from_q.z);
    doubtful |= std::abs(below) < 1e-5 || std::abs(room) < 1e-5;
    return below > 0 && room > 0;
  }

  /// The sky over a lobe that falls linearly in the cosine and has the weight of a cone of so many
  /// steradians; with pi it is the irradiance over pi.
  glm::dvec3 around(const glm::dvec3& camera_direction, double solid_angle) const {
    const glm::dvec3 d = glm::transpose(glm::dmat3(g_.world_to_camera)) * camera_direction;
    const double edge = 1 - solid_angle / glm::pi<double>();
    glm::dvec3 sum(0);
    double weights = 0;
    for (const Texel& texel : texels_) {
      const double w = std::max(0.0, glm::dot(d, texel.direction) - edge) * texel.solid_angle;
      weights += w, sum += w * texel.radiance;
    }
    return sum / weights;
  }

  const Geometry& g_;
  std::vector<Texel> texels_;
  double radius_;
  Parameters parameters_;
  std::vector<std::vector<HalfBallSample>> pattern_ = half_ball_pattern(4, kPoints, 0);
};

/// Compares pixels of which no point is doubtful; gives how many of them have lost half of the red
/// light, but a tenth of the blue at most.
int expect_the_slow_light(const SlowDirect::Parameters& parameters) {
  const Geometry g = floor_wall_and_ball();
  const Environment sky = two_coloured_lamps();
  const Products out = run_ssdo(g, {.radius = 0.8f, .environment = sky, .set = parameters.set()});
  SlowDirect slow(g, sky, 0.8, parameters);
  int compared = 0, without_red = 0;
  for (int y = 1; y < kWindow.height(); y += 5) {
    for (int x = 2; x < kWindow.width(); x += 5) {
      if (!g.surfaces(x, y).is_surface()) continue;
      slow.look_from(x, y);
      if (slow.doubtful) continue;
      EXPECT_NEAR(out.ao(x, y), slow.ao, 1e-4) << x << "," << y;
      // Lookups interpolate between directions 3 degrees apart, and light without occluders is
      // exact to 1e-3 of that of a surface which faces the lamps.
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(out.direct(x, y)[c], slow.direct[c], 0.008 * slow.open[c]) << x << "," << y;
      const glm::dvec3 share = glm::dvec3(out.direct(x, y)) / slow.open;
      without_red += share.x < 0.5 && share.z > 0.9;
      ++compared;
    }
  }
  EXPECT_GT(compared, 150);
  return without_red;
}

TEST(SsdoLight, IsTheSumOverVisiblePointsAndItsShadowsHaveTheOtherLampsColour) {
  EXPECT_GT(expect_the_slow_light({}), 3);
}

TEST(SsdoLight, ItsParametersAreThoseOfTheSum) {
  EXPECT_EQ(expect_the_slow_light({.strength = 0.3}), 0) << "a third of the shadow";
  // More is taken than there is.
  EXPECT_GT(expect_the_slow_light({.strength = 3}), 3);
  expect_the_slow_light({.bias = 0.2});
  expect_the_slow_light({.singularity = 0.1});
}

TEST(SsdoLight, ParametersChangeIt) {
  const Geometry g = floor_wall_and_ball();
  const Environment sky = two_coloured_lamps();
  const auto mean = [&](const SlowDirect::Parameters& parameters) {
    double sum = 0;
    for (const glm::vec3& light :
         run_ssdo(g, {.radius = 0.8f, .environment = sky, .set = parameters.set()}).direct.pixels)
      sum += double(light.x + light.y + light.z);
    return sum;
  };
  const double usual = mean({});
  EXPECT_GT(mean({.strength = 0.3}), 1.01 * usual);
  EXPECT_LT(mean({.strength = 3}), 0.99 * usual);
  EXPECT_GT(mean({.bias = 0.2}), 1.01 * usual);
  EXPECT_GT(mean({.singularity = 0.1}), 1.01 * usual);
}

/// The listing's sum for one pixel, and how many form factors it cut.
struct SlowBounce {
  double strength = 1, singularity = 1;
  int cut = 0, whole = 0;

  glm::dvec3 operator()(const Geometry& g, int x, int y, const Plane<glm::vec3>& sent,
                        double radius) {
    constexpr int kPoints = 16;
    const auto pattern = half_ball_pattern(4, kPoints, 0);
    const glm::dvec3 p(g.surfaces(x, y).position), n(g.surfaces(x, y).normal);
    const glm::dmat3 frame(frame_about(glm::vec3(n)));
    glm::dvec3 sum(0);
    for (const HalfBallSample& s : pattern[std::size_t((y % 4) * 4 + x % 4)]) {
      const glm::dvec3 point = p + radius * double(s.length) * (frame * glm::dvec3(s.direction));
      const glm::dvec2 at = g.camera.project(point);
      if (!g.window.contains(int(std::floor(at.x)), int(std::floor(at.y)))) continue;
      const int qx = int(at.x), qy = int(at.y);
      const glm::dvec3 delta = p - glm::dvec3(g.surfaces(qx, qy).position),
                       unit = glm::normalize(delta);
      if (delta == glm::dvec3(0)) continue;
      const double receiver = std::max(0.0, glm::dot(unit, -n)),
                   sender = std::max(0.0, glm::dot(unit, glm::dvec3(g.surfaces(qx, qy).normal))),
                   form_factor = radius * radius * receiver * sender / glm::dot(delta, delta);
      cut += form_factor > singularity, whole += form_factor > 0 && form_factor < singularity;
      sum += strength * std::min(singularity, form_factor) * glm::dvec3(sent(qx, qy));
    }
    return sum * 2.0 * glm::pi<double>() / double(kPoints) / glm::pi<double>();
  }
};

TEST(SsdoLight, BounceIsTheListingsSum) {
  const Geometry g = floor_wall_and_ball();
  Plane<glm::vec3> sent(kWindow.width(), kWindow.height());
  for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = {0.8f, float(i % 7), 0};
  for (SlowBounce slow : {SlowBounce{}, SlowBounce{2.5, 0.2}, SlowBounce{0.5, 2}}) {
    const Products out =
        run_ssdo(g, {.radius = 0.8f,
                     .set = {"bounce-strength=" + std::to_string(slow.strength),
                             "bounce-singularity=" + std::to_string(slow.singularity)},
                     .bounces = 1,
                     .radiance = sent});
    double total = 0;
    for (int y = 1; y < kWindow.height(); y += 5) {
      for (int x = 2; x < kWindow.width(); x += 7) {
        const glm::dvec3 expected = slow(g, x, y, sent, 0.8);
        // A point may project onto the edge between two pixels.
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(out.bounce(x, y)[c], expected[c], 1e-4 + 1e-4 * expected[c]) << x << "," << y;
        total += expected.x;
      }
    }
    EXPECT_GT(total, 10);
    EXPECT_GT(slow.cut, 10);
    EXPECT_GT(slow.whole, 100);
  }
}

}  // namespace
}  // namespace ssdo::test::ssdo_light_test
