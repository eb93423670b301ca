// SPDX-License-Identifier: Apache-2.0
#include "mesh.h"

#include <algorithm>
#include <array>

void Mesh::triangle(Vec a, Vec b, Vec c) {
  const Vec n = unit(cross(b - a, c - a));
  const unsigned first = static_cast<unsigned>(points.size());
  for (const Vec p : {a, b, c}) {
    points.push_back(p);
    normals.push_back(n);
  }
  for (unsigned i = 0; i < 3; ++i) corners.push_back(first + i);
  albedo.push_back(tint);
}

void Mesh::quad(Vec a, Vec b, Vec c, Vec d) {
  triangle(a, b, c);
  triangle(a, c, d);
}

void Mesh::box(Vec centre, Vec half, const Rot& rot) {
  Vec p[8];
  for (int i = 0; i < 8; ++i)
    p[i] = centre +
           rot * Vec{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
  quad(p[0], p[2], p[3], p[1]);
  quad(p[4], p[5], p[7], p[6]);
  quad(p[0], p[1], p[5], p[4]);
  quad(p[2], p[6], p[7], p[3]);
  quad(p[0], p[4], p[6], p[2]);
  quad(p[1], p[3], p[7], p[5]);
}

void Mesh::ellipsoid(Vec centre, Vec radii, int segments) {
  surface(segments, segments / 2, true, [=](float u, float v) {
    const float f = 2 * kPi * u, t = kPi * v;
    return centre + Vec{radii.x * std::sin(t) * std::cos(f), radii.y * std::sin(t) * std::sin(f),
                        -radii.z * std::cos(t)};
  });
}

void Mesh::tube(Vec a, Vec b, float radius_a, float radius_b, int segments, bool caps) {
  const Rot axes = around(unit(b - a));
  const auto rim = [=](int i, float radius) {
    const float f = 2 * kPi * static_cast<float>(i) / static_cast<float>(segments);
    return axes * Vec{radius * std::cos(f), radius * std::sin(f), 0};
  };
  surface(segments, 1, true, [=](float u, float v) {
    const float f = 2 * kPi * u, radius = radius_a + (radius_b - radius_a) * v;
    return a + (b - a) * v + axes * Vec{radius * std::cos(f), radius * std::sin(f), 0};
  });
  if (!caps) return;
  for (int i = 0; i < segments; ++i) {
    if (radius_a > 0) triangle(a, a + rim(i + 1, radius_a), a + rim(i, radius_a));
    if (radius_b > 0) triangle(b, b + rim(i, radius_b), b + rim(i + 1, radius_b));
  }
}

void Mesh::capsule(Vec a, Vec b, float radius_a, float radius_b, int segments) {
  tube(a, b, radius_a, radius_b, segments, false);
  ellipsoid(a, Vec{1, 1, 1} * radius_a, segments);
  ellipsoid(b, Vec{1, 1, 1} * radius_b, segments);
}

void Mesh::surface(int nu, int nv, bool wrap, const std::function<Vec(float, float)>& f) {
  const unsigned first = static_cast<unsigned>(points.size());
  const auto at = [&](int i, int j) { return first + unsigned(j * (nu + 1) + i); };
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i <= nu; ++i) {
      const float u = wrap && i == nu ? 0.f : static_cast<float>(i) / static_cast<float>(nu);
      points.push_back(f(u, static_cast<float>(j) / static_cast<float>(nv)));
      normals.push_back({0, 0, 0});
    }
  const auto face = [&](const std::array<unsigned, 3>& q) {
    const Vec n = cross(points[q[1]] - points[q[0]], points[q[2]] - points[q[0]]);
    for (const unsigned k : q) {
      normals[k] = normals[k] + n;
      corners.push_back(k);
    }
    albedo.push_back(tint);
  };
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      face({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      face({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  for (int j = 0; j <= nv && wrap; ++j)
    normals[at(0, j)] = normals[at(nu, j)] = normals[at(0, j)] + normals[at(nu, j)];
  for (unsigned k = first; k < points.size(); ++k) normals[k] = unit(normals[k]);
}

void Mesh::add(const Mesh& m, const Rot& rot, Vec offset, float scale) {
  const unsigned first = static_cast<unsigned>(points.size());
  for (const Vec p : m.points) points.push_back(rot * (p * scale) + offset);
  for (const Vec n : m.normals) normals.push_back(rot * n);
  for (const unsigned i : m.corners) corners.push_back(i + first);
  albedo.insert(albedo.end(), m.albedo.begin(), m.albedo.end());
}

void Mesh::stand() {
  float low = 1e9f;
  for (const Vec p : points) low = std::min(low, p.z);
  for (Vec& p : points) p.z -= low;
}

float Mesh::top() const {
  float high = -1e9f;
  for (const Vec p : points) high = std::max(high, p.z);
  return high;
}

static float lattice(int x, int y, int z, int seed) {
  unsigned h = unsigned(x) * 374761393u + unsigned(y) * 668265263u + unsigned(z) * 2147483647u +
               unsigned(seed) * 1274126177u;
  h = (h ^ (h >> 13)) * 1274126177u;
  h ^= h >> 16;
  return static_cast<float>(h & 0xffffff) / 16777216.f;
}

float noise(Vec p, int seed) {
  const int x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y)),
            z = static_cast<int>(std::floor(p.z));
  const auto smooth = [](float t) { return t * t * (3 - 2 * t); };
  const float fx = smooth(p.x - float(x)), fy = smooth(p.y - float(y)), fz = smooth(p.z - float(z));
  float sum = 0;
  for (int i = 0; i < 8; ++i)
    sum += lattice(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2), seed) * (i & 1 ? fx : 1 - fx) *
           (i & 2 ? fy : 1 - fy) * (i & 4 ? fz : 1 - fz);
  return 2 * sum - 1;
}

float fractal(Vec p, int seed, int octaves, float gain) {
  float sum = 0, amplitude = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += amplitude * noise(p, seed + i);
    p = p * 2.03f;
    amplitude *= gain;
  }
  return sum;
}
