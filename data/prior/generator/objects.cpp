// SPDX-License-Identifier: Apache-2.0
#include "things.h"

Mesh blob(Random& r, float amplitude, int segments, float frequency) {
  Mesh m(r);
  const int seed = r.count(0, 1 << 20), octaves = r.count(1, 4);
  const Vec k{r(.5f, 1), r(.5f, 1), r(.4f, 1.2f)};
  const float f0 = r(.7f, 1.4f) * frequency;
  m.surface(segments, segments / 2, true, [&](float u, float v) {
    const float f = 2 * kPi * u, t = kPi * v;
    const Vec d{std::sin(t) * std::cos(f), std::sin(t) * std::sin(f), -std::cos(t)};
    const float q = .5f * (1 + amplitude * fractal(d * f0, seed, octaves));
    return Vec{d.x * k.x * q, d.y * k.y * q, d.z * k.z * q};
  });
  return m;
}

Mesh vessel(Random& r) {
  Mesh m(r);
  float radius[6];
  for (float& q : radius) q = r(.1f, .42f);
  const float h = r(.5f, 1.5f);
  const bool open = r.chance(.5f);
  m.surface(28, 24, true, [&](float u, float v) {
    const float x = v * 4.999f;
    const int i = static_cast<int>(x);
    float t = x - float(i);
    t = t * t * (3 - 2 * t);
    float q = radius[i] * (1 - t) + radius[i + 1] * t;
    if (v == 0 || (v == 1 && !open)) q = 0;
    return Vec{q * std::cos(2 * kPi * u), q * std::sin(2 * kPi * u), h * v};
  });
  return m;
}

Mesh compound(Random& r) {
  Mesh m(r);
  for (int i = r.count(2, 6); i > 0; --i) {
    const Vec c{r(-.3f, .3f), r(-.3f, .3f), r(0, .7f)};
    const int kind = r.count(0, 2);
    if (kind == 0) {
      const Vec half{r.log(.03f, .4f), r.log(.03f, .4f), r.log(.03f, .4f)};
      m.box(c, half, r.chance(.6f) ? about_z(r.angle()) : r.rotation());
    } else if (kind == 1) {
      m.ellipsoid(c, Vec{1, 1, 1} * r.log(.06f, .35f));
    } else {
      const Vec d = r.direction() * r(.2f, .6f);
      const float q = r.log(.02f, .15f);
      m.tube(c - d, c + d, q, q * r(.2f, 1), 12);
    }
  }
  return m;
}

Mesh pile(Random& r) {
  Mesh m;
  const Vec size{r(.2f, .5f), r(.15f, .4f), r(.03f, .15f)};
  float z = 0;
  for (int i = r.count(2, 7); i > 0; --i) {
    m.tint = r.albedo();
    const float h = size.z * r(.5f, 1.5f);
    m.box({r(-.04f, .04f), r(-.04f, .04f), z + h}, {size.x * r(.7f, 1), size.y * r(.7f, 1), h},
          about_z(r(-.2f, .2f)));
    z += 2 * h;
  }
  return m;
}

static Mesh ring(Random& r) {
  Mesh m(r);
  const float b = r(.08f, .22f), a = .5f - b;
  const bool upright = r.chance(.3f);
  m.surface(28, 14, true, [&](float u, float v) {
    const float f = 2 * kPi * u, g = 2 * kPi * (v == 1 ? 0 : v);
    const Vec q{(a + b * std::cos(g)) * std::cos(f), (a + b * std::cos(g)) * std::sin(f),
                b * std::sin(g)};
    return upright ? Vec{q.x, q.z, q.y} : q;
  });
  return m;
}

static Mesh bucket(Random& r) {
  Mesh m(r);
  const float a = r(.2f, .45f), h = r(.2f, .8f);
  m.tube({0, 0, 0}, {0, 0, h}, a * r(.6f, 1), a, 24, false);
  m.tube({0, 0, 0}, {0, 0, .02f}, a * .8f, a * .8f, 24);
  return m;
}

static Mesh solid(Random& r) {
  Mesh m(r);
  const int kind = r.count(0, 2);
  if (kind == 0) {
    m.box({0, 0, 0}, {r.log(.1f, .5f), r.log(.1f, .5f), r.log(.1f, .5f)},
          r.chance(.8f) ? Rot{} : r.rotation());
  } else if (kind == 1) {
    m.ellipsoid({0, 0, 0}, Vec{1, 1, 1} * r(.2f, .5f), 32);
  } else {
    const float a = r.log(.05f, .4f);
    m.tube({0, 0, 0}, {0, 0, r.log(.15f, 1)}, a, r.chance(.6f) ? a : a * r(0, 1), 24);
  }
  return m;
}

static Mesh twigs(Random& r) {
  Mesh m(r);
  for (int i = r.count(3, 9); i > 0; --i)
    m.tube({0, 0, 0}, unit(r.direction() + Vec{0, 0, 1}) * r(.4f, .9f), .02f, .012f, 6);
  return m;
}

Mesh thing(Random& r) {
  Mesh m;
  switch (r.count(0, 11)) {
    case 0:
    case 1:
    case 2:
      m = solid(r);
      break;
    case 3:
      m = ring(r);
      break;
    case 4:
    case 5:
      m = blob(r, r(.1f, .8f), 36);
      break;
    case 6:
      m = vessel(r);
      break;
    case 7:
    case 8:
      m = compound(r);
      break;
    case 9:
      m = pile(r);
      break;
    case 10:
      m = bucket(r);
      break;
    default:
      m = twigs(r);
  }
  m.stand();
  return m;
}
