// SPDX-License-Identifier: Apache-2.0
//
// Places under a wide sky: open ground, squares, low walls, roads, meadows, halls with open sides.
#include <algorithm>

#include "scene.h"

namespace {
void wide_ground(Random& r, Scene& s) {
  s.mesh.tint = r.floor_albedo();
  ground(s.mesh);
}

// Few or many things on open ground, of one size or of many.
void scatter(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float size = r.log(.5f, 10);
  if (r.chance(.75f)) {
    wide_ground(r, s);
  } else {
    m.tint = r.floor_albedo();
    m.box({0, 0, -.05f * size}, {size * r(.9f, 3), size * r(.9f, 3), .05f * size});
  }
  const float least = r.log(.05f, .3f), most = least * r.log(1, 6);
  std::vector<Mesh> kinds;
  for (int i = r.count(1, 8); i > 0; --i) kinds.push_back(r.chance(.1f) ? robot(r) : thing(r));
  for (int i = r.chance(.4f) ? r.count(2, 6) : r.count(6, 50); i > 0; --i) {
    const Mesh& o = kinds[size_t(r.count(0, int(kinds.size()) - 1))];
    place(r, m, o, {r(-1, 1) * size, r(-1, 1) * size, 0}, size * r.log(least, most));
  }
  const float near = r.log(.15f, 1) * size;
  s.camera = orbit(r, {r(-.5f, .5f) * size, r(-.5f, .5f) * size, least * size * .5f},
                   {near * .8f, near * 3}, {2, 65}, {20, 70});
}

// Swings, slides, climbing frames, benches and low walls.
void playground(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  wide_ground(r, s);
  const auto spot = [&] { return Vec{r(-5, 5), r(-4, 6), 0}; };
  for (int i = r.count(2, 6); i > 0; --i) {
    Mesh o(r);
    const float h = r(1.6f, 2.6f), w = r(1, 2.5f);
    switch (r.count(0, 4)) {
      case 0:  // swings
        for (const float x : {-w, w})
          for (const float y : {-.8f, .8f}) o.tube({x, y, 0}, {x, 0, h}, .04f, .04f);
        o.tube({-w, 0, h}, {w, 0, h}, .04f, .04f);
        for (const float x : {-w * .5f, w * .4f}) {
          for (const float d : {-.2f, .2f}) o.tube({x + d, 0, .5f}, {x + d, 0, h}, .01f, .01f, 4);
          o.box({x, 0, .5f}, {.25f, .1f, .02f});
        }
        break;
      case 1:  // a slide
        o.surface(4, 12, false, [&](float u, float v) {
          return Vec{(u - .5f) * .6f, 2.4f * v, h * (1 - v * v * (3 - 2 * v)) + .1f};
        });
        o.block({-.4f, -.8f, h - .06f}, {.4f, 0, h});
        o.add(stairs({.6f, h / 6, .22f, 6}, false), {}, {0, -2.2f, 0});
        break;
      case 2:  // a frame to climb
        for (float x = -w; x <= w; x += w)
          for (float y = -w; y <= w; y += w) o.tube({x, y, 0}, {x, y, h}, .025f, .025f);
        for (float z = h / 3; z <= h + .01f; z += h / 3)
          for (float t = -w; t <= w; t += w) {
            o.tube({t, -w, z}, {t, w, z}, .025f, .025f);
            o.tube({-w, t, z}, {w, t, z}, .025f, .025f);
          }
        break;
      case 3:  // a sandbox
        for (const float d : {-1.f, 1.f}) {
          o.box({0, d * w, .12f}, {w, .1f, .12f});
          o.box({d * w, 0, .12f}, {.1f, w, .12f});
        }
        place(r, o, blob(r, .4f, 16), {0, 0, 0}, .6f);
        break;
      default:  // a bench
        o.block({-w * .6f, -.2f, .42f}, {w * .6f, .2f, .47f});
        for (const float x : {-.5f, .5f}) o.block({x * w, -.18f, 0}, {x * w + .08f, .18f, .42f});
        if (r.chance(.6f)) o.box({0, .24f, .75f}, {w * .6f, .02f, .2f}, about_x(-.15f));
    }
    place(r, m, o, spot());
  }
  for (int i = r.count(0, 5); i > 0; --i) place(r, m, person(r), spot(), r(.6f, 1));
  for (int i = r.count(0, 6); i > 0; --i) place(r, m, tree(r), {r(-15, 15), r(5, 18), 0}, r(3, 8));
  if (r.chance(.4f)) fence(r, m, {-9, 8, 0}, {9, 8, 0}, r(.8f, 1.6f));
  s.camera = orbit(r, {r(-2, 2), r(-1, 3), r(.3f, 1.2f)}, {3, 11}, {2, 35}, {25, 70});
}

// A large square: paving, benches, steps, a statue, few people; houses far away or none.
void plaza(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  wide_ground(r, s);
  const float size = r.log(10, 50);
  if (r.chance(.7f))
    for (int i = 0, n = r.count(1, 4); i < n; ++i) {
      Mesh row;
      row.add(facade(r, size * r(.6f, 2), size * r.log(.08f, .5f)), {}, {-size * .6f, size, 0});
      m.add(row, about_z(float(i) * kPi / 2 + r(-.1f, .1f)), {0, 0, 0});
    }
  m.tint = r.albedo();
  for (int k = 0, n = r.count(0, 4); k < n; ++k) {  // steps around the middle
    const float q = size * .12f * float(n - k);
    if (r.chance(.5f))
      m.box({0, 0, .15f * float(k) + .075f}, {q, q, .075f});
    else
      m.tube({0, 0, .15f * float(k)}, {0, 0, .15f * float(k) + .15f}, q, q, 40);
  }
  if (r.chance(.6f)) {
    const float h = r(1, 4);
    m.tube({0, 0, 0}, {0, 0, h}, r(.4f, 1.2f), r(.4f, 1), 24);
    place(r, m, r.chance(.5f) ? person(r) : thing(r), {0, 0, h}, r(1, 3));
  }
  for (int i = r.count(3, 30); i > 0; --i) {
    const Vec at{r(-.7f, .7f) * size, r(-.7f, .7f) * size, 0};
    const int kind = r.count(0, 5);
    if (kind == 0) {
      m.tint = r.albedo();
      m.tube(at, at + Vec{0, 0, r(3, 6)}, .06f, .05f);
    } else if (kind == 1) {
      m.tint = r.albedo();
      m.box(at + Vec{0, 0, .25f}, {r(.5f, 2), .25f, .25f}, about_z(r.angle()));
    } else {
      const Mesh o = kind == 2 ? tree(r) : kind == 3 ? car(r) : kind == 4 ? thing(r) : person(r);
      place(r, m, o, at, kind == 2 ? r(3, 7) : 1);
    }
  }
  const float a = r.angle(), d = size * r(.1f, .6f);
  s.camera = walk(r, {d * std::cos(a), d * std::sin(a), r.chance(.7f) ? r(1, 2) : r(2, 12)}, kPi,
                  {25, 80});
  if (r.chance(.6f)) s.camera.target = {r(-3, 3), r(-3, 3), r(.2f, 1.5f)};
}

// Walls lower than a person, stumps of columns, blocks: ruins, terraces, a building site.
void low_walls(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  wide_ground(r, s);
  const float size = r.log(2, 14);
  const Vec stone = r.albedo();
  for (int i = r.count(2, 9); i > 0; --i) {
    m.tint = r.chance(.7f) ? stone : r.albedo();
    const float h = r.log(.2f, 1.6f), l = size * r(.2f, .8f);
    const Vec at{r(-1, 1) * size, r(-1, 1) * size, h / 2};
    m.box(at, {l, r(.1f, .35f), h / 2}, about_z((r.chance(.5f) ? 0 : kPi / 2) + r(-.05f, .05f)));
  }
  for (int i = r.chance(.5f) ? r.count(1, 10) : 0; i > 0; --i) {
    const Vec at{r(-1, 1) * size, r(-1, 1) * size, 0};
    const float q = r(.15f, .45f);
    m.tube(at, at + Vec{0, 0, r.log(.2f, 4)}, q, q * .9f, 20);
  }
  for (int i = r.count(1, 14); i > 0; --i) {
    const int kind = r.count(0, 4);
    const Mesh o = kind == 0 ? person(r) : kind == 1 ? plant(r) : kind == 2 ? tree(r) : thing(r);
    place(r, m, o, {r(-1, 1) * size, r(-1, 1) * size, 0},
          kind == 0   ? 1
          : kind == 2 ? r(2, 5)
                      : r.log(.2f, 1));
  }
  s.camera = orbit(r, {r(-.4f, .4f) * size, r(-.4f, .4f) * size, r(.1f, .8f)},
                   {size * .3f + 1, size * 1.6f}, {2, 35}, {25, 75});
}

// A large roof on few columns, with one to four open sides: a hangar, a station, a stand.
void open_hall(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  wide_ground(r, s);
  const float x = r(12, 50), y = r(10, 30), h = r(4, 14);
  const Vec from[4] = {{x, 0, 0}, {x, y, 0}, {0, y, 0}, {0, 0, 0}};
  const float gone = r(.4f, .9f);
  for (int i = 0; i < 4; ++i) {
    m.tint = r.albedo();
    if (!r.chance(gone))
      m.add(wall(i & 1 ? y : x, h * (r.chance(.7f) ? 1 : r(.2f, .8f)), .2f, {}),
            about_z(float(i) * kPi / 2 + kPi), from[i]);
  }
  m.tint = r.albedo();
  const float hole = r.chance(.5f) ? 0 : r(.15f, .6f);  // share of the roof that is of glass
  const float bay = x / float(r.count(3, 8));
  for (float t = 0; t < x - .01f; t += bay) {
    m.block({t, 0, h}, {t + bay * (1 - hole), y, h + .3f});
    for (const float v : {0.f, y}) m.tube({t + .2f, v, 0}, {t + .2f, v, h}, .15f, .15f, 12);
    m.box({t + .1f, y / 2, h - .3f}, {.1f, y / 2, .3f});
  }
  for (int i = r.count(2, 18); i > 0; --i) {
    const int kind = r.count(0, 4);
    const Mesh o = kind == 0   ? car(r)
                   : kind == 1 ? engine(r)
                   : kind == 2 ? pile(r)
                   : kind == 3 ? thing(r)
                               : person(r);
    place(r, m, o, {x * r(-.1f, 1.1f), y * r(-.2f, 1.1f), 0}, kind == 2 ? 2 : 1);
  }
  if (r.chance(.6f)) {
    s.camera = inside(r, {x, y, std::min(h, 3.f)}, {35, 85});
  } else {
    s.camera.eye = {x * r(-.5f, 1.5f), -y * r(.2f, 1.2f), r(1, 5)};
    s.camera.target = {x * r(.2f, .8f), y * .5f, h * r(.1f, .6f)};
    s.camera.fov = r(30, 70);
  }
}

// A building that stands alone, seen from outside.
void lone_house(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  wide_ground(r, s);
  const float w = r(5, 16), h = r.chance(.8f) ? r(3, 9) : r(9, 40);
  m.add(facade(r, w, h), {}, {-w / 2, 0, 0});
  if (r.chance(.4f)) {
    const float a = r(3, 8), b = r(2.4f, h);
    m.add(facade(r, a, b), about_z(r.chance(.5f) ? 0 : kPi / 2), {w / 2, r(-2, 3), 0});
  }
  if (r.chance(.3f)) {  // a porch
    m.tint = r.albedo();
    m.block({-w / 2, -2.2f, 2.4f}, {w * r(-.2f, .5f), 0, 2.55f});
    for (float t = -w / 2 + .2f; t < 0; t += 2) m.tube({t, -2, 0}, {t, -2, 2.4f}, .08f, .08f);
  }
  for (int i = r.count(0, 10); i > 0; --i)
    place(r, m, r.chance(.6f) ? tree(r) : plant(r), {r(-1.6f, 1.6f) * w, r(-12, 8), 0}, r(1, 7));
  for (int i = r.count(0, 4); i > 0; --i)
    place(r, m, r.chance(.5f) ? person(r) : car(r), {r(-1, 1) * w, -r(2, 9), 0});
  if (r.chance(.3f)) fence(r, m, {-w, -r(5, 9), 0}, {w, -r(5, 9), 0}, r(.7f, 1.6f));
  const float a = -kPi / 2 + r(-1.1f, 1.1f), d = r.log(6, 40);
  Camera& c = s.camera;
  c.eye = {d * std::cos(a), d * std::sin(a), r.chance(.8f) ? r(1, 2.2f) : r(3, 20)};
  c.target = {r(-.3f, .3f) * w, 2, std::min(h, d) * r(.15f, .5f)};
  c.fov = r(25, 70);
}

// Gentle land with a road or a beach, poles, stones, a car.
void country(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float size = r.log(12, 120), amplitude = size * r(0, .03f), rate = r(1, 4) / size;
  const int seed = r.count(0, 1 << 20);
  const auto z = [&](float x, float y) {
    const float off = std::min(1.f, std::max(0.f, std::fabs(y) / 4 - .7f));
    return amplitude * off * fractal({x * rate, y * rate, 0}, seed, 4);
  };
  m.tint = r.floor_albedo();
  m.surface(140, 140, false, [&](float u, float v) {
    const float x = (u - .5f) * 6 * size, y = (v - .5f) * 6 * size;
    return Vec{x, y, z(x, y)};
  });
  if (r.chance(.6f)) {
    m.tint = r.floor_albedo();
    m.box({0, 0, .02f}, {size * 3, 3, .03f});
  }
  for (int i = r.chance(.5f) ? r.count(0, 8) : r.count(10, 60); i > 0; --i) {
    const float x = r(-1, 1) * size, y = r.sign() * (3.5f + size * r(0, .6f) * r(0, 1));
    const Vec at{x, y, z(x, y)};
    if (r.chance(.6f))
      m.add(blob(r, r(.3f, .8f), 16), r.rotation(), at, r.log(.1f, 2));
    else
      place(r, m, r.chance(.5f) ? plant(r) : tree(r), at, r(.4f, 4));
  }
  if (r.chance(.4f)) {
    m.tint = r.albedo();
    for (float x = -size; x < size; x += 8) m.tube({x, 4.5f, -.5f}, {x, 4.5f, 6}, .12f, .1f);
  }
  for (int i = r.count(0, 3); i > 0; --i)
    m.add(car(r), about_z(r(-.1f, .1f)), {r(-.4f, .4f) * size, r.sign() * 1.5f, .05f});
  for (int i = r.count(0, 3); i > 0; --i)
    place(r, m, person(r), {r(-.3f, .3f) * size, r(-4, 4), .03f});
  s.camera = walk(r, {r(-.6f, 0) * size, r(-3, 3), r.log(.3f, 4)}, .8f, {25, 75});
  s.camera.target.z -= r(0, 2.5f);
}

// Blades, leaves and stones under an open sky, thin to dense, seen from near.
void meadow(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const int seed = r.count(0, 1 << 20);
  const float amplitude = r(0, .1f), size = r.log(.4f, 4), tall = size * r.log(.02f, .25f);
  const auto z = [&](float x, float y) {
    return amplitude * fractal({x * .7f, y * .7f, 0}, seed, 3);
  };
  m.tint = r.floor_albedo();
  m.surface(60, 60, false, [&](float u, float v) {
    const float x = (u - .5f) * 20 * size, y = (v - .5f) * 20 * size;
    return Vec{x, y, z(x, y)};
  });
  grass(r, m, {0, 0, size * 2}, int(r.log(60, 5000)), tall, z);
  const auto spot = [&] {
    const float x = r(-1.4f, 1.4f) * size, y = r(-1.4f, 1.4f) * size;
    return Vec{x, y, z(x, y)};
  };
  for (int i = r.count(0, 10); i > 0; --i)
    m.add(blob(r, .5f, 20), r.rotation(), spot(), size * r.log(.05f, .3f));
  for (int i = r.count(0, 12); i > 0; --i) place(r, m, plant(r), spot(), size * r.log(.08f, .3f));
  if (r.chance(.4f)) place(r, m, thing(r), {0, 0, z(0, 0)}, size * r(.2f, .6f));
  if (r.chance(.3f)) place(r, m, tree(r, 3), spot(), size * r(1, 3));
  s.camera = orbit(r, {r(-.2f, .2f) * size, r(-.2f, .2f) * size, size * r(.02f, .2f)},
                   {size * .8f, size * 2.5f}, {4, 50}, {25, 65});
}

// Wide steps out of doors: a stair before a building, rows of seats.
void wide_steps(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  wide_ground(r, s);
  const float rise = r(.12f, .5f), going = r(.28f, 1), width = r(4, 30);
  const int n = r.count(3, 16);
  m.tint = r.albedo();
  const float depth = going * float(n), top = rise * float(n);
  if (r.chance(.6f)) {
    m.add(stairs({width, rise, going, n}, true), {}, {0, 0, 0});
    m.block({-width / 2, depth, 0}, {width / 2, depth + r(2, 10), top});
  } else {  // half rings
    const float inner = r(2, 8);
    for (int i = 0; i < n; ++i)
      m.surface(40, 2, false, [&](float u, float v) {
        const float a = kPi * (u * .9f + .05f), q = inner + going * float(v > .4f ? i + 1 : i);
        const float up = rise * float(v < .4f ? i : i + 1);
        const float edge = v > .4f && v < .6f ? inner + going * float(i) : q;
        return Vec{edge * std::cos(a), edge * std::sin(a), up};
      });
  }
  if (r.chance(.3f)) m.add(facade(r, width, r(3, 9)), {}, {-width / 2, depth + r(2, 6), top});
  for (int i = r.count(1, 12); i > 0; --i) {
    const int k = r.count(0, n - 1);
    const Mesh o = r.chance(.6f) ? person(r) : thing(r);
    place(r, m, o, {r(-.45f, .45f) * width, going * (float(k) + .4f), rise * float(k + 1)},
          o.top() > 1.2f ? 1 : .6f);
  }
  for (int i = r.count(0, 4); i > 0; --i)
    place(r, m, r.chance(.6f) ? person(r) : tree(r), {r(-.6f, .6f) * width, -r(1, 6), 0}, 1.5f);
  Camera& c = s.camera;
  c.eye = {r(-.6f, .6f) * width, -r.log(1.5f, 12), r(.6f, 3)};
  c.target = {r(-.25f, .25f) * width, depth * r(.2f, .8f), top * r(.3f, .8f)};
  c.fov = r(28, 75);
}

// A street of which only the side that is seen was built.
void backlot(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  wide_ground(r, s);
  float x = -r(4, 14);
  for (int i = r.count(1, 4); i > 0; --i) {
    const float w = r(4, 12);
    m.add(facade(r, w, r.log(3, 14)), {}, {x, r.chance(.8f) ? 0 : r(0, 2), 0});
    x += w + (r.chance(.2f) ? r(1, 4) : 0);
  }
  if (r.chance(.3f)) m.add(facade(r, r(5, 12), r(3, 10)), about_z(-kPi / 2), {x, 0, 0});
  if (r.chance(.5f)) {
    m.tint = r.floor_albedo();
    m.block({-30, -2.5f, 0}, {30, 0, .12f});
  }
  for (int i = r.count(1, 14); i > 0; --i) {
    const int kind = r.count(0, 4);
    const Mesh o = kind == 0   ? tree(r)
                   : kind == 1 ? car(r)
                   : kind == 2 ? thing(r)
                   : kind == 3 ? laid_table(r)
                               : person(r);
    place(r, m, o, {r(-9, 9), -r(.6f, 8), .05f}, kind == 0 ? r(2, 6) : kind == 2 ? .7f : 1);
  }
  Camera& c = s.camera;
  c.eye = {r(-9, 9), -r(4, 16), r.chance(.8f) ? r(1, 2) : r(2, 6)};
  c.target = {c.eye.x * .4f + r(-7, 7), 0, r(1, 4)};
  c.fov = r(25, 70);
}
}  // namespace

std::vector<Family> open_place_families() {
  return {{"scatter", scatter, true, false},      {"playground", playground, true, true},
          {"plaza", plaza, false, false},         {"low walls", low_walls, true, false},
          {"open hall", open_hall, false, false}, {"lone house", lone_house, false, false},
          {"country", country, false, false},     {"meadow", meadow, true, false},
          {"wide steps", wide_steps, true, false}};
}

std::vector<Family> backlot_families() { return {{"backlot", backlot, true, false}}; }
