// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "scene.h"

Camera orbit(Random& r, Vec at, Range distance, Range elevation, Range fov) {
  Camera c;
  const float a = r.angle(), e = r(elevation.low, elevation.high) * kPi / 180;
  const float d = r.log(distance.low, distance.high);
  c.fov = r(fov.low, fov.high);
  c.target = at;
  c.eye = at + Vec{std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)} * d;
  if (r.chance(.07f)) c.ortho_width = 2 * d * std::tan(c.fov * kPi / 360);
  return c;
}

Camera inside(Random& r, Vec size, Range fov) {
  Camera c;
  const float top = size.z - .25f;
  const float height = r.chance(.6f) ? std::min(r(1.3f, 1.8f), top) : r(.3f, top);
  const auto near_wall = [&](float s) { return r.chance(.5f) ? r(.3f, .6f) : s - r(.3f, .6f); };
  c.eye = {near_wall(size.x), near_wall(size.y), height};
  if (r.chance(.5f)) c.eye.x = size.x * r(.15f, .85f);
  if (r.chance(.3f)) c.eye.y = size.y * r(.15f, .85f);
  const Vec across{size.x - c.eye.x, size.y - c.eye.y, 0};
  c.target = {c.eye.x + (across.x - c.eye.x) * r(.3f, 1) + size.x * r(-.2f, .2f),
              c.eye.y + (across.y - c.eye.y) * r(.3f, 1) + size.y * r(-.2f, .2f),
              height + r(-.8f, .3f)};
  c.fov = r(fov.low, fov.high);
  return c;
}

Camera walk(Random& r, Vec eye, float turn, Range fov) {
  Camera c;
  const float a = r(-turn, turn);
  c.eye = eye;
  c.target = eye + Vec{std::cos(a), std::sin(a), r(-.2f, .15f)} * 10;
  c.fov = r(fov.low, fov.high);
  return c;
}

void behind_camera(Random& r, Scene& scene) {
  if (!r.chance(.4f)) return;
  const Camera& c = scene.camera;
  const Vec view = c.target - c.eye;
  const float reach = std::max(length(view), .3f), heading = std::atan2(view.y, view.x);
  const Rot face = about_z(heading - kPi / 2);  // +y of the added things looks along the view
  const float near = reach * r(.3f, 1.5f);
  const auto at = [&](float side, float back) {
    Vec p = c.eye + face * Vec{side, -back, 0};
    p.z = 0;
    return p;
  };
  Mesh& m = scene.mesh;
  m.tint = r.albedo();
  switch (r.count(0, 3)) {
    case 0: {  // a wall or a house front
      const float w = reach * r(.6f, 4), h = reach * r(.4f, 2.5f);
      m.box(at(r(-.5f, .5f) * w, near) + Vec{0, 0, h / 2}, {w / 2, reach * .03f, h / 2},
            face * about_z(r(-.4f, .4f)));
      break;
    }
    case 1:  // houses
      for (int i = r.count(1, 4); i > 0; --i) {
        const float w = reach * r(.3f, 1), h = reach * r(.5f, 2.5f);
        m.box(at(reach * r(-2, 2), near + w + reach * r(0, 2)) + Vec{0, 0, h / 2},
              {w, w * r(.5f, 1), h / 2}, face);
      }
      break;
    case 2:  // trees
      for (int i = r.count(1, 6); i > 0; --i)
        place(r, m, tree(r, r.count(0, 1)), at(reach * r(-2, 2), near + reach * r(.2f, 2)),
              reach * r(.5f, 1.6f));
      break;
    default:  // a crew, and a frame of cloth
      for (int i = r.count(1, 5); i > 0; --i)
        place(r, m, person(r), at(reach * r(-1, 1), near + r(.2f, 1)), std::min(1.f, reach));
      if (r.chance(.5f))
        m.box(at(reach * r(-1, 1), near) + Vec{0, 0, reach * r(.5f, 1.2f)},
              {reach * .5f, .01f, reach * .4f}, face * about_z(r(-1, 1)) * about_x(r(-.6f, .6f)));
  }
}

namespace {
// Steps back, in the direction of the view, until everything near the target is in the picture, or
// nearly so. What is more than a few times as far away as the camera was, is ground or background.
void show_all(Random& r, Scene& scene) {
  Camera& c = scene.camera;
  const Vec view = c.target - c.eye, forward = unit(view);
  const Vec right = unit(cross(forward, Vec{0, 0, 1})), up = cross(right, forward);
  const float before = length(view), reach = 2.5f * before;
  const float wide = std::tan(c.fov * kPi / 360), high = wide * .6f;
  float distance = before, half_width = 0;
  for (const Vec p : scene.mesh.points) {
    const Vec v = p - c.target;
    if (length(v) > reach) continue;
    const float x = std::fabs(dot(v, right)), y = std::fabs(dot(v, up));
    distance = std::max(distance, std::max(x / wide, y / high) - dot(v, forward));
    half_width = std::max(half_width, std::max(x, y / .6f));
  }
  const float margin = r(.8f, 1.15f);
  c.eye = c.target - forward * std::max(before, distance * margin);
  c.eye.z = std::max(c.eye.z, .05f * before);
  if (c.ortho_width > 0) c.ortho_width = std::max(c.ortho_width, 2 * half_width * margin);
}
}  // namespace

const std::vector<Family>& families() {
  static const std::vector<Family> all = [] {
    std::vector<Family> out;
    for (const auto& part :
         {room_families(), town_families(), nature_families(), object_families(), set_families(),
          open_set_families(), open_place_families(), cutaway_families(), backlot_families()})
      out.insert(out.end(), part.begin(), part.end());
    return out;
  }();
  return all;
}

namespace {
// Frames from `id` on are of the families from `first` to before `end`.
struct Part {
  int id, first, end;
  bool behind;           // things may stand behind the camera
  float whole;           // probability that the camera steps back until it shows all that is there
  float foreground = 0;  // probability that something stands close to the camera
};
constexpr Part kParts[] = {{0, 0, 38, true, 0},
                           {1200, 38, 55, true, 0},
                           {2200, 38, 57, false, 0},
                           {2500, 38, 57, false, .6f},
                           {2900, 0, 57, true, .1f, .6f}};

const Part& part_of(int id) {
  const Part* part = kParts;
  for (const Part& p : kParts)
    if (id >= p.id) part = &p;
  return *part;
}
}  // namespace

// In turn; of the open families, those that are trained on three times as often as the others.
int family_of(int id) {
  const Part& part = part_of(id);
  std::vector<int> turns;
  for (int round = 0; round < (part.first ? 3 : 1); ++round)
    for (int i = part.first; i < part.end; ++i)
      if (round == 0 || !families()[size_t(i)].validation) turns.push_back(i);
  return turns[size_t(id - part.id) % turns.size()];
}

void surround(Random& r, Scene& s, int id) {
  const Part& part = part_of(id);
  if (part.behind) behind_camera(r, s);
  if (part.whole > 0 && r.chance(part.whole)) show_all(r, s);
}

bool has_foreground(Random& r, int id) {
  const float share = part_of(id).foreground;
  return share > 0 && r.chance(share);
}
