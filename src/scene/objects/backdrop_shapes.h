// SPDX-License-Identifier: Apache-2.0
//
// What backdrops are made of, and what is fitted to samples of a frame to find them.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/geometry.h"

namespace ssdo {

using SurfelSamples = std::vector<Surfel>;

/// Fewest samples that a shape is fitted to.
inline constexpr std::size_t kFewestOfShape = 24;

/// A surface is on a shape if it lies off by less than this share of the shape's radius or
/// distance; domes of 16 segments do.
inline constexpr double kOnShape = 0.02;

/// Most sides of a box that are seen from inside of it.
inline constexpr std::size_t kMostPlanes = 5;

/// Least mean cosine between normals and those of the shape.
inline constexpr double kInward = 0.9;

/// A shape that may be a backdrop.
struct BackdropShape {
  std::function<bool(const Surfel&)> has;
  std::string what;      ///< as Backdrop::what
  double clearance = 0;  ///< as Backdrop::clearance
  bool is_dome = false;
  bool stands = false;  ///< on a ground that leads up to it
};

/// A sphere, or a cylinder along `axis`, of whose points only the place across the axis counts.
struct RoundShape {
  glm::dvec3 axis{0};  ///< unit; 0: a sphere
  glm::dvec3 middle{0};
  double radius = 0;

  glm::dvec3 across(const glm::dvec3& p) const { return p - axis * glm::dot(axis, p); }
  glm::dvec3 to_middle(const glm::dvec3& p) const { return (middle - across(p)) / radius; }
  double off(const glm::dvec3& p) const {
    return std::abs(glm::distance(across(p), middle) - radius);
  }
  bool has(const glm::dvec3& p) const { return off(p) <= kOnShape * radius; }
};

/// A side of a box, or a card: normal . p = -distance, seen from the side of the camera.
struct Flat {
  glm::dvec3 normal{0};  ///< unit, towards the camera
  double distance = 0;   ///< of its plane from the camera

  double off(const glm::dvec3& p) const { return std::abs(glm::dot(normal, p) + distance); }
  bool has(const Surfel& s) const {
    return off(glm::dvec3(s.position)) <= kOnShape * distance &&
           glm::dot(glm::dvec3(s.normal), normal) > kInward;
  }
};

/// Surfaces of a frame, one in each cell of a coarse grid.
SurfelSamples samples_of(const Geometry& geometry);

/// The distance of a sample from the camera.
inline double distance_of(const Surfel& s) { return glm::length(glm::dvec3(s.position)); }

/// The largest distance of the samples; 0 where there are none.
double farthest_of(const SurfelSamples& samples);
SurfelSamples farther_than(const SurfelSamples& samples, double distance);

/// The median of one value or more.
double median(std::vector<double> all);

/// The sphere, or the cylinder along `axis`, of far surfaces: fitted to all, then to those that lie
/// near it. Distances are computed in units of `unit`, so that sums keep their digits.
std::optional<RoundShape> round_of(const SurfelSamples& far, const glm::dvec3& axis, double unit);

/// Whether this share of samples lies on a cylinder that has the camera inside, is seen from there,
/// and is far from it.
bool is_cylinder_around(const RoundShape& cylinder, const SurfelSamples& far, double share);

/// The plane through a sample on which most samples lie, averaged over these; nothing where none
/// lie on it.
std::optional<Flat> flat_of(const SurfelSamples& all);

/// Planes that this share of `left` lies on, kMostPlanes of them at most, each with as many samples
/// as a shape needs; those samples are taken out of it. A plane for which `may_be` is false ends
/// the search.
std::vector<Flat> take_flats(SurfelSamples& left, double share,
                             const std::function<bool(const Flat&)>& may_be);

}  // namespace ssdo
