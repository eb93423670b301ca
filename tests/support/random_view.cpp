// SPDX-License-Identifier: Apache-2.0
#include "support/random_view.h"

#include <algorithm>
#include <utility>

#include "support/boxes.h"

namespace ssdo::test {
namespace {

/// Where a thing stands, and how large it is.
struct Place {
  glm::dvec3 middle;
  glm::dvec3 to_viewer;  ///< unit
  double size;           ///< compared with the width of the frame there
};

Place random_place(RandomNumbers& random, const RandomLens& lens, double near, double far) {
  const double depth = random.by_ratio(near, far);
  const Window& w = lens.display;
  const double y = random.between(-0.2, 1.2), x = random.between(-0.2, 1.2);
  const glm::dvec2 pixel(w.x0 + x * w.width(), w.y0 + y * w.height());
  const double width = w.width() / lens.camera.fx * (lens.camera.orthographic ? 1 : depth);
  const Camera::Ray ray = lens.camera.ray(pixel);
  return {lens.camera.unproject(pixel, depth), -glm::normalize(ray.direction),
          width * random.by_ratio(0.03, 1)};
}

Box random_box(RandomNumbers& random, const Place& at) {
  const double z = random.between(0.05, 1), y = random.between(0.05, 1),
               x = random.between(0.05, 1);
  const glm::dvec3 half = at.size * glm::dvec3(x, y, z);
  return {at.middle - half, at.middle + half};
}

/// A box as seen from within.
Surface room(const Box& box) {
  return [=](const Ray& ray) -> std::optional<Hit> {
    const auto [enter, leave] = box.cross(ray);
    if (enter > leave || leave < 1e-9) return std::nullopt;
    const glm::dvec3 p = ray.origin + leave * ray.direction, middle = (box.low + box.high) / 2.0,
                     from = (p - middle) / (box.high - middle);
    int side = 0;
    for (int c = 1; c < 3; ++c) side = std::abs(from[c]) > std::abs(from[side]) ? c : side;
    glm::dvec3 normal(0);
    normal[side] = from[side] > 0 ? -1 : 1;
    return Hit{leave, normal};
  };
}

/// The part of a plane that is no farther than `length` from a point, and `width` from a line
/// through it.
Surface strip(const glm::dvec3& middle, const glm::dvec3& normal, double length, double width) {
  const glm::dvec3 other = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0),
                   across = glm::normalize(glm::cross(normal, other));
  return cut(plane(middle, normal), [=](const glm::dvec3& p) {
    return glm::length(p - middle) < length && std::abs(glm::dot(p - middle, across)) < width;
  });
}

Surface stairs(RandomNumbers& random, const Place& at) {
  std::vector<Surface> steps;
  const double high = at.size * random.by_ratio(0.01, 0.3);
  const glm::dvec3 rise = random.direction() * high;
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 middle = at.middle + rise * double(i);
    steps.push_back(strip(middle, at.to_viewer, 2 * at.size, at.size * (1 - 0.2 * i)));
  }
  return all_of(std::move(steps));
}

Surface random_thing(RandomNumbers& random, const Place& at) {
  const glm::dvec3 side = glm::normalize(glm::cross(at.to_viewer, random.direction()));
  switch (random.whole(0, 7)) {
    case 0:
      return random_box(random, at).surface();
    case 1:
      return plane(at.middle, random.direction());
    case 2:
      return plane(at.middle, glm::normalize(side + random.by_ratio(1e-4, 0.1) * at.to_viewer));
    case 3: {
      const double wide = at.size * random.by_ratio(1e-3, 0.1);
      return strip(at.middle, random.direction(), 4 * at.size, wide);
    }
    case 4:
      return stairs(random, at);
    case 5: {
      const double gap = glm::length(at.middle) * random.by_ratio(1e-9, 1e-3);
      return all_of({strip(at.middle, at.to_viewer, at.size, at.size),
                     plane(at.middle - gap * at.to_viewer, at.to_viewer)});
    }
    case 6: {
      const Box box = random_box(random, at);
      return room(
          {glm::min(box.low, glm::dvec3(-at.size)), glm::max(box.high, glm::dvec3(at.size))});
    }
    default:
      return sphere(at.middle, at.size);
  }
}

}  // namespace

RandomLens random_lens(RandomNumbers& random) {
  RandomLens lens;
  int width = random.whole(6, 24), height = random.whole(5, 16);
  if (random.chance(0.1)) width = random.whole(1, 4);
  if (random.chance(0.1)) height = random.whole(1, 4);
  const int x0 = random.chance(0.6) ? 0 : random.whole(-40, 40),
            y0 = random.chance(0.6) ? 0 : random.whole(-40, 40);
  lens.data = lens.display = {x0, y0, x0 + width, y0 + height};
  if (random.chance(0.3)) {
    Window& w = lens.display;
    w.x0 += random.whole(-width, width / 2), w.x1 += random.whole(-width / 2, width);
    w.y0 += random.whole(-height, height / 2), w.y1 += random.whole(-height / 2, height);
    w.x1 = std::max(w.x1, w.x0 + 1), w.y1 = std::max(w.y1, w.y0 + 1);
  }
  lens.pixel_aspect = random.chance(0.8) ? 1 : random.by_ratio(0.5, 2);
  const double fov = random.chance(0.7) ? random.between(20, 90) : random.by_ratio(1, 170);
  lens.camera = random.chance(0.2) ? camera_from_ortho_width(random.by_ratio(0.5, 20), lens.display,
                                                             lens.pixel_aspect)
                                   : camera_from_fov(fov, lens.display, lens.pixel_aspect);
  if (random.chance(0.2)) {
    lens.is_centred = false;
    lens.camera.cx += random.between(-1, 1) * width,
        lens.camera.cy += random.between(-1, 1) * height;
  }
  return lens;
}

RandomLens finer(RandomLens lens, int times) {
  for (Window* w : {&lens.data, &lens.display})
    *w = {times * w->x0, times * w->y0, times * w->x1, times * w->y1};
  Camera& camera = lens.camera;
  for (double* length : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *length *= times;
  return lens;
}

Surface random_world(RandomNumbers& random, const RandomLens& lens) {
  const bool deep = random.chance(0.1);
  const double near = deep ? 1e-3 : 2, far = deep ? 1e4 : 20;
  std::vector<Surface> things;
  for (int left = random.whole(1, 6); left > 0; --left)
    things.push_back(random_thing(random, random_place(random, lens, near, far)));
  return all_of(std::move(things));
}

Plane<SeenPoint> look(const Surface& world, const RandomLens& lens, const glm::dmat3& to_world,
                      const glm::dvec3& eye) {
  Camera camera = lens.camera;
  camera.rotation = glm::transpose(to_world);
  camera.origin = eye;
  Plane<SeenPoint> seen(lens.data.width(), lens.data.height());
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const Ray ray = ray_through(camera, lens.data.x0 + x + 0.5, lens.data.y0 + y + 0.5);
      const auto hit = world(ray);
      if (!hit) continue;
      const bool away = glm::dot(hit->normal, ray.direction) > 0;
      seen(x, y) = {true, ray.origin + hit->distance * ray.direction,
                    away ? -hit->normal : hit->normal};
    }
  }
  return seen;
}

glm::dmat3 random_rotation(RandomNumbers& random) {
  const glm::dvec3 x = random.direction(), z = glm::normalize(glm::cross(x, random.direction()));
  return {x, glm::cross(z, x), z};
}

}  // namespace ssdo::test
