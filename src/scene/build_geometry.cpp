// SPDX-License-Identifier: Apache-2.0
#include "scene/build_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numeric>

#include "error.h"
#include "parallel/planes.h"
#include "parallel/tiles.h"
#include "scene/camera/find_camera.h"
#include "scene/normals/lens_of_normals.h"
#include "scene/normals/normal_space.h"
#include "scene/normals/normal_trust.h"
#include "scene/normals/normals.h"
#include "scene/normals/world_of_normals.h"
#include "scene/order_statistics.h"
#include "scene/silhouettes.h"

namespace ssdo {
namespace {

/// Camera-space positions, and the radius by which rounding may have moved each of them. Returns
/// how many were left out because they lie behind the camera.
std::size_t place_positions(const GBuffer& g, const Camera& camera, DepthKind kind, Geometry& out) {
  out.surfaces = Surfaces::unset(g.window.width(), g.window.height());
  std::vector<std::size_t> behind(std::size_t(out.surfaces.height));
  const auto surfel_at = [&](int x, int y, std::size_t i) -> Surfel {
    constexpr Surfel kBroken{glm::vec3(0), glm::vec3(0), Surfel::kBroken};
    if (!g.valid[i]) return !g.broken.empty() && g.broken[i] ? kBroken : Surfel();
    glm::dvec3 p;
    double magnitude;
    if (g.position.empty()) {
      const glm::dvec2 centre(g.window.x0 + x + 0.5, g.window.y0 + y + 0.5);
      p = camera.unproject(centre, g.depth[i]);
      if (kind == DepthKind::ray && !camera.orthographic) p *= g.depth[i] / glm::length(p);
      magnitude = g.depth[i];
    } else {
      p = camera.to_camera(glm::dvec3(g.position[i]));
      magnitude = std::max(
          {std::abs(g.position[i].x), std::abs(g.position[i].y), std::abs(g.position[i].z)});
    }
    if (!camera.panorama && !(float(p.z) < 0)) {
      ++behind[std::size_t(y)];
      return kBroken;
    }
    return {glm::vec3(p), glm::vec3(0), float(magnitude) * g.position_step};
  };
  for_each_row(out.surfaces.height, [&](int y) {
    for (int x = 0; x < out.surfaces.width; ++x) {
      const std::size_t i = out.surfaces.index(x, y);
      out.surfaces.set(i, surfel_at(x, y, i));
    }
  });
  return std::accumulate(behind.begin(), behind.end(), std::size_t(0));
}

float median_depth(const Geometry& geometry) {
  constexpr float kLeftOut = -1;
  Plane<float> depths = Plane<float>::like(geometry.surfaces);
  for_each_row(depths.height, [&](int y) {
    for (int x = 0; x < depths.width; ++x) {
      const Surfel& s = geometry.surfaces(x, y);
      depths(x, y) = s.is_surface() ? float(geometry.camera.depth_of(s.position)) : kLeftOut;
    }
  });
  const OrderStatistics in_order(depths.pixels);
  return in_order.count() == 0 ? 0 : in_order.at(in_order.count() / 2);
}

/// A kind of depth fits normals clearly better if its mean of 1 - cosine is below this share of the
/// other's.
constexpr double kClearlyBetter = 0.5;

/// Normals count as rebuilt where less than half of them is as stored.
constexpr float kMostlyStored = 0.5f;

/// Normals within 53 degrees of the opposite of what P shows are those of the back.
constexpr float kOpposite = 0.6f;

/// The world whose pose is given.
std::string name_of_world(const GeometryReport& report) {
  return report.header ? "the world of the header" : "the world of --camera";
}

/// The spaces that N may be in.
std::vector<NamedRotation> spaces_of_normals(const GBuffer& g, const GeometryReport& report) {
  const Placement& found = report.placement;
  const glm::mat3 of_positions(found.position_camera.rotation), world(found.camera.rotation);
  std::vector<NamedRotation> spaces;
  if (!g.position.empty()) spaces.push_back({of_positions, "the space of P"});
  spaces.push_back({glm::mat3(1), "camera space"});
  if (found.world_given && (g.position.empty() || of_positions != world))
    spaces.push_back({world, name_of_world(report)});
  return spaces;
}

std::string_view name_of(Space space) { return space == Space::world ? "world" : "camera"; }

/// The space that --space says N is in. Errors: ExitCode::layer for a world that nothing places.
NamedRotation given_space_of_normals(const GBuffer& g, const Geometry& out,
                                     const GeometryReport& report, const std::string& file) {
  const Placement& found = report.placement;
  const NamedRotation of_positions{glm::mat3(found.position_camera.rotation), "the space of P"},
      of_camera{glm::mat3(1), "camera space"};
  if (*g.space == Space::camera) {
    const bool same =
        !g.position.empty() && found.position_camera.is_camera_space(median_depth(out));
    return same ? of_positions : of_camera;
  }
  if (!g.position.empty()) return of_positions;
  if (found.world_given) return {glm::mat3(found.camera.rotation), name_of_world(report)};
  throw Error(ExitCode::layer,
              fmt::format("{}: --space world: without P, the pose of the camera is not known; give "
                          "--camera FILE.json",
                          file));
}

/// The normals as --space says, whether or not they agree with P.
NormalSpace given_normal_space(const GBuffer& g, const Geometry& out, const std::string& file,
                               GeometryReport& report) {
  NormalSpace space =
      measure_normal_space(g.normal, out.surfaces, given_space_of_normals(g, out, report, file),
                           out.camera.orthographic);
  report.normal_agreement = space.share;
  space.name += ", by --space";
  if (space.smooth_pixels >= NormalSpace::kFewestSmoothPixels &&
      space.share < NormalSpace::kLeastShare) {
    report.warnings.push_back(
        fmt::format("--space {}: taken as {}, normals agree with {} in {:.0f} % of the smooth "
                    "pixels only",
                    name_of(*g.space), space.name.substr(0, space.name.find(',')),
                    g.position.empty() ? "the depth" : "P", 100 * space.share));
  }
  return space;
}

/// Checks by the normals that a depth is planar where nothing states its kind: read as planar, a
/// distance along the rays gives bent surfaces. Warns if surfaces from a distance along the rays
/// fit the normals better; returns whether planar depth fits.
bool is_depth_planar(const GBuffer& g, const Geometry& planar, const NormalSpace& of_planar,
                     GeometryReport& report) {
  if (planar.camera.orthographic) return true;
  Geometry by_rays;
  place_positions(g, to_grid(report.placement.position_camera, g.grid), DepthKind::ray, by_rays);
  const NormalSpace of_rays =
      find_normal_space(g.normal, by_rays.surfaces, spaces_of_normals(g, report), false);
  const bool clearly = 1 - of_rays.mean_cosine < kClearlyBetter * (1 - of_planar.mean_cosine);
  if (!clearly || of_rays.smooth_pixels < NormalSpace::kFewestSmoothPixels) return true;
  report.warnings.push_back(
      "the depth is taken as planar, and by the normals it is the distance along the rays: give "
      "--depth-kind ray, or --depth-kind planar where it is not");
  return false;
}

/// Warns where the normals fit the surfaces of a planar depth better under another lens.
void check_lens(const GBuffer& g, const Geometry& out, GeometryReport& report) {
  if (out.camera.orthographic || out.camera.panorama || g.depth_kind != DepthKind::planar) return;
  const auto lens = find_lens_of_normals(g.normal, out);
  if (!lens) return;
  Camera other = out.camera;
  other.fx *= lens->focal_ratio;
  const int width = out.display.width();
  report.warnings.push_back(fmt::format(
      "the normals disagree with the depth under the camera ({}, {:.1f} degrees) by {:.2g} degrees "
      "in half of the pixels, and by {:.2g} under --fov {:.1f}",
      report.camera_source, out.camera.hfov_degrees(width), lens->miss_before, lens->miss,
      other.hfov_degrees(width)));
}

/// The space of the stored normals; nothing where there are none.
std::optional<NormalSpace> space_of_normals(const GBuffer& g, const Geometry& out,
                                            const std::string& of_shot, const std::string& file,
                                            GeometryReport& report) {
  if (g.normal.empty()) return std::nullopt;
  if (g.space) return given_normal_space(g, out, file, report);
  NormalSpace space = find_normal_space(g.normal, out.surfaces, spaces_of_normals(g, report),
                                        out.camera.orthographic, of_shot);
  report.normal_agreement = space.share;
  report.normals_known = space.is_known();
  const bool from_depth = g.position.empty();
  if (from_depth && (!g.depth_source.empty() || is_depth_planar(g, out, space, report)))
    check_lens(g, out, report);
  return space;
}

/// How the stored normals are used: nothing of them without a way to camera space.
struct UsedNormals {
  std::optional<glm::mat3> to_camera;
  NormalTrust trust = {};
};

/// Decides how far normals that disagree with P are used, and says so.
UsedNormals judge_normals(const GBuffer& g, const Geometry& out, NormalSpace& space,
                          GeometryReport& report) {
  const std::string_view source = g.position.empty() ? "the depth" : "P";
  if (space.smooth_pixels < NormalSpace::kFewestSmoothPixels && !g.position.empty()) {
    space.name += ", unchecked: P is nowhere smooth";
    return {space.to_camera};
  }
  NormalTrust trust = find_normal_trust(g.normal, out.surfaces, space, out.camera.orthographic);
  if (trust.least() < kMostlyStored) {
    const bool nowhere = trust.most() == 0;
    report.warnings.push_back(
        fmt::format("normals do not belong to {0}: they agree with it in {1:.0f} % of the smooth "
                    "pixels; rebuilt from {0}{2}",
                    source, 100 * space.share, nowhere ? "" : " where they disagree"));
    if (nowhere) return {};
    space.name += ", rebuilt from P where they disagree";
  } else if (space.share < NormalSpace::kLeastShare) {
    report.warnings.push_back(
        fmt::format("normals agree with {} in {:.0f} % of the smooth pixels only, and are used as "
                    "they are: if they are not meant to lean away from the surface, name another "
                    "layer with --aov normal=LAYER",
                    source, 100 * space.share));
  }
  return {space.to_camera, std::move(trust)};
}

/// A normal as it is used, and what became of the stored one.
struct PlacedNormal {
  glm::vec3 normal;
  enum class Fate : unsigned char { kept, rebuilt, turned } fate;
};

/// The normal at a pixel; `stored` is in camera space, of any length, and used as far as `trust`
/// says. A smooth normal may lean away from the viewer at a silhouette. One below the surface is
/// negated if it is nearly opposite to the geometric normal (a back face); otherwise it is mirrored
/// in the surface (a leaf that is lit as a crown).
PlacedNormal placed_normal(const Surfaces& surfels, int x, int y, const glm::vec3& stored,
                           float trust, bool orthographic) {
  using Fate = PlacedNormal::Fate;
  const glm::vec3& p = surfels(x, y).position;
  const auto gradient = [&] {
    const glm::vec3 view = direction_to_viewer(p, orthographic),
                    found = gradient_normal(surfels, x, y, view);
    return found == glm::vec3(0) ? view : found;
  };
  const float length = glm::length(stored);
  if (!(length > 1e-4f && length < 1e4f)) return {gradient(), Fate::rebuilt};
  PlacedNormal placed{stored / length, Fate::kept};
  glm::vec3& n = placed.normal;
  if (orthographic ? n.z < 0 : glm::dot(n, p) > 0) {
    const glm::vec3 g = gradient();
    const float along = glm::dot(n, g);
    if (along < 0) {
      n = along < -kOpposite ? -n : glm::normalize(n - 2 * along * g);
      placed.fate = Fate::turned;
    }
  }
  if (trust == 1) return placed;
  const glm::vec3 g = gradient(), blend = glm::mix(g, n, trust);
  const float size = glm::length(blend);
  n = size > 1e-3f ? blend / size : g;
  if (trust < kMostlyStored) placed.fate = Fate::rebuilt;
  return placed;
}

void place_normals(const GBuffer& g, const UsedNormals& used, Geometry& out,
                   GeometryReport& report) {
  using Fate = PlacedNormal::Fate;
  Plane<Fate> fates(out.surfaces.width, out.surfaces.height, Fate::kept);
  for_each_row(out.surfaces.height, [&](int y) {
    for (int x = 0; x < out.surfaces.width; ++x) {
      const std::size_t i = out.surfaces.index(x, y);
      if (!out.is_surface(i)) continue;
      const glm::vec3 stored = used.to_camera ? *used.to_camera * g.normal[i] : glm::vec3(0);
      const PlacedNormal placed =
          placed_normal(out.surfaces, x, y, stored, used.trust.at(x, y), out.camera.orthographic);
      out.surfaces.set_normal(i, placed.normal);
      fates[i] = placed.fate;
    }
  });
  for (const Fate fate : fates.pixels) {
    report.normals_rebuilt += fate == Fate::rebuilt;
    report.normals_turned += fate == Fate::turned;
  }
}

UsedNormals find_normals(const GBuffer& g, const Geometry& out, const std::string& of_shot,
                         const std::string& file, GeometryReport& report) {
  std::optional<NormalSpace> space = space_of_normals(g, out, of_shot, file, report);
  UsedNormals used;
  if (space) used = g.space ? UsedNormals{space->to_camera} : judge_normals(g, out, *space, report);
  report.normal_space = used.to_camera ? space->name : "rebuilt from P";
  // Bands know only this transform, so they use all stored normals or none.
  if (used.trust.mean() > kMostlyStored) report.placement.normals_to_camera = used.to_camera;
  return used;
}

/// Moves averages of P at edges back to surfaces, where the edges of the whole frame show that P is
/// filtered.
void mend(const GBuffer& g, Geometry& out, GeometryReport& report, const Placement* known) {
  Placement& placement = report.placement;
  if (known) {
    if (known->mends_silhouettes) mend_silhouettes(out, placement.residual, true);
    return;
  }
  if (!report.residual || out.camera.panorama) return;
  const double stride = g.grid.stride;
  placement.residual = {stride * report.residual->median_px, stride * report.residual->p99_px,
                        stride * report.residual->max_px};
  const std::size_t averages = mend_silhouettes(out, *report.residual);
  placement.mends_silhouettes = averages > 0;
  if (averages == 0) return;
  report.warnings.push_back(fmt::format(
      "P is an average over an edge in {} pixels, which take the surface beside them; export P "
      "and N without a filter",
      averages));
}

/// Whether P is in world space: not where its own camera stands at the origin and looks along an
/// axis. --space decides first.
bool is_in_world_space(const GBuffer& g, const Placement& found, GeometryReport& report) {
  if (g.position.empty()) return false;
  const bool in_camera_space = found.position_camera.is_camera_space(found.median_depth);
  if (g.space == Space::camera && !in_camera_space) {
    report.warnings.push_back(
        "--space camera: the camera of P stands elsewhere than at its origin, or is turned; the "
        "environment is taken in camera space");
  }
  return g.space ? *g.space == Space::world : !in_camera_space;
}

}  // namespace

Geometry build_geometry(const GBuffer& g, const CameraOptions& options, const std::string& file,
                        GeometryReport& report, const Placement* known) {
  Geometry out;
  out.window = g.window;
  out.display = g.display;
  out.part_of = g.part_of;
  // Where the overview of a frame shows no surface, the camera is not known.
  if (known && known->median_depth <= 0) {
    out.surfaces = Surfaces(g.window.width(), g.window.height());
    return out;
  }
  if (!known && g.background_pixels + g.bad_pixels >= g.valid.size() &&
      std::none_of(g.valid.pixels.begin(), g.valid.pixels.end(), [](auto v) { return v != 0; })) {
    report.camera_source = "none: the frame shows no surface";
    report.warnings.push_back("the frame shows no surface");
    out.surfaces = Surfaces(g.window.width(), g.window.height());
    return out;
  }
  Placement& placement = report.placement;
  std::vector<HeaderCamera> readings;
  if (known) {
    placement = *known;
  } else {
    const FoundCamera found = find_camera(g, options, file, report);
    placement.camera = found.camera, placement.position_camera = found.position_camera;
    placement.world_given = found.world_given;
    readings = found.readings;
  }
  out.camera = to_grid(placement.camera, g.grid);
  const Camera position_camera = to_grid(placement.position_camera, g.grid);
  if (const std::size_t behind = place_positions(g, position_camera, g.depth_kind, out)) {
    report.warnings.push_back(
        fmt::format("{} positions lie behind the camera and are left out", behind));
  }
  if (!readings.empty()) {
    settle_world(g, out.surfaces, readings, report);
    out.camera = to_grid(placement.camera, g.grid);
  }
  const UsedNormals normals = known ? UsedNormals{known->normals_to_camera}
                                    : find_normals(g, out, options.shot.normal_space, file, report);
  out.normals_to_camera = normals.to_camera.value_or(glm::mat3(placement.position_camera.rotation));
  place_normals(g, normals, out, report);
  mend(g, out, report, known);
  if (!known) {
    placement.median_depth = median_depth(out);
    placement.world_known = placement.world_given || is_in_world_space(g, placement, report);
  }
  out.median_depth = placement.median_depth;
  out.world_known = placement.world_known;
  if (out.world_known) out.world_to_camera = glm::mat3(out.camera.rotation);
  return out;
}

}  // namespace ssdo
