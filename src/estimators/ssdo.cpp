// SPDX-License-Identifier: Apache-2.0
//
// Screen-space directional occlusion: Ritschel, Grosch, Seidel, "Approximating Dynamic Global
// Illumination in Image Space", I3D 2009, in the form of their chapter in GPU Pro (2010).
//
//   direct(p) = 1/pi * 2 pi/N * sum_i V_i L(w_i) (n.w_i)        over N points x_i = p + R l_i w_i,
//   bounce(p) = 1/pi * 2 pi/N * sum_i L_s(q_i) min(F_i, F_max)  uniform in the half-ball about n
//
// q_i is the surface in the pixel that x_i projects to. V_i is 0 where that surface is in front of
// x_i, nearer than the singularity. F_i = R^2 cos_p cos_q / d^2 is the form factor of q_i; every
// sample sends, hidden or not, as in the listing.
//
// What differs, and why:
// - "In front" is asked of the tangent plane of q, not of the depth at its pixel's centre: on a
//   tilted plane the depth differs within a pixel by more than any bias would forgive.
// - The bias is a share of the radius plus what the precision of P demands, not a constant.
// - F has the factor R^2, the area that the samples stand for: the bounce and its clamp then do not
//   depend on the unit of the scene.
// - The environment is averaged over the solid angle of a sample, 2 pi / N, and looked up in an
//   octahedral map: the listing's "blurred map" without its pole.
// - direct is the ratio of the sum over visible samples to the sum over all, times the exact
//   irradiance of the environment on n. What N directions make of a sun differs from pixel to pixel
//   of the pattern, and on curved surfaces no filter averages it away; in the ratio it cancels.
//
// Known fault, kept: a point is tested, not the ray to it. What lies between p and x_i is missed
// and what hides x_i from the eye alone counts, so that the result is biased even when converged.
#include "estimators/ssdo.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>

#include "estimators/half_ball.h"
#include "math/frame.h"

namespace ssdo {
namespace {

constexpr int kPatternSize = 4;
constexpr float kPi = glm::pi<float>();

using Pattern = std::vector<std::vector<HalfBallSample>>;

struct Settings {
  int samples;
  float radius;
  float bias;         ///< scene units
  float singularity;  ///< scene units
  float strength;
  float bounce_strength;
  float bounce_singularity;  ///< F_max

  explicit Settings(const EstimateInput& in)
      : samples(int(in.parameters.at("samples"))),
        radius(in.radius),
        bias(float(in.parameters.at("bias")) * in.radius),
        singularity(float(in.parameters.at("singularity")) * in.radius),
        strength(float(in.parameters.at("strength"))),
        bounce_strength(float(in.parameters.at("bounce-strength"))),
        bounce_singularity(float(in.parameters.at("bounce-singularity"))) {}
};

/// Camera space to the pixels of a plane, in float.
struct Projection {
  float fx, fy, cx, cy;
  bool orthographic;

  explicit Projection(const Geometry& g)
      : fx(float(g.camera.fx)),
        fy(float(g.camera.fy)),
        cx(float(g.camera.cx - g.window.x0)),
        cy(float(g.camera.cy - g.window.y0)),
        orthographic(g.camera.orthographic) {}

  glm::vec2 operator()(const glm::vec3& p) const {
    const float w = orthographic ? 1.0f : 1.0f / -p.z;
    return {cx + fx * p.x * w, cy - fy * p.y * w};
  }
};

/// One pixel that gathers, and how to place its samples.
struct Receiver {
  glm::vec3 position, normal;
  glm::mat3 frame;
  const std::vector<HalfBallSample>& samples;
  float bias;
};

/// Walks the samples of a pixel: both passes see the same points and the same surfaces.
class Sampler {
 public:
  Sampler(const Geometry& geometry, const Settings& settings, const Pattern& pattern)
      : geometry_(geometry), settings_(settings), pattern_(pattern), project_(geometry) {}

  Receiver receiver(int x, int y) const {
    const std::size_t i = geometry_.position.index(x, y);
    const glm::vec4 n = geometry_.normal[i];
    // The pattern is fixed to the display window: a crop sees the same.
    const int row = (y + geometry_.window.y0) & (kPatternSize - 1);
    const int column = (x + geometry_.window.x0) & (kPatternSize - 1);
    return {glm::vec3(geometry_.position[i]), glm::vec3(n), frame_about(glm::vec3(n)),
            pattern_[std::size_t(row * kPatternSize + column)], settings_.bias + n.w};
  }

  /// The pixel that hides the point `x` from the eye or lies behind it; -1 outside the frame, on
  /// the background and behind the camera.
  std::ptrdiff_t pixel_of(const glm::vec3& x) const {
    if (x.z >= 0) return -1;
    const glm::vec2 at = project_(x);
    if (!(at.x >= 0 && at.y >= 0 && at.x < float(geometry_.position.width) &&
          at.y < float(geometry_.position.height))) {
      return -1;
    }
    const std::size_t i = geometry_.position.index(int(at.x), int(at.y));
    return geometry_.is_surface(i) ? std::ptrdiff_t(i) : -1;
  }

  /// Whether the surface at pixel `i` is in front of `x` by more than the bias and nearer to it
  /// than the singularity.
  bool is_occluded(const glm::vec3& x, std::size_t i, float bias) const {
    const glm::vec3 to_x = x - glm::vec3(geometry_.position[i]);
    return glm::dot(to_x, glm::vec3(geometry_.normal[i])) < -bias &&
           std::abs(to_x.z) < settings_.singularity;
  }

 private:
  const Geometry& geometry_;
  const Settings& settings_;
  const Pattern& pattern_;
  Projection project_;
};

/// The environment as the samples see it, for directions in camera space.
struct Sky {
  OctahedralMap radiance;    ///< averaged over the solid angle of a sample
  OctahedralMap irradiance;  ///< over pi, on a surface with the normal that is looked up

  Sky(const Environment& environment, int samples, const glm::mat3& world_to_camera)
      : radiance(environment.blurred(2 * kPi / float(samples), world_to_camera)),
        irradiance(environment.blurred(kPi, world_to_camera)) {}
};

/// part / whole for each colour; nothing of nothing is nothing.
glm::vec3 share_of(const glm::vec3& part, const glm::vec3& whole) {
  glm::vec3 share(0);
  for (int c = 0; c < 3; ++c) share[c] = whole[c] > 0 ? std::max(part[c], 0.0f) / whole[c] : 0.0f;
  return share;
}

/// Visibility of every sample against the environment.
void gather_direct(const EstimateInput& in, const Settings& settings, const Sampler& sampler,
                   const Sky* sky, Products& out) {
  const auto work = [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const std::size_t i = out.ao.index(x, y);
        if (!in.geometry.is_surface(i)) continue;
        const Receiver p = sampler.receiver(x, y);
        float visible = 0;
        glm::vec3 lit(0), light(0);
        for (const HalfBallSample& sample : p.samples) {
          const glm::vec3 direction = p.frame * sample.direction;
          const glm::vec3 point = p.position + settings.radius * sample.length * direction;
          const std::ptrdiff_t q = sampler.pixel_of(point);
          const bool hidden = q >= 0 && sampler.is_occluded(point, std::size_t(q), p.bias);
          const float share = hidden ? 1 - settings.strength : 1.0f;
          visible += share * sample.direction.z;
          if (!sky) continue;
          const glm::vec3 arriving = sample.direction.z * sky->radiance(direction);
          light += arriving;
          lit += share * arriving;
        }
        // 2 pi / N over pi; a strength above 1 takes more than there is.
        out.ao[i] = std::clamp(visible * 2.0f / float(settings.samples), 0.0f, 1.0f);
        if (out.direct.empty()) continue;
        out.direct[i] = sky ? share_of(lit, light) * sky->irradiance(p.normal)
                            : out.ao[i] * in.environment.constant_radiance();
      }
    }
  };
  for_each_tile(out.ao.width, out.ao.height, work, in.progress);
}

/// Light that the surfaces around every pixel send on: `sent` is their radiance.
Plane<glm::vec3> gather_bounce(const EstimateInput& in, const Settings& settings,
                               const Sampler& sampler, const Plane<glm::vec3>& sent) {
  Plane<glm::vec3> bounce(sent.width, sent.height, glm::vec3(0));
  const float per_sample = settings.bounce_strength * 2.0f / float(settings.samples);
  const float radius2 = settings.radius * settings.radius;
  const auto work = [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const std::size_t i = bounce.index(x, y);
        if (!in.geometry.is_surface(i)) continue;
        const Receiver p = sampler.receiver(x, y);
        glm::vec3 sum(0);
        for (const HalfBallSample& sample : p.samples) {
          const glm::vec3 point =
              p.position + settings.radius * sample.length * (p.frame * sample.direction);
          const std::ptrdiff_t q = sampler.pixel_of(point);
          if (q < 0) continue;
          const glm::vec3 to_q = glm::vec3(in.geometry.position[std::size_t(q)]) - p.position;
          const float d2 = std::max(glm::dot(to_q, to_q), 1e-20f);
          const float cos_p = std::max(0.0f, glm::dot(to_q, p.normal));
          const float cos_q =
              std::max(0.0f, -glm::dot(to_q, glm::vec3(in.geometry.normal[std::size_t(q)])));
          // The cosines still carry the length of to_q.
          const float form_factor = radius2 * cos_p * cos_q / (d2 * d2);
          sum += std::min(form_factor, settings.bounce_singularity) * sent[std::size_t(q)];
        }
        bounce[i] = sum * per_sample;
      }
    }
  };
  for_each_tile(bounce.width, bounce.height, work, in.progress);
  return bounce;
}

/// What every pixel sends: its albedo times all the light that arrives, or the layer that says so.
Plane<glm::vec3> sender_radiance(const EstimateInput& in, const Products& so_far) {
  if (!in.radiance.empty()) return in.radiance;
  Plane<glm::vec3> sent(so_far.ao.width, so_far.ao.height, glm::vec3(0));
  for (std::size_t i = 0; i < sent.size(); ++i) {
    sent[i] = in.albedo[i] * (so_far.direct[i] + so_far.bounce[i]);
  }
  return sent;
}

Products estimate(const EstimateInput& in) {
  const Settings settings(in);
  const Pattern pattern = half_ball_pattern(kPatternSize, settings.samples, in.seed);
  const Sampler sampler(in.geometry, settings, pattern);
  const int width = in.geometry.position.width, height = in.geometry.position.height;

  Products out;
  out.ao = Plane<float>(width, height, 1.0f);
  if (in.products.direct || in.products.bounce)
    out.direct = Plane<glm::vec3>(width, height, glm::vec3(0));
  std::optional<Sky> sky;
  if (!out.direct.empty() && !in.environment.is_constant()) {
    sky.emplace(in.environment, settings.samples, in.geometry.world_to_camera);
  }
  gather_direct(in, settings, sampler, sky ? &*sky : nullptr, out);
  if (in.products.bounce) out.bounce = Plane<glm::vec3>(width, height, glm::vec3(0));
  for (int pass = 0; in.products.bounce && pass < in.bounces; ++pass) {
    out.bounce = gather_bounce(in, settings, sampler, sender_radiance(in, out));
  }
  return out;
}

}  // namespace

Method ssdo_method() {
  return {
      "ssdo",
      "directional occlusion and one bounce, Ritschel et al. 2009",
      {.ao = true, .direct = true, .bounce = true},
      kPatternSize,
      {
          {"samples", 16, 1, 1024, "", "points per pixel", true},
          {"bias", 0.001, 0, 1, "radii", "how far in front of a point a surface has to be", false},
          {"singularity", 1, 0, 100, "radii", "surfaces farther in front than this do not occlude",
           false},
          {"strength", 1, 0, 10, "", "how much an occluder takes away", false},
          {"bounce-strength", 1, 0, 100, "", "gain of the bounce", false},
          {"bounce-singularity", 1, 0, 1e6, "", "largest form factor of a sample", false},
      },
      [](const ParameterValues& p) { return int(p.at("samples")); },
      estimate,
  };
}

}  // namespace ssdo
