// SPDX-License-Identifier: Apache-2.0
#include "things.h"

static void legs(Mesh& m, float x, float y, float height, float half) {
  for (const float sx : {-1.f, 1.f})
    for (const float sy : {-1.f, 1.f})
      m.box({sx * (x - half), sy * (y - half), height / 2}, {half, half, height / 2});
}

static Mesh sized_table(Random& r, float x, float y, float h) {
  Mesh m(r);
  const float t = r(.01f, .03f);
  if (r.chance(.2f)) {  // round, on one foot
    m.tube({0, 0, h - 2 * t}, {0, 0, h}, y, y, 32);
    m.tube({0, 0, .02f}, {0, 0, h}, .05f, .05f, 12);
    m.tube({0, 0, 0}, {0, 0, .03f}, y * .6f, y * .5f, 24);
    return m;
  }
  m.box({0, 0, h - t}, {x, y, t});
  legs(m, x, y, h - 2 * t, r(.015f, .045f));
  return m;
}

Mesh table(Random& r) { return sized_table(r, r(.3f, 1), r(.25f, .6f), r(.4f, .9f)); }

Mesh chair(Random& r) {
  Mesh m(r);
  const float w = r(.18f, .26f), h = r(.38f, .5f), back = r(.35f, .6f);
  m.box({0, 0, h}, {w, w, .02f});
  legs(m, w, w, h, r(.012f, .03f));
  if (r.chance(.6f)) {
    m.box({0, w - .02f, h + back / 2}, {w, .015f, back / 2});
  } else {
    for (int i = 0; i < 4; ++i)
      m.box({-w + .02f + float(i) * (w - .02f) * 2 / 3, w - .02f, h + back / 2},
            {.015f, .012f, back / 2});
    m.box({0, w - .02f, h + back}, {w, .015f, .03f});
  }
  return m;
}

Mesh shelf(Random& r) {
  Mesh m(r);
  const float w = r(.4f, 1.2f), h = r(.8f, 2.2f), d = r(.14f, .3f), t = .015f;
  const Vec wood = m.tint;
  const int boards = r.count(2, 6);
  for (const float s : {-1.f, 1.f}) m.box({s * w, 0, h / 2}, {t, d, h / 2});
  if (r.chance(.6f)) m.box({0, d, h / 2}, {w, .01f, h / 2});
  const float step = h / float(boards);
  for (int i = 0; i <= boards; ++i) {
    m.tint = wood;
    const float z = step * float(i);
    m.box({0, 0, z}, {w, d, t});
    for (float x = -w + .05f; x < w - .1f && i < boards;) {
      const float a = r(.02f, .1f), b = r(.35f, .85f) * step;
      m.tint = r.albedo();
      if (r.chance(.75f))
        m.box({x + a / 2, r(-.2f, .3f) * d, z + b / 2 + t}, {a / 2, d * r(.5f, .7f), b / 2});
      x += a + (r.chance(.2f) ? r(0, .3f) : .003f);
    }
  }
  return m;
}

Mesh sofa(Random& r) {
  Mesh m(r);
  const float w = r(.5f, 1.2f), d = r(.38f, .48f), h = r(.2f, .26f), arm = .09f;
  m.box({0, 0, h * .6f}, {w, d, h * .5f});
  m.box({0, d - .1f, h * 1.7f}, {w, .1f, h * 1.7f - .04f});
  if (r.chance(.8f))
    for (const float s : {-1.f, 1.f}) m.box({s * (w - arm), 0, h * 1.2f}, {arm, d, h * 1.1f});
  const int seats = w > .8f ? 3 : w > .6f ? 2 : 1;
  const float seat = (w - 2 * arm) / float(seats);
  for (int i = 0; i < seats; ++i)
    m.box({-w + 2 * arm + seat * float(2 * i + 1), -.1f, h * 1.1f + .07f},
          {seat * .97f, d - .12f, .07f});
  return m;
}

Mesh bed(Random& r) {
  Mesh m(r);
  const float w = r(.45f, .9f), d = 1.f, h = r(.2f, .3f);
  m.box({0, 0, h * .8f}, {w, d, h * .3f});
  legs(m, w, d, h, .04f);
  m.box({0, d + .03f, h * 1.8f}, {w, .03f, h * 1.7f});
  m.tint = r.albedo();
  m.surface(20, 24, false, [&](float u, float v) {  // a blanket that hangs over the sides
    const float x = (u - .5f) * 2.3f * w, drop = std::max(0.f, std::fabs(x) - w) * 2.5f;
    const float bump = .03f * noise({x * 5, v * 9, 0}, 7);
    return Vec{std::min(std::max(x, -w - .02f), w + .02f), -d + 1.5f * v, h * 1.5f - drop + bump};
  });
  for (int i = w > .6f ? 2 : 1, n = i; i > 0; --i)
    m.ellipsoid({n == 1 ? 0 : (float(i) - 1.5f) * w, d * .75f, h * 1.4f + .08f}, {.3f, .2f, .1f});
  return m;
}

Mesh cabinet(Random& r) {
  Mesh m(r);
  const float w = r(.3f, .9f), d = r(.2f, .3f), h = r(.5f, 2);
  m.block({-w, -d, .06f}, {w, d, h});
  m.block({-w + .03f, -d + .04f, 0}, {w - .03f, d, .06f});
  const int columns = r.count(1, 3), rows = r.count(1, 4);
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const float x0 = -w + 2 * w * float(i) / float(columns),
                  z0 = .06f + (h - .06f) * float(j) / float(rows);
      const float x1 = x0 + 2 * w / float(columns), z1 = z0 + (h - .06f) / float(rows);
      m.block({x0 + .008f, -d - .018f, z0 + .008f}, {x1 - .008f, -d, z1 - .008f});
      m.box({x1 - .05f, -d - .03f, (z0 + z1) / 2}, {.008f, .012f, .05f});
    }
  return m;
}

Mesh lamp(Random& r) {
  Mesh m(r);
  const float h = r(.4f, 1.6f), wide = r(.12f, .25f);
  m.tube({0, 0, 0}, {0, 0, .03f}, .15f, .15f, 16);
  m.tube({0, 0, .03f}, {0, 0, h}, .012f, .012f, 6);
  m.tint = r.albedo();
  m.tube({0, 0, h - .05f}, {0, 0, h + .2f}, wide, wide * r(.4f, 1), 20, false);
  return m;
}

Mesh laid_table(Random& r) {
  const float x = r(.5f, 1.1f), y = r(.4f, .55f), h = r(.7f, .78f);
  Mesh m = sized_table(r, x, y, h);
  const Mesh seat = chair(r);
  for (int i = r.count(1, 4); i > 0; --i) {
    const float s = r.sign();
    m.add(seat, about_z(s > 0 ? r(-.3f, .3f) : kPi + r(-.3f, .3f)),
          {r(-.8f, .8f) * x, s * (y + r(0, .35f)), 0});
  }
  for (int i = r.count(1, 8); i > 0; --i) {
    const bool plate = r.chance(.3f);
    const Vec at{r(-.7f, .7f) * x * .7f, r(-.7f, .7f) * y * .8f, h};
    if (plate) {
      m.tint = r.albedo();
      m.tube(at, at + Vec{0, 0, .02f}, .08f, .13f, 24);
    } else {
      place(r, m, thing(r), at, r.log(.06f, .25f));
    }
  }
  return m;
}

Mesh furniture(Random& r) {
  switch (r.count(0, 8)) {
    case 0:
      return table(r);
    case 1:
      return chair(r);
    case 2:
      return shelf(r);
    case 3:
      return sofa(r);
    case 4:
      return lamp(r);
    case 5:
      return bed(r);
    case 6:
      return laid_table(r);
    default:
      return cabinet(r);
  }
}
