// SPDX-License-Identifier: Apache-2.0
#include "scene/light/lamps/lamp.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

#include "math/light_range.h"
#include "math/pi.h"
#include "scene/light/lamps/disk_lamp.h"
#include "scene/light/lamps/distant_lamp.h"
#include "scene/light/lamps/rect_lamp.h"
#include "scene/light/lamps/sphere_lamp.h"

namespace ssdo {

double Lamp::area() const {
  double size = 0;
  switch (type) {
    case LampType::sphere:
      size = 4 * kPi * radius * radius;
      break;
    case LampType::disk:
      size = kPi * radius * radius;
      break;
    case LampType::rect:
      size = width * height;
      break;
    case LampType::distant: {
      const double sine = std::sin(glm::radians(angle) / 2), covered = sine * sine;
      size = kPi * (angle <= 180 ? covered : 2 - covered);
    }
  }
  return size > 0 ? size : 1;
}

double Lamp::reach() const {
  return type == LampType::rect ? std::hypot(width, height) / 2 : radius;
}

glm::dvec3 Lamp::value() const { return color * temperature * (intensity * std::exp2(exposure)); }

namespace {

/// What stands for the radius of a point: it is less than any pixel.
constexpr double kPointRadius = 1e-9;

glm::vec3 turned(const WorldToCamera& camera, const glm::dvec3& direction) {
  return glm::vec3(glm::normalize(camera.rotation * direction));
}

std::shared_ptr<LocalLamp> shape_of(const Lamp& lamp) {
  if (lamp.type == LampType::rect) {
    auto rect = std::make_shared<RectLamp>();
    const double longer = std::max(lamp.width, lamp.height);
    rect->half_sides = glm::dvec2(lamp.width, lamp.height) / longer;
    rect->size = longer / 2;
    return rect;
  }
  std::shared_ptr<LocalLamp> round;
  if (lamp.type == LampType::disk)
    round = std::make_shared<DiskLamp>();
  else
    round = std::make_shared<SphereLamp>();
  round->size = std::max(lamp.radius, kPointRadius);
  round->faces_receiver = lamp.soft_falloff;
  return round;
}

std::shared_ptr<DistantLamp> distant(const Lamp& lamp, const WorldToCamera& camera) {
  auto source = std::make_shared<DistantLamp>();
  source->direction = turned(camera, lamp.axes[2]);
  const double half_angle = glm::radians(lamp.angle) / 2;
  source->cap = {std::sin(half_angle), std::cos(half_angle)};
  return source;
}

}  // namespace

std::shared_ptr<Source> make_source(const Lamp& lamp, const WorldToCamera& camera, double nearest) {
  // What it gives to a surface for which received() is 1: that is over the area that it shows, a
  // quarter of that of a sphere and, of the sky, what is above the horizon.
  const double shown = lamp.type == LampType::sphere    ? lamp.area() / 4
                       : lamp.type == LampType::distant ? std::min(lamp.area(), glm::pi<double>())
                                                        : lamp.area();
  const glm::dvec3 light =
      lamp.value() * (lamp.normalize ? shown / lamp.area() : shown) / glm::pi<double>();
  const double most = std::max({light.x, light.y, light.z});
  std::shared_ptr<Source> source;
  if (lamp.type == LampType::distant) {
    source = distant(lamp, camera);
  } else {
    const std::shared_ptr<LocalLamp> near = shape_of(lamp);
    near->center = glm::vec3(camera.rotation * (lamp.position - camera.origin));
    near->axes = {turned(camera, lamp.axes[0]), turned(camera, lamp.axes[1]),
                  turned(camera, -lamp.axes[2])};
    // No receiver gets more than kBrightest: see LocalLamp::received().
    near->nearest =
        std::max(nearest, std::sqrt(most * glm::pi<double>() / near->shown_area() / kBrightest));
    if (lamp.has_cone) {
      near->spot_cone.outer = glm::radians(lamp.cone_angle);
      near->spot_cone.inner = near->spot_cone.outer * (1 - lamp.cone_softness);
      near->spot_cone.by_cosine = lamp.cone_by_cosine;
    }
    source = near;
  }
  source->name = lamp.name;
  source->irradiance = glm::vec3(light);
  return source;
}

}  // namespace ssdo
