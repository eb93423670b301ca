// SPDX-License-Identifier: Apache-2.0
//
// Landscapes and gardens.
#include <algorithm>

#include "scene.h"

namespace {
using Height = std::function<float(float, float)>;

void land(Random& r, Mesh& m, float half, int cells, const Height& z) {
  m.tint = r.albedo();
  m.surface(cells, cells, false, [&](float u, float v) {
    const float x = (u - .5f) * 2 * half, y = (v - .5f) * 2 * half;
    return Vec{x, y, z(x, y)};
  });
}

void terrain(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float size = r.log(15, 400), amplitude = size * r(.02f, .2f), rate = r(2, 6) / size;
  const int seed = r.count(0, 1 << 20), octaves = r.count(2, 6);
  const Height z = [&](float x, float y) {
    return amplitude * fractal({x * rate, y * rate, 0}, seed, octaves);
  };
  land(r, m, size, 160, z);
  const float unit_size = r.log(.01f, .05f) * size;
  for (int i = r.chance(.6f) ? r.count(5, 120) : r.count(0, 5); i > 0; --i) {
    const float x = r(-.7f, .7f) * size, y = r(-.7f, .7f) * size;
    if (r.chance(.6f))
      place(r, m, tree(r, r.count(0, 2)), {x, y, z(x, y)}, unit_size * r(.6f, 1.4f));
    else
      m.add(blob(r, r(.3f, .8f), 20), r.rotation(), {x, y, z(x, y)}, unit_size * r.log(.1f, .8f));
  }
  Camera& c = s.camera;
  const float x = r(-.4f, .4f) * size, y = r(-.4f, .4f) * size, a = r.angle(),
              d = size * r(.1f, .6f);
  c.eye = {x, y, z(x, y) + size * r.log(.006f, .15f)};
  c.target = {x + d * std::cos(a), y + d * std::sin(a), 0};
  c.target.z = z(c.target.x, c.target.y) + amplitude * r(-.2f, .3f);
  c.fov = r(25, 80);
}

void undergrowth(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const int seed = r.count(0, 1 << 20);
  const float amplitude = r(0, .15f), size = r(.6f, 2.5f);
  const Height z = [&](float x, float y) { return amplitude * fractal({x, y, 0}, seed, 3); };
  land(r, m, 15, 80, z);
  grass(r, m, {0, 0, size * 1.6f}, r.count(500, 7000), r(.06f, .5f), z);
  const auto spot = [&] {
    const float x = r(-1, 1) * size, y = r(-1, 1) * size;
    return Vec{x, y, z(x, y)};
  };
  for (int i = r.count(0, 6); i > 0; --i)
    m.add(blob(r, .5f, 24), r.rotation(), spot(), r(.1f, .6f));
  for (int i = r.count(0, 6); i > 0; --i) place(r, m, tree(r, 3), spot(), r(.5f, 3));
  for (int i = r.count(0, 25); i > 0; --i) place(r, m, plant(r), spot(), r(.15f, .6f));
  s.camera = orbit(r, {r(-.3f, .3f), r(-.3f, .3f), r(.05f, .3f)}, {size * .6f, size * 2}, {4, 45},
                   {30, 70});
}

void forest(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const int seed = r.count(0, 1 << 20), kind = r.count(0, 3);
  const float amplitude = r(0, 1.2f);
  const Height z = [&](float x, float y) {
    return amplitude * fractal({x * .12f, y * .12f, 0}, seed, 3);
  };
  land(r, m, 60, 120, z);
  std::vector<Mesh> kinds;  // a few trees, repeated
  for (int i = 0; i < 5; ++i) kinds.push_back(tree(r, r.chance(.8f) ? kind : r.count(0, 3)));
  const float height = r(5, 15);
  for (int i = r.count(40, 160); i > 0; --i) {
    const float a = r.angle(), d = 2 + 33 * std::sqrt(r(0, 1));
    const float x = d * std::cos(a), y = d * std::sin(a);
    place(r, m, kinds[size_t(r.count(0, 4))], {x, y, z(x, y)}, height * r(.5f, 1.2f));
  }
  for (int i = r.count(0, 25); i > 0; --i) {
    const float x = r(-9, 9), y = r(-9, 9);
    place(r, m, r.chance(.5f) ? plant(r) : blob(r, .5f, 16), {x, y, z(x, y)}, r(.3f, 1.2f));
  }
  if (r.chance(.5f)) grass(r, m, {0, 0, 8}, r.count(300, 3000), r(.1f, .4f), z);
  if (r.chance(.3f)) place(r, m, person(r), {4, 0, z(4, 0)});
  s.camera = walk(r, {0, 0, z(0, 0) + r(.6f, 2.2f)}, kPi, {30, 75});
}

// Rock faces: a wall of noise beside the ground, a canyon of two of them.
void cliff(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float h = r.log(4, 60), w = h * r(2, 4), steep = r(.05f, .5f), rough = h * r(.06f, .25f);
  const int seed = r.count(0, 1 << 20);
  m.tint = r.floor_albedo();
  ground(m);
  const bool canyon = r.chance(.5f);
  const float gap = h * r(.4f, 1.6f);
  for (const float side : {1.f, -1.f}) {
    if (side < 0 && !canyon) break;
    m.tint = r.albedo();
    m.surface(140, 70, false, [&](float u, float v) {
      const float x = (u - .5f) * 2 * w, up = std::min(1.f, v * 1.4f) * h;
      const float back = std::max(0.f, v - .714f) * 4 * h;
      const Vec p{x * 3 / h, up * 3 / h, side * 7 + back / h};
      return Vec{x, side * (gap / 2 + steep * up + back + rough * fractal(p, seed, 5)),
                 up + (back > 0 ? rough * .3f * noise(p, seed) : 0) - .2f};
    });
  }
  for (int i = r.count(5, 40); i > 0; --i)
    m.add(blob(r, r(.3f, .7f), 20), r.rotation(), {r(-.7f, .7f) * w, r(-.45f, .45f) * gap, 0},
          h * r.log(.01f, .15f));
  for (int i = r.count(0, 15); i > 0; --i)
    place(r, m, tree(r), {r(-.8f, .8f) * w, r(-.4f, .3f) * gap, 0}, h * r(.1f, .35f));
  Camera& c = s.camera;
  c.eye = {r(-.5f, 0) * w, r(-.35f, .2f) * gap, h * r.log(.03f, .3f)};
  c.target = c.eye + Vec{h, r(-.2f, 1) * h * .6f, r(-.1f, .3f) * h};
  c.fov = r(35, 80);
}

void garden(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  m.tint = r.floor_albedo();
  ground(m);
  const float x = r(6, 16), y = r(6, 14);
  const Height flat = [](float, float) { return 0.f; };
  if (r.chance(.7f)) m.add(facade(r, x * r(.6f, 1), r(3, 7)), {}, {0, y, 0});
  for (int i = r.count(1, 3); i > 0; --i) {  // hedges
    m.tint = {.08f, .15f, .04f};
    const float a = r.chance(.5f) ? 0 : kPi / 2, h = r(.6f, 2.2f);
    m.box({x * r(.1f, .9f), y * r(.1f, .9f), h / 2}, {r(1, 4), r(.2f, .5f), h / 2}, about_z(a));
  }
  if (r.chance(.5f)) fence(r, m, {0, r(0, 1), 0}, {x, r(0, 1), 0}, r(.8f, 1.8f));
  if (r.chance(.4f)) m.box({-.2f, y / 2, r(.8f, 1.2f)}, {.12f, y / 2, 1.2f});
  m.tint = r.albedo();
  m.box({x / 2, y / 2, .02f}, {r(.4f, 1), y / 2, .02f});
  for (int i = r.count(2, 9); i > 0; --i)
    place(r, m, tree(r), {x * r(-.2f, 1.2f), y * r(.1f, 1.1f), 0}, r(1.5f, 6));
  for (int i = r.count(5, 30); i > 0; --i)
    place(r, m, plant(r), {x * r(0, 1), y * r(0, 1), 0}, r(.3f, 1));
  grass(r, m, {x / 2, y / 2, x * .5f}, r.count(0, 2500), r(.06f, .25f), flat);
  if (r.chance(.5f)) place(r, m, laid_table(r), {x * r(.3f, .7f), y * r(.3f, .7f), 0});
  if (r.chance(.4f)) place(r, m, person(r), {x * r(.3f, .7f), y * r(.3f, .7f), 0});
  s.camera = inside(r, {x, y * .8f, 2.4f}, {30, 75});
  s.camera.target = {x * r(.2f, .8f), y, r(.3f, 1.2f)};
}
}  // namespace

std::vector<Family> nature_families() {
  return {{"terrain", terrain, false, false},
          {"undergrowth", undergrowth, true, false},
          {"forest", forest, false, false},
          {"cliff", cliff, false, true},
          {"garden", garden, true, false}};
}
