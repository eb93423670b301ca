// SPDX-License-Identifier: Apache-2.0
#include "things.h"

namespace {
struct Limb {
  Vec from, along;
  float length, radius;
};

void branch(Random& r, Mesh& m, const Limb& l, int depth, int leaves) {
  m.tint = {.16f, .11f, .08f};
  m.tube(l.from, l.from + l.along * l.length, l.radius, l.radius * .7f, 5, false);
  if (depth == 0) {
    m.tint = {.12f, .22f, .06f};
    for (int i = 0; i < leaves; ++i) {
      const Rot f = r.rotation();
      const Vec c = l.from + l.along * l.length + r.direction() * (l.length * r(.1f, .9f));
      const float s = l.length * r(.1f, .3f);
      m.quad(c - f.a * s, c + f.b * (s * .5f), c + f.a * s, c - f.b * (s * .5f));
    }
    return;
  }
  for (int i = r.count(2, 3); i > 0; --i) {
    const Vec d = unit(l.along + r.direction() * r(.4f, .9f) + Vec{0, 0, .15f});
    branch(
        r, m,
        {l.from + l.along * (l.length * r(.6f, 1)), d, l.length * r(.55f, .85f), l.radius * .65f},
        depth - 1, leaves);
  }
}
}  // namespace

Mesh tree(Random& r, int kind) {
  Mesh m;
  if (kind < 0) kind = r.count(0, 3);
  const float h = r(.8f, 1.2f);
  if (kind >= 2) {
    branch(r, m, {{0, 0, -.02f}, unit({r(-.1f, .1f), r(-.1f, .1f), 1}), h * .35f, .035f}, 3,
           kind == 3 ? r.count(4, 12) : 0);
    return m;
  }
  m.tint = {.16f, .11f, .08f};
  m.tube({0, 0, -.02f}, {0, 0, h * .5f}, .04f, .03f, 8);
  m.tint = {.08f, .16f, .05f};
  const int n = r.count(2, 5);
  for (int i = 0; i < n; ++i) {
    const float t = float(i) / float(n);
    if (kind == 0) {
      m.tube({0, 0, h * (.18f + .62f * t)}, {0, 0, h * (.5f + .5f * t)}, .28f - .2f * t, 0, 12);
    } else {
      const Mesh crown = blob(r, .35f, 16, 3);
      Mesh green = crown;
      for (Vec& c : green.albedo) c = m.tint;
      m.add(green, r.rotation(), {r(-.2f, .2f), r(-.2f, .2f), h * r(.5f, .85f)}, r(.3f, .7f));
    }
  }
  return m;
}

Mesh plant(Random& r) {
  Mesh m;
  m.tint = {.1f, .2f, .05f};
  const int n = r.count(5, 14);
  const float l = r(.4f, 1), droop = r(.2f, 1);
  for (int k = 0; k < n; ++k) {
    const float a = 2 * kPi * float(k) / float(n) + r(-.2f, .2f);
    const Vec d{std::cos(a), std::sin(a), r(.4f, 1.6f)};
    const Vec w{-std::sin(a) * l * .12f, std::cos(a) * l * .12f, 0};
    const Vec mid = unit(d) * (l * .6f), tip = unit(d + Vec{0, 0, -droop}) * l;
    m.quad(w * -.3f, w * .3f, mid + w, mid - w);
    m.triangle(mid - w, mid + w, tip);
  }
  return m;
}

void grass(Random& r, Mesh& scene, Patch where, int blades, float height,
           const std::function<float(float, float)>& ground) {
  scene.tint = {.13f, .24f, .06f};
  for (int i = 0; i < blades; ++i) {
    const float a = r.angle(), d = where.radius * std::sqrt(r(0, 1)), turn = r.angle();
    const float x = where.x + d * std::cos(a), y = where.y + d * std::sin(a);
    const float w = height * r(.02f, .06f), l = height * r(.5f, 1.2f);
    const Vec root{x, y, ground(x, y) - .01f}, side{std::cos(turn) * w, std::sin(turn) * w, 0};
    const Vec bend{r(-.3f, .3f) * l, r(-.3f, .3f) * l, 0};
    const Vec mid = root + Vec{0, 0, l * .55f} + bend * .35f, tip = root + Vec{0, 0, l} + bend;
    scene.quad(root - side, root + side, mid + side * .7f, mid - side * .7f);
    scene.triangle(mid - side * .7f, mid + side * .7f, tip);
  }
}
