// SPDX-License-Identifier: Apache-2.0
//
// The sides of bodies that the camera does not see, under lamps nearby, against rays in double.
#include "scene/solids/unseen_side.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>

#include "estimators/bitmask/request.h"
#include "math/frame.h"
#include "math/sampling.h"
#include "math/sobol.h"
#include "scene/light/lamps/lamp.h"
#include "support/boxes.h"

namespace ssdo::test::unseen_side_test {
namespace {

TEST(UnseenSide, OfABallIsTheOtherHalfOfIt) {
  const glm::vec3 view(0, 0, 1);
  for (const float radius : {0.5f, 3.0f}) {
    for (const float aside : {0.0f, 0.5f, 0.9f, 0.99f}) {
      const glm::vec3 normal(aside, 0, std::sqrt(1 - aside * aside));
      const float chord = 2 * radius * normal.z;
      const glm::vec3 behind = radius * normal - way_through(kDepthOfWidth * chord, 0) * view;
      EXPECT_NEAR(glm::distance(behind, radius * unseen_normal(normal, view)), 0, 1e-6f * radius);
    }
  }
}

const Window kWindow{0, 0, 192, 144};
const glm::dvec3 kCentre(0, 0, 0.6);
constexpr double kRadius = 0.6;
constexpr float kAlbedo = 0.8f;

/// Light and one bounce of what the scene's lamps give.
Products lit(const Scene& scene) {
  return bitmask_method().estimate(scene,
                                   {.products = {.ao = true, .direct = true, .bounce = true},
                                    .radius = kNoLimit,
                                    .bounces = 1,
                                    .slices = 12,
                                    .steps = 512,
                                    .extend_offscreen = false},
                                   {});
}

/// A ball on a floor, seen obliquely from above.
struct BallOnFloor {
  Surface ball = sphere(kCentre, kRadius);
  Surface all = all_of({plane({}, {0, 0, 1}), ball});
  Camera camera = tilted(camera_from_ortho_width(4, kWindow, 1), 55, 6, kCentre);
  Geometry geometry = geometry_of(all, camera, kWindow);

  std::shared_ptr<const Source> lamp_at(const glm::dvec3& position) const {
    Lamp lamp;
    lamp.position = position, lamp.radius = 0.05;
    lamp.intensity = 400;
    return make_source(lamp, {camera.rotation, camera.origin}, 0.005);
  }

  /// What of the lamp's light the ball sends to a point of the floor, over pi. It shadows itself
  /// only where it turns away from the lamp.
  double bounce_at(const Source& lamp, const Point& p) const {
    constexpr int kRays = 512;
    const glm::mat3 frame = frame_about(glm::vec3(p.normal));
    double sum = 0;
    for (std::uint32_t s = 0; s < kRays; ++s) {
      const glm::dvec3 to(cosine_direction(frame, sobol_point(s, 1)));
      const std::optional<Hit> hit = ball({p.position, to});
      if (!hit) continue;
      const glm::dvec3 at = p.position + hit->distance * to, normal = (at - kCentre) / kRadius;
      sum += kAlbedo * double(lamp.unoccluded(camera.to_camera(at), camera.rotation * normal).x) /
             kRays;
    }
    return sum;
  }
};

struct LampCase {
  const char* where;
  glm::dvec3 position;
};

/// On the floor behind the ball. Pixels tell the ball's width and a guess its depth.
TEST(UnseenSide, SendsWhatALampNearbyGivesIt) {
  const BallOnFloor of;
  const LampCase cases[] = {{"behind", {0, 1.3, 0.9}},
                            {"above", {0, 0.2, 1.8}},
                            {"in front", {0, -1.2, 1.6}},
                            {"under the floor", {0, 0.8, -0.4}}};
  for (const LampCase& c : cases) {
    Scene scene = scene_of(of.geometry, Environment::constant(glm::vec3(0)), kAlbedo);
    scene.solids = guess_solids(of.geometry);
    const auto lamp = of.lamp_at(c.position);
    scene.light.sources = {lamp};
    const Products out = lit(scene);
    double sum = 0, exact = 0;
    int count = 0;
    for (int y = 0; y < kWindow.height(); y += 2) {
      for (int x = 0; x < kWindow.width(); x += 2) {
        const Point p = point_at(of.all, of.camera, kWindow, x, y);
        const glm::dvec2 away(p.position.x, p.position.y - kCentre.y);
        if (p.position.z > 1e-6 || away.y < 0.5 * std::abs(away.x) || away.y > 1.2) continue;
        sum += double(out.bounce(x, y).x), ++count;
        if (c.position.z > 0) exact += of.bounce_at(*lamp, p);
      }
    }
    ASSERT_GT(count, 100);
    sum /= count, exact /= count;
    fmt::print("lamp {}: bounce {:.5f}, by rays {:.5f}\n", c.where, sum, exact);
    EXPECT_NEAR(sum, exact, 0.15 * exact + 0.0005) << c.where;
  }
}

/// A box on a floor before a wall, seen at a flat angle from above: its top takes few rows.
struct BoxBeforeWall {
  Box box{{-0.5, -0.4, 0}, {0.5, 0.4, 1}};
  Surface all =
      all_of({cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) { return p.y < 1; }),
              cut(plane({0, 1, 0}, {0, -1, 0}), [](const glm::dvec3& p) { return p.z > 0; }),
              box.surface()});
  Camera camera = tilted(camera_from_fov(40, kWindow, 1), 12, 6, {0, 0, 0.8});
  Geometry geometry = geometry_of(all, camera, kWindow);
  std::shared_ptr<const Source> lamp;

  explicit BoxBeforeWall(const glm::dvec3& position) {
    Lamp of;
    of.position = position, of.radius = 0.05, of.intensity = 400;
    lamp = make_source(of, {camera.rotation, camera.origin}, 0.005);
  }

  /// What surfaces send of the lamp's light to a point, over pi.
  double bounce_at(const glm::dvec3& from_lamp, const Point& p) const {
    constexpr int kRays = 512;
    const glm::mat3 frame = frame_about(glm::vec3(p.normal));
    double sum = 0;
    for (std::uint32_t s = 0; s < kRays; ++s) {
      const glm::dvec3 to(cosine_direction(frame, sobol_point(s, 1)));
      const std::optional<Hit> hit = all({p.position + 1e-6 * p.normal, to});
      if (!hit) continue;
      const glm::dvec3 at = p.position + hit->distance * to,
                       normal = glm::dot(hit->normal, to) > 0 ? -hit->normal : hit->normal,
                       way = from_lamp - at;
      const auto shade = all({at + 1e-6 * normal, glm::normalize(way)});
      if (shade && shade->distance < glm::length(way)) continue;
      sum += kAlbedo * double(lamp->unoccluded(camera.to_camera(at), camera.rotation * normal).x) /
             kRays;
    }
    return sum;
  }
};

/// On the wall, above and beside the box. With the mirror image of the visible sides the error is
/// 0.45 where the lamp lights the hidden side. Elsewhere what remains is the light of the hidden
/// floor, which is taken to be as bright as the floor before the box.
TEST(UnseenSide, OfABoxIsWhatItsDepthSays) {
  struct BoxCase {
    LampCase lamp;
    double most_error;
  };
  const BoxCase cases[] = {{{"behind", {0.2, 0.7, 1.5}}, 0.29},
                           {{"above", {0, 0, 1.8}}, 0.70},
                           {{"in front", {0, -1.2, 1.6}}, 0.45}};
  for (const auto& [c, most_error] : cases) {
    const BoxBeforeWall of(c.position);
    Scene scene = scene_of(of.geometry, Environment::constant(glm::vec3(0)), kAlbedo);
    scene.solids = guess_solids(of.geometry);
    scene.light.sources = {of.lamp};
    const Products out = lit(scene);
    double sum = 0, exact = 0, square = 0;
    int count = 0;
    for (int y = 0; y < kWindow.height(); y += 2) {
      for (int x = 0; x < kWindow.width(); x += 2) {
        const Point p = point_at(of.all, of.camera, kWindow, x, y);
        if (p.position.y < 0.999 || std::abs(p.position.x) > 0.6 || p.position.z > 2) continue;
        const double found = double(out.bounce(x, y).x), truth = of.bounce_at(c.position, p);
        sum += found, exact += truth, square += (found - truth) * (found - truth), ++count;
      }
    }
    ASSERT_GT(count, 100);
    sum /= count, exact /= count;
    const double error = std::sqrt(square / count) / exact;
    fmt::print("lamp {}: bounce {:.5f}, by rays {:.5f}, error {:.3f}\n", c.where, sum, exact,
               error);
    EXPECT_LT(error, most_error) << c.where;
  }
}

/// A wall on a floor, seen obliquely from above, and a screen that hides its lower part, which is
/// known as a solid that sends what the upper part does.
struct WallBehindScreen {
  Surface wall = all_of({plane({}, {0, 0, 1}), upright(0, 1.5)});
  Surface all = all_of({wall, upright(-0.2, 1)});
  Camera camera = tilted(camera_from_ortho_width(4, kWindow, 1), 45);
  Geometry geometry = geometry_of(all, camera, kWindow);
  Solids solids = constant_thickness(geometry, 0.01f);

  WallBehindScreen() {
    const Geometry hidden = geometry_of(wall, camera, kWindow);
    SolidLayer layer(kWindow.width(), kWindow.height(), Provenance::guessed);
    layer.thickness = Plane<float>(kWindow.width(), kWindow.height(), 0.01f);
    for (int x = 0; x < kWindow.width(); ++x) {
      int shown = -1;
      for (int y = 0; y < kWindow.height(); ++y) {
        const std::size_t i = geometry.surfaces.index(x, y);
        const Point p = point_at(wall, camera, kWindow, x, y);
        if (p.position.z < 0.01 || std::abs(p.position.y) > 0.01) continue;
        const float behind =
            glm::distance(geometry.surfaces[i].position, hidden.surfaces[i].position);
        if (behind < 0.01f)
          shown = int(i);
        else
          layer.distance[i] = behind, layer.sender[i] = shown;
      }
    }
    solids.behind.push_back(std::move(layer));
  }

  static Surface upright(double y, double half_width) {
    return cut(plane({0, y, 0}, {0, -1, 0}), [=](const glm::dvec3& p) {
      return p.z > 0 && p.z < 0.5 && std::abs(p.x) < half_width;
    });
  }

  /// Of a lamp in front, on the floor before the screen and behind the wall.
  glm::dvec2 bounces() const {
    Lamp lamp;
    lamp.position = {0, -1.2, 1.2}, lamp.radius = 0.05, lamp.intensity = 400;
    Scene scene = scene_of(geometry, Environment::constant(glm::vec3(0)), kAlbedo);
    scene.solids = solids;
    scene.light.sources = {make_source(lamp, {camera.rotation, camera.origin}, 0.005)};
    const Products out = lit(scene);
    glm::dvec2 mean(0);
    for (int x = 86; x < 106; ++x)
      mean += glm::dvec2(out.bounce(x, 100).x, out.bounce(x, 46).x) / 20.0;
    return mean;
  }
};

TEST(UnseenSide, OfWhatIsHiddenDoesNotSendTheLightOfItsFront) {
  const glm::dvec2 bounces = WallBehindScreen().bounces();
  const double before = bounces.x, behind = bounces.y;
  fmt::print("bounce before a screen {:.5f}, behind a wall behind it {:.5f}\n", before, behind);
  EXPECT_GT(before, 0.001);
  EXPECT_LT(behind, 0.01 * before);
}

}  // namespace
}  // namespace ssdo::test::unseen_side_test
