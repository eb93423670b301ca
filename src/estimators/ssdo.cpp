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
#include <array>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>

#include "estimators/view_space/half_ball.h"
#include "math/frame.h"
#include "math/light_range.h"
#include "scene/usable.h"

namespace ssdo {
namespace {

constexpr int kPatternSize = 4;
constexpr float kPi = glm::pi<float>();

struct Settings {
  int samples;
  float radius;
  float bias;         ///< scene units
  float singularity;  ///< scene units
  float strength;
  float bounce_strength;
  float bounce_singularity;  ///< F_max

  explicit Settings(const Request& request)
      : samples(int(request.parameters.at("samples"))),
        radius(request.radius),
        bias(float(request.parameters.at("bias")) * request.radius),
        singularity(float(request.parameters.at("singularity")) * request.radius),
        strength(float(request.parameters.at("strength"))),
        bounce_strength(float(request.parameters.at("bounce-strength"))),
        bounce_singularity(float(request.parameters.at("bounce-singularity"))) {}
};

/// The points of one member of the pattern, as arrays.
struct SampleSet {
  std::vector<float> x, y, cosine, length;

  explicit SampleSet(const std::vector<HalfBallSample>& samples) {
    for (const HalfBallSample& s : samples) {
      x.push_back(s.direction.x);
      y.push_back(s.direction.y);
      cosine.push_back(s.direction.z);
      length.push_back(s.length);
    }
  }
};

/// One pixel that gathers.
struct Receiver {
  glm::vec3 position, normal;
  glm::mat3 frame;
  const SampleSet& samples;
  float bias;
};

constexpr int kBatch = 16;

/// Some samples of a receiver after projection, as arrays that the compiler fills lane by lane.
struct Batch {
  int count;
  std::array<float, kBatch> direction_x, direction_y, direction_z;  ///< unit, camera space
  std::array<float, kBatch> x, y, z;                                ///< the points
  std::array<int, kBatch> pixel;  ///< index of the pixel that shows the point; -1 outside the frame

  glm::vec3 direction(int k) const {
    const auto i = std::size_t(k);
    return {direction_x[i], direction_y[i], direction_z[i]};
  }
  glm::vec3 point(int k) const {
    const auto i = std::size_t(k);
    return {x[i], y[i], z[i]};
  }
};

/// Places the samples of a pixel: both passes see the same points and the same surfaces.
class Sampler {
 public:
  Sampler(const Geometry& geometry, const Settings& settings, unsigned seed)
      : geometry_(geometry),
        settings_(settings),
        fx_(float(geometry.camera.fx)),
        fy_(float(geometry.camera.fy)),
        cx_(float(geometry.camera.cx - geometry.window.x0)),
        cy_(float(geometry.camera.cy - geometry.window.y0)),
        orthographic_(geometry.camera.orthographic) {
    for (const auto& samples : half_ball_pattern(kPatternSize, settings.samples, seed)) {
      pattern_.emplace_back(samples);
    }
  }

  Receiver receiver(int x, int y) const {
    const Surfel& s = geometry_.surfel(x, y);
    const glm::vec3 n(s.normal);
    // The pattern is fixed to the display window: a crop sees the same.
    const int row = (y + geometry_.window.y0 - geometry_.display.y0) & (kPatternSize - 1);
    const int column = (x + geometry_.window.x0 - geometry_.display.x0) & (kPatternSize - 1);
    return {glm::vec3(s.position), n, frame_about(n),
            pattern_[std::size_t(row * kPatternSize + column)], settings_.bias + s.normal.w};
  }

  /// Samples `first` to `first + kBatch` of the receiver, or as many as there are.
  void place(const Receiver& p, int first, Batch& out) const {
    out.count = std::min(kBatch, settings_.samples - first);
    const auto n = std::size_t(out.count), at = std::size_t(first);
    const float *sx = &p.samples.x[at], *sy = &p.samples.y[at], *sz = &p.samples.cosine[at];
    const float* length = &p.samples.length[at];
    const glm::mat3& f = p.frame;
    const float width = float(geometry_.surfel.width), height = float(geometry_.surfel.height);
    for (std::size_t k = 0; k < n; ++k) {
      out.direction_x[k] = f[0].x * sx[k] + f[1].x * sy[k] + f[2].x * sz[k];
      out.direction_y[k] = f[0].y * sx[k] + f[1].y * sy[k] + f[2].y * sz[k];
      out.direction_z[k] = f[0].z * sx[k] + f[1].z * sy[k] + f[2].z * sz[k];
      const float reach = settings_.radius * length[k];
      out.x[k] = p.position.x + reach * out.direction_x[k];
      out.y[k] = p.position.y + reach * out.direction_y[k];
      out.z[k] = p.position.z + reach * out.direction_z[k];
    }
    for (std::size_t k = 0; k < n; ++k) {
      const float w = orthographic_ ? 1.0f : -1.0f / out.z[k];
      const float column = cx_ + fx_ * out.x[k] * w, row = cy_ - fy_ * out.y[k] * w;
      const bool inside =
          (out.z[k] < 0) & (column >= 0) & (row >= 0) & (column < width) & (row < height);
      // Not evaluated as an index unless it is inside: a huge value has no int.
      const int px = int(inside ? column : 0.0f), py = int(inside ? row : 0.0f);
      out.pixel[k] = inside ? py * geometry_.surfel.width + px : -1;
    }
  }

  /// Whether the surface is in front of the point `x` by more than the bias and nearer to it than
  /// the singularity. The background is in front of nothing.
  bool is_in_front(const Surfel& s, const glm::vec3& x, float bias) const {
    const glm::vec3 to_x = x - glm::vec3(s.position);
    return (s.position.w != 0) & (glm::dot(to_x, glm::vec3(s.normal)) < -bias) &
           (std::abs(to_x.z) < settings_.singularity);
  }

 private:
  const Geometry& geometry_;
  const Settings& settings_;
  std::vector<SampleSet> pattern_;
  float fx_, fy_, cx_, cy_;
  bool orthographic_;
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
void gather_direct(const Scene& scene, const Settings& settings, const Sampler& sampler,
                   const Sky* sky, const Progress& progress, Products& out) {
  const auto work = [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const std::size_t i = out.ao.index(x, y);
        if (!is_usable(scene.geometry.surfel[i])) continue;
        const Receiver p = sampler.receiver(x, y);
        float visible = 0;
        glm::vec3 lit(0), light(0);
        Batch batch;
        for (int first = 0; first < settings.samples; first += kBatch) {
          sampler.place(p, first, batch);
          for (int k = 0; k < batch.count; ++k) {
            const int q = batch.pixel[std::size_t(k)];
            const bool hidden = q >= 0 && sampler.is_in_front(scene.geometry.surfel[std::size_t(q)],
                                                              batch.point(k), p.bias);
            const float cosine = p.samples.cosine[std::size_t(first + k)];
            const float share = hidden ? 1 - settings.strength : 1.0f;
            visible += share * cosine;
            if (!sky) continue;
            const glm::vec3 arriving = cosine * sky->radiance(batch.direction(k));
            light += arriving;
            lit += share * arriving;
          }
        }
        // 2 pi / N over pi; a strength above 1 takes more than there is.
        out.ao[i] = std::clamp(visible * 2.0f / float(settings.samples), 0.0f, 1.0f);
        if (out.direct.empty()) continue;
        out.direct[i] = sky ? share_of(lit, light) * sky->irradiance(p.normal)
                            : out.ao[i] * scene.light.environment.constant_radiance();
      }
    }
  };
  for_each_tile(out.ao.width, out.ao.height, work, progress);
}

/// Light that the surfaces around every pixel send on: `sent` is their radiance.
Plane<glm::vec3> gather_bounce(const Scene& scene, const Settings& settings, const Sampler& sampler,
                               const Progress& progress, const Plane<glm::vec3>& sent) {
  Plane<glm::vec3> bounce(sent.width, sent.height, glm::vec3(0));
  const float per_sample = settings.bounce_strength * 2.0f / float(settings.samples);
  const float radius2 = settings.radius * settings.radius;
  const auto work = [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const std::size_t i = bounce.index(x, y);
        if (!is_usable(scene.geometry.surfel[i])) continue;
        const Receiver p = sampler.receiver(x, y);
        glm::vec3 sum(0);
        Batch batch;
        for (int first = 0; first < settings.samples; first += kBatch) {
          sampler.place(p, first, batch);
          for (int k = 0; k < batch.count; ++k) {
            const int q = batch.pixel[std::size_t(k)];
            if (q < 0) continue;
            const Surfel& sender = scene.geometry.surfel[std::size_t(q)];
            const glm::vec3 to_q = glm::vec3(sender.position) - p.position;
            const float d2 = std::max(glm::dot(to_q, to_q), 1e-20f);
            const float cos_p = std::max(0.0f, glm::dot(to_q, p.normal));
            const float cos_q = std::max(0.0f, -glm::dot(to_q, glm::vec3(sender.normal)));
            // The cosines still carry the length of to_q.
            const float form_factor = radius2 * cos_p * cos_q / (d2 * d2);
            if (form_factor > 0)  // a broken position has none
              sum += std::min(form_factor, settings.bounce_singularity) * sent[std::size_t(q)];
          }
        }
        bounce[i] = sum * per_sample;
      }
    }
  };
  for_each_tile(bounce.width, bounce.height, work, progress);
  return bounce;
}

/// What every pixel sends: its albedo times all the light that arrives, or the layer that says so.
Plane<glm::vec3> sender_radiance(const Scene& scene, const Products& so_far) {
  Plane<glm::vec3> sent(so_far.ao.width, so_far.ao.height, glm::vec3(0));
  for (std::size_t i = 0; i < sent.size(); ++i) {
    sent[i] = within_range(scene.senders.radiance.empty()
                               ? scene.senders.albedo[i] * (so_far.direct[i] + so_far.bounce[i])
                               : scene.senders.radiance[i]);
  }
  return sent;
}

Products estimate(const Scene& scene, const Request& request, const Progress& progress) {
  const Settings settings(request);
  const Sampler sampler(scene.geometry, settings, request.seed);
  const int width = scene.geometry.surfel.width, height = scene.geometry.surfel.height;

  Products out;
  out.ao = Plane<float>(width, height, 1.0f);
  if (request.products.direct || request.products.bounce)
    out.direct = Plane<glm::vec3>(width, height, glm::vec3(0));
  std::optional<Sky> sky;
  if (!out.direct.empty() && !scene.light.environment.is_constant()) {
    sky.emplace(scene.light.environment, settings.samples, scene.geometry.world_to_camera);
  }
  gather_direct(scene, settings, sampler, sky ? &*sky : nullptr, progress, out);
  if (request.products.bounce) out.bounce = Plane<glm::vec3>(width, height, glm::vec3(0));
  for (int pass = 0; request.products.bounce && pass < request.bounces; ++pass) {
    out.bounce = gather_bounce(scene, settings, sampler, progress, sender_radiance(scene, out));
  }
  return out;
}

}  // namespace

Method ssdo_method() {
  return {
      .name = "ssdo",
      .summary = "directional occlusion and one bounce, Ritschel et al. 2009",
      .products = {.ao = true, .direct = true, .bounce = true},
      .takes = {.radius = true},
      .pattern_size = kPatternSize,
      .parameters =
          {
              {"samples", 16, 1, 1024, "", "points per pixel", true},
              {"bias", 0.001, 0, 1, "radii", "how far in front of a point a surface has to be"},
              {"singularity", 1, 0, 100, "radii",
               "surfaces farther in front than this do not occlude"},
              {"strength", 1, 0, 10, "", "how much an occluder takes away"},
              {"bounce-strength", 1, 0, 100, "", "gain of the bounce"},
              {"bounce-singularity", 1, 0, 1e6, "", "largest form factor of a sample"},
          },
      .samples_per_pixel = [](const Request& r) { return int(r.parameters.at("samples")); },
      .estimate = estimate,
      .ladder = {.rungs = rungs_of("samples", {8, 16, 32, 64, 128}),
                 .limit = {{{"samples", 512}}},
                 .seeds = 4},
  };
}

}  // namespace ssdo
