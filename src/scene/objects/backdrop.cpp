// SPDX-License-Identifier: Apache-2.0
//
// A sky dome in a G-buffer is a surface like any other, and hides all of the sky. What tells it
// from the walls of a place is its shape: the far surfaces of the frame lie on one sphere, which
// has the camera inside, is seen from its inside, and is several times as large as all else that is
// seen.
//
// The sphere |p - c| = r is fitted as |p|^2 = 2 c.p + k, which is linear, to the far surfaces, then
// again to those that lie on it. A room, a street or a terrain has far surfaces of which most lie
// on no sphere, however it is fitted. How many pixels show the dome does not matter.
//
// Cards behind a set, the sides of a box around it (the proxy of a volume) and cylinders of sky
// have the shape of walls: on the frames of a street a facade may be all that is seen beside a
// lamppost. What walls do not have is a gap: the ground leads up to them. So planes and upright
// cylinders are backdrops only where nothing is seen between them and all else, over a wide range
// of distances, and where no sky is seen above them. A card that stands on the ground is not told
// from a wall.
#include "scene/objects/backdrop.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <iterator>
#include <vector>

namespace ssdo {
namespace {

/// Samples of a frame, in rows and columns.
constexpr int kSamples = 96;

/// Fewest samples that a shape is fitted to.
constexpr std::size_t kFewest = 24;

/// What lies off a shape by less than this share of its radius, or of its distance, is on it: domes
/// of 16 segments do.
constexpr double kOnShape = 0.02;

/// Share of the surfaces farther than half of the radius that lie on the sphere, and of those
/// beyond the gap that lie on planes or a cylinder.
constexpr double kMostOnSphere = 0.8, kMostOnWalls = 0.95;

/// Least radius over the distance of all but a tenth of what is not on it.
constexpr double kLarger = 3;

/// Least distance of planes and cylinders over that of all that is nearer. Of the frames of `data`
/// and `truth` none has a gap of 3 before smooth surfaces.
constexpr double kGap = 10;

/// Gaps below this do not make a frame ask its shot.
constexpr double kAnyGap = 2;

/// Share of the surfaces that have to be before the gap: a set, and not one thing before a wall.
constexpr double kLeastBefore = 0.2;

/// One of so many samples may be in the gap.
constexpr std::size_t kInGap = 200;

/// Most sides of a box that are seen from inside of it.
constexpr int kMostPlanes = 5;

/// Samples whose plane is tried for all of them.
constexpr std::size_t kCandidates = 64;

/// Share of the columns of a backdrop that may show sky above it.
constexpr double kSkyAbove = 0.1;

/// Least mean distance of what is on it from the camera, over the radius. Far rows of a floor are
/// arcs, which lie on spheres too, with a middle high above them, and planes lie on all that is
/// large.
constexpr double kAround = 0.5;

/// Least mean cosine between normals and the way to the middle.
constexpr double kInward = 0.9;

constexpr int kRounds = 6;

using Samples = std::vector<const Surfel*>;

/// A sphere, or a cylinder along `axis`, whose places count across it alone.
struct Round {
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

Samples samples_of(const Geometry& g) {
  const int dx = std::max(1, g.surfel.width / kSamples),
            dy = std::max(1, g.surfel.height / kSamples);
  Samples samples;
  for (int y = dy / 2; y < g.surfel.height; y += dy)
    for (int x = dx / 2; x < g.surfel.width; x += dx)
      if (g.surfel(x, y).is_surface()) samples.push_back(&g.surfel(x, y));
  return samples;
}

double distance_of(const Surfel* s) { return glm::length(glm::dvec3(s->position)); }

/// Distances in units of `unit`, so that sums keep their digits. Nothing is known of the middle
/// along an axis: that of the least length is taken.
std::optional<Round> fit(const Samples& samples, const glm::dvec3& axis, double unit) {
  if (samples.size() < kFewest) return std::nullopt;
  Round round{axis};
  Eigen::Matrix4d sums = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Surfel* s : samples) {
    const glm::dvec3 p = round.across(glm::dvec3(s->position) / unit);
    const Eigen::Vector4d row(2 * p.x, 2 * p.y, 2 * p.z, 1);
    sums += row * row.transpose();
    right += row * glm::dot(p, p);
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sums(i, j) += double(samples.size()) * axis[i] * axis[j];
  const Eigen::Vector4d found = sums.ldlt().solve(right);
  const glm::dvec3 middle(found[0], found[1], found[2]);
  const double radius2 = found[3] + glm::dot(middle, middle);
  if (!(radius2 > 0) || !std::isfinite(radius2)) return std::nullopt;
  round.middle = unit * middle, round.radius = unit * std::sqrt(radius2);
  return round;
}

double median(std::vector<double> all) {
  std::ranges::nth_element(all, all.begin() + std::ptrdiff_t(all.size() / 2));
  return all[all.size() / 2];
}

/// The sphere or cylinder of far surfaces: fitted to all, then to those that lie near it.
std::optional<Round> round_of(const Samples& far, const glm::dvec3& axis, double unit) {
  std::optional<Round> shape = fit(far, axis, unit);
  for (int round = 0; shape && round < kRounds; ++round) {
    std::vector<double> all;
    for (const Surfel* s : far) all.push_back(shape->off(glm::dvec3(s->position)));
    const double most = std::max(median(all), kOnShape * shape->radius);
    Samples near_it;
    std::ranges::copy_if(far, std::back_inserter(near_it), [&](const Surfel* s) {
      return shape->off(glm::dvec3(s->position)) <= most;
    });
    shape = fit(near_it, axis, unit);
  }
  return shape;
}

/// What has a shape.
struct Found {
  std::function<bool(const Surfel&)> has;
  std::string what;
  double clearance = 0;
};

/// A dome, by the far surfaces of all.
std::optional<Found> find_dome(const Samples& samples) {
  double farthest = 0;
  for (const Surfel* s : samples) farthest = std::max(farthest, distance_of(s));
  Samples far_half;
  std::ranges::copy_if(samples, std::back_inserter(far_half),
                       [&](const Surfel* s) { return distance_of(s) > 0.5 * farthest; });
  const std::optional<Round> sphere = round_of(far_half, glm::dvec3(0), farthest);
  if (!sphere || glm::length(sphere->middle) >= sphere->radius) return std::nullopt;
  std::vector<double> others;
  double far = 0, on = 0, inward = 0, distances = 0;
  for (const Surfel* s : samples) {
    const glm::dvec3 p(s->position);
    const bool is_on = sphere->has(p);
    if (!is_on) others.push_back(distance_of(s));
    far += distance_of(s) > 0.5 * sphere->radius;
    if (!is_on) continue;
    on += 1, distances += distance_of(s);
    inward += glm::dot(glm::dvec3(s->normal), sphere->to_middle(p));
  }
  if (on < double(kFewest) || on < kMostOnSphere * far || inward < kInward * on)
    return std::nullopt;
  if (distances < kAround * sphere->radius * on) return std::nullopt;
  Found found{[sphere](const Surfel& s) { return sphere->has(glm::dvec3(s.position)); },
              fmt::format("a dome of radius {:.3g} around everything", sphere->radius), 1};
  if (others.empty()) return found;
  const auto most = others.begin() + std::ptrdiff_t(others.size() * 9 / 10);
  std::ranges::nth_element(others, most);
  found.clearance = sphere->radius / (kLarger * *most);
  return found;
}

/// The samples behind the widest gap in distance, and how wide that is as a factor.
struct Behind {
  Samples samples;
  double nearest = 0, gap = 0;
};

Behind behind_gap(Samples samples) {
  Behind found;
  std::ranges::sort(samples, {}, distance_of);
  const std::size_t within = 1 + samples.size() / kInGap;
  std::size_t first = 0;
  for (std::size_t i = std::size_t(kLeastBefore * double(samples.size()));
       i + within + kFewest <= samples.size(); ++i) {
    const double gap = distance_of(samples[i + within]) / distance_of(samples[i]);
    if (gap > found.gap) found.gap = gap, first = i + within;
  }
  if (found.gap < kAnyGap) return {};
  found.nearest = distance_of(samples[first]);
  found.samples.assign(samples.begin() + std::ptrdiff_t(first), samples.end());
  return found;
}

/// The plane of a sample that most of these lie on, then the mean of those; nothing if none lie on
/// it.
std::optional<Flat> flat_of(const Samples& all) {
  Flat best;
  std::ptrdiff_t most = 0;
  for (std::size_t k = 0; k < all.size(); k += 1 + all.size() / kCandidates) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(all[k]->normal));
    const Flat flat{normal, -glm::dot(normal, glm::dvec3(all[k]->position))};
    if (!(flat.distance > 0)) continue;
    const std::ptrdiff_t on =
        std::ranges::count_if(all, [&](const Surfel* s) { return flat.has(*s); });
    if (on > most) most = on, best = flat;
  }
  if (most == 0) return std::nullopt;
  Flat mean;
  for (const Surfel* s : all)
    if (best.has(*s)) mean.normal += glm::dvec3(s->normal);
  mean.normal = glm::normalize(mean.normal);
  for (const Surfel* s : all)
    if (best.has(*s))
      mean.distance -= glm::dot(mean.normal, glm::dvec3(s->position)) / double(most);
  return mean;
}

/// Planes that nearly all of these lie on.
std::optional<Found> find_flats(const Behind& behind) {
  std::vector<Flat> flats;
  Samples left = behind.samples;
  const double most_left = (1 - kMostOnWalls) * double(left.size());
  while (double(left.size()) > most_left) {
    if (flats.size() == kMostPlanes) return std::nullopt;
    const std::optional<Flat> flat = flat_of(left);
    if (!flat || std::erase_if(left, [&](const Surfel* s) { return flat->has(*s); }) < kFewest)
      return std::nullopt;
    flats.push_back(*flat);
  }
  const auto has = [flats, nearest = behind.nearest](const Surfel& s) {
    return distance_of(&s) >= nearest &&
           std::ranges::any_of(flats, [&](const Flat& flat) { return flat.has(s); });
  };
  const std::string which = flats.size() == 1 ? "a plane" : fmt::format("{} planes", flats.size());
  return Found{
      has, fmt::format("{} behind everything, from a distance of {:.3g} on", which, behind.nearest),
      behind.gap / kGap};
}

/// An upright cylinder around everything that nearly all of these lie on.
std::optional<Found> find_cylinder(const Behind& behind, const glm::dvec3& axis) {
  const std::optional<Round> found = round_of(behind.samples, axis, behind.nearest);
  if (!found || glm::length(found->middle) >= found->radius) return std::nullopt;
  double on = 0, inward = 0, distances = 0;
  for (const Surfel* s : behind.samples) {
    if (!found->has(glm::dvec3(s->position))) continue;
    on += 1, distances += glm::length(found->across(glm::dvec3(s->position)));
    inward += glm::dot(glm::dvec3(s->normal), found->to_middle(glm::dvec3(s->position)));
  }
  if (on < kMostOnWalls * double(behind.samples.size()) || inward < kInward * on)
    return std::nullopt;
  if (distances < kAround * found->radius * on) return std::nullopt;
  const auto has = [found, nearest = behind.nearest](const Surfel& s) {
    return distance_of(&s) >= nearest && found->has(glm::dvec3(s.position));
  };
  return Found{has, fmt::format("a cylinder of radius {:.3g} around everything", found->radius),
               behind.gap / kGap};
}

/// Planes, or an upright cylinder, with nothing between them and all else.
std::optional<Found> find_walls(const Samples& samples, const Geometry& g) {
  const Behind behind = behind_gap(samples);
  if (behind.samples.empty()) return std::nullopt;
  for (const int up : {1, 2}) {
    if (!g.world_known) break;
    if (auto found = find_cylinder(behind, glm::dvec3(g.world_to_camera[up]))) return found;
  }
  return find_flats(behind);
}

/// Whether sky is seen above what is covered, in more than a few columns.
bool has_sky_above(const Geometry& g, const Plane<float>& coverage) {
  double columns = 0, with_sky = 0;
  for (int x = 0; x < coverage.width; ++x) {
    bool sky = false;
    for (int y = 0; y < coverage.height; ++y) {
      const Surfel& s = g.surfel(x, y);
      sky |= !s.is_surface() && !s.is_broken();
      if (!(coverage(x, y) > 0)) continue;
      columns += 1, with_sky += sky;
      break;
    }
  }
  return with_sky > kSkyAbove * columns;
}

}  // namespace

std::optional<Backdrop> find_backdrop(const Geometry& g) {
  if (g.camera.orthographic) return std::nullopt;
  const Samples samples = samples_of(g);
  std::optional<Found> shape = find_dome(samples);
  const bool is_dome = shape.has_value();
  if (!shape) shape = find_walls(samples, g);
  if (!shape) return std::nullopt;
  Backdrop found{Plane<float>(g.surfel.width, g.surfel.height, 0.0f), 0, shape->what,
                 shape->clearance};
  for (std::size_t i = 0; i < g.surfel.size(); ++i) {
    if (!g.surfel[i].is_surface() || !shape->has(g.surfel[i])) continue;
    found.coverage[i] = 1;
    found.share += 1 / double(g.surfel.size());
  }
  if (!is_dome && has_sky_above(g, found.coverage)) return std::nullopt;
  return found;
}

}  // namespace ssdo
