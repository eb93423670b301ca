// SPDX-License-Identifier: Apache-2.0
#include "scene/gbuffer/normal_encoding.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string_view>
#include <vector>

#include "scene/camera/projection_model.h"

namespace ssdo {
namespace {

bool is_normal(const glm::vec3& n) {
  const float length = glm::length(n);  // not finite where a component is not
  return length > 0 && length < 1e4f;
}

/// Normals stored as n/2 + 1/2 have no negative component, and are of unit length after decoding.
bool normals_are_colors(const GBuffer& g) {
  double as_stored = 0, decoded = 0;
  for (std::size_t i = 0; i < g.normal.size(); ++i) {
    const glm::vec3 n = g.normal[i];
    if (!g.valid[i] || !is_normal(n)) continue;
    if (std::min({n.x, n.y, n.z}) < -1e-3f) return false;
    as_stored += std::abs(glm::length(n) - 1);
    decoded += std::abs(glm::length(2.0f * n - 1.0f) - 1);
  }
  return decoded < as_stored;
}

/// A curve that was applied to each component, and what undoes it.
struct Curve {
  std::string_view name;
  float (*undo)(float magnitude);
};

constexpr std::array<Curve, 4> kCurves = {{
    {"n^2.2", [](float v) { return std::pow(v, 2.2f); }},
    {"the curve of sRGB",
     [](float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }},
    {"n^(1/2.2)", [](float v) { return std::pow(v, 1 / 2.2f); }},
    {"the inverse curve of sRGB",
     [](float v) {
       return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
     }},
}};

glm::vec3 undone(const Curve& curve, glm::vec3 n) {
  for (int c = 0; c < 3; ++c) n[c] = std::copysign(curve.undo(std::abs(n[c])), n[c]);
  return n;
}

glm::vec3 from_color(const glm::vec3& n) { return 2.0f * n - 1.0f; }

/// The median difference of lengths from 1 is above kCurved where a curve was applied, and below
/// kStraight where it was undone. Right normals in 16 bits differ by 1e-3; 2.2 undone in place of
/// sRGB by 1e-2.
constexpr double kCurved = 0.02, kStraight = 0.005;

/// Normals along an axis have length 1 under every curve, and tell nothing unless they are colours.
constexpr float kAlongAxis = 0.98f;
constexpr std::size_t kFewestNormals = 16, kMostNormals = 20000;

/// Normals that tell the curve they are stored with.
std::vector<glm::vec3> telling_normals(const GBuffer& g) {
  std::vector<glm::vec3> normals;
  const std::size_t stride = g.normal.size() / kMostNormals + 1;
  for (std::size_t i = 0; i < g.normal.size(); i += stride) {
    const glm::vec3 &n = g.normal[i], size = glm::abs(n);
    const bool tells = g.encodings.normals_are_colors ||
                       std::max({size.x, size.y, size.z}) < kAlongAxis * glm::length(n);
    if (g.valid[i] && is_normal(n) && tells) normals.push_back(n);
  }
  return normals;
}

/// The curve that the normals are stored with, if any. Bands of a frame find it each for itself:
/// normals that do not tell it stay what they are under every curve.
const Curve* find_curve(const GBuffer& g) {
  const std::vector<glm::vec3> normals = telling_normals(g);
  if (normals.size() < kFewestNormals) return nullptr;
  const auto miss = [&](const Curve* curve) {
    std::vector<double> misses;
    for (glm::vec3 n : normals) {
      if (curve) n = undone(*curve, n);
      if (g.encodings.normals_are_colors) n = from_color(n);
      misses.push_back(std::abs(glm::length(n) - 1));
    }
    return quantile(misses, 0.5);
  };
  if (miss(nullptr) < kCurved) return nullptr;
  const Curve* best = nullptr;
  double least = kStraight;
  for (const Curve& curve : kCurves) {
    const double of_curve = miss(&curve);
    if (of_curve < least) best = &curve, least = of_curve;
  }
  return best;
}

}  // namespace

void undo_normal_encoding(GBuffer& g, const std::optional<Encodings>& known) {
  g.encodings.normals_are_colors = known ? known->normals_are_colors : normals_are_colors(g);
  if (const Curve* curve = find_curve(g)) {
    for (glm::vec3& n : g.normal.pixels) n = undone(*curve, n);
    g.warnings.push_back(fmt::format(
        "normals are encoded with a gamma, as their lengths tell; decoded with {}", curve->name));
  }
  if (!g.encodings.normals_are_colors) return;
  for (glm::vec3& n : g.normal.pixels) n = from_color(n);
  g.warnings.push_back("normals are encoded as 0..1; decoded with 2n - 1");
}

}  // namespace ssdo
