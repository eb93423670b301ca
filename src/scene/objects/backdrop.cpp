// SPDX-License-Identifier: Apache-2.0
//
// A sky dome in a G-buffer is a surface like any other, and hides all of the sky. Its shape tells
// it from the walls of a place: the far surfaces of the frame lie on one sphere, which encloses the
// camera, faces inward, and is several times as large as everything else in the frame.
//
// The sphere |p - c| = r is fitted as |p|^2 = 2 c.p + k, which is linear, to the far surfaces, then
// again to those that lie on it. A room, a street or a terrain has far surfaces of which most lie
// on no sphere, however it is fitted. How many pixels show the dome does not matter.
//
// Cards behind a set, the sides of a box around it (the proxy of a volume) and cylinders of sky
// have the shape of walls: in a frame of a street, a facade may be all that is seen besides a
// lamppost. But the ground leads up to walls, without a gap in distance. So planes and upright
// cylinders are backdrops only where nothing is seen between them and everything else, over a wide
// range of distances, and where no sky is seen above them. A ground that is seen far below, behind
// the edge of a roof or a table, has such a gap too, but faces up. Backdrops that stand on a ground
// are told by their scale alone: scene/objects/standing_backdrop.cpp.
#include "scene/objects/backdrop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>
#include <iterator>
#include <utility>
#include <vector>

#include "parallel/tiles.h"
#include "scene/objects/backdrop_shapes.h"
#include "scene/objects/standing_backdrop.h"

namespace ssdo {
namespace {

/// Share of the surfaces farther than half of the radius that lie on the sphere, and of those
/// beyond the gap that lie on planes or a cylinder.
constexpr double kMostOnSphere = 0.8, kMostOnWalls = 0.95;

/// Least ratio of the radius to the distance within which nine tenths of the other surfaces lie.
constexpr double kLarger = 3;

/// Least ratio of the distance of planes and cylinders to that of the surfaces before the gap. No
/// frame of `data` and `truth` has a gap of 3 before smooth surfaces.
constexpr double kGap = 10;

/// With a gap below this, the other frames of the shot are not asked for their answer.
constexpr double kAnyGap = 2;

/// Share of the surfaces that have to be before the gap: a set, and not one thing before a wall.
constexpr double kLeastBefore = 0.2;

/// One of so many samples may be in the gap.
constexpr std::size_t kInGap = 200;

/// A plane is a ground if the cosine between its normal and the way up is at least this. A roof
/// slopes less than that; a card that leans back does not lean so far.
constexpr double kGround = 0.7;

/// Largest share of the columns of a backdrop that show sky above it; and, for a backdrop that
/// stands on a ground, most sky pixels in the frame, relative to its own pixels.
constexpr double kSkyAbove = 0.1;

/// Least mean distance from the camera of the surfaces on a sphere, over its radius. The far rows
/// of a floor are arcs, which lie on spheres too, with a middle high above them; and any plane lies
/// on a sphere that is large enough.
constexpr double kAround = 0.5;

/// The dome that the far ones of these surfaces show.
std::optional<BackdropShape> find_dome(const SurfelSamples& samples) {
  const double farthest = farthest_of(samples);
  const std::optional<RoundShape> sphere =
      round_of(farther_than(samples, 0.5 * farthest), glm::dvec3(0), farthest);
  if (!sphere || glm::length(sphere->middle) >= sphere->radius) return std::nullopt;
  std::vector<double> others;
  double far = 0, on = 0, inward = 0, distances = 0;
  for (const Surfel& s : samples) {
    const glm::dvec3 p(s.position);
    const bool is_on = sphere->has(p);
    if (!is_on) others.push_back(distance_of(s));
    far += distance_of(s) > 0.5 * sphere->radius;
    if (!is_on) continue;
    on += 1, distances += distance_of(s);
    inward += glm::dot(glm::dvec3(s.normal), sphere->to_middle(p));
  }
  if (on < double(kFewestOfShape) || on < kMostOnSphere * far || inward < kInward * on)
    return std::nullopt;
  if (distances < kAround * sphere->radius * on) return std::nullopt;
  // Through a narrow lens, what fits a sphere may be a wall as well.
  SurfelSamples on_sphere;
  std::ranges::copy_if(samples, std::back_inserter(on_sphere),
                       [&](const Surfel& s) { return sphere->has(glm::dvec3(s.position)); });
  if (const std::optional<Flat> flat = flat_of(on_sphere);
      flat && double(std::ranges::count_if(
                  on_sphere, [&](const Surfel& s) { return flat->has(s); })) >= kMostOnWalls * on)
    return std::nullopt;
  BackdropShape found{[sphere](const Surfel& s) { return sphere->has(glm::dvec3(s.position)); },
                      fmt::format("a dome of radius {:.3g} around everything", sphere->radius), 1,
                      true};
  if (others.empty()) return found;
  const auto most = others.begin() + std::ptrdiff_t(others.size() * 9 / 10);
  std::ranges::nth_element(others, most);
  found.clearance = sphere->radius / (kLarger * *most);
  return found;
}

/// The samples behind the widest gap in distance, and how wide that is as a factor.
struct Behind {
  SurfelSamples samples;
  double nearest = 0, gap = 0;
};

Behind behind_gap(SurfelSamples samples) {
  Behind found;
  std::ranges::sort(samples, {}, distance_of);
  const std::size_t within = 1 + samples.size() / kInGap;
  std::size_t first = 0;
  for (std::size_t i = std::size_t(kLeastBefore * double(samples.size()));
       i + within + kFewestOfShape <= samples.size(); ++i) {
    const double gap = distance_of(samples[i + within]) / distance_of(samples[i]);
    if (gap > found.gap) found.gap = gap, first = i + within;
  }
  if (found.gap < kAnyGap) return {};
  found.nearest = distance_of(samples[first]);
  found.samples.assign(samples.begin() + std::ptrdiff_t(first), samples.end());
  return found;
}

/// The way up in camera space: the axis of the world, y or z, that is nearer to the way up in the
/// picture. A camera that looks steeply down may take the wrong axis, but then it sees no plane
/// that faces along that one.
glm::dvec3 up_of(const Geometry& g) {
  if (!g.world_known) return {0, 1, 0};
  const glm::dvec3 y(g.world_to_camera[1]), z(g.world_to_camera[2]);
  return y.y > z.y ? y : z;
}

/// Planes that nearly all of these lie on, and none of which is a ground.
std::optional<BackdropShape> find_flats(const Behind& behind, const glm::dvec3& up) {
  SurfelSamples left = behind.samples;
  const std::vector<Flat> flats = take_flats(
      left, kMostOnWalls, [&](const Flat& flat) { return glm::dot(flat.normal, up) < kGround; });
  if (double(left.size()) > (1 - kMostOnWalls) * double(behind.samples.size())) return std::nullopt;
  const auto has = [flats, nearest = behind.nearest](const Surfel& s) {
    return distance_of(s) >= nearest &&
           std::ranges::any_of(flats, [&](const Flat& flat) { return flat.has(s); });
  };
  const std::string which = flats.size() == 1 ? "a plane" : fmt::format("{} planes", flats.size());
  return BackdropShape{
      has, fmt::format("{} behind everything, from a distance of {:.3g} on", which, behind.nearest),
      behind.gap / kGap};
}

/// An upright cylinder around everything that nearly all of these lie on.
std::optional<BackdropShape> find_cylinder(const Behind& behind, const glm::dvec3& axis) {
  const std::optional<RoundShape> found = round_of(behind.samples, axis, behind.nearest);
  if (!found || !is_cylinder_around(*found, behind.samples, kMostOnWalls)) return std::nullopt;
  const auto has = [shape = *found, nearest = behind.nearest](const Surfel& s) {
    return distance_of(s) >= nearest && shape.has(glm::dvec3(s.position));
  };
  return BackdropShape{has,
                       fmt::format("a cylinder of radius {:.3g} around everything", found->radius),
                       behind.gap / kGap};
}

/// Planes, or an upright cylinder, with nothing between them and all else.
std::optional<BackdropShape> find_walls(const SurfelSamples& samples, const Geometry& g) {
  const Behind behind = behind_gap(samples);
  if (behind.samples.empty()) return std::nullopt;
  for (const int up : {1, 2}) {
    if (!g.world_known) break;
    if (auto found = find_cylinder(behind, glm::dvec3(g.world_to_camera[up]))) return found;
  }
  return find_flats(behind, up_of(g));
}

/// Whether sky is seen above what is covered, in more than a few columns.
bool has_sky_above(const Geometry& g, const Plane<float>& coverage) {
  enum class Above : unsigned char { no_sky, sky, covered };
  std::vector<Above> above(std::size_t(coverage.width), Above::no_sky);
  double columns = 0, with_sky = 0;
  for (int y = 0; y < coverage.height; ++y) {
    for (int x = 0; x < coverage.width; ++x) {
      Above& so_far = above[std::size_t(x)];
      if (so_far == Above::covered) continue;
      const Surfel& s = g.surfaces(x, y);
      if (!s.is_surface() && !s.is_broken()) so_far = Above::sky;
      if (!(coverage(x, y) > 0)) continue;
      columns += 1, with_sky += so_far == Above::sky;
      so_far = Above::covered;
    }
  }
  return with_sky > kSkyAbove * columns;
}

/// Whether the frame shows much sky beside what is covered.
bool has_sky_beside(const Geometry& g, double share) {
  const std::size_t sky = count_over_rows(g.surfaces.height, [&](int y) {
    const float* row = &g.surfaces.rounding(0, y);
    return std::size_t(std::count(row, row + g.surfaces.width, Surfel::kBackground));
  });
  return double(sky) > kSkyAbove * share * double(g.surfaces.size());
}

/// The pixels of the frame on a shape, as a backdrop; nothing where much sky is seen above the
/// shape, or beside one that stands on a ground.
std::optional<Backdrop> shown(const Geometry& g, const BackdropShape& shape) {
  Backdrop found{Plane<float>::like(g.surfaces), 0, shape.what, shape.clearance, shape.has};
  const std::size_t covered = count_over_rows(g.surfaces.height, [&](int y) {
    std::size_t in_row = 0;
    for (std::size_t i = g.surfaces.index(0, y); i < g.surfaces.index(0, y + 1); ++i) {
      const bool has = g.surfaces[i].is_surface() && shape.has(g.surfaces[i]);
      found.coverage[i] = has;
      in_row += has;
    }
    return in_row;
  });
  found.share = double(covered) / double(g.surfaces.size());
  if (!shape.is_dome && has_sky_above(g, found.coverage)) return std::nullopt;
  if (shape.stands && has_sky_beside(g, found.share)) return std::nullopt;
  return found;
}

}  // namespace

std::optional<Backdrop> find_backdrop(const Geometry& g) {
  if (g.camera.orthographic) return std::nullopt;
  const SurfelSamples samples = samples_of(g);
  std::optional<Backdrop> farthest;
  for (const auto& shape :
       {find_dome(samples), find_walls(samples, g), find_standing_backdrop(samples)}) {
    if (!shape || (farthest && shape->clearance <= farthest->clearance)) continue;
    std::optional<Backdrop> found = shown(g, *shape);
    if (found) farthest = std::move(found);
    if (farthest && farthest->is_far()) break;
  }
  return farthest;
}

}  // namespace ssdo
