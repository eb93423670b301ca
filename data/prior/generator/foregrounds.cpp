// SPDX-License-Identifier: Apache-2.0
//
// What stands between the camera and what it looks at: posts, ledges, leaves, shoulders, door
// frames.
#include <algorithm>

#include "scene.h"

namespace {
// The camera's axes, and places in its picture at a distance along the view.
struct View {
  explicit View(const Camera& c)
      : eye(c.eye),
        forward(unit(c.target - c.eye)),
        right(unit(cross(forward, Vec{0, 0, 1}))),
        up(cross(right, forward)),
        wide(std::tan(c.fov * kPi / 360)),
        face(about_z(std::atan2(forward.y, forward.x) - kPi / 2)) {}

  // x and y are -1..1 across a picture of 16 x 9.
  Vec at(float x, float y, float distance) const {
    return eye + (forward + right * (x * wide) + up * (y * wide * 9 / 16)) * distance;
  }
  float half_width(float distance) const { return wide * distance; }

  Vec eye, forward, right, up;
  float wide;
  Rot face;  // +y of what is added looks along the view
};

float to_a_side(Random& r) { return r.sign() * r(.25f, 1.1f); }

// A post, a pillar or a trunk, from the ground or from above, which may end in the picture.
void post(Random& r, Mesh& m, const View& v, float distance) {
  const float radius = v.half_width(distance) * r.log(.015f, .2f);
  const Vec p = v.at(to_a_side(r), r.chance(.5f) ? 2.f : r(-.6f, .9f), distance);
  const float foot = std::min(0.f, p.z - .1f);
  if (r.chance(.5f))
    m.tube({p.x, p.y, foot}, p, radius * r(1, 1.4f), radius, r.count(8, 24));
  else
    m.box({p.x, p.y, (p.z + foot) / 2}, {radius, radius * r(.6f, 1.5f), (p.z - foot) / 2},
          about_z(r.angle()));
  if (r.chance(.25f)) m.ellipsoid(p, Vec{1, 1, 1} * (radius * r(1, 2.5f)));
}

// A parapet, the edge of a table or of a roof, along the lower border.
void ledge(Random& r, Mesh& m, const View& v, float distance) {
  const Vec top = v.at(r(-.6f, .6f), r(-1.1f, -.45f), distance);
  const float deep = distance * r.log(.02f, .4f), wide = v.half_width(distance) * r(.4f, 3),
              down = r.chance(.5f) ? std::max(top.z, .05f) : distance * r.log(.03f, .3f);
  m.box(top - Vec{0, 0, down / 2}, {wide, deep / 2, down / 2}, v.face * about_z(r(-.3f, .3f)));
  if (r.chance(.3f)) place(r, m, thing(r), top, v.half_width(distance) * r(.15f, .4f));
}

// A plant, or a branch that hangs in from above.
void leaves(Random& r, Mesh& m, const View& v, float distance) {
  const float size = v.half_width(distance) * r(.4f, 1.2f);
  if (r.chance(.5f)) {
    place(r, m, plant(r), v.at(to_a_side(r), r(-1.4f, -.6f), distance), size);
    return;
  }
  const Vec from = v.at(to_a_side(r), 1.4f, distance),
            to = v.at(to_a_side(r), r(.2f, .9f), distance);
  m.tube(from, to, size * .04f, size * .015f);
  for (int i = r.count(8, 40); i > 0; --i) {
    const Vec at = from + (to - from) * r(.2f, 1) + r.direction() * (size * .15f);
    m.box(at, {size * r(.04f, .12f), size * r(.02f, .06f), size * .002f}, r.rotation());
  }
}

// A thing on a stand, or a person who is seen from behind.
void figure(Random& r, Mesh& m, const View& v, float distance) {
  const Vec head = v.at(to_a_side(r), r(-.5f, .6f), distance);
  if (head.z > .3f && r.chance(.5f)) {
    m.add(person(r), v.face * about_z(kPi + r(-.6f, .6f)), {head.x, head.y, 0}, head.z / 1.75f);
    return;
  }
  const float size = v.half_width(distance) * r(.2f, .7f);
  const Vec foot = head - Vec{0, 0, size};
  place(r, m, thing(r), foot, size);
  const float down = r.chance(.7f) ? std::max(foot.z, .02f) : .03f * size;
  m.box(foot - Vec{0, 0, down / 2}, {size * r(.3f, .8f), size * r(.3f, .8f), down / 2},
        about_z(r.angle()));
}

// A door, a window or an arch that the camera looks through.
void opening(Random& r, Mesh& m, const View& v, float distance) {
  const float x = r(.55f, 1.05f), y = r(.6f, 1.1f), deep = distance * r.log(.02f, .3f);
  const Vec middle = v.at(0, 0, distance), far = v.right * (v.half_width(distance) * 4);
  const auto side = [&](float s) {
    const Vec edge = v.at(s * x, 0, distance);
    m.box(edge + far * (s * .5f), {length(far) * .5f, deep / 2, distance * 2}, v.face);
  };
  const int sides = r.count(1, 3);  // left, right, both
  if (sides & 1) side(-1);
  if (sides & 2) side(1);
  const float half = v.half_width(distance) * x;
  if (r.chance(.4f))
    m.box(v.at(0, y, distance) + Vec{0, 0, distance}, {half, deep / 2, distance}, v.face);
  if (r.chance(.4f)) {
    const Vec sill = v.at(0, -y, distance);
    m.box({middle.x, middle.y, sill.z - distance}, {half, deep / 2, distance}, v.face);
  }
}

// Bars, wires or a fence across the picture.
void bars(Random& r, Mesh& m, const View& v, float distance) {
  const float radius = v.half_width(distance) * r.log(.006f, .04f);
  const bool upright = r.chance(.4f);
  const float first = r(-1, 1), apart = r(.15f, .6f);
  for (int i = r.count(1, 5); i > 0; --i) {
    const float s = first + apart * float(i - 2), lean = r(-.03f, .03f);
    if (upright)
      m.tube(v.at(s, -2, distance), v.at(s + lean, 2, distance), radius, radius);
    else
      m.tube(v.at(-1.6f, s, distance), v.at(1.6f, s + lean, distance), radius, radius);
  }
}
}  // namespace

void foreground(Random& r, Scene& scene) {
  const Camera& c = scene.camera;
  if (c.ortho_width > 0) return;
  const View view(c);
  const float reach = length(c.target - c.eye);
  for (int i = r.chance(.3f) ? 2 : 1; i > 0; --i) {
    const float distance = std::max(reach * r.log(.06f, .5f), .1f);
    scene.mesh.tint = r.albedo();
    constexpr void (*kinds[])(Random&, Mesh&, const View&, float) = {post,   post,    ledge, leaves,
                                                                     figure, opening, bars};
    kinds[r.count(0, 6)](r, scene.mesh, view, distance);
  }
}
