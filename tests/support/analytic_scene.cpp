// SPDX-License-Identifier: Apache-2.0
#include "support/analytic_scene.h"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

namespace ssdo::test {

Surface plane(const glm::dvec3& point, const glm::dvec3& normal) {
  return [=](const Ray& ray) -> std::optional<Hit> {
    const double t = glm::dot(point - ray.origin, normal) / glm::dot(ray.direction, normal);
    if (!(t > 1e-9)) return std::nullopt;
    return Hit{t, normal};
  };
}

Surface sphere(const glm::dvec3& centre, double radius) {
  return [=](const Ray& ray) -> std::optional<Hit> {
    const glm::dvec3 o = ray.origin - centre;
    const double b = glm::dot(o, ray.direction), c = glm::dot(o, o) - radius * radius,
                 d = b * b - c;
    if (d < 0 || -b - std::sqrt(d) < 1e-9) return std::nullopt;
    const double t = -b - std::sqrt(d);
    return Hit{t, (o + t * ray.direction) / radius};
  };
}

Surface dome(const glm::dvec3& centre, double radius) {
  return [=](const Ray& ray) -> std::optional<Hit> {
    const glm::dvec3 o = ray.origin - centre;
    const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(o, ray.direction) / a,
                 d = b * b - (glm::dot(o, o) - radius * radius) / a;
    if (d < 0 || std::sqrt(d) - b < 1e-9) return std::nullopt;
    const double t = std::sqrt(d) - b;
    return Hit{t, -(o + t * ray.direction) / radius};
  };
}

Surface cut(Surface surface, std::function<bool(const glm::dvec3&)> keep) {
  return [=](const Ray& ray) -> std::optional<Hit> {
    const auto hit = surface(ray);
    return hit && keep(ray.origin + hit->distance * ray.direction) ? hit : std::nullopt;
  };
}

Surface all_of(std::vector<Surface> surfaces) {
  return [=](const Ray& ray) {
    std::optional<Hit> nearest;
    for (const Surface& surface : surfaces) {
      const auto hit = surface(ray);
      if (hit && (!nearest || hit->distance < nearest->distance)) nearest = hit;
    }
    return nearest;
  };
}

Camera look_at(Camera projection, const glm::dvec3& eye, const glm::dvec3& target,
               const glm::dvec3& up) {
  const glm::dvec3 back = glm::normalize(eye - target),
                   right = glm::normalize(glm::cross(up, back));
  const glm::dmat3 to_world(right, glm::cross(back, right), back);
  projection.rotation = glm::transpose(to_world);
  projection.origin = eye;
  return projection;
}

Camera tilted(const Camera& projection, double tilt_degrees, double distance,
              const glm::dvec3& target) {
  const double t = glm::radians(tilt_degrees);
  return look_at(projection, target + distance * glm::dvec3(0, -std::sin(t), std::cos(t)), target,
                 {0, std::cos(t), std::sin(t)});
}

Camera lat_long(const Window& display) {
  Camera camera;
  camera.panorama = true;
  camera.fx = display.width() / (2 * glm::pi<double>());
  camera.fy = display.height() / glm::pi<double>();
  camera.cx = 0.5 * (display.x0 + display.x1), camera.cy = 0.5 * (display.y0 + display.y1);
  return camera;
}

Ray ray_through(const Camera& camera, double px, double py) {
  const glm::dmat3 to_world = glm::transpose(camera.rotation);
  const Camera::Ray ray = camera.ray({px, py});
  return {camera.origin + to_world * ray.origin, glm::normalize(to_world * ray.direction)};
}

Picture take_picture(const Surface& scene, const Camera& camera, const Window& window) {
  Picture picture{window, camera, Plane<glm::vec3>(window.width(), window.height()),
                  Plane<glm::vec3>(window.width(), window.height()),
                  Plane<unsigned char>(window.width(), window.height())};
  for (int y = window.y0; y < window.y1; ++y) {
    for (int x = window.x0; x < window.x1; ++x) {
      const Ray ray = ray_through(camera, x + 0.5, y + 0.5);
      const auto hit = scene(ray);
      if (!hit) continue;
      const std::size_t i = picture.position.index(x - window.x0, y - window.y0);
      picture.position[i] = glm::vec3(ray.origin + hit->distance * ray.direction);
      const bool away = glm::dot(hit->normal, ray.direction) > 0;
      picture.normal[i] = glm::vec3(away ? -hit->normal : hit->normal);
      picture.valid[i] = 1;
    }
  }
  return picture;
}

Geometry geometry_of(const Surface& scene, const Camera& camera, const Window& window) {
  Geometry g;
  g.window = g.display = window;
  g.camera = camera;
  g.world_known = true;
  g.world_to_camera = glm::mat3(camera.rotation);
  g.surfaces = Surfaces(window.width(), window.height());
  for (int y = window.y0; y < window.y1; ++y) {
    for (int x = window.x0; x < window.x1; ++x) {
      const Ray ray = ray_through(camera, x + 0.5, y + 0.5);
      const auto hit = scene(ray);
      if (!hit) continue;
      const std::size_t i = g.surfaces.index(x - window.x0, y - window.y0);
      const glm::dvec3 p = camera.to_camera(ray.origin + hit->distance * ray.direction);
      const glm::dvec3 n = glm::dot(hit->normal, ray.direction) > 0 ? -hit->normal : hit->normal;
      g.surfaces.set(
          i, {glm::vec3(p), glm::vec3(camera.rotation * n), float(glm::length(p)) / 16777216});
    }
  }
  return g;
}

}  // namespace ssdo::test
