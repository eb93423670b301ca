// SPDX-License-Identifier: Apache-2.0
//
// Small scenes that are open to the sky and to the camera: boxes without a front, walls that end,
// backdrops, plinths, still lifes, single props.
#include <algorithm>

#include "scene.h"

namespace {
// The ground of a small scene at height z: without an end, a slab, a disc, or none.
void open_floor(Random& r, Scene& s, float size, float chance_of_none = 0, float z = 0) {
  Mesh& m = s.mesh;
  m.tint = r.floor_albedo();
  const float end = size * r.log(1.2f, 8);
  if (r.chance(chance_of_none)) return;
  if (r.chance(.6f))
    ground(m, z);
  else if (r.chance(.5f))
    m.box({0, 0, z - .02f * size}, {end, end * r(.6f, 1), .02f * size}, about_z(r.angle()));
  else
    m.tube({0, 0, z - .05f * size}, {0, 0, z}, end, end, 48);
}

Mesh some_thing(Random& r) {
  return r.chance(.08f) ? robot(r) : r.chance(.06f) ? engine(r) : thing(r);
}

void things_on(Random& r, Mesh& m, Vec middle, Vec spread, Range count, Range size) {
  for (int i = r.count(int(count.low), int(count.high)); i > 0; --i) {
    Mesh o = some_thing(r);
    const float scale = r.log(size.low, size.high) / std::max(.6f, o.top());
    place(r, m, o, middle + Vec{r(-1, 1) * spread.x, r(-1, 1) * spread.y, 0}, scale);
  }
}

// Looks from the open side, -y, at a point, within `side` radians.
void from_front(Random& r, Scene& s, Vec at, Range distance, float side, Range elevation) {
  const float a = -kPi / 2 + r(-side, side), e = r(elevation.low, elevation.high);
  const float d = r.log(distance.low, distance.high);
  Camera& c = s.camera;
  c.target = at;
  c.eye = at + Vec{std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)} * d;
  c.fov = r(22, 62);
  if (r.chance(.06f)) c.ortho_width = 2 * d * std::tan(c.fov * kPi / 360);
}

// A box of three to five thin faces whose front is open, seen whole or nearly so from outside.
void open_box(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float size = r.log(.3f, 6), x = size * r(.7f, 1.5f), y = size * r(.5f, 1.4f),
              h = size * r(.5f, 1.3f), t = size * r(.005f, .04f);
  const Vec paint = r.albedo();
  const auto face = [&](float chance_of_paint) {
    m.tint = r.chance(chance_of_paint) ? paint : r.albedo();
  };
  open_floor(r, s, size, .25f);
  const float base = r.chance(.6f) ? t : size * r(.05f, .8f);  // stands higher than the ground
  Mesh outside;
  std::swap(outside, m);
  face(1);
  m.block({-x / 2, -y / 2, -t}, {x / 2, y / 2, 0});
  if (r.chance(.92f)) m.block({-x / 2, y / 2, 0}, {x / 2, y / 2 + t, h});
  face(.4f);
  const float left = r.chance(.8f) ? 1 : r(.2f, .8f), right = r.chance(.8f) ? 1 : r(.2f, .8f);
  if (r.chance(.85f)) m.block({-x / 2 - t, -y / 2, -t}, {-x / 2, y / 2 + t, h * left});
  face(.4f);
  if (r.chance(.85f)) m.block({x / 2, -y / 2, -t}, {x / 2 + t, y / 2 + t, h * right});
  face(.8f);
  if (r.chance(.45f))
    m.block({-x / 2 - t, -y / 2 + (r.chance(.3f) ? y * r(.2f, .7f) : 0), h},
            {x / 2 + t, y / 2 + t, h + t});
  things_on(r, m, {0, y * .05f, 0}, {x * .36f, y * .34f, 0}, {1, 7}, {h * .12f, h * .6f});
  outside.add(m, {}, {0, 0, base});
  std::swap(outside, m);
  if (r.chance(.3f)) things_on(r, m, {0, -y, 0}, {x * .8f, y * .3f, 0}, {1, 3}, {h * .1f, h * .3f});
  from_front(r, s, {x * r(-.12f, .12f), 0, base + h * r(.35f, .55f)},
             {y * .5f + h * .5f, y * .6f + h * 2.2f}, .6f, {-.05f, .5f});
}

// Two walls and a floor that end in or beside the picture, things before them.
void two_walls(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float size = r.log(.5f, 8), h = size * r(.4f, 1.2f), t = size * .02f;
  open_floor(r, s, size * 1.5f, .4f, -.02f * size);
  m.tint = r.floor_albedo();
  const float far = size * r(.7f, 1.6f), along = size * r(.7f, 1.8f);
  m.block({-far, -along, -.03f * size}, {size + t, size + t, 0});
  m.tint = r.albedo();
  m.add(wall(far + size, h, t, r.chance(.3f) ? windows(r, far + size, h) : std::vector<Opening>{}),
        {}, {-far, size, 0});
  if (r.chance(.5f)) m.tint = r.albedo();
  const float other = r.chance(.7f) ? h : h * r(.3f, 1);
  if (r.chance(.75f)) m.block({size, size - along * r(.5f, 1.4f), 0}, {size + t, size, other});
  things_on(r, m, {size * .2f, size * .3f, 0}, {size * .6f, size * .55f, 0}, {1, 9},
            {size * .1f, size * .5f});
  if (size > 2)
    for (int i = r.count(0, 5); i > 0; --i) {
      const Mesh o = r.chance(.7f) ? furniture(r) : person(r);
      place(r, m, o, {size * r(-.4f, .8f), size * r(-.3f, .8f), 0});
    }
  from_front(r, s, {size * r(0, .5f), size * r(.2f, .6f), h * r(.2f, .5f)}, {size * 1, size * 2.6f},
             .2f, {.05f, .55f});
  const float turn = r(-1, .25f);  // towards the side that has no wall
  const Vec view = about_z(turn) * (s.camera.eye - s.camera.target);
  s.camera.eye = s.camera.target + view;
}

// A stage with flats: a back, wings at the sides, sometimes a canopy.
void stage(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  m.tint = r.floor_albedo();
  ground(m);
  const float x = r(5, 14), y = r(4, 9), h = r(3, 6), up = r(0, 1.2f);
  m.tint = r.albedo();
  m.block({-x / 2, -y / 2, 0}, {x / 2, y / 2, up});
  m.tint = r.albedo();
  if (r.chance(.85f)) m.block({-x / 2, y / 2 - .1f, up}, {x / 2, y / 2, up + h});
  const int wings = r.count(0, 3);
  for (int i = 0; i < wings; ++i)
    for (const float side : {-1.f, 1.f})
      m.box({side * x * .45f, y * (float(i) * .3f - .25f), up + h * .45f},
            {x * .06f, .05f, h * .45f}, about_z(side * r(-.1f, .5f)));
  if (r.chance(.3f)) {
    m.block({-x / 2, -y * r(-.2f, .5f), up + h}, {x / 2, y / 2, up + h + .15f});
    for (const float side : {-1.f, 1.f})
      m.tube({side * x * .48f, -y * .45f, 0}, {side * x * .48f, -y * .45f, up + h}, .1f, .1f);
  }
  if (up > .2f) {
    m.tint = r.albedo();
    m.add(stairs({2, up / 3, .3f, 3}, true), {}, {x * r(-.4f, .4f), -y / 2 - .9f, 0});
  }
  for (int i = r.count(1, 9); i > 0; --i) {
    Mesh o = r.chance(.5f) ? person(r) : r.chance(.5f) ? furniture(r) : thing(r);
    place(r, m, o, {x * r(-.36f, .36f), y * r(-.4f, .3f), up});
  }
  for (int i = r.chance(.4f) ? r.count(2, 14) : 0; i > 0; --i)
    place(r, m, person(r), {x * r(-.6f, .6f), -y * r(.7f, 1.5f), 0});
  from_front(r, s, {x * r(-.2f, .2f), 0, up + r(.8f, 1.6f)}, {y, y * 2.5f}, .7f, {.02f, .25f});
}

// A sheet that bends upwards behind a product, under the open sky; its edges may be seen.
void backdrop(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float size = r.log(.25f, 3), w = size * r(.7f, 3), bend = size * r(.15f, .7f),
              high = size * r(.3f, 2), front = size * r(.8f, 3), back = size * r(.5f, 1.2f);
  open_floor(r, s, size * 2, .5f);
  m.tint = r.albedo();
  m.surface(1, 40, false, [&](float u, float v) {
    const float x = (u - .5f) * 2 * w, z = .01f * size;
    if (v < .3f) return Vec{x, -front + (front + back) * v / .3f, z};
    if (v > .7f) return Vec{x, back + bend, z + bend + high * (v - .7f) / .3f};
    const float a = (v - .3f) / .4f * kPi / 2;
    return Vec{x, back + bend * std::sin(a), z + bend - bend * std::cos(a)};
  });
  float top = .01f * size;
  if (r.chance(.4f)) {
    const float q = size * r(.2f, .6f);
    const Vec at{0, 0, top};
    top += size * r(.05f, .5f);
    m.tint = r.albedo();
    if (r.chance(.5f))
      m.tube(at, {0, 0, top}, q, q, 40);
    else
      m.block({-q, -q, at.z}, {q, q, top});
  }
  place(r, m, some_thing(r), {0, 0, top}, size * r(.25f, .6f));
  things_on(r, m, {0, 0, .01f * size}, {w * .6f, size * .6f, 0}, {0, 4}, {size * .1f, size * .4f});
  from_front(r, s, {0, 0, top + size * r(.1f, .3f)}, {size * 1, size * 3}, .6f, {.03f, .6f});
}

// Things on plinths, steps and discs out in the open.
void pedestal(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float size = r.log(.3f, 3);
  open_floor(r, s, size * 3, .1f);
  for (int i = 0, n = r.chance(.6f) ? 1 : r.count(2, 5); i < n; ++i) {
    Vec at{i ? size * r(-2.5f, 2.5f) : 0, i ? size * r(-1, 2.5f) : 0, 0};
    float w = size * r(.3f, 1.1f);
    for (int k = r.count(1, 3); k > 0; --k) {  // steps, each narrower
      const float h = size * r.log(.05f, k == 1 ? 1.2f : .3f);
      m.tint = r.albedo();
      if (r.chance(.5f))
        m.tube(at, at + Vec{0, 0, h}, w, w, 40);
      else
        m.box(at + Vec{0, 0, h / 2}, {w, w, h / 2});
      at.z += h;
      w *= r(.6f, .95f);
    }
    const Mesh o = r.chance(.2f) ? robot(r) : thing(r);
    place(r, m, o, at, w * r(.8f, 1.8f) / std::max(.7f, o.top()));
  }
  s.camera = orbit(r, {0, 0, size * r(.2f, .9f)}, {size * 1.6f, size * 6}, {-2, 40}, {20, 60});
}

// A few small things on a board, seen from near; nothing else around them but the ground.
void still_life(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float size = r.log(.1f, .5f);
  const Vec board{size * r(1, 4), size * r(.8f, 3), size * .05f};
  const float high = r.chance(.5f) ? .75f : r(.02f, .4f);
  m.tint = r.floor_albedo();
  if (r.chance(.7f)) ground(m, -high - board.z);
  m.tint = r.albedo();
  m.box({0, 0, -board.z}, board);
  if (r.chance(.5f))
    for (const float x : {-.9f, .9f})
      for (const float y : {-.9f, .9f})
        m.tube({x * board.x, y * board.y, -high - board.z}, {x * board.x, y * board.y, -board.z},
               .02f, .02f);
  if (r.chance(.2f))
    m.box({0, board.y * r(.9f, 2), board.x * .3f}, {board.x * 1.5f, .02f, board.x * r(.4f, .9f)});
  const float reach = std::min(.8f, r(.4f, 1.2f) * size / board.y);
  things_on(r, m, {0, 0, 0}, {reach * board.x * .7f, reach * board.y, 0}, {2, 9},
            {size * .2f, size * .9f});
  if (r.chance(.3f)) place(r, m, plant(r), {board.x * r(-.4f, .4f), board.y * .3f, 0}, size);
  s.camera = orbit(r, {0, 0, size * r(.05f, .4f)}, {size * 1.5f, size * 5}, {4, 60}, {20, 55});
}

// A table that is laid outdoors, or a cloth on the ground, with or without a wall behind.
void picnic(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  m.tint = r.floor_albedo();
  ground(m);
  float top = .02f;
  if (r.chance(.6f)) {
    const Mesh t = r.chance(.5f) ? table(r) : laid_table(r);
    m.add(t, about_z(r(-.2f, .2f)), {0, 0, 0});
    top = .78f;
  } else {
    m.tint = r.albedo();
    m.box({0, 0, .01f}, {r(.6f, 1.2f), r(.5f, 1), .01f}, about_z(r(-.4f, .4f)));
  }
  const float e = top > .5f ? .3f : .5f;
  things_on(r, m, {0, 0, top}, {e, e * .8f, 0}, {3, 12}, {.05f, .35f});
  if (r.chance(.35f)) m.add(facade(r, 9, r(3, 6)), {}, {-4.5f, r(1.2f, 4), 0});
  for (int i = r.count(0, 4); i > 0; --i)
    place(r, m, r.chance(.5f) ? tree(r) : plant(r), {r(-8, 8), r(1.5f, 12), 0}, r(1, 5));
  for (int i = r.count(0, 3); i > 0; --i)
    place(r, m, r.chance(.5f) ? person(r) : chair(r), {r.sign() * r(.9f, 2), r(-.5f, 1.2f), 0});
  s.camera = orbit(r, {r(-.1f, .1f), 0, top + r(0, .15f)}, {.7f, 3}, {4, 50}, {20, 60});
}

// One prop, or a few that touch, with no ground or a small base.
void prop(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float size = r.log(.1f, 5);
  open_floor(r, s, size * .5f, .55f);
  const int kind = r.count(0, 6);
  Mesh o = kind == 0   ? robot(r)
           : kind == 1 ? engine(r)
           : kind == 2 ? furniture(r)
           : kind == 3 ? car(r)
           : kind == 4 ? compound(r)
                       : thing(r);
  o.stand();
  const float scale = size / std::max(.6f, o.top());
  place(r, m, o, {0, 0, 0}, scale);
  if (r.chance(.3f)) place(r, m, thing(r), {size * r(.3f, .8f), 0, 0}, size * r(.2f, .6f));
  s.camera = orbit(r, {0, 0, size * r(.3f, .6f)}, {size * 1.6f, size * 4}, {-15, 60}, {20, 55});
}

// A furnished room without what would stand before the camera: two walls or three, mostly no
// ceiling, seen from inside, from outside or from above.
void cutaway(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const RoomPlan p{r(2.5f, 7), r(2.5f, 6), r(2.3f, 3.2f)};
  if (r.chance(.6f)) {
    m.tint = r.floor_albedo();
    ground(m, -.15f);
  }
  m.tint = r.floor_albedo();
  m.block({-.1f, -.1f, -.12f}, {p.x + .1f, p.y + .1f, 0});
  const Vec paint = r.albedo();
  const auto side = [&](float width, const Rot& turn, Vec at) {
    m.tint = r.chance(.7f) ? paint : r.albedo();
    m.add(wall(width, p.height, .1f,
               r.chance(.5f) ? windows(r, width, p.height) : std::vector<Opening>{}),
          turn, at);
  };
  side(p.x, {}, {0, p.y, 0});
  side(p.y, about_z(kPi / 2), {0, 0, 0});
  const bool both = r.chance(.4f);
  if (both) side(p.y, about_z(-kPi / 2), {p.x, p.y, 0});
  if (r.chance(.25f))
    m.block({-.1f, r.chance(.5f) ? 0 : p.y * r(.2f, .7f), p.height},
            {p.x + .1f, p.y + .1f, p.height + .1f});
  furnish(r, m, p, r.count(3, 10));
  for (int i = r.count(0, 2); i > 0; --i)
    place(r, m, person(r), {p.x * r(.2f, .8f), p.y * r(.3f, .8f), 0});
  Camera& c = s.camera;
  c.target = {p.x * r(.3f, .6f), p.y * r(.4f, .8f), p.height * r(.15f, .45f)};
  const float a = both ? -kPi / 2 + r(-.35f, .35f) : -kPi / 4 + r(-.6f, .6f);
  const float d = p.x * r(.6f, 1.6f) + p.y * .3f, e = r.chance(.4f) ? r(.4f, .9f) : r(0, .3f);
  c.eye = c.target + Vec{std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)} * d;
  c.fov = r(25, 60);
  if (r.chance(.15f)) c.ortho_width = p.x * r(1, 1.8f);
}
}  // namespace

std::vector<Family> open_set_families() {
  return {{"open box", open_box, true, false}, {"two walls", two_walls, true, false},
          {"stage", stage, true, true},        {"backdrop", backdrop, true, false},
          {"pedestal", pedestal, true, false}, {"still life", still_life, false, false},
          {"picnic", picnic, true, true},      {"prop", prop, false, false}};
}

std::vector<Family> cutaway_families() { return {{"cutaway", cutaway, true, false}}; }
