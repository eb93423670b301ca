// SPDX-License-Identifier: Apache-2.0
//
// Multi-Scale Volumetric Obscurance, as in Unity's post-processing package, which has it from
// Microsoft's MiniEngine. It needs depth alone.
//
// The idea is the paper's, Loos and Sloan, "Volumetric Obscurance", I3D 2010: how much of a sphere
// about p is free, summed over chords along the view axis. A chord at distance r R from the centre
// has the half length t R, t = sqrt(1 - r^2); the surface visible there at depth Z leaves free
//
//   D = 1/2 + (Z - Z_p) / (2 t R),   clamped to 0..1,   ao(p) = 2 sum t D / sum t.
//
// What is Unity's:
// - Samples come in pairs, p + o and p - o, that share what is free: saturate(D + D'). A plane
//   leaves half of each chord free where it faces the viewer; where it is tilted, one side gains
//   what the other loses. Either way the pair is open.
// - A surface in front of the sphere, D < 0, is discounted by q = saturate(-D / T), T the thickness
//   modifier: its pair is saturate(clamp(D, q', 1) + clamp(D', q, 1) - q q'), open where q is 1.
// - 36 samples on the points of a checkerboard with distances below 5 steps. The sphere's radius
//   is 5 steps of 4 pixels at a half, a quarter, an eighth and a sixteenth of the resolution: 40,
//   80, 160 and 320 pixels wherever it is, so that --radius has no say.
// - ao is the product of the scales, each of them upsampled to the next; see msvo/scales.cpp.
//
// What differs, and why:
// - Spheres have their true size under an orthographic camera, where the source scales by depth.
// - Beyond the frame, the outermost pixels are repeated. The source reads the last of every fourth
//   pixel.
// - Background is infinitely far, not 10^5 far planes.
//
// Known faults, kept: halos of what stands before a far background where T is large, since what
// should be forgiven then hides; transitions softer than in methods with rays, as a coarse scale
// is blurred; sizes that follow the resolution, so that a larger picture has smaller shadows; every
// scale takes the upper left pixel of four, so that it jumps when things move.
//
// The direct light is the irradiance of the pixel's normal times ao. A crop changes pixels within
// 352 pixels of its border: the widest sphere's samples and the blur.
#include "estimators/msvo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "estimators/msvo/scales.h"
#include "estimators/view_space/openness.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/msvo.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"

#ifndef SSDO_MSVO_CHORDS_
#define SSDO_MSVO_CHORDS_
namespace ssdo {

/// Chords at opposite places of the disc.
struct ChordPair {
  int x, y;            ///< of one of them, in pixels of the scale
  float inverse_half;  ///< 1 / t
  float weight;        ///< shares of all pairs add up to 1
};

struct MsvoJob {
  const DepthScale& scale;
  std::array<ChordPair, 18> pairs;
  bool orthographic;
  float inverse_diameter;  ///< of the sphere; of its share of the depth where not orthographic
  float rejection;         ///< 1 / T
  float intensity;
};

}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// What a pair leaves free, 0..1.
HWY_INLINE V free_share(V free1, V free2, V rejection) {
  const V one = set(1), forgiven1 = saturate(set(0) - free1 * rejection),
          forgiven2 = saturate(set(0) - free2 * rejection);
  const V part1 = hn::Min(hn::Max(free1, forgiven2), one),
          part2 = hn::Min(hn::Max(free2, forgiven1), one);
  return saturate(part1 + part2 - forgiven1 * forgiven2);
}

void obscure_row(const MsvoJob& job, int y, float* open) {
  const DepthScale& scale = job.scale;
  for (int x = 0; x < scale.width; x += kLanes) {
    const V depth = load(scale.depth.row(y) + x);
    const V per_chord =
        job.orthographic ? set(job.inverse_diameter) : set(job.inverse_diameter) / depth;
    V sum = set(0);
    for (const ChordPair& pair : job.pairs) {
      const V scaled = per_chord * set(pair.inverse_half);
      const V z1 = load(scale.row(scale.depth, y + pair.y) + x + pair.x),
              z2 = load(scale.row(scale.depth, y - pair.y) + x - pair.x);
      const V free1 = hn::MulAdd(z1 - depth, scaled, set(0.5f)),
              free2 = hn::MulAdd(z2 - depth, scaled, set(0.5f));
      sum = hn::MulAdd(set(pair.weight), free_share(free1, free2, set(job.rejection)), sum);
    }
    const V ao = saturate(hn::MulAdd(sum - set(1), set(job.intensity), set(1)));
    store(hn::IfThenElse(shows_surface(hn::Neg(depth)), ao, set(1)), open + x);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(obscure_row);

namespace {

constexpr int kCoarsest = 4;
constexpr int kSphere = 5;  ///< radius in steps
constexpr int kStep = 4;    ///< pixels of a scale

std::array<ChordPair, 18> checkerboard() {
  std::array<ChordPair, 18> pairs;
  std::size_t count = 0;
  float sum = 0;
  for (int y = 0; y < kSphere; ++y) {
    for (int x = 1 - kSphere; x < kSphere; ++x) {
      const int distance2 = x * x + y * y;
      const bool once =
          y > 0 || x > 0;  // the other half of the disc is the other half of the pairs
      if ((x + y) % 2 != 0 || !once || distance2 >= kSphere * kSphere) continue;
      const float half = std::sqrt(1 - float(distance2) / (kSphere * kSphere));
      pairs[count++] = {kStep * x, kStep * y, 1 / half, half};
      sum += half;
    }
  }
  for (ChordPair& pair : pairs) pair.weight /= sum;
  return pairs;
}

Products estimate(const Scene& scene, const Request& request, const Progress& progress) {
  const auto parameter = [&](const char* name) { return request.parameters.find(name)->second; };
  const ViewPlanes planes = make_view_planes(scene.geometry);
  std::vector<DepthScale> scales = make_depth_scales(planes, kCoarsest);
  for (int k = 1; k <= kCoarsest; ++k) {
    DepthScale& scale = scales[std::size_t(k)];
    const float diameter_px = float(2 * kSphere * kStep << k);
    const MsvoJob job{scale,
                      checkerboard(),
                      planes.orthographic,
                      planes.fx / diameter_px,
                      float(1 / parameter("thickness")),
                      float(parameter("intensity"))};
    for_each_row(scale.height, [&](int y) {
      HWY_DYNAMIC_DISPATCH(obscure_row)(job, y, scale.open.row(y));
      scale.repeat_ends(scale.open, y);
    });
  }
  const double depth_tolerance = std::pow(10, parameter("upsample-tolerance"));
  for (int k = kCoarsest; k > 0; --k) {
    // The display window's width, so that a crop is blurred alike.
    const int width = (scene.geometry.display.width() + (1 << k) - 1) >> k;
    const double step = 1920.0 / width,
                 tolerance = 1 - std::pow(10, parameter("blur-tolerance")) * step;
    const Upsampling how{float(1 / parameter("far")), float(step), float(tolerance * tolerance),
                         float(depth_tolerance),
                         float(1 / (std::pow(10, parameter("noise-tolerance")) + depth_tolerance))};
    upsample(scales[std::size_t(k)], how, k > 1, scales[std::size_t(k - 1)]);
    if (progress) progress(std::size_t(kCoarsest - k + 1), std::size_t(kCoarsest));
  }
  Plane<float> ao(planes.width(), planes.height());
  for (int y = 0; y < planes.height(); ++y)
    std::copy_n(scales[0].open.row(y), planes.width(), &ao(0, y));
  return products_of_ao(scene, request, std::move(ao));
}

}  // namespace

Method msvo_method() {
  return {
      .name = "msvo",
      .summary = "multi-scale volumetric obscurance, as in Unity, with sizes in pixels",
      .products = {.ao = true, .direct = true},
      .supports = {},
      .pattern_size = 1,
      .published_filter = {"none"},
      .parameters =
          {
              {"intensity", 1, 0, 4, "", "gain of the obscurance"},
              {"thickness", 1, 1, 10, "chords", "over which what is in front is forgiven"},
              {"far", 1000, 1e-6, 1e9, "units", "far plane, the unit of the tolerances"},
              {"noise-tolerance", 0, -8, 0, "log10", "the less, the more fine pixels turn open"},
              {"blur-tolerance", -4.6, -8, -1, "log10", "of bends that are blurred across"},
              {"upsample-tolerance", -12, -12, -1, "log10", "of depths between scales"},
          },
      // 36 of each pixel of four scales: 36 (1/4 + 1/16 + 1/64 + 1/256).
      .samples_per_pixel = [](const Request&) { return 12; },
      .estimate = estimate,
      .ladder = {.rungs = {{{}, "four scales"}}, .limit = {{}, "four scales"}},
  };
}

}  // namespace ssdo
#endif
