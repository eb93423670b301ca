// SPDX-License-Identifier: Apache-2.0
//
// Evaluation at half resolution. Upsampling along surfaces is the joint bilateral upsampling of
// Kopf, Cohen, Lischinski, Uyttendaele (2007), guided by positions:
//
//   out(p) = sum_q b(q) w(p, q) in(q) / sum_q b(q) w(p, q)
//
// b are the bilinear weights of the four q around p, w is how much q lies on the tangent plane of p
// by scene/same_surface.h, less what rounding may have moved p.
#include "estimators/view_space/half_resolution.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/view_space/half_resolution.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"
#include "scene/same_surface-inl.h"

#ifndef SSDO_HALF_RESOLUTION_JOB
#define SSDO_HALF_RESOLUTION_JOB
namespace ssdo {
namespace {

struct UpsamplingJob {
  const ViewPlanes &full, &receivers;
  const Plane<float>& half;
  const HalfResolution::Taps &columns, &rows;
  Plane<float>& out;
};

}  // namespace
}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

void upsample_tile(const UpsamplingJob& job, const Tile& tile) {
  const ViewPlanes& half = job.receivers;
  for_each_vector(job.full, tile, [&](int x, int y) HWY_ATTR {
    const ViewReceiver p = load_receiver(job.full, x, y);
    const V share_x = load(&job.columns.share[std::size_t(x)]);
    const V share_y = set(job.rows.share[std::size_t(y)]);
    V sum = set(0), whole = set(0), nearest = set(1), least = set(INFINITY);
    const auto add = [&](const std::vector<int>& columns, int row, V weight) HWY_ATTR {
      const VI column = hn::LoadU(DI(), &columns[std::size_t(x)]);
      const V value = gather(&job.half(0, row), column);
      const V z = gather(half.z.row(row), column);
      const V gap = hn::Abs(z - p.position.z);
      const M closer = gap < least;
      least = hn::IfThenElse(closer, gap, least);
      nearest = hn::IfThenElse(closer, value, nearest);
      const V3 q = along_ray(half, gather(half.ray_x(), column), set(half.ray_y()[row]), z);
      const V3 to_q = q - p.position;
      const V off_plane = hn::Abs(dot(to_q, p.normal)) - p.rounding;
      const V on_plane = plane_weight(off_plane / hn::Sqrt(dot(to_q, to_q)));
      // On its own plane whatever rounding says, p itself among them.
      const V w = weight * hn::IfThenElse(off_plane <= set(0), set(1), on_plane);
      // Background has no place that could be weighed.
      const V counted = hn::IfThenElseZero(shows_surface(z), w);
      sum = hn::MulAdd(counted, value, sum);
      whole = whole + counted;
    };
    const int above = job.rows.before[std::size_t(y)], below = job.rows.after[std::size_t(y)];
    const V one = set(1);
    add(job.columns.before, above, (one - share_x) * (one - share_y));
    add(job.columns.after, above, share_x * (one - share_y));
    add(job.columns.before, below, (one - share_x) * share_y);
    add(job.columns.after, below, share_x * share_y);
    const V mean = hn::IfThenElse(whole > set(0), sum / whole, nearest);
    store_first(tile.x1 - x, hn::IfThenElse(p.valid, mean, one), &job.out(x, y));
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {
namespace {

HWY_EXPORT(upsample_tile);

/// Entries of the half frame along an axis: how many, for `count` pixels from `first` on.
int half_count(int count, int first) { return ((first + count - 1) >> 1) - (first >> 1) + 1; }

/// The pixel that an entry is evaluated at.
int sampled_pixel(int entry, int count, int first) {
  return std::min(2 * ((first >> 1) + entry) + 1 - first, count - 1);
}

HalfResolution::Taps make_taps(int count, int first) {
  const int last = half_count(count, first) - 1;
  HalfResolution::Taps taps;
  for (int i = 0; i < count + PaddedLayout::kPad; ++i) {
    // A value of half resolution lies in the middle of its 2 x 2 pixels, a quarter of its own width
    // from the centre of each.
    const int pixel = std::min(i, count - 1) + first, own = (pixel >> 1) - (first >> 1);
    const bool unpack_bf16_first = (pixel & 1) == 0;
    const int before = unpack_bf16_first ? own - 1 : own;
    taps.before.push_back(std::max(before, 0));
    taps.after.push_back(std::min(before + 1, last));
    taps.share.push_back(unpack_bf16_first ? 0.75f : 0.25f);
  }
  return taps;
}

}  // namespace

HalfResolution::HalfResolution(const ViewPlanes& full)
    : full_(full),
      columns_(make_taps(full.width(), full.first_column)),
      rows_(make_taps(full.height(), full.first_row)),
      surfels_(sampled_surfels()),
      receivers_(surfels_) {
  const int width = receivers_.width(), height = receivers_.height();
  receivers_.orthographic = full.orthographic;
  receivers_.first_column = full.first_column >> 1;
  receivers_.first_row = full.first_row >> 1;
  receivers_.rays_x.assign(std::size_t(receivers_.layout.stride), 0.0f);
  receivers_.rays_y.assign(std::size_t(height) + PaddedLayout::kPad, 0.0f);
  for (int x = 0; x < width; ++x)
    receivers_.rays_x[std::size_t(x + PaddedLayout::kPad)] = full.ray_x()[column(x)];
  for (int y = 0; y < height; ++y)
    receivers_.rays_y[std::size_t(y + PaddedLayout::kPad)] = full.ray_y()[row(y)];
}

int HalfResolution::column(int x) const {
  return sampled_pixel(x, full_.width(), full_.first_column);
}

int HalfResolution::row(int y) const { return sampled_pixel(y, full_.height(), full_.first_row); }

Surfaces HalfResolution::sampled_surfels() const {
  Surfaces out(half_count(full_.width(), full_.first_column),
               half_count(full_.height(), full_.first_row));
  for_each_row(out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x) out.set(x, y, full_.surfaces(column(x), row(y)));
  });
  return out;
}

Plane<float> HalfResolution::upsample_bilinear(const Plane<float>& half) const {
  Plane<float> out(full_.width(), full_.height());
  for_each_row(out.height, [&](int y) {
    const auto at = std::size_t(y);
    const float *above = &half(0, rows_.before[at]), *below = &half(0, rows_.after[at]);
    std::vector<float> between(std::size_t(half.width));
    for (std::size_t x = 0; x < between.size(); ++x)
      between[x] = above[x] + rows_.share[at] * (below[x] - above[x]);
    const float* z = full_.z.row(y);
    float* to = &out(0, y);
    for (std::size_t x = 0; x < std::size_t(out.width); ++x) {
      const float before = between[std::size_t(columns_.before[x])];
      const float value =
          before + columns_.share[x] * (between[std::size_t(columns_.after[x])] - before);
      to[x] = shows_surface(z[x]) ? value : 1.0f;
    }
  });
  return out;
}

Plane<float> HalfResolution::upsample_along_surfaces(const Plane<float>& half) const {
  Plane<float> out(full_.width(), full_.height(), 1.0f);
  const UpsamplingJob job{full_, receivers_, half, columns_, rows_, out};
  for_each_tile(out.width, out.height, [&](const Tile& tile) {
    HWY_DYNAMIC_DISPATCH(upsample_tile)(job, tile);
  });
  return out;
}

}  // namespace ssdo
#endif
