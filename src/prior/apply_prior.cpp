// SPDX-License-Identifier: Apache-2.0
//
// The prior in full resolution: see prior.h. Lanes are neighbouring pixels of a row. Compiled once
// for every instruction set.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "math/spherical_harmonics.h"
#include "prior/prior.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prior/apply_prior.cpp"
#include <hwy/foreach_target.h>

#include "filters/similarity-inl.h"
#include "scene/light/light-inl.h"
#include "scene/surfaces-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Least 1 - ao that the bounce is divided by: of smaller occluders, nothing is known.
constexpr float kLeastHidden = 1e-3f;

/// The weight of a square that shows another surface: decisive only where no square shows the
/// pixel's.
constexpr float kOtherSurface = 1e-3f;

/// Planes of values by square, which are interpolated between squares.
template <int kCount>
using SquareValues = std::array<const Plane<float>*, kCount>;

/// A row of squares, spread to pixels: entry x holds the last square whose centre is not right of
/// pixel x, entry x + step the next square. Channels 0 to 6 are those of TileRows, then the values.
template <int kCount>
class SpreadRow {
 public:
  static constexpr int kFirst = TileRows::kSurfelChannels, kChannels = kFirst + kCount;

  explicit SpreadRow(std::size_t width, int step)
      : step_(step), stride_(width + std::size_t(step) + kLanes), values_(kChannels * stride_) {}

  /// `columns` are those of the squares, by entry.
  void spread(const Surfaces& squares, const SquareValues<kCount>& values, int row,
              const std::vector<int>& columns) {
    for (std::size_t x = 0; x < columns.size(); ++x) {
      const std::size_t i = squares.index(columns[x], row);
      const Surfel& q = squares[i];
      const float of[kFirst] = {q.position.x, q.position.y, q.position.z, q.normal.x,
                                q.normal.y,   q.normal.z,   q.rounding};
      for (std::size_t c = 0; c < kFirst; ++c) values_[c * stride_ + x] = of[c];
      for (std::size_t c = 0; c < kCount; ++c)
        values_[(kFirst + c) * stride_ + x] = (*values[c])[i];
    }
  }

  HWY_INLINE Shown shown(std::size_t x) const {
    const float* from = values_.data() + x;
    const auto stride = std::ptrdiff_t(stride_);
    return {load_apart(from, stride), load_apart(from + 3 * stride, stride),
            load(from + 6 * stride)};
  }
  HWY_INLINE V value(int c, std::size_t x) const {
    return load(values_.data() + std::size_t(kFirst + c) * stride_ + x);
  }
  std::size_t next(std::size_t x) const { return x + std::size_t(step_); }

 private:
  int step_;
  std::size_t stride_;
  std::vector<float> values_;
};

/// The mean of four squares, weighted by distance and by how far they show the surface of `p`; 0
/// where no square exists. `right` and `low` are the weights of the squares to the right, and
/// below.
template <int kCount>
HWY_INLINE void interpolate(const Shown& p, const SpreadRow<kCount>& above,
                            const SpreadRow<kCount>& below, std::size_t x, V right, V low,
                            V* found) {
  const std::size_t next = above.next(x);
  const Shown q[4] = {above.shown(x), above.shown(next), below.shown(x), below.shown(next)};
  const V one = set(1), left = one - right, high = one - low;
  const V share[4] = {left * high, right * high, left * low, right * low};
  V sum = set(0);
  for (int c = 0; c < kCount; ++c) found[c] = sum;
  for (int k = 0; k < 4; ++k) {
    const M exists = dot(q[k].normal, q[k].normal) > set(0);
    const V alike = similarity(p, q[k], [&]() HWY_ATTR { return q[3 - k]; });
    const V weight = hn::IfThenElseZero(exists, share[k] * (alike + set(kOtherSurface)));
    const SpreadRow<kCount>& row = k < 2 ? above : below;
    const std::size_t at = k % 2 ? next : x;
    sum = sum + weight;
    for (int c = 0; c < kCount; ++c) found[c] = hn::MulAdd(weight, row.value(c, at), found[c]);
  }
  for (int c = 0; c < kCount; ++c) found[c] = hn::IfThenElseZero(sum > set(0), found[c] / sum);
}

/// What is open of what is guessed, s, after the prior; `lean` is u - 1/2.
HWY_INLINE V leaned_share(V s, V lean) {
  const V half = set(0.5f), open = s * (half + lean), closed = (set(1) - s) * (half - lean);
  return open / (open + closed);
}

/// ao' of prior.h; `lean` is u - 1/2.
HWY_INLINE V leaned(V ao, V guesses, V lean) {
  const V zero = set(0), one = set(1), g2 = guesses * guesses;
  const V spread = set(0.99f * 4) * ao * (one - ao) + set(0.01f) * g2 * g2,
          g = guesses * hn::Sqrt(spread);
  const V lo = hn::Max(ao - g, zero), hi = hn::Min(ao + g, one), width = hi - lo;
  const V s =
      hn::Clamp((ao - lo) / hn::Max(width, set(1e-6f)), set(kLeastShare), set(1 - kLeastShare));
  return hn::Clamp(hn::MulAdd(width, leaned_share(s, lean) - s, ao), lo, hi);
}

/// The two columns, or rows, of squares around each pixel, and the weight of the second one.
struct Axis {
  std::vector<int> square;  ///< of the first one, by pixel, and `step` pixels farther
  std::vector<float> share;
};

inline Axis make_axis(int first_pixel, int first_square, int squares, int pixels, int step) {
  Axis axis;
  for (int i = 0; i < pixels + step; ++i) {
    const double at = (double(first_pixel + i) + 0.5) / step - 0.5, whole = std::floor(at);
    axis.square.push_back(std::clamp(int(whole) - first_square, 0, squares - 1));
    axis.share.push_back(float(at - whole));
  }
  axis.share.resize(axis.share.size() + kMostLanes);
  return axis;
}

/// Calls work(index, count, surfels, values) for vectors of pixels of the rows, with the values
/// between squares.
template <int kCount, class Work>
HWY_INLINE void between_squares(const PriorGrid& s, const Geometry& geometry,
                                const SquareValues<kCount>& values, int y0, int y1,
                                const Work& work) {
  const int width = geometry.surfaces.width, step = s.step,
            left = geometry.window.x0 - geometry.display.x0,
            top = geometry.window.y0 - geometry.display.y0;
  const Axis columns = make_axis(left, s.first.x, s.pixel.width, width, step),
             rows = make_axis(top, s.first.y, s.pixel.height, geometry.surfaces.height, step);
  SpreadRow<kCount> above(std::size_t(width), step), below(std::size_t(width), step);
  int spread_above = -1, spread_below = -1;
  for (int y = y0; y < y1; ++y) {
    const int row = rows.square[std::size_t(y)], next = rows.square[std::size_t(y + step)];
    const auto spread = [&](SpreadRow<kCount>& to, int from) {
      to.spread(s.surfaces, values, from, columns.square);
    };
    if (row == spread_below) std::swap(above, below), std::swap(spread_above, spread_below);
    if (row != spread_above) spread(above, row), spread_above = row;
    if (next != spread_below) spread(below, next), spread_below = next;
    for (int x = 0; x < width; x += kLanes) {
      const Surfels surfels = surfels_at(geometry.surfaces, x, y);
      if (!any(surfels.surface)) continue;
      V found[kCount];
      interpolate<kCount>({surfels.position, surfels.normal, surfels.rounding}, above, below,
                          std::size_t(x), load(&columns.share[std::size_t(x)]),
                          set(rows.share[std::size_t(y)]), found);
      work(geometry.surfaces.index(x, y), width - x, surfels, found);
    }
  }
}

/// `ao` after the prior, where there is a surface.
HWY_INLINE V amended(const Surfels& surfels, V ao, V guesses, V lean, float part) {
  const V after = hn::MulAdd(leaned(ao, guesses, lean) - ao, set(part), ao);
  return hn::IfThenElse(surfels.surface, after, ao);
}

/// Changes the bounce of a vector of pixels; `sent` is the mean radiance that surfaces send of its
/// light.
HWY_INLINE void amend_bounce(std::size_t i, int count, V ao, V after, const glm::vec3& sent,
                             Plane<glm::vec3>& bounce) {
  if (bounce.empty()) return;
  const V one = set(1), closer = hn::Max(ao - after, set(0)),
          opener = (one - hn::Max(after, ao)) / hn::Max(one - ao, set(kLeastHidden));
  const V3 found = load_first(count, &bounce[i]);
  store_first(count, mul_add(set(sent), closer, found * hn::Min(opener, one)), &bounce[i]);
}

/// Writes the prior's answer for each pixel.
void write_rows(const PriorField& field, const Geometry& geometry, float offscreen_sun, int y0,
                int y1, LearnedVisibility& learned) {
  between_squares<2>(
      field.grid, geometry, {&field.change, &field.offscreen_sun}, y0, y1,
      [&](std::size_t i, int count, const Surfels& surfels, const V* of) HWY_ATTR {
        store_first(count, hn::IfThenElseZero(surfels.surface, of[0]), &learned.change[i]);
        const V rules = set(offscreen_sun),
                past = hn::MulAdd(of[1] - rules, set(kPartOfSun), rules);
        store_first(count, hn::IfThenElseZero(surfels.surface, past), &learned.offscreen_sun[i]);
      });
}

/// Changes the share of what is mirrored of the sky.
void amend_mirrored(const PriorField& field, const Scene& scene, int y0, int y1,
                    LightVisibility& visibility) {
  const V part = set(field.part);
  between_squares<1>(
      field.grid, scene.geometry, {&field.visibility_bias}, y0, y1,
      [&](std::size_t i, int count, const Surfels& surfels, const V* of) HWY_ATTR {
        const V guessed = saturate(load_first(count, &visibility.mirrored_guessed[i])),
                s = hn::Clamp(load_first(count, &visibility.mirrored_guessed_open[i]) /
                                  hn::Max(guessed, set(1e-6f)),
                              set(kLeastShare), set(1 - kLeastShare));
        const V more = guessed * part * (leaned_share(s, of[0]) - s);
        const V3 share = load_first(count, &visibility.mirrored_sky[i]);
        const V3 after{saturate(share.x + more), saturate(share.y + more),
                       saturate(share.z + more)};
        store_first(count, if_then_else(surfels.surface, after, share),
                    &visibility.mirrored_sky[i]);
      });
}

void amend_rows(const PriorField& field, const Scene& scene, int y0, int y1, Products& products) {
  if (!products.visibility.mirrored_guessed.empty())
    amend_mirrored(field, scene, y0, y1, products.visibility);
  const auto lean = [&](std::size_t i, int count, const Surfels& surfels, const V* of) HWY_ATTR {
    const V ao = load_first(count, &products.ao[i]),
            after = amended(surfels, ao, of[0], of[1], field.part);
    store_first(count, after, &products.ao[i]);
    amend_bounce(i, count, ao, after, products.visibility.sent, products.bounce);
    for (LightProducts& light : products.lights)
      amend_bounce(i, count, ao, after, light.sent, light.bounce);
    return after - ao;
  };
  const PriorGrid& s = field.grid;
  Plane<glm::vec3>& sky = products.visibility.sky;
  if (sky.empty()) {
    between_squares<2>(s, scene.geometry, {&s.guesses, &field.visibility_bias}, y0, y1, lean);
    return;
  }
  // The first two bands of the sky are L(d) = mean + slope . d.
  const Light& light = scene.light;
  const glm::vec3 mean = light.coefficients[0] * kShConstants[0],
                  slope_y = light.coefficients[1] * kShConstants[1],
                  slope_z = light.coefficients[2] * kShConstants[2],
                  slope_x = light.coefficients[3] * kShConstants[3];
  // Visibility for light with directions lies halfway between open borders and surfaces that go on.
  const bool has_directions = light.order > 0;
  const V halfway = set(has_directions ? 0.5f : 0.0f),
          part = set(has_directions ? kPartOfSky : 1.0f);
  between_squares<6>(
      s, scene.geometry,
      {&s.guesses, &field.visibility_bias, &field.open_border_gain, &field.moment[0],
       &field.moment[1], &field.moment[2]},
      y0, y1, [&](std::size_t i, int count, const Surfels& surfels, const V* of) HWY_ATTR {
        const V change = lean(i, count, surfels, of) - halfway * of[2];
        const V3 moment{of[3], of[4], of[5]}, all = unoccluded_sky(light, surfels.normal);
        const auto amend = [&](V share, V whole, int c) HWY_ATTR {
          const V more =
              hn::MulAdd(set(mean[c]), change,
                         dot(V3{set(slope_x[c]), set(slope_y[c]), set(slope_z[c])}, moment));
          return hn::IfThenElse(whole > set(0), saturate(saturate(share) + part * more / whole),
                                share);
        };
        const V3 share = load_first(count, &sky[i]);
        const V3 after{amend(share.x, all.x, 0), amend(share.y, all.y, 1),
                       amend(share.z, all.z, 2)};
        store_first(count, if_then_else(surfels.surface, after, share), &sky[i]);
      });
}

/// |m| if what is open is a cone about its axis: 2/3 (1 - cos^3) of its half-angle, where ao is
/// sin^2.
HWY_INLINE V moment_of_cone(V ao) {
  const V cosine2 = set(1) - ao;
  return set(2 / 3.0f) * hn::NegMulAdd(cosine2, hn::Sqrt(cosine2), set(1));
}

void finish_rows(const PriorField& field, const Scene& scene, int y0, int y1, Products& products) {
  const PriorGrid& s = field.grid;
  if (!products.bent.empty()) {
    between_squares<5>(
        s, scene.geometry,
        {&s.ao, &field.open_border_gain, &field.moment[0], &field.moment[1], &field.moment[2]}, y0,
        y1, [&](std::size_t i, int count, const Surfels& surfels, const V* of) HWY_ATTR {
          const V halfway = saturate(hn::MulAdd(set(0.5f), of[1], of[0]));
          const V3 bent = load_first(count, &products.bent[i]),
                   mean = mul_add(bent, moment_of_cone(halfway), V3{of[2], of[3], of[4]});
          const M has_length = hn::And(surfels.surface, dot(mean, mean) > set(1e-8f));
          store_first(count, if_then_else(has_length, normalise(mean), bent), &products.bent[i]);
        });
  }
  if (!products.guessed.empty()) {
    between_squares<1>(s, scene.geometry, {&field.spread}, y0, y1,
                       [&](std::size_t i, int count, const Surfels& surfels, const V* of) HWY_ATTR {
                         store_first(count, hn::IfThenElseZero(surfels.surface, saturate(of[0])),
                                     &products.guessed[i]);
                       });
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(amend_rows);
HWY_EXPORT(write_rows);
HWY_EXPORT(finish_rows);

LearnedVisibility by_pixel(const PriorField& field, const Geometry& geometry, float offscreen_sun) {
  const Surfaces& surfaces = geometry.surfaces;
  LearnedVisibility learned{Plane<float>(surfaces.width, surfaces.height, 0.0f),
                            Plane<float>(surfaces.width, surfaces.height, 1.0f)};
  for_each_band(surfaces.height, [&](int y0, int y1) {
    HWY_DYNAMIC_DISPATCH(write_rows)(field, geometry, offscreen_sun, y0, y1, learned);
  });
  return learned;
}

void apply_prior(const PriorField& field, const Scene& scene, Products& products) {
  for_each_band(scene.geometry.surfaces.height, [&](int y0, int y1) {
    HWY_DYNAMIC_DISPATCH(amend_rows)(field, scene, y0, y1, products);
  });
}

void finish_with_prior(const PriorField& field, const Scene& scene, bool wants_guessed,
                       Products& products) {
  const Surfaces& surfaces = scene.geometry.surfaces;
  if (wants_guessed) products.guessed = Plane<float>(surfaces.width, surfaces.height, 0.0f);
  for_each_band(scene.geometry.surfaces.height, [&](int y0, int y1) {
    HWY_DYNAMIC_DISPATCH(finish_rows)(field, scene, y0, y1, products);
  });
}

}  // namespace ssdo
#endif
