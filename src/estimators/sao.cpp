// SPDX-License-Identifier: Apache-2.0
//
// Scalable Ambient Obscurance: McGuire, Mara, Luebke, High Performance Graphics 2012. The estimator
// is the authors' refined Alchemy obscurance (McGuire et al. 2011):
//
//   ao(p) = max(0, 1 - 5 s / N * sum_i max(1 - v.v, 0)^3 max(v.n - b, 0) / (v.v + e))
//
// v leads from p to the surface in the pixel of tap i, in units of the radius R: nearer surfaces
// count more, those beyond R nothing. s is the intensity, b the bias, e keeps the division finite.
// The N taps lie on a spiral of T turns in the disc that R projects to, tap i at (i + 1/2) / N of
// the disc's radius, turned in each pixel by 10 h radians, h = (3x) xor (y + xy). A tap r pixels
// away reads its depth from level floor(log2 r) - 3 of a chain of subsampled depths, so that the
// cost of a tap does not grow with the radius; see depth_mips.h.
//
// What differs, and why:
// - b, e and s are in radii, where the authors' are in scene units: the result then does not depend
//   on the unit of the scene. At R = 1 they are the same numbers, and so is the result: the
//   authors' sum with (R^2 - v.v)^3 over R^6 is this one over R.
// - The bias grows by what the precision of P demands.
// - What is outside the frame or background hides nothing; the authors' frames have a border of
//   pixels that are rendered but not shown.
// - Pixels that are not square are taken into account.
// - Seeds other than 0 turn all spirals by the same angle and move the taps along them, tap i to
//   (i + u) / N, by the sequence R2 of Roberts (2018); the authors have one pattern for all frames.
// - Left out are the authors' mean over quads of 2 x 2 pixels and their blur, which the filter
//   of the pipeline stands for, and normals made from depth, which are made before.
//
// Unity's component of the same name takes points in the half-ball instead of the spiral and reads
// full resolution; what is here is the paper's.
//
// Known faults, kept: a tap has the depth of another pixel than its place where its level is not 0,
// so that a tilted plane hides itself when the radius is many pixels, by 0.002 at most on average;
// intensities above 1 lead to bands, since few taps make few steps; and obscurance with a gain of 5
// is not visibility: corners are darker than ao.
//
// The direct light is the irradiance of the pixel's normal times ao. A crop changes only pixels
// within a disc and one pixel of the coarsest level, 32, of its border.
#include "estimators/sao.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "estimators/view_space/depth_mips.h"
#include "estimators/view_space/openness.h"
#include "math/sequence_numbers.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/sao.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"
// After the targets' headers.
#include <hwy/contrib/math/math-inl.h>

#ifndef SSDO_SAO_TAPS_
#define SSDO_SAO_TAPS_
namespace ssdo {

/// A place in the unit disc, in pixels per pixel of the disc's vertical radius.
struct SpiralTap {
  float x, y;
  float distance;  ///< over the disc's radius
};

struct SaoJob {
  const ViewPlanes& planes;
  const DepthMips& mips;
  std::vector<SpiralTap> taps;
  float inverse_radius;
  float disc_px;  ///< radius of the disc at depth 1, or at any where orthographic
  float scale;    ///< 5 s / N
  float bias, epsilon;
};

}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The angle by which the spiral of pixels (x, y), (x + 1, y), ... of the display window is turned.
HWY_INLINE V spin_angle(unsigned x, unsigned y) {
  const VU column = hn::Iota(DU(), x), row = set_bits(y);
  const VU hash = hn::Xor(column * set_bits(3), row + column * row);
  // 10 radians and 4096 times as many, in 2^-32 of a turn: a float of 10 h has no fraction left.
  constexpr double kTurn = 4294967296.0 / (2 * std::numbers::pi);
  constexpr auto kStep = std::uint32_t(std::uint64_t(10 * kTurn + 0.5)),
                 kStep4096 = std::uint32_t(std::uint64_t(40960 * kTurn + 0.5));
  const VU turns = hn::And(hash, set_bits(4095)) * set_bits(kStep) +
                   hn::ShiftRight<12>(hash) * set_bits(kStep4096);
  return hn::ConvertTo(D(), hn::BitCast(DI(), turns)) * set(float(1 / kTurn));
}

/// The depth that taps `distance` pixels away see at `at`.
HWY_INLINE V mip_depth(const DepthMips& mips, const Pixels& at, V distance) {
  // The exponent of a float is floor(log2).
  const VI exponent = hn::ShiftRight<23>(hn::BitCast(DI(), distance)) - set_int(127);
  const VI level =
      hn::Min(hn::Max(exponent - set_int(3), set_int(0)), set_int(DepthMips::kCoarsest));
  const VI twice_rows = set_int(mips.twice_rows());
  const VI column = (at.column + set_int(mips.left())) >> level,
           row = twice_rows - (twice_rows >> level) + ((at.row + set_int(mips.top())) >> level);
  const V z = gather(mips.data(), row * set_int(mips.stride()) + column);
  return hn::IfThenElse(at.inside, z, set(kBackgroundDepth));
}

/// max(1 - v.v, 0)^3 max(v.n - b, 0) / (v.v + e), 0 for what is not finite.
HWY_INLINE V obscurance(const SaoJob& job, const V3& v, const V3& normal, V bias) {
  const V distance2 = dot(v, v), height = dot(v, normal);
  const V falloff = set(1) - distance2;
  const V term =
      falloff * falloff * falloff * hn::Max(height - bias, set(0)) / (distance2 + set(job.epsilon));
  return hn::IfThenElseZero(distance2 < set(1), term);
}

void sao_of_tile(const SaoJob& job, const Tile& tile, Plane<float>& ao) {
  const D d;
  const ViewPlanes& planes = job.planes;
  set_openness(planes, tile, ao, [&](const ViewReceiver& p, int x, int y) HWY_ATTR {
    const V disc = length_px(planes, p, job.disc_px);
    const V angle = spin_angle(unsigned(x + planes.first_column), unsigned(y + planes.first_row));
    const V cosine = hn::Cos(d, angle) * disc, sine = hn::Sin(d, angle) * disc;
    const V stretch = set(planes.fx / planes.fy);
    const V bias = hn::MulAdd(p.rounding, set(job.inverse_radius), set(job.bias));
    V sum = set(0);
    for (const SpiralTap& tap : job.taps) {
      const V right = hn::Trunc((set(tap.x) * cosine - set(tap.y) * sine) * stretch),
              down = hn::Trunc(set(tap.x) * sine + set(tap.y) * cosine);
      const Pixels at = pixels_at(planes, p.x + right, p.y + down);
      const V z = mip_depth(job.mips, at, set(tap.distance) * disc);
      const V3 v = way_to(planes, p, right, down, z);
      sum = sum + obscurance(job, v * set(job.inverse_radius), p.normal, bias);
    }
    return hn::NegMulAdd(sum, set(job.scale), set(1));
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(sao_of_tile);

namespace {

std::vector<SpiralTap> spiral(int count, int turns, unsigned seed) {
  const double turn = fraction(seed * kR2First), along = fraction(0.5 + seed * kR2Second);
  std::vector<SpiralTap> taps;
  for (int i = 0; i < count; ++i) {
    const double distance = (i + along) / count,
                 angle = (distance * turns + turn) * 2 * std::numbers::pi;
    taps.push_back(
        {float(distance * std::cos(angle)), float(distance * std::sin(angle)), float(distance)});
  }
  return taps;
}

Products estimate(const Scene& scene, const Request& request, const Progress& progress) {
  const auto parameter = [&](const char* name) { return request.parameters.find(name)->second; };
  const int samples = int(parameter("samples"));
  const ViewPlanes planes = make_view_planes(scene.geometry);
  const DepthMips mips(planes);
  const SaoJob job{planes,
                   mips,
                   spiral(samples, int(parameter("turns")), request.seed),
                   1 / request.radius,
                   planes.fy * request.radius,
                   float(5 * parameter("intensity") / samples),
                   float(parameter("bias")),
                   float(parameter("epsilon"))};
  const auto find = [&](const Tile& tile, Plane<float>& ao) {
    HWY_DYNAMIC_DISPATCH(sao_of_tile)(job, tile, ao);
  };
  return products_of_ao(scene, request, find_openness(planes, progress, find));
}

/// Taps cover the disc evenly where the turns of the spiral are near their number times the golden
/// ratio, as McGuire's 7 turns of 11 are, and share no factor with it.
Rung spiral(int samples) {
  int turns = int(0.618 * samples + 0.5);
  while (std::gcd(turns, samples) != 1) ++turns;
  return {{{"samples", samples}, {"turns", turns}}};
}

}  // namespace

Method sao_method() {
  return {
      .name = "sao",
      .summary = "scalable ambient obscurance, McGuire et al. 2012",
      .products = {.ao = true, .direct = true},
      .supports = {.radius = true},
      .pattern_size = 4,
      .published_filter = {"depth"},
      .parameters =
          {
              {"samples", 11, 1, 1024, "", "taps per pixel", true},
              {"turns", 7, 1, 1024, "", "of the spiral; shares no factor with samples", true},
              {"intensity", 1, 0, 100, "", "gain of the obscurance"},
              {"bias", 0.01, 0, 1, "radii", "surfaces lower above the tangent plane do not hide"},
              {"epsilon", 0.01, 1e-6, 1, "radii^2", "holds back the nearest surfaces"},
          },
      .samples_per_pixel = [](const Request& r) { return int(r.parameters.at("samples")); },
      .estimate = estimate,
      .ladder = {.rungs = {spiral(7), spiral(11), spiral(23), spiral(47)},
                 .limit = spiral(1013),
                 .seeds = 4},
  };
}

}  // namespace ssdo
#endif
