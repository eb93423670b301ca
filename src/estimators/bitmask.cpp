// SPDX-License-Identifier: Apache-2.0
//
// Slices with a visibility bitmask: the horizon slices of GTAO (Jimenez, Wu, Pesce, Jarabo 2016,
// Practical Real-Time Strategies for Accurate Indirect Occlusion) with the bitmask of Therrien,
// Levesque and Gilet (2023, Screen Space Indirect Lighting with Visibility Bitmask).
//
// A slice is a plane through the view ray; its two halves are marched over the frame. In the half
// along T, a unit vector perpendicular to V, a direction at angle t from V has the cosine
// n_v cos t + n_t sin t to the normal and, as slices turn about V, the measure |sin t| dt:
//
//   M(S) = int_S (n_v c + n_t s) dc,   c = cos t, s = sin t
//
// 32 sectors divide a half equally in c, which is in solid angle. What is seen in a pixel hides
// those between its front and its back, which lies behind it on its own view ray; a mask gathers
// them near to far. Then
//
//   ao      = 1 - sum w M(hidden) / sum w M(all)               over the halves of all slices
//   direct  = E(N)/pi * (1 - sum w int_hidden L dM / sum w int_all L dM)    channel by channel
//   bounce  = (1 - ao) * sum w sum_q M(newly hidden by q) L_out(q) / sum w M(hidden)
//
// What differs from the sources, and why:
// - w = 1 / |T~|^2, T~ the part of the slice's picture direction that is perpendicular to V. Slices
//   that are uniform in the picture are not uniform around V off the optical axis: without w a true
//   0.5 reads from 0.41 to 0.60 at 45 degrees.
// - Sums are divided by what they are for an open surface, so that this reads exactly 1.
// - Sectors of equal angle that count alike read a pit of 0.75 as 0.38 when seen from the side.
//   Here they count by the integral of the cosine over them. Equal steps of c are cheap to find
//   (no arc function) and the same for all pixels, so that moments of masks come from tables
//   (slice_sectors.cpp). The point that stands for a sector differs from slice to slice, or a
//   gentle curve would show the sectors as bands.
// - direct is a ratio to the exact unoccluded irradiance E(N): the noise of a few directions
//   cancels. L is taken in spherical harmonics, of the environment without its suns; each sun is a
//   direction of its own, tested along the slice that holds it (bitmask_sun.cpp).
// - bounce takes the radiance of the first surface in each sector; no 1/d^2, so no singularity. The
//   side of a surface that is not seen has the light of its own side, as far as the seen one is
//   open. That senders which face away send nothing, as in the sources, left five of seven frames
//   too dark by a fifth and more.
// - What a pixel shows counts for the stretch of the way up to those that are seen before and after
//   it (bitmask_side-inl.h). Taken for points, few steps see too little: 16 that count for their
//   stretches are nearer to the limit than 24 points.
// - Backs, surfaces behind what covers them (hidden_geometry.cpp) and beyond the frame
//   (bitmask_extension-inl.h) are guesses that GTAO does not make.
#include "estimators/bitmask.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <optional>

#include "estimators/bitmask_march.h"
#include "math/frame.h"
#include "math/light_range.h"
#include "math/luminance.h"
#include "math/sequence_numbers.h"
#include "parallel/isa.h"
#include "scene/light_model.h"

namespace ssdo {
namespace {

constexpr int kPeriod = Interleaving::kPeriod;

/// Light that bounces is a small part of all light on most surfaces: with two thirds of the steps
/// it adds less noise than direct light has. Measured on seven frames.
constexpr int bounce_steps(int steps) { return (2 * steps + 2) / 3; }

/// A shadow's edge shows single steps, where slices average them.
constexpr int kSunSteps = 2;

/// One colour for each pixel, in the order of the march.
InterleavedColor make_color(const Interleaving& layout) {
  return {InterleavedPlane(layout), InterleavedPlane(layout), InterleavedPlane(layout)};
}

glm::vec3 color_at(const InterleavedColor& color, std::ptrdiff_t i) {
  return {color[0][i], color[1][i], color[2][i]};
}

/// What the light's coefficients weigh the polynomials of add_basis with, channel by channel: these
/// lack the constants that make spherical harmonics orthonormal. Without light, band 0 alone.
std::vector<float> basis_weights(const LightModel* light, int order) {
  const int count = sh_count(order);
  std::vector<float> weights(std::size_t(3 * count), 0.0f);
  for (int c = 0; c < 3; ++c) {
    float* channel = &weights[std::size_t(c * count)];
    if (!light) channel[0] = 1;
    for (int i = 0; light && i < count; ++i)
      channel[i] = kShConstants[std::size_t(i)] * light->coefficients[std::size_t(i)][c];
  }
  return weights;
}

/// The method on one frame.
class Bitmask {
 public:
  explicit Bitmask(const EstimateInput& in)
      : in_(in),
        scene_(make_march_scene(in.geometry, in.hidden)),
        layout_(scene_.layout),
        pattern_(layout_, in.geometry.display, in.slices, in.steps, in.seed),
        bounce_pattern_(layout_, in.geometry.display, in.slices, bounce_steps(in.steps), in.seed),
        march_{scene_, pattern_, in.radius, in.extend_offscreen},
        bounce_march_{scene_, bounce_pattern_, in.radius, in.extend_offscreen},
        ao_(layout_) {
    choose_isa();
  }

  Products run() {
    gather_visibility();
    if (in_.products.bounce) {
      out_.bounce = Plane<glm::vec3>(width(), height(), glm::vec3(0));
      for (int pass = 1; pass <= in_.bounces; ++pass) gather_bounce(pass == in_.bounces);
    }
    return std::move(out_);
  }

 private:
  int width() const { return layout_.width(); }
  int height() const { return layout_.height(); }

  bool is_surface(std::ptrdiff_t i) const { return !std::isnan(scene_.depth[i]); }

  /// Calls `work(pixel, index)` for each pixel that shows a surface; index is that of the march.
  template <class Work>
  void for_each_surface(const Work& work) const {
    for_each_row(height(), [&](int y) {
      for (int x = 0; x < width(); ++x) {
        const std::size_t pixel = in_.geometry.surfel.index(x, y);
        const std::ptrdiff_t i = layout_.index(x, y);
        if (is_surface(i)) work(pixel, i);
      }
    });
  }

  void gather_visibility() {
    const bool wants_light = in_.products.direct || in_.products.bounce || in_.products.error;
    const LightModel* light = wants_light ? in_.light : nullptr;
    const bool directional = light && light->order > 0;

    InterleavedColor bent, share, difference;
    VisibilityJob job{march_, 0, nullptr, &ao_, nullptr, nullptr, nullptr};
    std::vector<float> weights;
    if (in_.products.bent) {
      bent = make_color(layout_);
      job.bent = &bent;
      job.order = 1;
    }
    if (directional || (wants_light && in_.products.error)) {
      job.order = std::max(directional ? light->order : 0, 1);
      weights = basis_weights(directional ? light : nullptr, job.order);
      job.light = weights.data();
      share = make_color(layout_);
      job.share = &share;
    }
    if (in_.products.error) {
      difference = make_color(layout_);
      job.share_difference = &difference;
    }
    for_each_band(
        height(), [&](int y0, int y1) { march_visibility(job, y0, y1); }, in_.progress);

    out_.ao = Plane<float>(width(), height(), 1.0f);
    if (in_.products.bent) out_.bent = Plane<glm::vec3>(width(), height(), glm::vec3(0));
    if (in_.products.error) out_.error = Plane<float>(width(), height(), 0.0f);
    if (wants_light) out_.direct = Plane<glm::vec3>(width(), height(), glm::vec3(0));
    for_each_surface([&](std::size_t pixel, std::ptrdiff_t i) {
      out_.ao[pixel] = ao_[i];
      const glm::vec3 normal(in_.geometry.surfel[pixel].normal);
      if (in_.products.bent) {
        const glm::vec3 sum = color_at(bent, i);
        const float length = glm::length(sum);
        out_.bent[pixel] = length > 0 ? sum / length : normal;
      }
      if (!wants_light) return;
      const glm::vec3 unoccluded =
          light ? light->irradiance(normal) : in_.environment.constant_radiance();
      out_.direct[pixel] = unoccluded * (directional ? color_at(share, i) : glm::vec3(ao_[i]));
      if (in_.products.error) out_.error[pixel] = luminance(unoccluded * color_at(difference, i));
    });
    if (light) {
      for (const Sun& sun : light->suns) add_sun(sun);
    }
  }

  /// Adds the light of a sun where it is seen. Members of the pattern look at different points of
  /// its disc.
  void add_sun(const Sun& sun) {
    InterleavedPlane visible(layout_);
    SunJob job{march_, {}, {}, &visible};
    const glm::mat3 frame = frame_about(sun.direction);
    const double diagonal = std::hypot(in_.geometry.display.width(), in_.geometry.display.height());
    const int members = kPeriod * kPeriod, steps = kSunSteps * in_.steps;
    for (int m = 0; m < members; ++m) {
      const int rank = SlicePattern::rank(m);
      const float angle = float(2 * glm::pi<double>() * fraction(rank * kR2First)),
                  off = sun.angular_radius * std::sqrt((float(rank) + 0.5f) / float(members));
      const glm::vec3 to =
          glm::normalize(frame * glm::vec3(off * std::cos(angle), off * std::sin(angle), 1));
      job.directions[std::size_t(m)] = {to.x, to.y, to.z};
      const double start = fraction(rank * kR2Second);
      for (int i = 0; i < steps; ++i)
        job.distances_px[std::size_t(m)].push_back(
            float(march_distance((i + start) / steps, diagonal)));
    }
    for_each_band(
        height(), [&](int y0, int y1) { march_sun(job, y0, y1); }, in_.progress);
    for_each_surface([&](std::size_t pixel, std::ptrdiff_t i) {
      const glm::vec3 normal(in_.geometry.surfel[pixel].normal);
      out_.direct[pixel] +=
          visible[i] * std::max(0.0f, glm::dot(normal, sun.direction)) * sun.irradiance;
    });
  }

  /// What each pixel sends: its albedo times all the light that arrives, or the layer that says so.
  glm::vec3 sent_by(std::size_t pixel) const {
    if (!in_.radiance.empty()) return within_range(in_.radiance[pixel]);
    return within_range(in_.albedo[pixel] * (out_.direct[pixel] + out_.bounce[pixel]));
  }

  /// What the unseen side of a pixel's surface sends: it has the light from its side, as far as the
  /// seen side is open.
  glm::vec3 sent_by_back(std::size_t pixel) const {
    const glm::vec3 normal = -glm::vec3(in_.geometry.surfel[pixel].normal);
    glm::vec3 light = in_.light->irradiance(normal);
    for (const Sun& sun : in_.light->suns)
      light += std::max(0.0f, glm::dot(normal, sun.direction)) * sun.irradiance;
    return within_range(in_.albedo[pixel] * (out_.ao[pixel] * light + out_.bounce[pixel]));
  }

  static void put(InterleavedColor& color, std::ptrdiff_t i, const glm::vec3& value) {
    for (int c = 0; c < 3; ++c) color[std::size_t(c)][i] = value[c];
  }

  /// The pixel that shows what goes on behind this one; -1 where nothing does.
  int source_behind(std::size_t pixel) const {
    const bool known = in_.hidden && !in_.hidden->behind_source.empty();
    return known ? in_.hidden->behind_source[pixel] : -1;
  }

  void gather_bounce(bool last) {
    const bool two_sided = in_.light && in_.radiance.empty();
    InterleavedColor sent = make_color(layout_), sent_behind = make_color(layout_),
                     bounce = make_color(layout_), sent_back;
    if (two_sided) sent_back = make_color(layout_);
    for_each_row(height(), [&](int y) {
      for (InterleavedColor* color : {&sent, &sent_behind, &sent_back}) {
        for (InterleavedPlane& plane : *color) {
          if (plane.data()) plane.fill_row(layout_, y, 0);
        }
      }
      for (int x = 0; x < width(); ++x) {
        const std::size_t pixel = in_.geometry.surfel.index(x, y);
        const std::ptrdiff_t i = layout_.index(x, y);
        if (!is_surface(i)) continue;
        put(sent, i, sent_by(pixel));
        if (two_sided) put(sent_back, i, sent_by_back(pixel));
        const int source = source_behind(pixel);
        if (source >= 0) put(sent_behind, i, sent_by(std::size_t(source)));
      }
    });
    BorderValues sent_border[3];
    for (int c = 0; c < 3; ++c) {
      sent_border[c] = scene_.border.gather(
          [&](int x, int y) { return sent[std::size_t(c)][layout_.index(x, y)]; });
    }
    InterleavedColor difference;
    if (in_.products.error) difference = make_color(layout_);
    const BounceJob job{
        bounce_march_, &ao_,        &sent,   two_sided ? &sent_back : nullptr,
        &sent_behind,  sent_border, &bounce, in_.products.error ? &difference : nullptr};
    for_each_band(
        height(), [&](int y0, int y1) { march_bounce(job, y0, y1); }, in_.progress);
    for_each_surface([&](std::size_t pixel, std::ptrdiff_t i) {
      out_.bounce[pixel] = color_at(bounce, i);
      if (last && in_.products.error) out_.error[pixel] += luminance(color_at(difference, i));
    });
  }

  const EstimateInput& in_;
  MarchScene scene_;
  const Interleaving& layout_;
  SlicePattern pattern_, bounce_pattern_;
  March march_, bounce_march_;
  InterleavedPlane ao_;
  Products out_;
};

Products estimate(const EstimateInput& in) { return Bitmask(in).run(); }

}  // namespace

Method bitmask_method() {
  return {"bitmask",
          "slices with a visibility bitmask; light and bounce from the same march",
          {.ao = true, .direct = true, .bounce = true, .bent = true, .error = true},
          kPeriod,
          {},
          true,
          nullptr,
          estimate};
}

}  // namespace ssdo
