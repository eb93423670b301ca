// SPDX-License-Identifier: Apache-2.0
//
// What a frame has found, in the form that the others of its shot look up. Compiled once for every
// instruction set.
#include "filters/shot/findings.h"

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "math/luminance.h"
#include "parallel/tiles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/shot/findings.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Half numbers of `count` values, a multiple of Findings::kGroup; 0 for not-a-number.
void to_half(const float* values, int count, std::uint16_t* half) {
  const hn::CappedTag<float, Findings::kGroup> d;
  const hn::Rebind<hwy::float16_t, decltype(d)> halves;
  const hn::Rebind<std::uint16_t, decltype(d)> bits;
  const auto most = hn::Set(d, 65504.0f);
  for (int c = 0; c < count; c += int(hn::Lanes(d))) {
    const auto value = hn::LoadU(d, values + c);
    const auto finite =
        hn::IfThenElseZero(hn::Eq(value, value), hn::Min(hn::Max(value, hn::Neg(most)), most));
    hn::StoreU(hn::BitCast(bits, hn::DemoteTo(halves, finite)), bits, half + c);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(to_half);

namespace {

/// From the deviation of a bent normal from N, as find_visibility() leaves it, to world space.
glm::vec3 to_world(const glm::vec3& deviation, const glm::vec3& normal,
                   const glm::mat3& to_camera) {
  return glm::transpose(to_camera) * turned(deviation, glm::vec3(0, 0, 1), normal);
}

/// Filters keep the light of small bright senders apart; not every frame shows some.
void join_emitted(Plane<glm::vec3>& bounce, Plane<glm::vec3>& emitted) {
  for (std::size_t i = 0; i < emitted.size(); ++i) bounce[i] += emitted[i];
  emitted = {};
}

/// A power of two near the mean size of the values of a plane.
template <class T>
float unit_of(const Plane<T>& plane) {
  double sum = 0;
  for (const T& value : plane.pixels) {
    if constexpr (std::is_same_v<T, float>)
      sum += double(std::abs(value));
    else
      sum += double(std::abs(value.x) + std::abs(value.y) + std::abs(value.z)) / 3;
  }
  const double mean = plane.empty() ? 0 : sum / double(plane.size());
  return mean > 0 && std::isfinite(mean) ? float(std::exp2(std::round(std::log2(mean)))) : 1;
}

void store(float value, float* to) { *to = value; }
void store(const glm::vec3& value, float* to) { std::copy_n(&value.x, 3, to); }

/// The values of a row of pixels, side by side, in their units.
void store_row(Products& products, const Geometry& geometry, int y, Findings& out,
               std::vector<float>& row) {
  const Surfaces& surfaces = geometry.surfaces;
  const glm::mat3 to_camera(geometry.camera.rotation);
  std::size_t channel = 0;
  for_each_found(
      [&](auto& plane, int, bool is_direction) {
        using T = std::decay_t<decltype(plane[0])>;
        if (plane.empty()) return;
        for (int x = 0; x < surfaces.width; ++x) {
          T value = plane(x, y);
          if constexpr (std::is_same_v<T, glm::vec3>) {
            const Surfel& s = surfaces(x, y);
            if (is_direction && s.is_surface()) value = to_world(value, s.normal, to_camera);
          }
          store(value / out.unit[channel],
                &row[std::size_t(x + 1) * std::size_t(out.stride) + channel]);
        }
        channel += channels_of<T>();
      },
      products);
}

}  // namespace

Findings take_findings(Products& products, const Geometry& geometry,
                       const Plane<glm::vec3>& radiance) {
  join_emitted(products.bounce, products.visibility.emitted);
  for (LightProducts& light : products.lights) join_emitted(light.bounce, light.emitted);
  Findings out;
  out.surfaces = keep_surfaces(geometry);
  const KeptSurfaces& surfaces = out.surfaces;
  if (!radiance.empty()) {
    out.glow.resize(surfaces.size());
    for (int y = 0; y < radiance.height; ++y)
      for (int x = 0; x < radiance.width; ++x)
        out.glow[surfaces.index(x, y)] = luminance(radiance(x, y));
  }
  int channels = 0;
  for_each_found(
      [&](auto& plane, int source, bool is_direction) {
        using T = std::decay_t<decltype(plane[0])>;
        const int count = plane.empty() ? 0 : channels_of<T>();
        out.planes.push_back({count, source, is_direction});
        out.unit.insert(out.unit.end(), std::size_t(count), unit_of(plane));
        channels += count;
      },
      products);
  out.stride = (channels + Findings::kGroup - 1) / Findings::kGroup * Findings::kGroup;
  out.unit.resize(std::size_t(out.stride), 1);
  out.values.resize(surfaces.size() * std::size_t(out.stride));
  const int height = surfaces.window.height();
  for_each_row(channels > 0 ? height + 2 : 0, [&](int padded_row) {
    const int y = padded_row - 1;
    std::vector<float> row(std::size_t(surfaces.stride()) * std::size_t(out.stride), 0.0f);
    if (y >= 0 && y < height) store_row(products, geometry, y, out, row);
    HWY_DYNAMIC_DISPATCH(to_half)
    (row.data(), int(row.size()), &out.values[surfaces.index(-1, y) * std::size_t(out.stride)]);
  });
  for_each_found([](auto& plane, int, bool) { plane = {}; }, products);
  return out;
}

}  // namespace ssdo
#endif
