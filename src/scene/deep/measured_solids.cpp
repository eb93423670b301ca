// SPDX-License-Identifier: Apache-2.0
#include "scene/deep/measured_solids.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "error.h"
#include "io/exr/file/exr_parts.h"
#include "math/infinity.h"
#include "parallel/tiles.h"
#include "scene/deep/ray_solids.h"
#include "scene/gbuffer/background.h"
#include "scene/normals/normals.h"
#include "scene/same_surface.h"

namespace ssdo {
namespace {

/// Solids that are looked for on one ray: what is seen, some in front that contradict, those
/// behind.
constexpr std::size_t kMostOnRay = 32;

/// Shares of the pixels with samples. Where kAgrees of them agree with the frame by a kind of
/// depth, no other kind is tried; where more than kContradicts contradict the frame and less than
/// that agree, the image is refused. Silhouettes of averaged samples contradict, and rarely cover
/// more than a third.
constexpr double kAgrees = 0.9, kContradicts = 0.5;

/// How pixels meet the frame.
struct Tally {
  std::atomic<std::size_t> with_samples{0}, agreeing{0}, contradicting{0};
};

/// What is found on the ray of one pixel.
struct OnRay {
  float seen_thickness = kInfinity;
  struct {
    float distance, thickness;
  } behind[kMostBehind];
  std::size_t count = 0;
  bool agrees = false, contradicts = false;
};

/// Places the samples of images on the rays of a geometry.
class Placement {
 public:
  Placement(const Geometry& geometry, const std::vector<DeepImage>& images, DepthKind kind)
      : geometry_(geometry),
        is_ray_(kind == DepthKind::ray && !geometry.camera.orthographic),
        footprint_(geometry.camera) {
    for (const DeepImage& image : images)
      if (image.half) step_ = kStepHalf;
  }

  OnRay find(const Surfel& s, const std::vector<RaySolid>& solids) const {
    OnRay out;
    const bool orthographic = geometry_.camera.orthographic;
    const float depth = -s.position.z, length = glm::length(s.position),
                per_depth = orthographic ? 1 : length / depth,
                facing = std::max(glm::dot(s.normal, direction_to_viewer(s.position, orthographic)),
                                  kLeastCosine);
    const float at_seen = (gap(depth) + s.rounding) / facing;
    float end = 0;  // of the solid so far
    for (const RaySolid& solid : solids) {
      const auto distance = [&](float z) { return is_ray_ ? z - length : (z - depth) * per_depth; };
      const float front = distance(solid.front), back = distance(solid.back),
                  near = gap(depth + std::max(front, 0.0f) / per_depth);
      const bool thick = back < kInfinity && back - front > near / kSurfaceGap;
      if (front < -at_seen) {
        out.contradicts = true;
        continue;
      }
      const bool seen = front <= at_seen;
      out.agrees |= seen;
      if (seen || front <= end + near) {
        // A part of the solid so far.
        if (!thick || back <= end) continue;
        end = back;
        if (out.count == 0)
          out.seen_thickness = end;
        else
          out.behind[out.count - 1].thickness = end - out.behind[out.count - 1].distance;
        continue;
      }
      if (out.count == kMostBehind) break;
      out.behind[out.count++] = {front, thick ? back - front : kInfinity};
      end = thick ? back : front;
    }
    return out;
  }

 private:
  /// Solids whose ends are nearer than this are one: the same surface in two elements, or in P and
  /// in a deep image.
  float gap(float depth) const { return kSurfaceGap * footprint_.at(depth) + 2 * step_ * depth; }

  const Geometry& geometry_;
  bool is_ray_;
  PixelFootprint footprint_;
  float step_ = 0;  ///< relative rounding of depths
};

MeasuredSolids find(const Geometry& geometry, const std::vector<DeepImage>& images, DepthKind kind,
                    float far, Tally& tally) {
  const int w = geometry.surfaces.width, h = geometry.surfaces.height;
  MeasuredSolids found{Plane<float>(w, h, kInfinity), {}};
  for (std::size_t k = 0; k < kMostBehind; ++k)
    found.behind.push_back({Plane<float>(w, h, kInfinity), Plane<float>(w, h, kInfinity)});
  const Placement placement(geometry, images, kind);
  std::atomic<std::size_t> layers{0};
  for_each_row(h, [&](int y) {
    RaySolids ray(far);
    std::size_t with_samples = 0, agreeing = 0, contradicting = 0, most = 0;
    for (int x = 0; x < w; ++x) {
      const std::size_t i = geometry.surfaces.index(x, y);
      if (!geometry.surfaces[i].is_usable()) continue;
      for (const DeepImage& image : images)
        ray.add(image.at(geometry.window.x0 + x, geometry.window.y0 + y));
      const std::vector<RaySolid>& solids = ray.find(kMostOnRay);
      if (solids.empty()) continue;
      const OnRay on_ray = placement.find(geometry.surfaces[i], solids);
      found.seen_thickness[i] = on_ray.seen_thickness;
      for (std::size_t k = 0; k < on_ray.count; ++k) {
        found.behind[k].distance[i] = on_ray.behind[k].distance;
        found.behind[k].thickness[i] = on_ray.behind[k].thickness;
      }
      ++with_samples;
      agreeing += on_ray.agrees;
      contradicting += on_ray.contradicts;
      most = std::max(most, on_ray.count);
    }
    tally.with_samples += with_samples;
    tally.agreeing += agreeing;
    tally.contradicting += contradicting;
    for (std::size_t before = layers; before < most && !layers.compare_exchange_weak(before, most);)
      continue;
  });
  found.behind.resize(layers);
  return found;
}

void check_windows(const Geometry& geometry, const std::vector<DeepImage>& images) {
  for (const DeepImage& image : images) {
    if (image.display == geometry.display) continue;
    throw Error(ExitCode::layer,
                fmt::format("{}: has the display window {}, and the frame has {}; a deep image "
                            "shows the same frame: render them to one size",
                            image.file, text_of(image.display), text_of(geometry.display)));
  }
}

std::string names_of(const std::vector<DeepImage>& images) {
  std::string names;
  for (const DeepImage& image : images) names += (names.empty() ? "" : ", ") + image.file;
  return names;
}

}  // namespace

MeasuredSolids measure_solids(const Geometry& geometry, const std::vector<DeepImage>& images,
                              const DeepDepths& depths, std::vector<std::string>& warnings) {
  check_windows(geometry, images);
  Tally tally;
  const DepthKind first = depths.kind.value_or(DepthKind::planar);
  MeasuredSolids found = find(geometry, images, first, depths.far, tally);
  const auto with_samples = double(tally.with_samples);
  std::size_t agreeing = tally.agreeing, contradicting = tally.contradicting;
  if (!depths.kind && double(agreeing) < kAgrees * with_samples) {
    Tally other;
    MeasuredSolids by_rays = find(geometry, images, DepthKind::ray, depths.far, other);
    if (other.agreeing > agreeing) {
      found = std::move(by_rays);
      agreeing = other.agreeing, contradicting = other.contradicting;
      warnings.push_back(fmt::format(
          "{}: its depths are taken as distances along the rays, which fit the frame better; give "
          "--depth-kind to choose",
          names_of(images)));
    }
  }
  if (double(contradicting) > kContradicts * with_samples &&
      double(agreeing) < kContradicts * with_samples) {
    throw Error(ExitCode::layer,
                fmt::format("{}: lies in front of what the frame shows in {:.0f} % of the pixels "
                            "that it covers; it is of another frame, camera or unit, or of another "
                            "--depth-kind",
                            names_of(images), 100 * double(contradicting) / with_samples));
  }
  if (with_samples > 0 && agreeing == 0) {
    warnings.push_back(fmt::format(
        "{}: no sample lies on a surface that the frame shows; check that it shows this "
        "frame in the same unit",
        names_of(images)));
  }
  return found;
}

}  // namespace ssdo
