// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "scene/camera/camera.h"
#include "scene/geometry.h"

namespace ssdo::test {

/// Where a ray meets a surface.
struct Hit {
  double distance = 0;
  glm::dvec3 normal{0};
};

struct Ray {
  glm::dvec3 origin, direction;
};

/// A surface that answers rays; nothing where it is missed.
using Surface = std::function<std::optional<Hit>(const Ray&)>;

/// The plane through `point`, one-sided or not does not matter to a camera.
Surface plane(const glm::dvec3& point, const glm::dvec3& normal);

Surface sphere(const glm::dvec3& centre, double radius);

/// A sphere seen from its inside.
Surface dome(const glm::dvec3& centre, double radius);

/// The part of a surface where `keep` holds.
Surface cut(Surface surface, std::function<bool(const glm::dvec3&)> keep);

/// The nearest of several surfaces.
Surface all_of(std::vector<Surface> surfaces);

/// The projection of a lat-long panorama of all directions.
Camera lat_long(const Window& display);

/// A camera at `eye` that looks at `target`, in a world with `up` up.
Camera look_at(Camera projection, const glm::dvec3& eye, const glm::dvec3& target,
               const glm::dvec3& up);

/// A camera in the plane x = 0 that looks at `target` from `tilt_degrees` beside the z axis.
Camera tilted(const Camera& projection, double tilt_degrees, double distance = 6,
              const glm::dvec3& target = {});

/// The world-space ray through the centre of a pixel of the display window.
Ray ray_through(const Camera& camera, double px, double py);

/// World-space positions and normals of every pixel, and which pixels show a surface.
struct Picture {
  Window window;
  Camera camera;
  Plane<glm::vec3> position, normal;
  Plane<unsigned char> valid;
};

Picture take_picture(const Surface& scene, const Camera& camera, const Window& window);

/// The same in camera space, rounded once from double, as estimators take it.
Geometry geometry_of(const Surface& scene, const Camera& camera, const Window& window);

}  // namespace ssdo::test
