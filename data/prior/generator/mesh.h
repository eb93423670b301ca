// SPDX-License-Identifier: Apache-2.0
//
// Triangle meshes with vertex normals and an albedo per triangle, and the primitives they are
// built from. Lengths are metres, z is up.
#pragma once

#include <functional>
#include <vector>

#include "vec.h"

struct Mesh {
  std::vector<Vec> points, normals;
  std::vector<unsigned> corners;  // three per triangle
  std::vector<Vec> albedo;        // one per triangle
  Vec tint{.5f, .5f, .5f};        // albedo of the triangles that are added next

  Mesh() = default;
  explicit Mesh(Random& r) : tint(r.albedo()) {}

  void triangle(Vec a, Vec b, Vec c);
  void quad(Vec a, Vec b, Vec c, Vec d);
  /// A box by its centre and half sizes.
  void box(Vec centre, Vec half, const Rot& rot = {});
  /// A box by its lower and upper corner.
  void block(Vec low, Vec high) { box((low + high) * .5f, (high - low) * .5f); }
  void ellipsoid(Vec centre, Vec radii, int segments = 24);
  /// A cone or cylinder from a to b, closed by discs if caps.
  void tube(Vec a, Vec b, float radius_a, float radius_b, int segments = 8, bool caps = true);
  /// A cylinder with round ends.
  void capsule(Vec a, Vec b, float radius_a, float radius_b, int segments = 10);
  /// A smooth surface f(u, v) over [0, 1]^2; wrap joins the normals of u = 0 and u = 1.
  void surface(int nu, int nv, bool wrap, const std::function<Vec(float, float)>& f);
  /// Appends a mesh, turned, scaled, then moved.
  void add(const Mesh& m, const Rot& rot, Vec offset, float scale = 1);
  /// Moves the mesh so that its lowest point is z = 0.
  void stand();
  float top() const;
};

/// Value noise in -1..1, and a sum of octaves of it.
float noise(Vec p, int seed);
float fractal(Vec p, int seed, int octaves, float gain = .5f);
