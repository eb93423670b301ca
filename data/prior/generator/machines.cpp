// SPDX-License-Identifier: Apache-2.0
#include "things.h"

namespace {
// A limb of two capsules: from a by way of a bend to its end.
Vec limb(Mesh& m, Vec a, Vec first, Vec second, float thick, float thin) {
  const Vec bend = a + first, end = bend + second;
  m.capsule(a, bend, thick, (thick + thin) / 2);
  m.capsule(bend, end, (thick + thin) / 2, thin);
  return end;
}
}  // namespace

Mesh person(Random& r) {
  Mesh m(r);
  const float h = r(1.5f, 1.9f);
  const bool sits = r.chance(.12f);
  const float hip = sits ? .5f : h * .52f;
  const Vec shirt = r.albedo(), skin{.55f, .38f, .3f};
  const Vec lean{r(-.06f, .06f), r(-.1f, .05f), 0};
  const Vec chest = Vec{0, 0, hip + h * .26f} + lean;
  if (sits) m.block({-.2f, -.2f, 0}, {.2f, .25f, hip - .09f});
  for (const float s : {-1.f, 1.f}) {  // legs, in trousers
    const float swing = r(-.25f, .25f);
    const float thigh = h * .25f;
    const Vec up = sits ? Vec{s * .05f, -thigh, -.02f}
                        : Vec{s * .03f, swing * thigh, -thigh * std::cos(swing)};
    const Vec down = sits ? Vec{0, -.03f, -hip + .06f}
                          : Vec{0, std::fabs(swing) * .5f * thigh, -(hip - thigh) + .05f};
    const Vec foot = limb(m, {s * h * .055f, 0, hip}, up, down, .085f, .05f);
    m.capsule(foot, foot + Vec{0, -.14f, -.015f}, .045f, .04f);
  }
  m.tint = shirt;
  m.capsule({0, 0, hip + .02f}, chest, h * .075f, h * .095f, 14);
  m.capsule(chest + Vec{-h * .09f, 0, .02f}, chest + Vec{h * .09f, 0, .02f}, h * .045f, h * .045f);
  for (const float s : {-1.f, 1.f}) {
    const Vec upper{s * r(.03f, .15f), r(-.12f, .1f), -h * r(.1f, .17f)};
    const Vec lower{s * r(-.1f, .08f), -r(.02f, .22f), -h * r(-.08f, .15f)};
    limb(m, chest + Vec{s * h * .11f, 0, .02f}, upper, lower, .045f, .03f);
  }
  m.tint = skin;
  const Vec neck = chest + Vec{0, 0, h * .07f};
  m.capsule(chest, neck, .05f, .045f);
  m.ellipsoid(neck + Vec{0, -.02f, h * .065f}, {h * .045f, h * .055f, h * .068f}, 16);
  return m;
}

Mesh car(Random& r) {
  Mesh m(r);
  const float half = r(1.7f, 2.3f), w = r(.75f, .95f), belt = r(.8f, 1), clear = r(.18f, .3f);
  const float roof = belt + r(.45f, .6f), front = half * r(.25f, .55f), rear = -half * r(.5f, .9f);
  m.block({-half, -w, clear}, {half, w, belt});
  m.tint = Vec{.06f, .06f, .07f};
  const float in = w * .84f;
  const Vec p[8] = {{rear, -w, belt},        {front, -w, belt},        {front, w, belt},
                    {rear, w, belt},         {rear * .85f, -in, roof}, {front * .4f, -in, roof},
                    {front * .4f, in, roof}, {rear * .85f, in, roof}};
  m.quad(p[4], p[5], p[6], p[7]);
  for (int k = 0; k < 4; ++k) m.quad(p[k], p[(k + 1) % 4], p[4 + (k + 1) % 4], p[4 + k]);
  const float wheel = clear + .1f;
  for (const float x : {-half * .62f, half * .62f})
    for (const float s : {-1.f, 1.f})
      m.tube({x, s * (w - .16f), wheel}, {x, s * (w + .03f), wheel}, wheel, wheel, 20);
  return m;
}

Mesh engine(Random& r) {
  Mesh m(r);
  const Vec half{r(.25f, .6f), r(.2f, .4f), r(.2f, .45f)};
  m.box({0, 0, half.z + .05f}, half);
  m.box({0, 0, .03f}, {half.x * 1.2f, half.y * 1.2f, .03f});
  for (int i = r.count(3, 9); i > 0; --i) {  // housings with flanges and ribs
    const Vec axis = r.chance(.5f) ? Vec{0, 0, 1} : Vec{r.sign(), 0, 0};
    const float radius = r(.05f, .2f), reach = r(.1f, .5f);
    const Vec a{r(-.9f, .9f) * half.x, r(-1.1f, 1.1f) * half.y, r(.2f, 1.9f) * half.z};
    m.tint = r.albedo();
    m.tube(a, a + axis * reach, radius, radius, 20);
    m.tube(a + axis * reach, a + axis * (reach + .03f), radius * 1.25f, radius * 1.25f, 20);
    for (int k = r.count(0, 6); k > 0; --k)
      m.tube(a + axis * (reach * .15f * float(k)), a + axis * (reach * .15f * float(k) + .012f),
             radius * 1.12f, radius * 1.12f, 20);
  }
  for (int i = r.count(3, 12); i > 0; --i) {  // pipes with right-angled bends
    m.tint = r.albedo();
    const float radius = r.log(.008f, .05f);
    Vec at{r(-1, 1) * half.x, r(-1.2f, 1.2f) * half.y, r(.1f, 2.2f) * half.z};
    for (int k = r.count(2, 5); k > 0; --k) {
      const float l = r(.1f, .5f) * r.sign();
      const int axis = r.count(0, 2);
      const Vec to = at + Vec{axis == 0 ? l : 0, axis == 1 ? l : 0, axis == 2 ? l : 0};
      if (to.z > .02f) {
        m.capsule(at, to, radius, radius, 8);
        at = to;
      }
    }
  }
  for (int i = r.count(0, 14); i > 0; --i) {
    const Vec at{r(-.9f, .9f) * half.x, -half.y, r(.3f, 2) * half.z};
    m.tube(at, at + Vec{0, -.03f, 0}, .015f, .015f, 6);
  }
  return m;
}

Mesh robot(Random& r) {
  Mesh m(r);
  Vec at{0, 0, r(.15f, .4f)};
  m.tube({0, 0, 0}, at, r(.15f, .3f), .15f, 24);
  Vec d = unit(Vec{r(-.4f, .4f), r(-.4f, .4f), 1});
  float thick = r(.1f, .16f), l = r(.4f, .8f);
  for (int i = r.count(2, 4); i > 0; --i) {
    m.ellipsoid(at, Vec{1, 1, 1} * (thick * 1.25f), 20);
    m.tube(at, at + d * l, thick, thick * .8f, 16);
    at = at + d * l;
    thick *= .78f;
    l *= r(.65f, .95f);
    d = unit(d + r.direction() * 1.1f + Vec{0, 0, .2f});
    if (at.z + d.z * l < .2f) d.z = std::fabs(d.z);
  }
  m.tint = r.albedo();
  m.box(at, Vec{1, .5f, 1} * (thick * 1.5f), around(d));
  for (const float s : {-1.f, 1.f})
    m.box(at + around(d) * Vec{s * thick, 0, thick * 2.4f}, {thick * .25f, thick * .3f, thick},
          around(d));
  return m;
}
