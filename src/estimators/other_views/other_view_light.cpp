// SPDX-License-Identifier: Apache-2.0
//
// The light of method trace (see trace.cpp) at the vertices of other views, in few samples: a
// bounce averages over many of them.
#include "estimators/other_views/other_view_light.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "estimators/other_views/other_view_rays.h"
#include "math/frame.h"
#include "math/light_range.h"
#include "math/sampling.h"
#include "math/sobol.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr int kRays = 16, kSourceRays = 4;

/// Vertices that one task works on.
constexpr int kBand = 1024;

/// Rays begin this many footprints above their surface: on a curved surface, neighbouring triangles
/// rise above the start by less.
constexpr float kAbove = 0.3f;

constexpr std::uint32_t kSurfaceSeed = 0x3c91, kSourceSeed = 0x77e5;

/// The surfaces of other views as senders: their direct light and bounces, found by rays.
class OtherViewSenders {
 public:
  OtherViewSenders(const Scene& scene, const LightGroup& light, float radius)
      : surfaces_(scene.other_surfaces),
        light_(light.light),
        numbers_(light.source_indices),
        to_world_(glm::transpose(scene.geometry.world_to_camera)),
        radius_(radius),
        rays_(surfaces_.vertices, surfaces_.all) {}

  std::vector<OtherViewLight> run(int bounces) {
    const std::size_t count = surfaces_.vertices.size();
    find_senders(bounces > 0);
    OtherViewLight direct = dark(count), bounce = direct;
    for_each_side([&](std::size_t i, const Side& side, bool seen) {
      of(direct, seen)[i] = direct_light(side);
    });
    std::vector<OtherViewLight> passes;
    for (int pass = 0;; ++pass) {
      OtherViewLight out = dark(count);
      for_each_side([&](std::size_t i, const Side&, bool seen) {
        const glm::vec3 light = of(direct, seen)[i] + of(bounce, seen)[i];
        of(out, seen)[i] = within_range(surfaces_.vertices[i].albedo * light);
      });
      passes.push_back(std::move(out));
      if (pass >= bounces) return passes;
      OtherViewLight next = dark(count);
      for_each_side([&](std::size_t i, const Side& side, bool seen) {
        of(next, seen)[i] = bounced_light(side, passes.back());
      });
      bounce = std::move(next);
    }
  }

 private:
  /// One side of a surface, and where its rays begin.
  struct Side {
    std::uint32_t vertex;
    glm::vec3 start, normal;
    std::uint32_t seed;
  };

  static OtherViewLight dark(std::size_t count) {
    return {std::vector<glm::vec3>(count, glm::vec3(0)),
            std::vector<glm::vec3>(count, glm::vec3(0))};
  }
  static std::vector<glm::vec3>& of(OtherViewLight& light, bool seen) {
    return seen ? light.seen : light.unseen;
  }

  /// The vertices that send light to the frame; with `all`, also those that send to other vertices.
  void find_senders(bool all) {
    std::vector<bool> sends(surfaces_.vertices.size(), false);
    for (const auto& triangle : all ? surfaces_.all : surfaces_.added)
      for (const std::uint32_t corner : triangle) sends[surfaces_.vertices[corner].sender] = true;
    for (std::size_t i = 0; i < sends.size(); ++i)
      if (sends[i]) senders_.push_back(std::uint32_t(i));
  }

  /// Calls `work(vertex, side, whether it is the one that is seen)`. Surfaces are taken for thin:
  /// the other side is lit by the light that arrives there.
  template <class Work>
  void for_each_side(const Work& work) const {
    const int count = int(senders_.size());
    for_each_row((count + kBand - 1) / kBand, [&](int band) {
      for (int k = band * kBand; k < std::min(count, (band + 1) * kBand); ++k) {
        const std::uint32_t i = senders_[std::size_t(k)];
        const Vertex& v = surfaces_.vertices[i];
        for (const bool seen : {true, false}) {
          const glm::vec3 normal = seen ? v.normal : -v.normal;
          work(i, Side{i, v.position + kAbove * v.footprint * normal, normal, 2 * i + seen}, seen);
        }
      }
    });
  }

  static glm::vec3 direction(const glm::mat3& frame, int sample, std::uint32_t seed) {
    return cosine_direction(frame,
                            sobol_point(std::uint32_t(sample), hash_of(seed, 0, kSurfaceSeed)));
  }

  glm::vec3 direct_light(const Side& side) const {
    const glm::mat3 frame = frame_about(side.normal);
    const bool even = light_.is_constant();
    glm::vec3 part(0), whole(0);
    int open = 0;
    for (int s = 0; s < kRays; ++s) {
      const glm::vec3 to = direction(frame, s, side.seed);
      const bool is_open = !rays_.is_blocked(side.start, to, radius_);
      open += is_open;
      if (even) continue;
      const glm::vec3 radiance = light_.sky.radiance(to_world_ * to);
      whole += radiance;
      if (is_open) part += radiance;
    }
    glm::vec3 share(float(open) / kRays);
    for (int c = 0; c < 3; ++c)
      if (whole[c] > 0) share[c] = part[c] / whole[c];
    glm::vec3 direct = light_.unoccluded_sky(side.normal) * share;
    for (std::size_t i = 0; i < light_.sources.size(); ++i)
      direct += light_of(*light_.sources[i], std::uint32_t(numbers_[i]), side);
    return direct;
  }

  /// The share of a source's unoccluded light that a vertex receives. A vertex of a view that does
  /// not know the source's selection receives nothing.
  float taken_by(const Source& source, std::uint32_t vertex) const {
    if (!source.receivers) return 1;
    const std::uint32_t pixel = surfaces_.vertices[vertex].frame_pixel;
    if (pixel != Vertex::kOfOtherView) return source.link_weight(pixel);
    const auto found = surfaces_.receives.find(source.receive);
    return found == surfaces_.receives.end() ? 0.0f : found->second[vertex];
  }

  glm::vec3 light_of(const Source& source, std::uint32_t number, const Side& side) const {
    const glm::vec3 unoccluded =
        taken_by(source, side.vertex) * source.unoccluded(side.start, side.normal);
    if (unoccluded == glm::vec3(0)) return unoccluded;
    float seen = 0, above = 0;
    for (int s = 0; s < kSourceRays; ++s) {
      const SourcePoint point = source.sample(
          side.start, sobol_point(std::uint32_t(s), hash_of(side.seed, number, kSourceSeed)));
      const float light = point.weight * std::max(0.0f, glm::dot(point.to, side.normal));
      above += light;
      const float reach = std::min(point.distance, radius_);
      if (light > 0 && !rays_.is_blocked(side.start, point.to, reach)) seen += light;
    }
    return above > 0 ? unoccluded * (seen / above) : glm::vec3(0);
  }

  glm::vec3 bounced_light(const Side& side, const OtherViewLight& sent) const {
    const glm::mat3 frame = frame_about(side.normal);
    glm::vec3 sum(0);
    for (int s = 0; s < kRays; ++s) {
      const auto hit = rays_.first_hit(side.start, direction(frame, s, side.seed), radius_);
      if (hit.sender < 0) continue;
      sum += (hit.unseen ? sent.unseen : sent.seen)[std::size_t(hit.sender)];
    }
    return sum / float(kRays);
  }

  const OtherSurfaces& surfaces_;
  const Light& light_;
  const std::vector<std::size_t>& numbers_;  ///< by which rays to a source are chosen
  glm::mat3 to_world_;
  float radius_;
  OtherViewRays rays_;
  std::vector<std::uint32_t> senders_;
};

}  // namespace

std::vector<OtherViewLight> light_other_surfaces(const Scene& scene, const LightGroup& light,
                                                 int bounces, float radius) {
  return OtherViewSenders(scene, light, radius).run(bounces);
}

}  // namespace ssdo
