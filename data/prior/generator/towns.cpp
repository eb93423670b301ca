// SPDX-License-Identifier: Apache-2.0
//
// Streets, yards and other built places outdoors.
#include <algorithm>

#include "scene.h"

namespace {
void pave(Random& r, Scene& s, float z = 0) {
  s.mesh.tint = r.floor_albedo();
  ground(s.mesh, z);
}

void row_of_houses(Random& r, Mesh& m, float length, float offset, Range heights) {
  for (float x = -length / 2; x < length / 2;) {
    const float w = r(5, 16), set_back = r.chance(.8f) ? 0 : r(0, 3);
    if (!r.chance(.1f))
      m.add(facade(r, w, r(heights.low, heights.high)), {}, {x, offset + set_back, 0});
    x += w + (r.chance(.1f) ? r(2, 6) : 0);
  }
}

void street(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float w = r.log(5, 24), l = r(40, 130);
  pave(r, s);
  const Range heights{r(4, 10), r(10, 28)};
  row_of_houses(r, m, l, w / 2, heights);
  Mesh other;
  if (r.chance(.8f)) row_of_houses(r, other, l, w / 2, heights);
  m.add(other, about_z(kPi), {0, 0, 0});
  if (r.chance(.35f))
    m.add(facade(r, w + 12, r(8, 25)), about_z(-kPi / 2), {l * .55f, w / 2 + 6, 0});
  const float walk_width = std::min(2.5f, w * .2f);
  m.tint = r.albedo();
  for (const float side : {-1.f, 1.f})
    m.box({0, side * (w - walk_width) / 2, .07f}, {l / 2, walk_width / 2, .07f});
  if (w > 8)
    for (int i = r.count(0, 14); i > 0; --i) {
      const float side = r.sign();
      m.add(car(r), about_z(side > 0 ? 0 : kPi),
            {r(-.5f, .5f) * l, side * (w / 2 - walk_width - 1.1f), 0});
    }
  for (int i = r.count(2, 18); i > 0; --i) {
    const Vec at{r(-.5f, .5f) * l, r.sign() * (w / 2 - walk_width * r(.2f, .9f)), .14f};
    const int kind = r.count(0, 3);
    if (kind == 0) {  // a street lamp
      const float h = r(3, 7);
      m.tube(at, at + Vec{0, 0, h}, .06f, .05f, 8);
      m.tube(at + Vec{0, 0, h}, at + Vec{0, at.y > 0 ? -1.f : 1.f, h + .2f}, .04f, .04f, 8);
    } else if (kind == 1) {
      place(r, m, tree(r), at, r(3, 7));
    } else {
      place(r, m, kind == 2 ? person(r) : thing(r), at, kind == 2 ? 1 : r(.4f, 1.1f));
    }
  }
  const Vec eye{r(-.4f, .1f) * l, r(-.35f, .35f) * w, r.chance(.8f) ? r(1.2f, 2) : r(3, 10)};
  s.camera = walk(r, eye, .9f, {30, 85});
}

void courtyard(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float x = r(7, 25), y = r(7, 25), h = r(3, 14);
  pave(r, s);
  const Vec from[4] = {{x, 0, 0}, {x, y, 0}, {0, y, 0}, {0, 0, 0}};
  for (int i = 0; i < 4; ++i)
    if (!r.chance(.12f))
      m.add(facade(r, i & 1 ? y : x, h * r(.7f, 1.2f)), about_z(float(i) * kPi / 2 + kPi), from[i]);
  if (r.chance(.6f)) {  // a colonnade along the walls
    const float in = r(1.2f, 2.6f), q = r(.12f, .3f), top = std::min(h * .8f, r(2.6f, 4));
    m.tint = r.albedo();
    for (float t = in; t <= x - in; t += r(1.8f, 3))
      for (const float v : {in, y - in}) m.tube({t, v, 0}, {t, v, top}, q, q * .85f, 12);
    for (const float v : {in, y - in})
      m.box({x / 2, v, top + .2f}, {x / 2 - in + q, q * 1.2f, .2f});
    for (const float v : {in / 2, y - in / 2}) m.box({x / 2, v, top + .45f}, {x / 2, in / 2, .08f});
  }
  for (int i = r.count(1, 12); i > 0; --i) {
    const int kind = r.count(0, 3);
    const Vec at{x * r(.15f, .85f), y * r(.15f, .85f), 0};
    if (kind == 0)
      place(r, m, tree(r), at, r(2, 6));
    else
      place(r, m,
            kind == 1   ? person(r)
            : kind == 2 ? car(r)
                        : thing(r),
            at, kind == 3 ? r(.4f, 1.6f) : 1);
  }
  s.camera = inside(r, {x, y, 3}, {35, 85});
}

void vehicles(Random& r, Scene& s) {
  pave(r, s);
  if (r.chance(.6f)) s.mesh.add(facade(r, r(12, 30), r(4, 12)), {}, {-12, r(3.5f, 8), 0});
  const int n = r.count(1, 7);
  const bool parked = r.chance(.7f);
  for (int i = 0; i < n; ++i)
    s.mesh.add(car(r), about_z(parked ? kPi / 2 + r(-.1f, .1f) : r(-.2f, .2f)),
               parked ? Vec{float(i - n / 2) * r(2.4f, 3), r(-.4f, .4f), 0}
                      : Vec{float(i - n / 2) * r(5, 7), r.sign() * 1.7f, 0});
  for (int i = r.count(0, 4); i > 0; --i) place(r, s.mesh, person(r), {r(-5, 5), r(-5, -2.6f), 0});
  s.camera = orbit(r, {r(-2, 2), 0, r(.4f, 1)}, {3, 10}, {3, 30}, {25, 70});
}

void aerial(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  pave(r, s);
  const float pitch = r(14, 40), h = r.log(6, 60), w = pitch * r(.25f, .42f);
  for (int i = -7; i <= 7; ++i)
    for (int j = -7; j <= 7; ++j) {
      if (r.chance(.1f)) continue;
      m.tint = r.albedo();
      const float top = h * r.log(.3f, 1.6f), x = float(i) * pitch, y = float(j) * pitch;
      m.box({x, y, top / 2}, {w * r(.6f, 1.1f), w * r(.6f, 1.1f), top / 2});
      if (r.chance(.5f)) m.box({x + w * .2f, y, top * 1.06f}, {w * .4f, w * .4f, top * .06f});
    }
  for (int i = r.count(0, 60); i > 0; --i)
    place(r, m, tree(r, r.count(0, 1)),
          {(float(r.count(-4, 4)) + .5f) * pitch + r(-2, 2), r(-4, 4) * pitch, 0}, r(4, 10));
  s.camera = orbit(r, {r(-1, 1) * pitch, r(-1, 1) * pitch, h * .3f},
                   {pitch * 1.5f + h, pitch * 4 + h}, {15, 80}, {25, 65});
}

// A roof on columns along a house front, as of shops or a cloister.
void arcade(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  pave(r, s);
  const float l = r(15, 40), depth = r(2, 5), h = r(2.8f, 5), pitch = r(2, 4), q = r(.12f, .35f);
  m.add(facade(r, l, h + r(1, 9)), {}, {-l / 2, 0, 0});
  m.tint = r.albedo();
  m.block({-l / 2, -depth - q, h}, {l / 2, 0, h + r(.2f, .5f)});
  const bool arches = r.chance(.5f);
  for (float x = -l / 2 + .5f; x < l / 2; x += pitch) {
    m.box({x, -depth, h / 2}, {q, q, h / 2});
    for (int k = 0; arches && k < 8; ++k) {  // spandrels, in steps
      const float t = (float(k) + .5f) / 8;
      const float low = h - (pitch / 2) * (1 - std::sqrt(1 - t * t));
      for (const float side : {-1.f, 1.f})
        m.block({x + pitch / 2 + side * (pitch / 2 - q) * t - .12f, -depth - q * .6f,
                 std::min(low, h - .02f)},
                {x + pitch / 2 + side * (pitch / 2 - q) * t + .12f, -depth + q * .6f, h});
    }
  }
  m.block({-l / 2, -depth - .5f, 0}, {l / 2, 0, .12f});
  for (int i = r.count(1, 10); i > 0; --i) {
    Mesh o = r.chance(.4f) ? person(r) : r.chance(.4f) ? laid_table(r) : thing(r);
    place(r, m, o, {r(-.5f, .5f) * l, r(-1.6f, -.15f) * depth, .05f}, o.top() > 1 ? 1 : r(.4f, 1));
  }
  const bool under = r.chance(.5f);
  s.camera = walk(
      r, {-l * r(.1f, .45f), under ? -depth * r(.3f, .8f) : -depth * r(1.2f, 2.5f), r(1.2f, 1.8f)},
      .2f, {40, 80});
  if (!under) s.camera.target.y = -depth * .4f;
}

// Below a bridge or in an underpass: a heavy roof, open at two sides.
void underpass(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  pave(r, s);
  const float w = r(6, 20), l = r(6, 30), h = r(3, 7), wall_h = r.chance(.6f) ? h : h * .5f;
  m.tint = r.albedo();
  m.block({-l / 2, -w / 2 - 2, h}, {l / 2, w / 2 + 2, h + r(.8f, 2)});
  for (const float side : {-1.f, 1.f})
    if (r.chance(.8f)) m.box({0, side * (w / 2 + .5f), wall_h / 2}, {l / 2, .5f, wall_h / 2});
  for (float x = -l / 2 + 1; x < l / 2; x += r(2.5f, 4))
    m.box({x, 0, h - .3f}, {.2f, w / 2 + 1, .3f});
  if (r.chance(.6f))
    for (float x = -l / 2 + 2; x < l / 2; x += 5) m.tube({x, 0, 0}, {x, 0, h}, .4f, .4f, 20);
  for (int i = r.count(0, 5); i > 0; --i) m.add(car(r), {}, {r(-1, 1) * l, r.sign() * w * .25f, 0});
  for (int i = r.count(0, 8); i > 0; --i)
    place(r, m, r.chance(.5f) ? person(r) : pile(r),
          {r(-.6f, .6f) * l, r.sign() * w * r(.3f, .48f), 0});
  if (r.chance(.5f)) m.add(facade(r, 30, r(6, 20)), {}, {-15, w / 2 + r(6, 20), 0});
  s.camera = walk(r, {-l * r(.1f, .9f), r(-.35f, .35f) * w, r(1, 2)}, .4f, {35, 80});
}

void terrace(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  pave(r, s, -r(.2f, 6));
  const float x = r(4, 12), y = r(3, 8);
  m.tint = r.albedo();
  m.block({0, 0, -.2f}, {x, y, 0});
  m.add(facade(r, x, r(2.8f, 7)), {}, {0, y, 0});
  if (r.chance(.4f)) m.block({-.2f, y * r(.2f, .8f), 0}, {0, y, r(1.8f, 3)});
  if (r.chance(.5f)) {  // a pergola or an awning
    const float h = r(2.3f, 3), reach = y * r(.3f, .8f);
    m.tint = r.albedo();
    if (r.chance(.5f))
      m.block({x * .1f, y - reach, h}, {x * .9f, y, h + .04f});
    else
      for (float t = 0; t < x; t += r(.3f, .5f))
        m.block({t, y - reach, h}, {t + .06f, y, h + .14f});
    for (const float t : {x * .1f, x * .9f})
      m.tube({t, y - reach, 0}, {t, y - reach, h}, .05f, .05f, 10);
  }
  if (r.chance(.6f)) fence(r, m, {0, .1f, 0}, {x, .1f, 0}, 1);
  for (int i = r.count(1, 4); i > 0; --i)
    place(r, m, r.chance(.6f) ? laid_table(r) : sofa(r), {x * r(.2f, .8f), y * r(.25f, .8f), 0});
  for (int i = r.count(1, 8); i > 0; --i) {
    const Vec at{x * r(.05f, .95f), y * (r.chance(.5f) ? r(.05f, .15f) : r(.85f, .95f)), 0};
    m.tint = r.albedo();
    m.tube(at, at + Vec{0, 0, .35f}, .15f, .22f, 16);
    m.add(plant(r), about_z(r.angle()), at + Vec{0, 0, .35f}, r(.3f, .8f));
  }
  for (int i = r.count(0, 3); i > 0; --i)
    place(r, m, person(r), {x * r(.1f, .9f), y * r(.2f, .8f), 0});
  for (int i = r.count(0, 8); i > 0; --i)
    place(r, m, tree(r, r.count(0, 1)), {r(-1, 2) * x, -r(3, 20), -1}, r(3, 8));
  s.camera = inside(r, {x, y * .9f, 2.6f}, {35, 80});
  if (r.chance(.5f)) s.camera.target = {x * r(.2f, .8f), y, r(.5f, 1.6f)};
}

void pavilion(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  pave(r, s, -.15f);
  const float x = r(3, 14), y = r(3, 10), h = r(2.3f, 5), q = r(.06f, .28f), over = r(.2f, .9f);
  m.tint = r.albedo();
  m.block({-.5f, -.5f, -.15f}, {x + .5f, y + .5f, 0});
  m.tint = r.albedo();
  if (r.chance(.85f))
    m.block({-over, -over, h}, {x + over, y + over, h + .2f});
  else
    for (float t = 0; t < x; t += .5f) m.block({t, -over, h}, {t + .1f, y + over, h + .22f});
  const int columns = r.count(1, 5);
  const bool round = r.chance(.5f);
  for (int i = 0; i <= columns; ++i)
    for (const float v : {0.f, y}) {
      const float u = x * float(i) / float(columns);
      if (round)
        m.tube({u, v, 0}, {u, v, h}, q, q, 16);
      else
        m.box({u, v, h / 2}, {q, q, h / 2});
    }
  if (r.chance(.55f)) m.box({x / 2, y, h / 2}, {x / 2, .1f, h / 2});
  if (r.chance(.25f)) m.box({0, y / 2, h / 2}, {.1f, y / 2, h / 2});
  for (int i = r.count(1, 7); i > 0; --i)
    place(r, m, r.chance(.6f) ? furniture(r) : person(r),
          {x * r(.15f, .85f), y * r(.15f, .85f), 0});
  for (int i = r.count(0, 10); i > 0; --i) {
    const float a = r.angle(), d = r(4, 25) + x;
    place(r, m, tree(r), {x / 2 + d * std::cos(a), y / 2 + d * std::sin(a), -.15f}, r(3, 8));
  }
  if (r.chance(.6f)) {
    s.camera = inside(r, {x, y, h}, {35, 85});
  } else {
    s.camera.eye = {x * r(-.2f, 1.2f), -r(2, 9), r(1, 2)};
    s.camera.target = {x * r(.2f, .8f), y * .5f, h * r(.2f, .5f)};
    s.camera.fov = r(30, 70);
  }
}

// Decks on columns: a car park, a shell of concrete, a building site.
void decks(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  pave(r, s, -.02f);
  const float pitch = r(4, 8), h = r(2.4f, 3.6f), q = r(.15f, .35f);
  const int nx = r.count(2, 6), ny = r.count(2, 4), floors = r.count(1, 4);
  m.tint = r.albedo();
  for (int k = 0; k < floors; ++k) {
    const float z = float(k) * h;
    m.block({-1, -1, z + h - .25f}, {pitch * float(nx) + 1, pitch * float(ny) + 1, z + h});
    for (int i = 0; i <= nx; ++i)
      for (int j = 0; j <= ny; ++j)
        m.box({pitch * float(i), pitch * float(j), z + h / 2}, {q, q, h / 2});
    for (int i = 0; i < nx; ++i)
      if (r.chance(.3f))
        m.box({pitch * (float(i) + .5f), pitch * float(ny), z + h / 2}, {pitch / 2, .1f, h / 2});
    if (r.chance(.6f)) m.block({-1, -1, z + h}, {pitch * float(nx) + 1, -.85f, z + h + 1});
  }
  const float x = pitch * float(nx), y = pitch * float(ny);
  const float z = float(r.count(0, floors)) * h;
  for (int i = r.count(1, 9); i > 0; --i) {
    const Vec at{x * r(.05f, .95f), y * r(.05f, .95f), z};
    if (r.chance(.6f))
      m.add(car(r), about_z(kPi / 2), at);
    else
      place(r, m, r.chance(.5f) ? person(r) : pile(r), at, 1);
  }
  s.camera = inside(r, {x, y, 2.4f}, {40, 85});
  s.camera.eye.z += z;
  s.camera.target.z = s.camera.eye.z + r(-.6f, .2f);
}
}  // namespace

std::vector<Family> town_families() {
  return {{"street", street, false, false},    {"courtyard", courtyard, false, true},
          {"vehicles", vehicles, true, false}, {"aerial", aerial, false, false},
          {"arcade", arcade, true, false},     {"underpass", underpass, true, false},
          {"terrace", terrace, true, true},    {"pavilion", pavilion, true, false},
          {"decks", decks, false, false}};
}
