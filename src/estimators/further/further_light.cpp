// SPDX-License-Identifier: Apache-2.0
//
// The light of method trace (see trace.cpp) at the vertices of further views, in few samples: a
// bounce averages over many of them.
#include "estimators/further/further_light.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>

#include "estimators/further/further_rays.h"
#include "math/frame.h"
#include "math/light_range.h"
#include "math/sobol.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr int kRays = 16, kSunRays = 4;

/// Vertices that one task works on.
constexpr int kBand = 1024;

/// Rays begin so many footprints above their surface: neighbouring triangles of a rounded surface
/// lie above it by less.
constexpr float kAbove = 0.3f;

constexpr std::uint32_t kSurfaceSeed = 0x3c91, kSunSeed = 0x77e5;

class Lamps {
 public:
  Lamps(const Scene& scene, float radius)
      : surfaces_(scene.further),
        light_(scene.light),
        to_world_(glm::transpose(scene.geometry.world_to_camera)),
        radius_(radius),
        rays_(surfaces_.vertices, surfaces_.all) {}

  std::vector<FurtherLight> run(int bounces) {
    const std::size_t count = surfaces_.vertices.size();
    std::vector<glm::vec3> direct(count), bounce(count, glm::vec3(0)), next;
    std::vector<float> open(count);
    find_senders(bounces > 0);
    for_each([&](std::size_t i) { direct[i] = direct_light(i, open[i]); });
    std::vector<FurtherLight> passes;
    for (int pass = 0;; ++pass) {
      FurtherLight& out = passes.emplace_back();
      out.seen.resize(count), out.unseen.resize(count);
      for_each([&](std::size_t i) {
        const Vertex& v = surfaces_.vertices[i];
        out.seen[i] = within_range(v.albedo * (direct[i] + bounce[i]));
        // As in method trace: the other side has its own light, as far as this one is open.
        out.unseen[i] =
            within_range(v.albedo * (open[i] * light_.unoccluded(-v.normal) + bounce[i]));
      });
      if (pass >= bounces) return passes;
      next = bounce;
      for_each([&](std::size_t i) { next[i] = bounced_light(i, out); });
      bounce = next;
    }
  }

 private:
  /// The vertices that send light to the frame; to each other as well, where light goes on.
  void find_senders(bool all) {
    std::vector<bool> sends(surfaces_.vertices.size(), false);
    for (const auto& triangle : all ? surfaces_.all : surfaces_.added)
      for (const std::uint32_t corner : triangle) sends[surfaces_.vertices[corner].sender] = true;
    for (std::size_t i = 0; i < sends.size(); ++i)
      if (sends[i]) senders_.push_back(std::uint32_t(i));
  }

  template <class Work>
  void for_each(const Work& work) const {
    const int count = int(senders_.size());
    for_each_row((count + kBand - 1) / kBand, [&](int band) {
      for (int k = band * kBand; k < std::min(count, (band + 1) * kBand); ++k)
        work(std::size_t(senders_[std::size_t(k)]));
    });
  }

  static glm::vec3 start(const Vertex& v) { return v.position + kAbove * v.footprint * v.normal; }

  static glm::vec3 direction(const glm::mat3& frame, int sample, std::size_t vertex) {
    const glm::vec2 u =
        sobol_point(std::uint32_t(sample), hash_of(std::uint32_t(vertex), 0, kSurfaceSeed));
    const float r = std::sqrt(u.x), azimuth = 2 * glm::pi<float>() * u.y;
    return frame * glm::vec3(r * std::cos(azimuth), r * std::sin(azimuth), std::sqrt(1 - u.x));
  }

  glm::vec3 direct_light(std::size_t vertex, float& open) const {
    const Vertex& v = surfaces_.vertices[vertex];
    const glm::mat3 frame = frame_about(v.normal);
    const bool even = light_.is_constant();
    glm::vec3 part(0), whole(0);
    int seen = 0;
    for (int s = 0; s < kRays; ++s) {
      const glm::vec3 to = direction(frame, s, vertex);
      const bool is_open = !rays_.is_blocked(start(v), to, radius_);
      seen += is_open;
      if (even) continue;
      const glm::vec3 radiance = light_.sky.radiance(to_world_ * to);
      whole += radiance;
      if (is_open) part += radiance;
    }
    open = float(seen) / kRays;
    if (even) return open * light_.environment.constant_radiance();
    glm::vec3 share(open);
    for (int c = 0; c < 3; ++c)
      if (whole[c] > 0) share[c] = part[c] / whole[c];
    glm::vec3 direct = light_.irradiance(v.normal) * share;
    for (std::size_t i = 0; i < light_.suns.size(); ++i)
      direct += sunlight(light_.suns[i], std::uint32_t(i), v, vertex);
    return direct;
  }

  glm::vec3 sunlight(const Sun& sun, std::uint32_t number, const Vertex& v,
                     std::size_t vertex) const {
    const float cosine = glm::dot(v.normal, sun.direction);
    if (cosine <= 0) return glm::vec3(0);
    const glm::mat3 frame = frame_about(sun.direction);
    int seen = 0;
    for (int s = 0; s < kSunRays; ++s) {
      const glm::vec2 u =
          sobol_point(std::uint32_t(s), hash_of(std::uint32_t(vertex), number, kSunSeed));
      const float off = sun.angular_radius * std::sqrt(u.x), azimuth = 2 * glm::pi<float>() * u.y;
      const glm::vec3 to =
          glm::normalize(frame * glm::vec3(off * std::cos(azimuth), off * std::sin(azimuth), 1));
      seen += !rays_.is_blocked(start(v), to, radius_);
    }
    return cosine * sun.irradiance * (float(seen) / kSunRays);
  }

  glm::vec3 bounced_light(std::size_t vertex, const FurtherLight& sent) const {
    const Vertex& v = surfaces_.vertices[vertex];
    const glm::mat3 frame = frame_about(v.normal);
    glm::vec3 sum(0);
    for (int s = 0; s < kRays; ++s) {
      const auto hit = rays_.first_hit(start(v), direction(frame, s, vertex), radius_);
      if (hit.sender < 0) continue;
      sum += (hit.unseen ? sent.unseen : sent.seen)[std::size_t(hit.sender)];
    }
    return sum / float(kRays);
  }

  const FurtherSurfaces& surfaces_;
  const Light& light_;
  glm::mat3 to_world_;
  float radius_;
  FurtherRays rays_;
  std::vector<std::uint32_t> senders_;
};

}  // namespace

std::vector<FurtherLight> light_further_surfaces(const Scene& scene, int bounces, float radius) {
  return Lamps(scene, radius).run(bounces);
}

}  // namespace ssdo
