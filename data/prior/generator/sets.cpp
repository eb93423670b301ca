// SPDX-License-Identifier: Apache-2.0
//
// Sets and stages: open boxes, two walls and a floor, studios, people.
#include <algorithm>

#include "scene.h"

namespace {
// A box with an open front: test scenes, alcoves, shop windows.
void niche(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float x = r(1, 4), y = r(1, 4), h = r(1, 4), t = r(.02f, .15f);
  const int walls = r.count(0, 3);  // 0 left, 1 none, 2 and 3 both sides
  const Vec paint = r.albedo();
  m.tint = paint;
  m.block({-x / 2 - t, -y / 2 - t, -t}, {x / 2 + t, y / 2 + t, 0});
  m.block({-x / 2 - t, y / 2, 0}, {x / 2 + t, y / 2 + t, h});
  m.tint = r.chance(.6f) ? r.albedo() : paint;
  if (walls != 1) m.block({-x / 2 - t, -y / 2, 0}, {-x / 2, y / 2, h});
  m.tint = r.chance(.6f) ? r.albedo() : paint;
  if (walls > 1) m.block({x / 2, -y / 2, 0}, {x / 2 + t, y / 2, h});
  m.tint = paint;
  if (r.chance(.6f)) m.block({-x / 2 - t, -y / 2 - t, h}, {x / 2 + t, y / 2 + t, h + t});
  m.tint = r.floor_albedo();
  if (r.chance(.6f)) ground(m, r.chance(.7f) ? -t - .005f : -r(.5f, 4));
  for (int i = r.count(1, 8); i > 0; --i) {
    const Mesh o = r.chance(.15f) ? chair(r) : thing(r);
    place(r, m, o, {x * r(-.36f, .36f), y * r(-.35f, .36f), 0}, r(.15f, .5f) * std::min(x, y));
  }
  Camera& c = s.camera;
  c.eye = {x * r(-.45f, .45f), -r(.4f, 2.2f) * y, h * r(.2f, .9f)};
  c.target = {x * r(-.2f, .2f), y * .2f, h * r(.25f, .55f)};
  c.fov = r(30, 75);
  if (r.chance(.08f)) c.ortho_width = x * r(.8f, 1.6f);
}

// A film set: two or three flats, a floor, furniture; open above, lamps and crew outside.
void film_set(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  m.tint = r.floor_albedo();
  ground(m, -.02f);
  RoomPlan p{r(3, 9), r(3, 7), r(2.4f, 4)};
  m.tint = r.albedo();
  m.block({0, 0, -.02f}, {p.x, p.y, 0});
  m.tint = r.albedo();
  Mesh back =
      wall(p.x, p.height, .06f, r.chance(.5f) ? windows(r, p.x, p.height) : std::vector<Opening>{});
  m.add(back, {}, {0, p.y, 0});
  const bool left = r.chance(.5f), both = r.chance(.25f);
  const auto flat = [&](bool is_left) {
    Mesh side = wall(p.y, p.height, .06f,
                     r.chance(.4f) ? windows(r, p.y, p.height) : std::vector<Opening>{});
    m.add(side, about_z(kPi / 2), {is_left ? 0 : p.x + .06f, 0, 0});
  };
  if (left || both) flat(true);
  if (!left || both) flat(false);
  furnish(r, m, p, r.count(3, 9));
  for (int i = r.count(0, 3); i > 0; --i)
    place(r, m, person(r), {p.x * r(.2f, .8f), p.y * r(.2f, .8f), 0});
  for (int i = r.count(0, 4); i > 0; --i) {  // lamps on stands
    const Vec at{p.x * r(-.3f, 1.3f), -r(.3f, 2), r(2, 3.2f)};
    m.tint = {.05f, .05f, .05f};
    m.tube({at.x, at.y, 0}, at, .02f, .02f, 8);
    m.box(at, {.25f, .1f, .25f}, about_z(r(-.5f, .5f)) * about_x(-.5f));
  }
  Camera& c = s.camera;
  c.eye = {p.x * (left ? r(.4f, 1) : r(0, .6f)), r.chance(.5f) ? p.y * r(.05f, .25f) : -r(0, 3),
           r(.8f, 1.9f)};
  c.target = {p.x * r(.25f, .75f), p.y, r(.6f, 1.5f)};
  c.fov = r(28, 70);
}

// A sheet that bends from floor to wall.
void studio(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float size = r.log(.5f, 4), w = size * r(1, 4), bend = size * r(.1f, .8f);
  const float depth = size * r(.8f, 2), high = size * r(1, 3);
  m.tint = r.albedo();
  m.surface(1, 40, false, [&](float u, float v) {
    const float x = (u - .5f) * 2 * w;
    if (v < .3f) return Vec{x, -depth * 3 + (depth * 4 - bend) * v / .3f, 0};
    if (v > .7f) return Vec{x, depth, bend + high * (v - .7f) / .3f};
    const float a = (v - .3f) / .4f * kPi / 2;
    return Vec{x, depth - bend + bend * std::sin(a), bend - bend * std::cos(a)};
  });
  m.tint = r.floor_albedo();
  if (r.chance(.5f)) ground(m, -.01f);
  for (int i = r.count(1, 5); i > 0; --i) {
    const Mesh o = r.chance(.12f) ? person(r) : r.chance(.2f) ? robot(r) : thing(r);
    place(r, m, o, {r(-.4f, .4f) * size, r(-.4f, .4f) * size, 0}, size * r.log(.2f, .7f));
  }
  for (int i = r.chance(.5f) ? r.count(1, 3) : 0; i > 0; --i) {  // reflectors
    const float a = r(-kPi, 0), d = size * r(1.2f, 3);
    m.tint = {.8f, .8f, .8f};
    m.box({d * std::cos(a), d * std::sin(a), size * r(.5f, 1.5f)},
          {size * r(.3f, .8f), .02f * size, size * r(.3f, 1)}, about_z(a + kPi / 2));
  }
  const float a = -kPi / 2 + r(-.7f, .7f), e = r(.03f, .7f), d = size * r(1.2f, 3);
  Camera& c = s.camera;
  c.target = {0, 0, size * r(.1f, .35f)};
  c.eye = c.target + Vec{std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)} * d;
  c.fov = r(20, 50);
  if (r.chance(.08f)) c.ortho_width = size * r(1, 2);
}

// One to three free-standing walls with things in front of them.
void yard(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  m.tint = r.floor_albedo();
  ground(m);
  const float size = r.log(2, 20);
  for (int i = 0, n = r.count(1, 3); i < n; ++i) {
    const float h = r.chance(.6f) ? r.log(.8f, 4) : r.log(4, 12), l = size * r(.7f, 2.5f);
    const float turn = i ? kPi / 2 * r.sign() : 0;
    m.tint = r.albedo();
    m.box({i ? r.sign() * size * r(.6f, 1) : 0, size * (i ? r(.2f, .6f) : 1), h / 2},
          {l, .12f, h / 2}, about_z(turn + r(-.12f, .12f)));
  }
  for (int i = r.count(3, 16); i > 0; --i) {
    const Vec at{r(-.6f, .6f) * size, r(-.3f, .9f) * size, 0};
    const int kind = r.count(0, 5);
    const Mesh o = kind == 0   ? tree(r)
                   : kind == 1 ? furniture(r)
                   : kind == 2 ? person(r)
                   : kind == 3 ? plant(r)
                               : thing(r);
    place(r, m, o, at, kind == 0 ? r(1.5f, 5) : kind > 2 ? r.log(.2f, 1.2f) : 1);
  }
  if (r.chance(.4f))
    fence(r, m, {-size * .5f, r(-.3f, .6f) * size, 0}, {size * .5f, r(-.3f, .6f) * size, 0},
          r(.7f, 1.8f));
  Camera& c = s.camera;
  c.eye = {r(-.3f, .3f) * size, r(-.5f, .3f) * size, r(.6f, 2)};
  c.target = {c.eye.x + r(-.4f, .4f) * size, size, r(.3f, 1.6f)};
  c.fov = r(25, 70);
}

void people(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  m.tint = r.floor_albedo();
  ground(m);
  const int n = r.chance(.5f) ? r.count(1, 3) : r.count(4, 16);
  const float size = .5f * std::sqrt(float(n));
  for (int i = 0; i < n; ++i)
    place(r, m, person(r), n == 1 ? Vec{0, 0, 0} : Vec{r(-1, 1) * size, r(-1, 1) * size, 0});
  if (r.chance(.4f)) m.box({0, size + r(.6f, 3), 1.5f}, {r(2, 6), .1f, 1.6f});
  for (int i = r.count(0, 4); i > 0; --i)
    place(r, m, furniture(r), {r(-1, 1) * (size + .5f), r(-1, 1) * (size + .5f), 0});
  const bool close = r.chance(.35f);
  s.camera = orbit(r, {0, 0, close ? r(1.2f, 1.6f) : r(.7f, 1.1f)},
                   {close ? .8f + size * .6f : 2 + size, close ? 1.6f + size : 5 + size * 2},
                   {-4, 25}, {22, 55});
}

// Market stalls: cloth roofs over tables, close together.
void market(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  m.tint = r.floor_albedo();
  ground(m);
  const float lane = r(2, 4.5f), pitch = r(2.2f, 3.2f);
  const int n = r.count(2, 6);
  for (int i = 0; i < n; ++i)
    for (const float side : {-1.f, 1.f}) {
      if (r.chance(.15f)) continue;
      Mesh stall(r);
      const float w = pitch * r(.38f, .48f), d = r(.6f, 1), h = r(2, 2.5f);
      stall.block({-w, -d * .6f, .78f}, {w, d * .2f, .84f});
      stall.block({-w, -d * .6f, r.chance(.5f) ? .05f : .7f}, {w, -d * .55f, .8f});
      for (const float x : {-w, w})
        for (const float y : {-d, d}) stall.tube({x, y, 0}, {x, y, h}, .025f, .025f, 8);
      stall.tint = r.albedo();
      const float ridge = h + r(.1f, .6f);
      stall.quad({-w, -d - .2f, h - .1f}, {w, -d - .2f, h - .1f}, {w, 0, ridge}, {-w, 0, ridge});
      stall.quad({w, d, h}, {-w, d, h}, {-w, 0, ridge}, {w, 0, ridge});
      if (r.chance(.5f)) stall.quad({-w, d, .1f}, {w, d, .1f}, {w, d, h}, {-w, d, h});
      for (int k = r.count(3, 12); k > 0; --k)
        place(r, stall, r.chance(.5f) ? thing(r) : pile(r),
              {r(-.9f, .9f) * w, r(-.5f, .1f) * d, .84f}, r.log(.1f, .3f));
      m.add(stall, about_z(side > 0 ? 0 : kPi), {float(i) * pitch, side * (lane / 2 + d), 0});
    }
  for (int i = r.count(2, 12); i > 0; --i)
    place(r, m, person(r), {r(-.5f, float(n)) * pitch, r(-.4f, .4f) * lane, 0});
  if (r.chance(.5f)) m.add(facade(r, 25, r(6, 15)), {}, {-8, lane / 2 + r(4, 9), 0});
  s.camera = walk(r, {-r(.2f, 1.5f) * pitch, r(-.3f, .3f) * lane, r(1.3f, 1.8f)}, .35f, {35, 75});
}

// Goods on plinths and steps: a product shot, a museum.
void plinths(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  RoomPlan p{r(4, 9), r(4, 9), r(2.8f, 4.5f)};
  p.missing_wall = r.chance(.5f) ? 0 : .4f;
  p.missing_ceiling = .3f;
  p.windows = .3f;
  room(r, m, p);
  Vec at{p.x * .5f, p.y * .6f, 0};
  for (int i = r.count(1, 6); i > 0; --i) {
    const float w = r(.15f, .4f), h = r(.05f, 1.1f);
    const Vec c = i == 1 ? at : Vec{p.x * r(.15f, .85f), p.y * r(.3f, .9f), 0};
    m.tint = r.albedo();
    if (r.chance(.4f))
      m.tube(c, c + Vec{0, 0, h}, w, w, 32);
    else
      m.box(c + Vec{0, 0, h / 2}, {w, w, h / 2});
    place(r, m, r.chance(.2f) ? robot(r) : thing(r), c + Vec{0, 0, h}, w * r(1, 1.8f));
    if (i == 1) at.z = h;
  }
  s.camera =
      orbit(r, at + Vec{0, 0, r(.05f, .3f)}, {.8f, std::min(p.x, p.y) * .45f}, {2, 35}, {25, 60});
  s.camera.eye.z = std::max(s.camera.eye.z, .2f);
}
}  // namespace

std::vector<Family> set_families() {
  return {{"niche", niche, true, false},     {"film set", film_set, true, false},
          {"studio", studio, true, false},   {"yard", yard, true, false},
          {"people", people, true, true},    {"market", market, true, false},
          {"plinths", plinths, false, false}};
}
