// SPDX-License-Identifier: Apache-2.0
//
// Bounce of lamps off surfaces that continue beyond the border of the frame, against rays in
// double. A wall shows the light of a floor that the frame cuts close to the wall.
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
#include "scene/light/light_group.h"

namespace ssdo::test::lamp_bounce_test {
namespace {

const Window kWindow{0, 0, 120, 90};
constexpr float kAlbedo = 0.8f;

/// Sums over the pixels of the wall up to a height of 1.5.
struct Bounce {
  double found = 0, exact = 0;
};

struct WallOnFloor {
  Surface floor = plane({}, {0, 0, 1});
  Surface all = all_of({floor, plane({}, {0, -1, 0})});
  Camera camera = look_at(camera_from_fov(30, kWindow, 1), {0, -4, 4}, {0, 0, 0.9}, {0, 0, 1});
  Geometry geometry = geometry_of(all, camera, kWindow);

  Products run(std::vector<std::shared_ptr<const Source>> lamps, bool by_light) const {
    Scene scene = scene_of(geometry, Environment::constant(glm::vec3(0)), kAlbedo);
    scene.light.sources = std::move(lamps);
    Request request{.products = {.ao = true, .direct = true, .bounce = true},
                    .radius = kNoLimit,
                    .bounces = 1,
                    .slices = 12,
                    .steps = 256};
    request.by_light.bounce = by_light;
    return bitmask_method().estimate(scene, request, {});
  }

  std::shared_ptr<const Source> make(const Lamp& lamp) const {
    return make_source(lamp, {camera.rotation, camera.origin}, 0.005);
  }

  double exact_at(const Source& lamp, const Point& p) const {
    constexpr int kRays = 256;
    const glm::mat3 frame = frame_about(glm::vec3(p.normal));
    double sum = 0;
    for (std::uint32_t s = 0; s < kRays; ++s) {
      const glm::dvec3 to(cosine_direction(frame, sobol_point(s, 1)));
      const std::optional<Hit> hit = floor({p.position, to});
      if (!hit) continue;
      const glm::dvec3 at = p.position + hit->distance * to;
      sum +=
          kAlbedo *
          double(lamp.unoccluded(camera.to_camera(at), camera.rotation * glm::dvec3(0, 0, 1)).x) /
          kRays;
    }
    return sum;
  }

  Bounce of(const Lamp& described) const {
    const auto lamp = make(described);
    const Products out = run({lamp}, false);
    Bounce bounce;
    for (int y = 0; y < kWindow.height(); y += 3) {
      for (int x = 0; x < kWindow.width(); x += 3) {
        const Point p = point_at(all, camera, kWindow, x, y);
        if (std::abs(p.position.y) > 1e-6 || p.position.z > 1.5) continue;
        bounce.found += double(out.bounce(x, y).x), bounce.exact += exact_at(*lamp, p);
      }
    }
    return bounce;
  }
};

Lamp bulb(const glm::dvec3& position) {
  Lamp lamp;
  lamp.name = "lamp";
  lamp.position = position, lamp.radius = 0.05, lamp.intensity = 400;
  return lamp;
}

/// A spot that shines down, to 30 degrees off its axis.
Lamp spot(const glm::dvec3& position) {
  Lamp lamp = bulb(position);
  lamp.has_cone = true, lamp.cone_angle = 30, lamp.cone_softness = 0.2;
  return lamp;
}

TEST(LampBounce, FallsOffBeyondTheBorder) {
  const WallOnFloor scene;
  for (const double away : {0.3, 0.8}) {
    for (const bool is_spot : {false, true}) {
      const glm::dvec3 at(0, -away, 1);
      const Bounce bounce = scene.of(is_spot ? spot(at) : bulb(at));
      fmt::print("{} {} from the wall: bounce {:.4f}, by rays {:.4f}\n", is_spot ? "spot" : "bulb",
                 away, bounce.found, bounce.exact);
      EXPECT_NEAR(bounce.found, bounce.exact, 0.15 * bounce.exact) << away << " " << is_spot;
    }
  }
}

/// Each lamp is relit on its own, so that their layers have the sum that is found for all.
TEST(LampBounce, OfEachLampAddsUp) {
  const WallOnFloor scene;
  const Products out =
      scene.run({scene.make(bulb({0.5, -0.3, 1})), scene.make(spot({-0.5, -0.8, 1}))}, true);
  double off = 0, sum = 0;
  for (std::size_t i = 0; i < out.bounce.size(); ++i) {
    glm::vec3 all(0);
    for (const LightProducts& light : out.lights) all += light.bounce[i];
    off = std::max(off, double(std::abs(all.x - out.bounce[i].x)));
    sum += double(out.bounce[i].x);
  }
  EXPECT_LT(off, 1e-3 * sum / double(out.bounce.size()));
}

}  // namespace
}  // namespace ssdo::test::lamp_bounce_test
