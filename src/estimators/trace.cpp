// SPDX-License-Identifier: Apache-2.0
//
// Rays against the frame as thick solids (height_field.h), with Embree (Wald, Woop, Benthin,
// Johnson, Ernst 2014). The model is that of method bitmask, without its slices, sectors and steps:
// the yardstick of the other methods. With directions w_i that are distributed as the cosine is,
//
//   ao      = number open / n
//   direct  = E(N)/pi * sum_open L(w_i) / sum_all L(w_i)   channel by channel, then each source by
//             the visible part of the cosines to its points above the horizon
//   bounce  = sum L_out(q_i) / n                            q_i: the surface that is met first
//
// L is the environment without its sources, as it is: methods with light in spherical harmonics
// differ by what these leave out. Where nothing occludes, both ratios are exact with any n.
// Elsewhere the ratio of direct light is biased if few rays meet bright parts of L by chance; such
// parts are therefore among the sources.
//
// As in method bitmask, a surface sends its albedo times all the light that arrives. Its hidden
// side receives the unoccluded light of that side times the ao of the visible side.
//
// The hidden part of a solid counts only if its front is within the radius: the endless side walls
// of far objects would raise the RMSE of ao on the ground of a closed room, against a path tracer,
// from 0.04 to 0.10. Method bitmask limits guessed depths by the radius instead (solid_within()).
//
// Surfaces that only other views show are a second set of triangles, in camera space because they
// may lie behind the camera. The light that they send is found by rays among all views
// (other_views/other_view_light.h).
//
// Rays start from the surface itself, whose normal comes from P (scene/normals/normals.h), in front
// of all triangles of the pixel (trace/ray_origin.h). Ray directions are distributed about the
// shading normal; rays below the surface count as blocked.
//
// Directions are points of Sobol's sequence, scrambled anew for every pixel (math/sobol.h). Their
// error falls about as n^-3/4 and is independent among neighbours: no filter is needed, and means
// over a frame are unbiased. Surfaces of the frame end at its border.
#include "estimators/trace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "estimators/guessed.h"
#include "estimators/microfacets.h"
#include "estimators/other_views/other_view_light.h"
#include "estimators/specular/mirror_model.h"
#include "estimators/trace/frame_occluders.h"
#include "estimators/trace/light_sums.h"
#include "estimators/trace/mirrored_sums.h"
#include "estimators/trace/ray_origin.h"
#include "estimators/trace/senders.h"
#include "math/frame.h"
#include "math/infinity.h"
#include "math/luminance.h"
#include "math/sampling.h"
#include "math/sobol.h"
#include "scene/light/light_group.h"
#include "scene/light/source.h"
#include "scene/normals/geometric_normal.h"
#include "scene/normals/normals.h"
#include "scene/pixel_footprint.h"
#include "scene/surfaces.h"

namespace ssdo {
namespace {

/// Seeds of the uses of a pixel's sequence.
constexpr std::uint32_t kSurfaceSeed = 0x51ab, kSourceSeed = 0x9c3d, kFacetSeed = 0x2f17;

/// A pixel that gathers light: where its rays start, and the normals that bound and weigh them.
struct Receiver {
  std::size_t pixel;
  glm::vec3 position;
  glm::dvec3 origin;          ///< in front of all triangles of the pixel
  glm::vec3 normal, surface;  ///< of shading; of the geometry
  glm::mat3 frame;            ///< about the shading normal
  std::uint32_t seed;
};

/// The method on one frame.
class Trace {
 public:
  Trace(const Scene& scene, const Request& request, const Progress& progress)
      : scene_(scene),
        request_(request),
        progress_(progress),
        samples_(int(request.parameters.at("samples"))),
        footprint_(scene.geometry.camera),
        occluders_(scene, request.radius) {}

  Products run() {
    const ProductSet& r = request_.products;
    wants_light_ = r.direct || r.bounce || r.specular || r.error;
    out_.ao = Plane<float>(width(), height(), 1.0f);
    if (request_.products.bent) out_.bent = Plane<glm::vec3>(width(), height(), glm::vec3(0));
    if (wants_light_) {
      out_.direct = Plane<glm::vec3>(width(), height(), glm::vec3(0));
      out_.visibility.are_ao = scene_.light.is_constant();
      if (!out_.visibility.are_ao) out_.visibility.sky = out_.direct;
      out_.visibility.sources.assign(scene_.light.sources.size(),
                                     Plane<float>(width(), height(), 0.0f));
    }
    if (request_.products.error) luminances_ = Plane<Groups>(width(), height(), Groups{});
    for_each_surface([&](std::size_t pixel, const Receiver& p) { gather_visibility(pixel, p); });
    if (request_.products.bounce) {
      out_.bounce = Plane<glm::vec3>(width(), height(), glm::vec3(0));
      senders_.push_back(senders_of(as_one_group(scene_.light)));
      if (request_.by_light.bounce) {
        for (LightGroup& light : light_groups_of(scene_.light))
          senders_.push_back(senders_of(std::move(light)));
        out_.lights.resize(senders_.size() - 1);
        for (LightProducts& light : out_.lights) light.bounce = out_.bounce;
      }
      for (int pass = 1; pass <= request_.bounces; ++pass) gather_bounce(pass);
    }
    if (request_.products.error) {
      out_.error = Plane<float>(width(), height());
      std::ranges::transform(luminances_.pixels, out_.error.pixels.begin(), standard_error);
    }
    if (request_.products.reflection || request_.products.specular) gather_reflections();
    if (request_.products.guessed)
      out_.guessed = guessed_shares(scene_, {0, 0, width(), height()}, request_.radius,
                                    request_.seed, progress_);
    return std::move(out_);
  }

 private:
  int width() const { return scene_.geometry.surfaces.width; }
  int height() const { return scene_.geometry.surfaces.height; }

  /// Whether an occluder in the frame or in another view, or the receiver's own surface, blocks a
  /// ray.
  bool is_blocked(const Receiver& p, const glm::vec3& to) const {
    return glm::dot(to, p.surface) <= 0 || occluders_.is_blocked({p.origin, to}, kInfinity);
  }

  /// The same for a ray to a point of a source, at `distance`.
  bool is_blocked(const Receiver& p, std::uint32_t source, const glm::vec3& to,
                  float distance) const {
    return glm::dot(to, p.surface) <= 0 || occluders_.is_blocked({p.origin, to}, distance, source);
  }

  int group_of(int sample) const { return sample * kGroups / samples_; }

  Receiver receiver(int x, int y, std::size_t pixel) const {
    const Geometry& g = scene_.geometry;
    const Surfel& s = g.surfaces[pixel];
    const glm::vec3 normal(s.normal), position(s.position),
        view = direction_to_viewer(position, g.camera.orthographic),
        surface = geometric_normal(g.surfaces, x, y, view);
    return {pixel,
            position,
            ray_origin(occluders_.solids(), s, {surface, view, footprint_.at(-position.z)}),
            normal,
            surface,
            frame_about(normal),
            hash_of(std::uint32_t(g.window.x0 - g.display.x0 + x),
                    std::uint32_t(g.window.y0 - g.display.y0 + y), request_.seed)};
  }

  /// Calls `work(pixel, receiver)` for each pixel that shows a surface.
  template <class Work>
  void for_each_surface(const Work& work) const {
    for_each_tile(
        width(), height(),
        [&](const Tile& tile) {
          for (int y = tile.y0; y < tile.y1; ++y) {
            for (int x = tile.x0; x < tile.x1; ++x) {
              const std::size_t pixel = scene_.geometry.surfaces.index(x, y);
              if (scene_.geometry.surfaces[pixel].is_usable()) work(pixel, receiver(x, y, pixel));
            }
          }
        },
        progress_);
  }

  static glm::vec3 direction(const Receiver& p, int sample) {
    return cosine_direction(p.frame, sobol_point(std::uint32_t(sample), p.seed ^ kSurfaceSeed));
  }

  void gather_visibility(std::size_t pixel, const Receiver& p) {
    LightSums light;
    glm::vec3 open_sum(0), sum(0);
    const glm::mat3 to_world = glm::transpose(scene_.geometry.world_to_camera);
    int open = 0;
    for (int s = 0; s < samples_; ++s) {
      const glm::vec3 to = direction(p, s);
      const bool is_open = !is_blocked(p, to);
      const int g = group_of(s);
      ++light.number[g];
      open += is_open, light.seen[g] += is_open;
      sum += to;
      if (is_open) open_sum += to;
      if (!wants_light_ || scene_.light.is_constant()) continue;
      const glm::vec3 radiance = scene_.light.sky.radiance(to_world * to);
      light.all[g] += radiance;
      if (is_open) light.open[g] += radiance;
    }
    const float ao = float(open) / float(samples_);
    out_.ao[pixel] = ao;
    if (request_.products.bent) {
      // The difference between the sum over all directions and its expectation, times ao, is added:
      // the bent normal of an open surface is then exact.
      const glm::vec3 bent = open_sum + ao * (2.0f / 3 * float(samples_) * p.normal - sum);
      const float length = glm::length(bent);
      out_.bent[pixel] = length > 0 ? bent / length : p.normal;
    }
    if (wants_light_) add_direct(pixel, p, light, ao);
  }

  void gather_reflections() {
    if (request_.products.reflection) out_.reflection = Plane<float>(width(), height(), 1.0f);
    if (request_.products.specular) {
      out_.visibility.mirror = std::make_shared<const MirrorModel>(scene_, request_);
      out_.specular = out_.visibility.mirrored_sky =
          Plane<glm::vec3>(width(), height(), glm::vec3(0));
      if (!scene_.senders.albedo.empty() || !scene_.senders.radiance.empty())
        find_senders(scene_, out_, out_.bounce.empty() ? out_.specular : out_.bounce,
                     mirrored_.emplace(TraceSenders{as_one_group(scene_.light), {}, {}, {}}));
    }
    for_each_surface([&](std::size_t pixel, const Receiver& p) { gather_reflection(pixel, p); });
  }

  /// What facets mirror, each weighted by the share of it that other facets do not hide.
  void gather_reflection(std::size_t pixel, const Receiver& p) {
    const float roughness = scene_.roughness.empty() ? float(request_.parameters.at("roughness"))
                                                     : scene_.roughness[pixel];
    const bool is_orthographic = scene_.geometry.camera.orthographic;
    const glm::vec3 viewer = direction_to_viewer(p.position, is_orthographic) * p.frame;
    const glm::mat3 to_world = glm::transpose(scene_.geometry.world_to_camera);
    MirroredSums sums;
    if (request_.products.specular) sums.f0 = out_.visibility.mirror->f0_at(scene_, pixel);
    for (int s = 0; s < samples_; ++s) {
      const FacetSample sample =
          mirror_at_facet(viewer, roughness, sobol_point(std::uint32_t(s), p.seed ^ kFacetSeed));
      if (sample.share <= 0) continue;
      const glm::vec3 to = p.frame * sample.to;
      const bool is_open = !is_blocked(p, to);
      sums.add_ray(sample, is_open);
      if (request_.products.specular)
        sums.add_light(sample, viewer, is_open, scene_.light.sky.radiance(to_world * to),
                       is_open ? glm::vec3(0) : sent_along(p, to));
    }
    if (request_.products.reflection) out_.reflection[pixel] = sums.share();
    if (!request_.products.specular) return;
    out_.visibility.mirrored_sky[pixel] = sums.share_of_sky();
    out_.specular[pixel] = sums.surfaces();
  }

  /// The radiance of the surface that a ray meets first; 0 if only other views show that surface.
  glm::vec3 sent_along(const Receiver& p, const glm::vec3& to) const {
    if (!mirrored_ || glm::dot(to, p.surface) <= 0) return {};
    const std::optional<SurfaceHit> met = occluders_.first_hit({p.origin, to});
    return met && !met->other_view ? mirrored_->sent_by(*met, 0) : glm::vec3(0);
  }

  void add_direct(std::size_t pixel, const Receiver& p, const LightSums& light, float ao) {
    const bool even = scene_.light.is_constant();
    const glm::vec3 unoccluded = scene_.light.unoccluded_sky(p.normal);
    const glm::vec3 share = even ? glm::vec3(ao) : light.share_of_all(ao);
    out_.direct[pixel] = unoccluded * share;
    if (!even) out_.visibility.sky[pixel] = share;
    Groups groups{};
    for (int g = 0; g < kGroups; ++g) groups[g] = luminance(unoccluded * light.share_of_group(g));
    for (std::size_t i = 0; i < scene_.light.sources.size(); ++i)
      out_.direct[pixel] += light_of(*scene_.light.sources[i], std::uint32_t(i), p, groups,
                                     out_.visibility.sources[i][pixel]);
    if (request_.products.error) luminances_[pixel] = groups;
  }

  /// The light of a source at a receiver. Its luminance in each group of samples is added to
  /// `groups`; `share` is the part of the light that arrives. Every point of the source counts by
  /// its own cosine. If the normal faces away, `share` is the visibility of the source's centre:
  /// the normal may come from a normal map, and filters use the share for neighbours.
  glm::vec3 light_of(const Source& source, std::uint32_t number, const Receiver& p, Groups& groups,
                     float& share) const {
    const glm::vec3 unoccluded =
        source.link_weight(p.pixel) * source.unoccluded(p.position, p.normal);
    if (unoccluded == glm::vec3(0)) {
      const SourceCone cone = source.cone(p.position);
      share = !is_blocked(p, number, cone.to, cone.distance);
      return unoccluded;
    }
    std::array<float, kGroups> seen{}, above{};
    for (int s = 0; s < samples_; ++s) {
      const SourcePoint point = source.sample(
          p.position, sobol_point(std::uint32_t(s), hash_of(p.seed, number, kSourceSeed)));
      const float light = point.weight * glm::dot(point.to, p.normal);
      if (light <= 0) continue;
      above[group_of(s)] += light;
      if (!is_blocked(p, number, point.to, point.distance)) seen[group_of(s)] += light;
    }
    float all_seen = 0, all_above = 0;
    for (int g = 0; g < kGroups; ++g) {
      all_seen += seen[g], all_above += above[g];
      groups[g] += luminance(unoccluded) * (above[g] > 0 ? seen[g] / above[g] : 0);
    }
    share = all_above > 0 ? all_seen / all_above : 0;
    return unoccluded * share;
  }

  TraceSenders senders_of(LightGroup light) const {
    TraceSenders senders{std::move(light), {}, {}, {}};
    if (occluders_.has_other_views() && request_.bounces > 0)
      senders.others =
          light_other_surfaces(scene_, senders.light, request_.bounces - 1, request_.radius);
    return senders;
  }

  /// The bounce plane of senders_[k].
  Plane<glm::vec3>& bounce_of(std::size_t k) {
    return k == 0 ? out_.bounce : out_.lights[k - 1].bounce;
  }

  /// One pass of bounces: the same rays gather all light together and each light apart.
  void gather_bounce(int pass) {
    const bool wants_error = pass == request_.bounces && request_.products.error;
    for (std::size_t k = 0; k < senders_.size(); ++k)
      find_senders(scene_, out_, bounce_of(k), senders_[k]);
    for_each_surface([&](std::size_t pixel, const Receiver& p) {
      std::array<glm::vec3, kGroups> sums{};
      std::array<int, kGroups> number{};
      for (std::size_t k = 1; k < senders_.size(); ++k) bounce_of(k)[pixel] = glm::vec3(0);
      for (int s = 0; s < samples_; ++s) {
        const glm::vec3 to = direction(p, s);
        ++number[group_of(s)];
        if (glm::dot(to, p.surface) <= 0) continue;
        const std::optional<SurfaceHit> met = occluders_.first_hit({p.origin, to});
        if (!met) continue;
        sums[group_of(s)] += senders_[0].sent_by(*met, pass);
        for (std::size_t k = 1; k < senders_.size(); ++k)
          bounce_of(k)[pixel] += senders_[k].sent_by(*met, pass) / float(samples_);
      }
      glm::vec3 sum(0);
      for (int g = 0; g < kGroups; ++g) {
        sum += sums[g];
        if (wants_error) luminances_[pixel][g] += luminance(sums[g]) / float(number[g]);
      }
      out_.bounce[pixel] = sum / float(samples_);
    });
  }

  const Scene& scene_;
  const Request& request_;
  const Progress& progress_;
  int samples_;
  PixelFootprint footprint_;
  FrameOccluders occluders_;
  std::vector<TraceSenders> senders_;     ///< of all light, then of each light apart
  std::optional<TraceSenders> mirrored_;  ///< of all light, for `specular`; none: nothing sends
  bool wants_light_ = false;
  Plane<Groups> luminances_;  ///< of direct + bounce
  Products out_;
};

Products trace(const Scene& scene, const Request& request, const Progress& progress) {
  return Trace(scene, request, progress).run();
}

}  // namespace

Method trace_method() {
  return {.name = "trace",
          .summary = "rays against the frame as thick solids: slow, the yardstick of the others",
          .products = {.ao = true,
                       .direct = true,
                       .bounce = true,
                       .specular = true,
                       .bent = true,
                       .reflection = true,
                       .error = true,
                       .guessed = true},
          .supports = {.radius = true, .infinite_radius = true, .thickness = true},
          .pattern_size = 1,
          .published_filter = {"none"},
          .parameters = {{"samples", 64, kGroups, 65536, "rays", "per pixel and bounce", true},
                         kRoughness,
                         kIndexOfRefraction},
          .samples_per_pixel = [](const Request& r) { return int(r.parameters.at("samples")); },
          .estimate = trace,
          .ladder = {.rungs = rungs_of("samples", {4, 16, 64}),
                     .limit = {{{"samples", 512}}},
                     .seeds = 2},
          .sample_cost = 30,
          .is_reference = true};
}

}  // namespace ssdo
