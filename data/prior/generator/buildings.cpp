// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "things.h"

Mesh wall(float width, float height, float thickness, const std::vector<Opening>& openings) {
  std::vector<float> xs{0, width}, zs{0, height};
  for (const Opening& o : openings) {
    xs.insert(xs.end(), {o.x0, o.x1});
    zs.insert(zs.end(), {o.z0, o.z1});
  }
  std::sort(xs.begin(), xs.end());
  std::sort(zs.begin(), zs.end());
  const auto is_open = [&](float x, float z) {
    return std::any_of(openings.begin(), openings.end(), [&](const Opening& o) {
      return x > o.x0 && x < o.x1 && z > o.z0 && z < o.z1;
    });
  };
  Mesh m;
  for (size_t j = 0; j + 1 < zs.size(); ++j) {
    float start = -1;  // of the run of solid cells in this row
    for (size_t i = 0; i + 1 < xs.size(); ++i) {
      const bool open = is_open((xs[i] + xs[i + 1]) / 2, (zs[j] + zs[j + 1]) / 2);
      if (!open && start < 0) start = xs[i];
      if (start < 0 || (!open && i + 2 < xs.size())) continue;
      const float end = open ? xs[i] : xs[i + 1];
      if (end - start > 1e-4f && zs[j + 1] - zs[j] > 1e-4f)
        m.block({start, 0, zs[j]}, {end, thickness, zs[j + 1]});
      start = -1;
    }
  }
  return m;
}

std::vector<Opening> windows(Random& r, float width, float height) {
  std::vector<Opening> out;
  const float sill = r(.5f, 1.1f), head = std::min(height - .2f, sill + r(.8f, 1.8f));
  for (float x = r(.3f, 1.2f); x < width - .8f;) {
    const float w = std::min(r(.6f, 2.2f), width - x - .2f);
    if (w < .3f) break;
    if (r.chance(.6f)) out.push_back({x, x + w, r.chance(.2f) ? .01f : sill, head});
    x += w + r(.2f, 2);
  }
  return out;
}

static Mesh painted(Mesh m, Vec tint) {
  for (Vec& c : m.albedo) c = tint;
  return m;
}

void ground(Mesh& scene, float z) {
  const float s = 2000;
  scene.quad({-s, -s, z}, {s, -s, z}, {s, s, z}, {-s, s, z});
}

void room(Random& r, Mesh& scene, const RoomPlan& plan) {
  const float t = r(.08f, .35f), x = plan.x, y = plan.y, h = plan.height;
  const Vec paint = r.albedo(), white{.75f, .75f, .73f};
  scene.tint = r.albedo();
  scene.block({-t, -t, -t}, {x + t, y + t, 0});
  scene.tint = white;
  if (!r.chance(plan.missing_ceiling)) {
    if (r.chance(.12f)) {  // a skylight
      const Opening hole{x * r(.1f, .4f), x * r(.5f, .9f), y * r(.1f, .45f), y * r(.5f, .9f)};
      scene.add(painted(wall(x, y, t, {hole}), white), about_x(kPi / 2), {0, 0, h + t});
    } else {
      scene.block({-t, -t, h}, {x + t, y + t, h + t});
    }
  }
  const Vec from[4] = {{x, 0, 0}, {x, y, 0}, {0, y, 0}, {0, 0, 0}};
  for (int i = 0; i < 4; ++i) {
    if (r.chance(plan.missing_wall)) continue;
    const float w = i & 1 ? y : x;
    const Mesh m =
        wall(w, h, t, r.chance(plan.windows) ? windows(r, w, h) : std::vector<Opening>{});
    const Rot turn = about_z(float(i) * kPi / 2 + kPi);
    scene.add(painted(m, r.chance(.8f) ? paint : r.albedo()), turn, from[i]);
    if (r.chance(.5f)) {  // a skirting board
      scene.tint = white;
      const Vec a = from[i], b = from[i] + turn * Vec{w, 0, 0};
      const Vec in = turn * Vec{0, -.02f, 0};
      scene.box((a + b) * .5f + in * .5f + Vec{0, 0, .05f}, {w / 2, .01f, .05f}, turn);
    }
  }
  if (!plan.outside) return;
  scene.tint = r.floor_albedo();
  if (r.chance(.85f)) ground(scene, r.chance(.7f) ? -t - .01f : -r(3, 15));
  if (!r.chance(.4f)) return;
  for (int i = r.count(1, 5); i > 0; --i) {
    const float a = r.angle(), d = r(8, 25) + std::max(x, y);
    scene.box({x / 2 + d * std::cos(a), y / 2 + d * std::sin(a), 0}, {r(2, 6), r(2, 6), r(3, 15)},
              about_z(a));
  }
}

// Furniture stands along the walls with its back to them, or free in the middle.
void furnish(Random& r, Mesh& scene, const RoomPlan& plan, int pieces) {
  const float x = plan.x, y = plan.y, h = plan.height;
  for (int i = 0; i < pieces; ++i) {
    const bool loose = r.chance(.3f);
    const Mesh m = loose ? (r.chance(.25f) ? person(r) : thing(r)) : furniture(r);
    const float scale = loose && m.top() < 1.4f ? r.log(.2f, 1) : 1;
    if (r.chance(loose ? .3f : .75f)) {
      const int side = r.count(0, 3);
      const float q = r(.15f, .85f), d = r(.28f, .5f);
      const Vec at[4] = {{x * q, d, 0}, {x - d, y * q, 0}, {x * q, y - d, 0}, {d, y * q, 0}};
      scene.add(m, about_z(float(side) * kPi / 2 + kPi), at[side], scale);
    } else {
      place(r, scene, m, {x * r(.15f, .85f), y * r(.15f, .85f), 0}, scale);
    }
  }
  scene.tint = r.albedo();
  for (int i = r.chance(.4f) ? r.count(1, 5) : 0; i > 0; --i) {  // pictures on the walls
    const int side = r.count(0, 3);
    const Vec at[4] = {{x * r(.2f, .8f), .02f, 0},
                       {x - .02f, y * r(.2f, .8f), 0},
                       {x * r(.2f, .8f), y - .02f, 0},
                       {.02f, y * r(.2f, .8f), 0}};
    const float w = r(.1f, .5f);
    scene.box(at[side] + Vec{0, 0, h * r(.45f, .65f)},
              {side & 1 ? .02f : w, side & 1 ? w : .02f, r(.1f, .4f)});
  }
  if (r.chance(.25f)) {  // beams
    const float z = h - r(.1f, .2f);
    for (float at = r(.2f, 1); at < y; at += r(.8f, 1.6f))
      scene.box({x / 2, at, z}, {x / 2, .08f, .1f});
  }
  if (r.chance(.3f)) {  // a pendant lamp
    const Vec at{x * r(.35f, .65f), y * r(.35f, .65f), h - r(.3f, .9f)};
    scene.tube(at, {at.x, at.y, h}, .006f, .006f, 5);
    scene.tube(at - Vec{0, 0, .15f}, at, r(.15f, .3f), .05f, 20, false);
  }
}

Mesh facade(Random& r, float width, float height) {
  const float body = r(6, 15), storey = r(2.8f, 3.8f), pane = r(.8f, 1.6f), gap = r(.6f, 1.8f);
  const float recess = r(.08f, .4f);
  const bool shop = r.chance(.4f);
  const int storeys = std::max(1, int(height / storey));
  const int columns = std::max(1, int((width - gap) / (pane + gap)));
  const float pitch = width / float(columns);
  std::vector<Opening> holes;
  for (int j = 0; j < storeys; ++j)
    for (int i = 0; i < columns; ++i) {
      const float z = float(j) * storey + (j ? .8f : shop ? .3f : .9f);
      const float top = std::min(height - .3f, z + storey * (j || !shop ? .5f : .65f));
      const float x = float(i) * pitch;
      if (top > z + .2f && !r.chance(.03f))
        holes.push_back({x + (pitch - pane) / 2, x + (pitch + pane) / 2, z, top});
    }
  const Vec stone = r.albedo();
  Mesh m = painted(wall(width, height, recess, holes), stone);
  m.tint = r.chance(.6f) ? Vec{.08f, .09f, .1f} : stone;
  m.block({0, recess, 0}, {width, recess + body, height});
  m.tint = stone;
  if (r.chance(.35f))
    for (const Opening& o : holes)
      if (o.z0 > 2 && r.chance(.5f)) {  // balconies
        m.block({o.x0 - .3f, -1, o.z0 - .9f}, {o.x1 + .3f, 0, o.z0 - .75f});
        m.block({o.x0 - .3f, -1, o.z0 - .75f}, {o.x1 + .3f, -.96f, o.z0 + .2f});
      }
  if (r.chance(.5f)) m.block({-.1f, -.4f, height - .3f}, {width + .1f, .1f, height});
  if (r.chance(.35f)) {  // a pitched roof
    const float d = body + recess, rise = r(1.5f, 4);
    const Vec a{0, -.3f, height}, b{width, -.3f, height}, c{width, d, height}, e{0, d, height};
    const Vec p{0, d / 2, height + rise}, q{width, d / 2, height + rise};
    m.tint = r.albedo();
    m.quad(a, b, q, p);
    m.quad(c, e, p, q);
    m.triangle(b, c, q);
    m.triangle(e, a, p);
  }
  return m;
}

void fence(Random& r, Mesh& scene, Vec a, Vec b, float height) {
  const float l = length(b - a);
  const Vec d = unit(b - a);
  const int kind = r.count(0, 3);  // pickets, wires, rails, mesh
  const float pitch = kind == 0 ? r(.08f, .2f) : r(.9f, 2.5f);
  const float post = kind == 0 ? r(.006f, .03f) : r(.02f, .06f);
  scene.tint = r.albedo();
  for (float x = 0; x <= l; x += pitch)
    scene.tube(a + d * x, a + d * x + Vec{0, 0, height}, post, post, 6);
  const int rails = kind == 0 ? 2 : r.count(2, 5);
  const float rail = kind == 1 ? .004f : r(.012f, .035f);
  for (int i = 1; i <= rails; ++i) {
    const Vec z{0, 0, height * float(i) / float(rails) - (kind == 0 ? .1f * height : 0)};
    scene.tube(a + z, b + z, rail, rail, 6);
  }
  for (float z = .05f; z < height && kind == 3; z += .12f)
    scene.tube(a + Vec{0, 0, z}, b + Vec{0, 0, z}, .003f, .003f, 4, false);
}

Mesh stairs(const Flight& f, bool solid) {
  Mesh m;
  for (int i = 0; i < f.steps; ++i) {
    const float y = f.going * float(i), z = f.rise * float(i + 1);
    m.block({-f.width / 2, y, solid ? 0 : z - .05f}, {f.width / 2, y + f.going + .02f, z});
  }
  return m;
}
