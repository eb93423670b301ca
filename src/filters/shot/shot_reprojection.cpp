// SPDX-License-Identifier: Apache-2.0
//
// The tests of filters/temporal.cpp, for a vector of points. Sums and products are not fused, so
// that every instruction set rounds alike.
//
// There are three loops over at most 64 points. The first projects them into the other frame, the
// second copies the four pixels around each, 16 bytes per pixel, and the third tests these.
// Compiled once for every instruction set.
#include "filters/shot/shot_reprojection.h"

#include <algorithm>
#include <glm/matrix.hpp>
#include <limits>

#include "filters/reprojection.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/shot/shot_reprojection.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

constexpr int kMost = RowOfPoints::kMost;
static_assert(kMost % kMostLanes == 0);

/// A vector of what pixels show. `normal` has the length `length`.
struct KeptLanes {
  V3 position, normal;
  V length, rounding;
};

/// From pixels that lie one after the other in memory.
HWY_INLINE KeptLanes load_kept(const float* from, std::uint32_t least_rounding) {
  const D d;
  const DI di;
  const DU du;
  KeptLanes kept;
  V packed;
  hn::LoadInterleaved4(d, from, kept.position.x, kept.position.y, kept.position.z, packed);
  const VU bits = hn::BitCast(du, packed), part = set_bits((1u << KeptSurface::kNormalBits) - 1),
           rounding = hn::ShiftLeft<KeptSurface::kFloatShift>(
               hn::ShiftRight<KeptSurface::kRoundingShift>(bits));
  kept.rounding = hn::BitCast(d, rounding + set_bits(least_rounding));
  const auto coordinate = [&](VU steps) HWY_ATTR {
    return hn::ConvertTo(d, hn::BitCast(di, hn::And(steps, part))) *
               set(1 / KeptSurface::kNormalSteps) -
           set(1);
  };
  V3& n = kept.normal;
  n.x = coordinate(bits), n.y = coordinate(hn::ShiftRight<KeptSurface::kNormalBits>(bits));
  n.z = set(1) - hn::Abs(n.x) - hn::Abs(n.y);
  const V below = hn::Max(hn::Neg(n.z), set(0));  // the folded half
  n.x = n.x - hn::CopySign(below, n.x), n.y = n.y - hn::CopySign(below, n.y);
  kept.length = hn::Sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  return kept;
}

HWY_INLINE V dot_unfused(const V3& a, const V3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// The kept pixels as points.
void unpack_points(const float (*from)[4], std::uint32_t least_rounding, RowOfPoints* points) {
  for (int i = 0; i < points->count; i += kLanes) {
    KeptLanes kept = load_kept(from[i], least_rounding);
    V3& p = kept.position;
    const M exists = p.z > set(-std::numeric_limits<float>::max());
    const V nothing = set(std::numeric_limits<float>::quiet_NaN());
    store_apart(if_then_else(exists, p, {nothing, nothing, nothing}), kMost,
                &points->position[0][i]);
    store_apart(kept.normal / kept.length, kMost, &points->normal[0][i]);
    store(kept.rounding, &points->rounding[i]);
  }
}

/// Where points are in the other frame.
struct Places {
  alignas(64) std::int32_t pixel[kMost];         ///< as in ReprojectedPoints; -1: outside
  alignas(64) float across[kMost], down[kMost];  ///< from it
  alignas(64) float position[3][kMost];          ///< camera space of the other frame
};

HWY_INLINE V3 turn(const float* by, const V3& v) {
  const auto row = [&](int r) HWY_ATTR {
    return set(by[3 * r]) * v.x + set(by[3 * r + 1]) * v.y + set(by[3 * r + 2]) * v.z;
  };
  return {row(0), row(1), row(2)};
}

/// Rounds places to 1/1024 pixel. Under a camera at rest, points then lie exactly at the centres of
/// their pixels, and the pixels beside, which show other things, have the weight 0.
HWY_INLINE V to_steps(V pixels) {
  constexpr float kSteps = 1024;
  return hn::Floor(pixels * set(kSteps) + set(0.5f)) * set(1 / kSteps);
}

/// Projects the points into the other frame. False where all are outside.
HWY_INLINE bool find_places(const ShotReprojection::View& view, const RowOfPoints& points,
                            Places& places) {
  const DI di;
  bool some = false;
  for (int i = 0; i < points.count; i += kLanes) {
    const V3 at = load_apart(&points.position[0][i], kMost);
    const V3 p = turn(view.turn, at) + V3{set(view.step[0]), set(view.step[1]), set(view.step[2])};
    const V w = view.orthographic ? set(1) : set(1) / hn::Neg(p.z);
    const V x = to_steps(set(view.cx) + set(view.fx) * p.x * w),
            y = to_steps(set(view.cy) - set(view.fy) * p.y * w);
    const V left = hn::Floor(x), top = hn::Floor(y);
    // Not-a-number is neither below nor above anything.
    const M across = hn::And(left >= set(-1), left < set(float(view.width))),
            down = hn::And(top >= set(-1), top < set(float(view.height)));
    M inside = hn::And(across, down);
    if (!view.orthographic) inside = hn::And(inside, p.z < set(0));
    const VI column = hn::ConvertTo(di, hn::IfThenElseZero(inside, left + set(1))),
             row = hn::ConvertTo(di, hn::IfThenElseZero(inside, top + set(1)));
    const VI pixel = row * set_int(view.stride) + column;
    hn::StoreU(hn::IfThenElse(hn::RebindMask(di, inside), pixel, set_int(-1)), di,
               &places.pixel[i]);
    store(x - left, &places.across[i]), store(y - top, &places.down[i]);
    store_apart(p, kMost, &places.position[0][i]);
    some = some || any(inside);
  }
  return some;
}

/// The four pixels around each place, row by row.
struct Around {
  alignas(64) float pixel[4][kMost][4];
};

HWY_INLINE void copy_around(const ShotReprojection::View& view, const Places& places, int count,
                            Around& around) {
  for (int i = 0; i < count; ++i) {
    const KeptSurface* above = view.pixels + std::max(places.pixel[i], 0);
    const KeptSurface* below = above + view.stride;
    // cppcheck-suppress uninitvar
    copy_bits(above[0], around.pixel[0][i]);
    copy_bits(above[1], around.pixel[1][i]);
    copy_bits(below[0], around.pixel[2][i]);
    copy_bits(below[1], around.pixel[3][i]);
  }
}

/// The tests for a vector of points from `i` on. `same`: the frame shows the surface of the point;
/// `through`: it shows what lies behind. `weights` are those of the four pixels, 0 where a pixel
/// shows another surface, not yet divided by `sum`.
struct Tested {
  M same, through;
  V weights[4], sum;
};
HWY_INLINE Tested test(const ShotReprojection::View& view, const RowOfPoints& points,
                       const Places& places, const Around& around, int i) {
  const V3 p = load_apart(&places.position[0][i], kMost),
           normal = turn(view.turn, load_apart(&points.normal[0][i], kMost));
  const V scale = view.orthographic ? set(1) : hn::Neg(p.z);
  const V limit = set(view.half_pixel) * scale + load(&points.rounding[i]);
  const V across = load(&places.across[i]), down = load(&places.down[i]);
  const V behind = p.z - set(float(Reprojection::kBehind)) * hn::Abs(p.z);
  const V columns[] = {set(1) - across, across}, rows[] = {set(1) - down, down};
  Tested tested;
  tested.sum = set(0);
  const DI di;
  const M inside = hn::RebindMask(D(), hn::Not(hn::LoadU(di, &places.pixel[i]) < set_int(0)));
  tested.through = inside;
  for (int k = 0; k < 4; ++k) {
    const KeptLanes q = load_kept(around.pixel[k][i], view.least_rounding);
    const V3 away = q.position - p;
    const V near = limit + q.rounding;
    const M turned =
                dot_unfused(normal, q.normal) >= set(float(Reprojection::kSameNormal)) * q.length,
            on_own = hn::Abs(dot_unfused(normal, away)) <= near,
            on_other = hn::Abs(dot_unfused(q.normal, away)) <= near * q.length;
    const V part = columns[k % 2] * rows[k / 2];
    tested.through = hn::And(tested.through, hn::Or(q.position.z < behind, part == set(0)));
    tested.weights[k] = hn::IfThenElseZero(hn::And(hn::And(turned, on_own), on_other), part);
    tested.sum = tested.sum + tested.weights[k];
  }
  tested.same = hn::And(inside, tested.sum >= set(float(Reprojection::kLeastShare)));
  tested.through = hn::AndNot(tested.same, tested.through);
  return tested;
}

/// Stores `through` for a vector of points from `i` on, up to `count`.
HWY_INLINE void store_through(M looks_through, int i, int count, unsigned char* through) {
  alignas(64) float looks[kLanes];
  store(hn::IfThenElseZero(looks_through, set(1)), looks);
  for (int lane = 0; lane < std::min(kLanes, count - i); ++lane)
    through[i + lane] = looks[lane] > 0;
}

bool find_points(const ShotReprojection::View& view, const RowOfPoints& points,
                 ReprojectedPoints* sights, unsigned char* through) {
  if (through) std::fill_n(through, points.count, static_cast<unsigned char>(0));
  Places places;
  if (!find_places(view, points, places)) return false;
  Around around;
  copy_around(view, places, points.count, around);
  bool some = false;
  for (int i = 0; i < points.count; i += kLanes) {
    const DI di;
    const Tested tested = test(view, points, places, around, i);
    const VI pixel = hn::LoadU(di, &places.pixel[i]);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(di, tested.same), pixel, set_int(-1)), di,
               &sights->pixel[i]);
    const V scale = set(1) / tested.sum;
    for (int k = 0; k < 4; ++k) store(tested.weights[k] * scale, &sights->weight[k][i]);
    if (through) store_through(tested.through, i, points.count, through);
    some = some || any(tested.same);
  }
  return some;
}

/// Whether the frame may look through some place: all that is around it lies behind.
HWY_INLINE bool may_look_through(const ShotReprojection::View& view, const RowOfPoints& points,
                                 const Places& places) {
  alignas(64) float nearest[kMost];
  for (int i = 0; i < points.count; ++i) {
    const KeptSurface* above = view.pixels + std::max(places.pixel[i], 0);
    const KeptSurface* below = above + view.stride;
    const auto nearer = [](float part, float a, float b) { return part > 0 ? std::max(a, b) : a; };
    const float across = places.across[i], down = places.down[i];
    nearest[i] = nearer(down, nearer(across, above->position.z, above[1].position.z),
                        nearer(across, below->position.z, below[1].position.z));
  }
  bool some = false;
  for (int i = 0; i < points.count; i += kLanes) {
    const V z = load(&places.position[2][i]);
    const M inside = hn::RebindMask(D(), hn::Not(hn::LoadU(DI(), &places.pixel[i]) < set_int(0)));
    const V behind = z - set(float(Reprojection::kBehind)) * hn::Abs(z);
    some = some || any(hn::And(inside, load(&nearest[i]) < behind));
  }
  return some;
}

void find_points_through(const ShotReprojection::View& view, const RowOfPoints& points,
                         unsigned char* through) {
  std::fill_n(through, points.count, static_cast<unsigned char>(0));
  Places places;
  if (!find_places(view, points, places)) return;
  std::fill(places.pixel + points.count, std::end(places.pixel), -1);
  if (!may_look_through(view, points, places)) return;
  Around around;
  copy_around(view, places, points.count, around);
  for (int i = 0; i < points.count; i += kLanes) {
    store_through(test(view, points, places, around, i).through, i, points.count, through);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(unpack_points);
HWY_EXPORT(find_points);
HWY_EXPORT(find_points_through);

void load_points(const KeptSurfaces& own, const RowOfPixels& row, RowOfPoints& points) {
  alignas(64) float kept[RowOfPoints::kMost][4];
  const KeptSurface* from = &own.pixels[own.index(row.x, row.y)];
  points.count = row.count;
  for (int i = 0; i < row.count; ++i) copy_bits(from[i * row.step], kept[i]);
  const KeptSurface nothing{{0, 0, -std::numeric_limits<float>::infinity()}, 0};
  for (int i = row.count; i < RowOfPoints::kMost; ++i) copy_bits(nothing, kept[i]);
  HWY_DYNAMIC_DISPATCH(unpack_points)(kept, own.least_rounding, &points);
}

ShotReprojection::ShotReprojection(const KeptSurfaces& other, const KeptSurfaces& own) {
  const Camera& there = other.camera;
  const CameraChange change(own.camera, there);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      view_.turn[3 * row + column] = float(change.turn[column][row]);
    view_.step[row] = float(change.step[row]);
  }
  view_.fx = float(there.fx), view_.fy = float(there.fy);
  view_.cx = float(there.cx - other.window.x0 - 0.5);
  view_.cy = float(there.cy - other.window.y0 - 0.5);
  view_.half_pixel = float(0.5 / there.fx);
  view_.orthographic = there.orthographic;
  view_.width = other.window.width(), view_.height = other.window.height();
  view_.stride = other.stride();
  view_.least_rounding = other.least_rounding;
  view_.pixels = other.pixels.data();
}

bool ShotReprojection::find(const RowOfPoints& points, ReprojectedPoints& sights,
                            unsigned char* through) const {
  return HWY_DYNAMIC_DISPATCH(find_points)(view_, points, &sights, through);
}

void ShotReprojection::find_through(const RowOfPoints& points, unsigned char* through) const {
  HWY_DYNAMIC_DISPATCH(find_points_through)(view_, points, through);
}

}  // namespace ssdo
#endif
