// SPDX-License-Identifier: Apache-2.0
//
// Objects on open ground and in the air.
#include <algorithm>

#include "scene.h"

namespace {
void floor_of(Random& r, Scene& s) {
  s.mesh.tint = r.floor_albedo();
  ground(s.mesh);
}

void single(Random& r, Scene& s) {
  floor_of(r, s);
  const int n = r.chance(.5f) ? 1 : r.count(2, 5);
  for (int i = 0; i < n; ++i) {
    const Mesh m = r.chance(.15f) ? tree(r) : thing(r);
    place(r, s.mesh, m, i ? Vec{r(-1.2f, 1.2f), r(-1.2f, 1.2f), 0} : Vec{0, 0, 0},
          i ? r(.3f, 1.2f) : 1);
  }
  s.camera = orbit(r, {0, 0, r(.15f, .5f)}, {1.2f, 5}, {3, 70}, {20, 65});
}

void stacked(Random& r, Scene& s) {
  floor_of(r, s);
  Mesh& m = s.mesh;
  const float size = r(1, 3.5f);
  if (r.chance(.4f)) {
    RoomPlan p{r(6, 20), r(6, 20), r(3, 8)};
    p.missing_wall = p.missing_ceiling = .2f;
    Mesh store;
    room(r, store, p);
    m.add(store, {}, {-p.x / 2, -p.y / 2, .01f});
  }
  for (int i = r.count(3, 20); i > 0; --i) {
    const float x = r(-1, 1) * size, y = r(-1, 1) * size, turn = r(-.3f, .3f), w = r(.15f, .6f);
    float z = .01f;
    for (int j = r.count(1, 6); j > 0; --j) {
      const float h = r(.08f, .4f);
      m.tint = r.albedo();
      m.box({x + r(-.04f, .04f), y + r(-.04f, .04f), z + h}, {w * r(.8f, 1), w * r(.8f, 1), h},
            about_z(turn + r(-.1f, .1f)));
      z += 2 * h;
    }
  }
  for (int i = r.count(0, 4); i > 0; --i)
    place(r, m, shelf(r), {r(-1, 1) * size * 1.2f, r(-1, 1) * size * 1.2f, .01f}, r(.8f, 1.4f));
  s.camera = orbit(r, {r(-.5f, .5f), r(-.5f, .5f), r(.2f, 1)}, {size * .8f, size * 2.5f}, {5, 45},
                   {30, 75});
}

void floating(Random& r, Scene& s) {
  const float size = r.log(.6f, 5);
  for (int i = r.count(2, 40); i > 0; --i)
    s.mesh.add(r.chance(.1f) ? tree(r) : thing(r), r.rotation(),
               r.direction() * (size * std::cbrt(r(0, 1))), r.log(.2f, 2));
  s.camera =
      orbit(r, r.direction() * (size * .3f), {size * .8f + .5f, size * 3 + 1}, {-60, 60}, {20, 70});
}

void machine(Random& r, Scene& s) {
  floor_of(r, s);
  Mesh& m = s.mesh;
  if (r.chance(.4f)) m.box({0, r(1.2f, 2.5f), 1}, {3, .05f, 1.5f});
  const int n = r.count(1, 3);
  for (int i = 0; i < n; ++i)
    place(r, m, r.chance(.6f) ? engine(r) : robot(r), {float(i) * r(.9f, 1.6f), r(-.3f, .3f), 0},
          r(.7f, 1.4f));
  for (int i = r.count(0, 6); i > 0; --i)
    place(r, m, r.chance(.3f) ? table(r) : thing(r), {r(-1.5f, 2), r(-1, 1.2f), 0},
          r.log(.1f, .7f));
  s.camera = orbit(r, {r(-.1f, .3f), 0, r(.3f, .8f)}, {1, 3.2f}, {2, 45}, {25, 60});
}

void cables(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  floor_of(r, s);
  const float size = r(1, 6);
  if (r.chance(.5f)) m.box({0, size * r(.8f, 1.6f), size * .5f}, {size * 2, .1f, size * .6f});
  for (int i = r.count(4, 22); i > 0; --i) {  // sagging lines between two heights
    const Vec a{r(-1, 1) * size, r(-.6f, .8f) * size, size * r(.05f, .9f)};
    const Vec b{r(-1, 1) * size, r(-.6f, .8f) * size, size * r(.05f, .9f)};
    const float sag = length(b - a) * r(0, .25f), q = size * r.log(.001f, .012f);
    m.tint = r.albedo();
    Vec p = a;
    for (int k = 1; k <= 10; ++k) {
      const float t = float(k) / 10;
      Vec e = a + (b - a) * t;
      e.z = std::max(q, e.z - 4 * sag * t * (1 - t));
      m.tube(p, e, q, q, 6, false);
      p = e;
    }
  }
  for (int i = r.count(1, 6); i > 0; --i) {  // masts
    const Vec at{r(-1, 1) * size, r(-.6f, .8f) * size, 0};
    const float q = size * r.log(.004f, .03f);
    m.tube(at, at + Vec{0, 0, size * r(.5f, 1.2f)}, q, q * .8f, 10);
  }
  for (int i = r.count(0, 5); i > 0; --i)
    place(r, m, thing(r), {r(-.8f, .8f) * size, r(-.5f, .8f) * size, 0}, size * r.log(.06f, .25f));
  s.camera = orbit(r, {0, 0, size * r(.1f, .5f)}, {size * .8f, size * 2.5f}, {2, 40}, {25, 70});
}

void fences(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  floor_of(r, s);
  const float size = r(1.5f, 6);
  if (r.chance(.5f)) m.add(facade(r, size * 4, r(3, 8)), {}, {-size * 2, size * r(1, 2), 0});
  for (int i = r.count(1, 4); i > 0; --i) {
    const float y = r(-.8f, .8f) * size, a = r.chance(.6f) ? r(-.1f, .1f) : r.angle();
    const Vec d = Vec{std::cos(a), std::sin(a), 0} * (size * r(.6f, 2));
    fence(r, m, Vec{0, y, 0} - d, Vec{0, y, 0} + d, r(.6f, 2));
  }
  for (int i = r.count(2, 9); i > 0; --i) {
    const int kind = r.count(0, 4);
    const Vec at{r(-.8f, .8f) * size, r(-.7f, .9f) * size, 0};
    const Mesh o = kind == 0   ? chair(r)
                   : kind == 1 ? lamp(r)
                   : kind == 2 ? tree(r, r.count(2, 3))
                   : kind == 3 ? person(r)
                               : thing(r);
    place(r, m, o, at, kind == 2 ? r(1.5f, 4) : kind == 4 ? r.log(.2f, .8f) : 1);
  }
  s.camera = orbit(r, {r(-.3f, .3f) * size, r(-.3f, .3f) * size, r(.3f, 1)}, {size * .6f, size * 2},
                   {2, 25}, {25, 70});
}

// Scaffolds and lattices of tubes with boards.
void scaffold(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  floor_of(r, s);
  const float pitch = r(1.2f, 2.5f), storey = r(1.6f, 2.2f), depth = r(.7f, 1.4f),
              q = r(.02f, .05f);
  const int n = r.count(2, 6), levels = r.count(1, 4);
  const float l = pitch * float(n), h = storey * float(levels) + .9f;
  if (r.chance(.7f)) m.add(facade(r, l + 2, h + r(-1, 3)), {}, {-1, depth + .35f, 0});
  const Vec steel = r.albedo(), wood{.45f, .33f, .2f};
  m.tint = steel;
  for (int i = 0; i <= n; ++i)
    for (const float y : {0.f, depth}) {
      const float x = pitch * float(i);
      m.tube({x, y, 0}, {x, y, h}, q, q, 8);
      if (y == 0 && i < n && r.chance(.6f))
        m.tube({x, 0, 0}, {x + pitch, 0, storey}, q * .8f, q * .8f, 8);
    }
  for (int k = 1; k <= levels; ++k) {
    const float z = storey * float(k);
    m.tint = steel;
    for (const float up : {0.f, .5f, .9f}) m.tube({0, 0, z + up}, {l, 0, z + up}, q, q, 8);
    m.tint = wood;
    for (int i = 0; i < n; ++i)
      if (r.chance(.85f))
        for (int b = 0; b < 3; ++b) {
          const float y = depth * (float(b) + .08f) / 3;
          m.block({pitch * float(i), y, z}, {pitch * float(i + 1), y + depth * .29f, z + .04f});
        }
  }
  for (int i = r.count(0, 5); i > 0; --i)
    place(r, m, r.chance(.6f) ? person(r) : pile(r),
          {l * r(0, 1), r.chance(.5f) ? depth / 2 : -r(.5f, 3), 0});
  Camera& c = s.camera;
  c.eye = {l * r(-.3f, 1.3f), -r(1.5f, 8), r(.8f, 3)};
  c.target = {l * r(.2f, .8f), depth, h * r(.2f, .6f)};
  c.fov = r(30, 75);
}
}  // namespace

std::vector<Family> object_families() {
  return {{"single", single, true, false},      {"stacked", stacked, true, true},
          {"floating", floating, false, false}, {"machine", machine, true, true},
          {"cables", cables, true, false},      {"fences", fences, true, false},
          {"scaffold", scaffold, true, false}};
}
