// SPDX-License-Identifier: Apache-2.0
//
// Interiors.
#include <algorithm>

#include "scene.h"

namespace {
RoomPlan plan_of(Random& r, Range side, Range height) {
  RoomPlan p{r(side.low, side.high), r(side.low, side.high), r(height.low, height.high)};
  p.windows = r(.2f, .9f);
  p.missing_wall = r.chance(.6f) ? 0 : .3f;
  p.missing_ceiling = r.chance(.85f) ? 0 : .6f;
  return p;
}

void tabletop(Random& r, Scene& s) {
  const RoomPlan p = plan_of(r, {2.8f, 6}, {2.3f, 3.4f});
  room(r, s.mesh, p);
  furnish(r, s.mesh, p, r.count(1, 5));
  const float x = r(.3f, .7f) * p.x, y = r(.3f, .7f) * p.y;
  Mesh t(r);
  const float w = r(.4f, .9f), d = r(.3f, .55f), z = r(.45f, .85f);
  t.box({0, 0, z - .02f}, {w, d, .02f});
  for (const float sx : {-1.f, 1.f})
    for (const float sy : {-1.f, 1.f})
      t.box({sx * (w - .04f), sy * (d - .04f), z / 2 - .02f}, {.03f, .03f, z / 2 - .02f});
  for (int i = r.count(3, 16); i > 0; --i)
    place(r, t, thing(r), {r(-.8f, .8f) * w, r(-.8f, .8f) * d, z}, r.log(.05f, .3f));
  s.mesh.add(t, about_z(r.chance(.6f) ? 0 : r.angle()), {x, y, 0});
  s.camera = orbit(r, {x + r(-.15f, .15f), y + r(-.1f, .1f), z + r(0, .12f)}, {.5f, 1.2f}, {8, 55},
                   {25, 60});
}

void living_room(Random& r, Scene& s) {
  const RoomPlan p = plan_of(r, {2.8f, 8}, {2.2f, 3.8f});
  room(r, s.mesh, p);
  furnish(r, s.mesh, p, r.count(4, 14));
  s.camera = inside(r, {p.x, p.y, p.height}, {40, 90});
}

void corridor(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float l = r(8, 40), w = r(1.3f, 3.5f), h = r(2.2f, 4), t = .15f;
  m.tint = r.albedo();
  m.block({0, -w / 2 - t, -t}, {l, w / 2 + t, 0});
  const Vec paint = r.albedo();
  m.tint = paint;
  if (!r.chance(.1f)) m.block({0, -w / 2 - t, h}, {l, w / 2 + t, h + t});
  for (const float side : {-1.f, 1.f}) {
    if (r.chance(.05f)) continue;
    std::vector<Opening> doors;
    const bool daylight = r.chance(.35f);
    for (float x = r(.5f, 3); x < l - 2 && r.chance(.95f); x += r(1.6f, 5))
      doors.push_back({x, x + r(.75f, 1.3f), daylight ? .9f : .01f, std::min(2.1f, h - .1f)});
    Mesh side_wall = wall(l, h, t, doors);
    for (Vec& c : side_wall.albedo) c = paint;
    m.add(side_wall, {}, {0, side > 0 ? w / 2 : -w / 2 - t, 0});
    if (!daylight)  // closed doors in some openings, rooms behind the others
      for (const Opening& d : doors)
        if (r.chance(.6f))
          m.block({d.x0, side * (w / 2 + .08f) - .02f, 0},
                  {d.x1, side * (w / 2 + .08f) + .02f, d.z1});
    if (!daylight) {
      const float back = side * (w / 2 + t + r(2, 5));
      m.block({0, back - .05f, 0}, {l, back + .05f, h});
      m.block({0, std::min(back, 0.f), h}, {l, std::max(back, 0.f), h + t});
      m.block({0, std::min(back, 0.f), -t}, {l, std::max(back, 0.f), -.001f});
    }
  }
  for (const float x : {0.f, l})
    if (r.chance(.75f)) m.block({x - .1f, -w / 2 - t, 0}, {x + .1f, w / 2 + t, h});
  if (r.chance(.4f))
    for (float x = 1; x < l; x += r(2, 4)) m.box({x, 0, h - .1f}, {.1f, w / 2, .1f});
  for (int i = r.count(0, 8); i > 0; --i) {
    const bool wide = r.chance(.5f);
    Mesh o = wide ? cabinet(r) : r.chance(.5f) ? person(r) : thing(r);
    m.add(o, about_z(r.chance(.5f) ? 0 : kPi), {r(2, l - 1), r.sign() * (w / 2 - .35f), 0},
          o.top() < 1.2f ? r.log(.3f, .8f) : 1);
  }
  m.tint = r.floor_albedo();
  if (r.chance(.6f)) ground(m, -t - .01f);
  s.camera = walk(r, {r(.6f, l * .6f), r(-.25f, .25f) * w, r(.9f, 1.75f)}, .35f, {40, 85});
}

void kitchen(Random& r, Scene& s) {
  RoomPlan p = plan_of(r, {2.4f, 4.5f}, {2.3f, 2.8f});
  p.missing_wall *= .5f;
  room(r, s.mesh, p);
  Mesh& m = s.mesh;
  const float depth = r(.55f, .65f);
  const Vec front = r.albedo(), top = r.albedo();
  for (const int side : {2, 3}) {
    if (side == 3 && r.chance(.4f)) continue;
    const float l = side == 2 ? p.x : p.y - depth;
    Mesh row;
    row.tint = front;
    row.block({0, -depth + .05f, 0}, {l, 0, .1f});
    for (float x = 0; x < l - .2f; x += .6f)
      row.block({x + .005f, -depth, .1f}, {std::min(x + .595f, l), 0, .88f});
    row.tint = top;
    row.block({0, -depth - .03f, .88f}, {l, 0, .92f});
    row.tint = front;
    const float z = r(1.35f, 1.5f);
    for (float x = 0; x < l - .2f; x += .6f)
      if (r.chance(.8f)) row.block({x + .005f, -.35f, z}, {std::min(x + .595f, l), 0, z + .75f});
    for (int i = r.count(1, 7); i > 0; --i)
      place(r, row, thing(r), {r(.1f, .9f) * l, r(-.5f, -.2f), .92f}, r.log(.1f, .35f));
    m.add(row, about_z(side == 2 ? 0 : kPi / 2), side == 2 ? Vec{0, p.y, 0} : Vec{0, 0, 0});
  }
  if (r.chance(.6f)) place(r, m, laid_table(r), {p.x * .6f, p.y * .35f, 0});
  s.camera = inside(r, {p.x, p.y * .6f, p.height}, {45, 85});
  s.camera.target = {p.x * r(.1f, .8f), p.y, r(.7f, 1.3f)};
}

void staircase(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const Flight f{r(.9f, 2.2f), r(.14f, .19f), r(.25f, .33f), r.count(8, 18)};
  const float rise = f.rise * float(f.steps), run = f.going * float(f.steps);
  const Vec stone = r.albedo();
  Mesh up = stairs(f, r.chance(.6f));
  for (Vec& c : up.albedo) c = stone;
  m.add(up, {}, {0, 0, 0});
  m.tint = stone;
  const bool inside_house = r.chance(.7f);
  m.block({-f.width / 2, run, rise - .2f}, {f.width * 1.6f, run + 1.5f, rise});
  if (r.chance(.6f)) m.add(up, about_z(kPi), {f.width * 1.1f, run, rise});
  const float w = f.width * 1.7f, h = rise * (r.chance(.5f) ? 2.2f : 1.3f) + 2;
  m.tint = r.albedo();
  m.block({-4, -5, -.1f}, {6, run + 2, 0});
  if (inside_house) {
    const float half = f.width / 2 + .02f;
    if (r.chance(.85f)) m.block({-half - .2f, -3, 0}, {-half, run + 1.7f, h});
    if (r.chance(.75f)) m.block({w, -3, 0}, {w + .2f, run + 1.7f, h});
    if (r.chance(.8f)) {
      Mesh back = wall(w + half + .2f, h, .2f,
                       r.chance(.5f) ? windows(r, w + half, h) : std::vector<Opening>{});
      m.add(back, {}, {-half, run + 1.5f, 0});
    }
    if (r.chance(.75f)) m.block({-half - .2f, -3, h}, {w + .2f, run + 1.7f, h + .2f});
    if (r.chance(.5f)) m.block({-half, -3.2f, 0}, {w, -3, h});
  }
  if (r.chance(.6f))
    for (int i = 0; i < f.steps; ++i)
      m.tube({f.width / 2 - .05f, f.going * (float(i) + .5f), f.rise * float(i + 1)},
             {f.width / 2 - .05f, f.going * (float(i) + .5f), f.rise * float(i + 1) + .9f}, .012f,
             .012f, 6);
  for (int i = r.count(0, 2); i > 0; --i) {
    const int k = r.count(0, f.steps - 1);
    place(r, m, person(r),
          {r(-.3f, .2f) * f.width, f.going * (float(k) + .5f), f.rise * float(k + 1)});
  }
  Camera& c = s.camera;
  const bool down = r.chance(.3f);
  c.eye = down ? Vec{r(-.2f, .6f) * f.width, run + r(.3f, 1), rise + r(1.2f, 1.7f)}
               : Vec{r(-.3f, 1) * f.width, -r(.8f, 2.6f), r(.5f, 1.8f)};
  c.target =
      down ? Vec{0, run * .2f, rise * .2f} : Vec{r(-.2f, .4f) * f.width, run, rise * r(.4f, .9f)};
  c.fov = r(40, 80);
}

void attic(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  const float x = r(4, 9), y = r(4, 7), knee = r(.3f, 1.2f), ridge = knee + y * r(.35f, .6f);
  m.tint = r.albedo();
  m.block({-.2f, -.2f, -.2f}, {x + .2f, y + .2f, 0});
  m.tint = r.albedo();
  m.block({0, -.2f, 0}, {x, 0, knee});
  m.block({0, y, 0}, {x, y + .2f, knee});
  const float rise = ridge - knee, l = std::sqrt(rise * rise + y * y / 4);
  for (int side = 0; side < 2; ++side) {
    std::vector<Opening> holes;
    for (float at = r(.4f, 2); at < x - 1.2f && r.chance(.8f); at += r(1.5f, 4))
      holes.push_back({at, at + r(.5f, .9f), l * .25f, l * r(.5f, .7f)});
    Mesh slope = wall(x, l, .15f, holes);
    const Rot turn = (side ? about_z(kPi) : Rot{}) * about_x(std::atan2(rise, y / 2) - kPi / 2);
    m.add(slope, turn, side ? Vec{x, y, knee} : Vec{0, 0, knee});
  }
  for (const float at : {0.f, x}) {
    if (r.chance(.1f)) continue;
    const float t = at == 0 ? -.1f : .1f;
    m.box({at + t, y / 2, knee / 2}, {.1f, y / 2, knee / 2});
    for (const float q : {at, at + 2 * t})
      m.triangle({q, 0, knee}, {q, y, knee}, {q, y / 2, ridge});
  }
  for (float at = r(.3f, 1); at < x; at += r(.8f, 2.2f)) {
    m.tint = {.35f, .25f, .15f};
    m.block({at, y * .2f, knee + rise * .38f}, {at + .12f, y * .8f, knee + rise * .38f + .15f});
    if (r.chance(.4f)) m.block({at, y * .3f, 0}, {at + .12f, y * .3f + .12f, knee + rise * .5f});
  }
  for (int i = r.count(3, 14); i > 0; --i) {
    Mesh o = r.chance(.4f) ? furniture(r) : r.chance(.5f) ? pile(r) : thing(r);
    place(r, m, o, {x * r(.1f, .9f), y * r(.15f, .85f), 0}, o.top() > 1.3f ? .7f : r.log(.4f, 1));
  }
  m.tint = r.floor_albedo();
  if (r.chance(.5f)) ground(m, -r(3, 9));
  s.camera = inside(r, {x, y, std::max(1.4f, knee + rise * .5f)}, {45, 85});
  s.camera.eye.y = y * r(.3f, .7f);
  s.camera.eye.x = x * (r.chance(.5f) ? r(.06f, .2f) : r(.8f, .94f));
  s.camera.target = {x - s.camera.eye.x, y * r(.3f, .7f), r(.4f, 1.4f)};
}

void hall(Random& r, Scene& s) {
  Mesh& m = s.mesh;
  RoomPlan p{r(10, 30), r(8, 18), r(4, 10)};
  p.windows = r(.4f, 1);
  p.missing_wall = .08f;
  p.missing_ceiling = .08f;
  room(r, m, p);
  m.tint = r.albedo();
  const float pitch = r(2.5f, 5), q = r(.15f, .45f), in = r(1.2f, 3), tie = p.height * r(.5f, .85f);
  const bool round = r.chance(.5f), gallery = r.chance(.4f);
  for (float x = pitch; x < p.x - 1; x += pitch)
    for (const float y : {in, p.y - in}) {
      if (round) {
        m.tube({x, y, 0}, {x, y, p.height}, q, q * .9f, 16);
        m.box({x, y, q * .5f}, {q * 1.4f, q * 1.4f, q * .5f});
      } else {
        m.box({x, y, p.height / 2}, {q, q, p.height / 2});
      }
    }
  if (gallery)
    for (const float y : {in / 2, p.y - in / 2}) {
      m.box({p.x / 2, y, tie}, {p.x / 2, in / 2, .15f});
      m.box({p.x / 2, y < p.y / 2 ? in : p.y - in, tie + .6f}, {p.x / 2, .04f, .45f});
    }
  for (int i = r.count(2, 30); i > 0; --i) {
    Mesh o = r.chance(.35f) ? person(r) : r.chance(.5f) ? furniture(r) : thing(r);
    place(r, m, o, {p.x * r(.1f, .9f), p.y * r(.2f, .8f), 0});
  }
  s.camera = walk(r, {p.x * r(.05f, .5f), p.y * r(.3f, .7f), r(1.2f, 1.9f)}, .6f, {35, 80});
  if (gallery && r.chance(.3f)) s.camera.eye = {p.x * r(.1f, .4f), in * .7f, tie + 1.5f};
}

// Close views of what stands in a room: nothing in the picture shows the ceiling.
void close_in_room(Random& r, Scene& s) {
  RoomPlan p = plan_of(r, {2.5f, 5}, {2.3f, 3});
  room(r, s.mesh, p);
  furnish(r, s.mesh, p, r.count(5, 10));
  const float x = p.x * r(.15f, .85f), y = r.chance(.6f) ? p.y - r(.3f, .6f) : p.y * r(.3f, .7f);
  Mesh o = r.chance(.6f) ? furniture(r) : r.chance(.5f) ? person(r) : thing(r);
  s.mesh.add(o, about_z(r(-.4f, .4f)), {x, y, 0}, o.top() < .9f ? r.log(.4f, 1) : 1);
  for (int i = r.count(0, 5); i > 0; --i)
    place(r, s.mesh, thing(r), {x + r(-.6f, .6f), y - r(.1f, .8f), 0}, r.log(.1f, .4f));
  const float a = -kPi / 2 + r(-.8f, .8f), d = r(.6f, 1.6f), e = r(0, .6f);
  Camera& c = s.camera;
  c.target = {x + r(-.2f, .2f), y, std::min(o.top(), 1.5f) * r(.2f, .9f)};
  c.eye = c.target + Vec{std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)} * d;
  c.eye.z = std::min(std::max(c.eye.z, .2f), p.height - .3f);
  c.fov = r(25, 60);
}

void shelf_close(Random& r, Scene& s) {
  RoomPlan p = plan_of(r, {2.5f, 5}, {2.4f, 3});
  room(r, s.mesh, p);
  const float x = p.x * r(.3f, .7f);
  Mesh m = r.chance(.7f) ? shelf(r) : cabinet(r);
  s.mesh.add(m, {}, {x, p.y - .32f, 0});
  if (r.chance(.5f)) s.mesh.add(shelf(r), {}, {x + r(1.7f, 2.4f) * r.sign(), p.y - .32f, 0});
  Camera& c = s.camera;
  c.target = {x + r(-.3f, .3f), p.y - .3f, m.top() * r(.3f, .9f)};
  c.eye = c.target + Vec{r(-.8f, .8f), -r(.6f, 1.6f), r(-.2f, .6f)};
  c.fov = r(30, 60);
}

void cave(Random& r, Scene& s) {
  const float size = r.log(2, 12), rough = r(.15f, .4f), hole = r(.15f, .8f);
  const int seed = r.count(0, 1 << 20);
  const Vec k{r(.7f, 2), r(.7f, 1.2f), r(.45f, .8f)};
  const Vec mouth = unit(Vec{r.sign() * k.x, r(-.5f, .5f), r(-.1f, .8f)});
  Mesh shell(r), open(r);
  shell.surface(240, 120, true, [&](float u, float v) {
    const float f = 2 * kPi * u, t = kPi * v;
    const Vec d{std::sin(t) * std::cos(f), std::sin(t) * std::sin(f), -std::cos(t)};
    const float q = 1 + rough * fractal(d * 2.2f, seed, 4);
    const float floor = -.6f * k.z + .05f * fractal(d * 9, seed + 9, 2);
    return Vec{d.x * k.x * q, d.y * k.y * q, std::max(floor, d.z * k.z * q)};
  });
  open.points = shell.points;
  open.normals = shell.normals;
  for (size_t i = 0; i < shell.corners.size(); i += 3) {
    const unsigned* q = &shell.corners[i];
    const Vec e = unit(shell.points[q[0]] + shell.points[q[1]] + shell.points[q[2]]);
    if (dot(e, mouth) > 1 - hole * .6f && e.z > -.45f) continue;
    open.corners.insert(open.corners.end(), q, q + 3);
    open.albedo.push_back(shell.tint);
  }
  s.mesh.add(open, {}, {0, 0, 0}, size);
  for (int i = r.count(4, 30); i > 0; --i) {
    const float q = std::sqrt(r(0, .6f)), f = r.angle();
    s.mesh.add(blob(r, r(.3f, .8f), 20), about_z(r.angle()),
               {q * std::cos(f) * k.x * size, q * std::sin(f) * k.y * size, -.58f * k.z * size},
               size * r.log(.04f, .35f));
  }
  s.mesh.tint = r.floor_albedo();
  if (r.chance(.5f)) ground(s.mesh, -.65f * k.z * size);
  s.camera.eye = Vec{r(-.45f, .45f) * k.x, r(-.35f, .35f) * k.y, -.3f * k.z} * size;
  const Vec look = r.chance(.5f) ? mouth : Vec{-mouth.x, r(-1, 1), -.2f};
  s.camera.target = s.camera.eye + unit(Vec{look.x, look.y, r(-.35f, .15f)}) * size;
  s.camera.fov = r(40, 85);
}
}  // namespace

std::vector<Family> room_families() {
  return {{"tabletop", tabletop, false, false},   {"room", living_room, false, false},
          {"corridor", corridor, false, false},   {"kitchen", kitchen, false, false},
          {"staircase", staircase, false, false}, {"attic", attic, false, true},
          {"hall", hall, false, false},           {"close in room", close_in_room, false, false},
          {"shelf", shelf_close, false, false},   {"cave", cave, false, false}};
}
