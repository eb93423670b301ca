// SPDX-License-Identifier: Apache-2.0
//
// A position projects to the centre of its own pixel. If P does so under no camera, each known
// encoding is undone in turn: if a camera fits then, P has this encoding. Clipped parts of P are
// recognised by coordinates of exactly 0 or 1 where P misses its pixels.
#include "scene/camera/position_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "parallel/tiles.h"
#include "scene/camera/find_camera.h"
#include "scene/camera/fit.h"
#include "scene/camera/position_rounding.h"
#include "scene/marked_pixels.h"
#include "scene/straight.h"

namespace ssdo {
namespace {

/// Pixels that a camera is fitted to here, and the fewest that tell anything.
constexpr std::size_t kMostPixels = 4000, kFewestPixels = 32;

/// A coordinate counts as clipped if at least kFewestClipped pixels and kLeastClipped of all are at
/// 0 or 1, and half of these miss their places by kClippedMissPx.
constexpr double kFewestClipped = 16, kLeastClipped = 1e-3, kClippedMissPx = 2;

/// An encoding of P is recognised if undoing it leaves less than this part of the distance by
/// which P misses its pixels.
constexpr double kExplained = 0.2;

/// The most that P may miss with its encoding undone if P as it is leaves the camera open.
constexpr double kExactPx = 0.1;

/// P fits no camera if half of it misses its pixels by this share of the picture's diagonal. A lens
/// with 25 % of distortion in the corners stays below, at 1.2 %.
constexpr double kNoCamera = 0.02;

/// P is smooth where a position is nearer to the middle between its neighbours than this share of
/// their distance, and only these pixels are judged if kLeastSmooth of the surfaces are smooth.
constexpr float kStraight = 0.02f;
constexpr double kLeastSmooth = 0.1;

/// Where P fills its unit cube: the most by which the pixel aspect of the camera found may differ
/// from that of the picture.
constexpr double kSameAspect = 0.02;

/// An encoding of coordinates that has to be undone before a camera is fitted.
struct Encoding {
  std::string_view name;  ///< of what undoes it
  double (*decode)(double magnitude);
};

double from_srgb(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
double to_srgb(double v) {
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

/// Gammas of displays and cameras, applied once or undone once too often.
constexpr std::array<Encoding, 9> kEncodings = {{
    {"P^2.2", [](double v) { return std::pow(v, 2.2); }},
    {"P decoded from sRGB", from_srgb},
    {"P^2.4", [](double v) { return std::pow(v, 2.4); }},
    {"P^1.8", [](double v) { return std::pow(v, 1.8); }},
    {"P^2", [](double v) { return v * v; }},
    {"P^(1/2.2)", [](double v) { return std::pow(v, 1 / 2.2); }},
    {"P encoded with sRGB", to_srgb},
    {"P^(1/2.4)", [](double v) { return std::pow(v, 1 / 2.4); }},
    {"P^(1/1.8)", [](double v) { return std::pow(v, 1 / 1.8); }},
}};

Plane<unsigned char> thinned(const Plane<unsigned char>& mask) {
  // An odd stride, so that what is left does not line up in columns.
  const std::size_t stride = (count_marked(mask) / kMostPixels) | 1;
  Plane<unsigned char> thin(mask.width, mask.height);
  for (const std::size_t i : every_marked(mask, stride)) thin[i] = 1;
  return thin;
}

/// The median miss of the pixels of a mask under the camera that fits them best; infinite if they
/// are too few or determine no camera.
double least_miss_px(const Plane<glm::vec3>& positions, const Plane<unsigned char>& mask,
                     const Window& window) {
  if (count_marked(mask) < kFewestPixels) return INFINITY;
  const auto camera = fit_camera(positions, mask, window);
  return camera ? median_miss_px(*camera, positions, mask, window) : INFINITY;
}

struct Bounds {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{-low};
};

Bounds bounds_of(const GBuffer& g) {
  std::vector<Bounds> of_rows(std::size_t(g.position.height));
  for_each_row(g.position.height, [&](int y) {
    Bounds bounds;
    for (std::size_t i = g.position.index(0, y); i < g.position.index(0, y + 1); ++i) {
      if (!g.valid[i]) continue;
      bounds.low = glm::min(bounds.low, g.position[i]);
      bounds.high = glm::max(bounds.high, g.position[i]);
    }
    of_rows[std::size_t(y)] = bounds;
  });
  Bounds all;
  for (const Bounds& row : of_rows)
    all = {glm::min(all.low, row.low), glm::max(all.high, row.high)};
  return all;
}

/// An end of the range of coordinates along an axis: 0 as their minimum, or 1 as their maximum.
struct End {
  int axis;
  float value;
};

std::vector<End> ends_of(const GBuffer& g) {
  const auto [low, high] = bounds_of(g);
  std::vector<End> ends;
  for (int axis = 0; axis < 3; ++axis) {
    if (low[axis] == high[axis]) continue;
    if (low[axis] == 0) ends.push_back({axis, 0});
    if (high[axis] == 1) ends.push_back({axis, 1});
  }
  return ends;
}

/// The pixels whose coordinate is at an end.
Plane<unsigned char> pixels_at(const GBuffer& g, const End& end) {
  Plane<unsigned char> at(g.valid.width, g.valid.height);
  for (std::size_t i = 0; i < at.size(); ++i)
    at[i] = g.valid[i] && g.position[i][end.axis] == end.value;
  return at;
}

/// A camera and the median by which it misses the pixels that it was found from.
struct Fitted {
  std::optional<Camera> camera;
  double miss_px;
};

/// Fits a camera to the pixels that are at none of the ends.
Fitted fit_between(const GBuffer& g, const std::vector<End>& ends) {
  Plane<unsigned char> between = g.valid;
  for (std::size_t i = 0; i < between.size(); ++i)
    for (const End& end : ends) between[i] &= g.position[i][end.axis] != end.value;
  between = thinned(between);
  const auto camera = fit_camera(g.position, between, g.window);
  if (!camera || !explains(*camera, g.position, between, g.window, rounding_of_positions(g)))
    return {std::nullopt, INFINITY};
  return {camera, median_miss_px(*camera, g.position, between, g.window)};
}

/// The message for a P that was clipped at 0 or 1; empty if it was not. A floor at 0 lies at an end
/// too, but projects to its own pixels. `fitted` has a camera if the frame's camera explains P.
std::string find_clipping(const GBuffer& g, Fitted fitted) {
  const std::vector<End> ends = ends_of(g);
  if (ends.empty()) return "";
  if (!fitted.camera) fitted = fit_between(g, ends);
  if (!fitted.camera) return "";
  const auto count = std::count(g.valid.pixels.begin(), g.valid.pixels.end(), 1);
  for (const End& end : ends) {
    const Plane<unsigned char> at = pixels_at(g, end);
    const auto clipped = std::count(at.pixels.begin(), at.pixels.end(), 1);
    if (double(clipped) < std::max(kFewestClipped, kLeastClipped * double(count))) continue;
    const double miss = median_miss_px(*fitted.camera, g.position, at, g.window);
    if (miss < std::max(kClippedMissPx, fitted.miss_px / kExplained)) continue;
    return fmt::format(
        "looks clipped at {0:g}: its {1} is {0:g} in {2} pixels ({3:.2g} % of the surfaces), half "
        "of which miss their places by {4:.2g} px or more; export P in 32-bit float, as it is",
        end.value, "xyz"[end.axis], clipped, 100 * double(clipped) / double(count), miss);
  }
  return "";
}

/// Whether nearly all values have length 1.
bool has_length_1(const std::vector<glm::vec3>& values) {
  const auto of_length_1 = std::count_if(values.begin(), values.end(), [](const glm::vec3& v) {
    return std::abs(glm::length(v) - 1) < 0.01f;
  });
  return 20 * std::size_t(of_length_1) > 19 * values.size();
}

/// Whether all coordinates are multiples of 1/255 from 0 to 1, with more than 16 different values.
bool is_in_8_bits(const GBuffer& g) {
  const float rounding = 1e-3f + 255 * g.position_step / 4;
  std::array<bool, 256> has{};
  for (std::size_t i = 0; i < g.position.size(); ++i) {
    if (!g.valid[i]) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const float level = 255 * g.position[i][axis];
      if (!(level >= 0 && level <= 255) || std::abs(level - std::round(level)) > rounding)
        return false;
      has[std::size_t(std::round(level))] = true;
    }
  }
  return std::count(has.begin(), has.end(), true) > 16;
}

/// Whether the coordinates of each axis go from 0 to 1.
bool fills_unit_cube(const GBuffer& g) {
  constexpr float kEnd = 1e-3f;
  const auto [low, high] = bounds_of(g);
  for (int axis = 0; axis < 3; ++axis)
    if (low[axis] < 0 || low[axis] > kEnd || high[axis] < 1 - kEnd || high[axis] > 1) return false;
  return true;
}

/// The surfaces where P goes on in a straight line along both axes of the picture: averages over
/// edges are left out.
Plane<unsigned char> smooth_pixels(const GBuffer& g) {
  Plane<unsigned char> smooth(g.valid.width, g.valid.height);
  const auto is_straight = [&](std::size_t before, std::size_t i, std::size_t after) {
    return g.valid[before] && g.valid[after] &&
           ssdo::is_straight(g.position[before], g.position[i], g.position[after], kStraight);
  };
  for (int y = 1; y + 1 < g.valid.height; ++y) {
    for (int x = 1; x + 1 < g.valid.width; ++x) {
      const std::size_t i = g.valid.index(x, y), row = std::size_t(g.valid.width);
      smooth[i] = g.valid[i] && is_straight(i - 1, i, i + 1) && is_straight(i - row, i, i + row);
    }
  }
  return smooth;
}

/// Whether a camera fits P where it is smooth, so that P is a position with averages in it.
bool is_right_where_smooth(const GBuffer& g) {
  const Plane<unsigned char> smooth = smooth_pixels(g);
  const auto count = [](const Plane<unsigned char>& mask) {
    return double(std::count(mask.pixels.begin(), mask.pixels.end(), 1));
  };
  return count(smooth) >= kLeastSmooth * count(g.valid) &&
         least_miss_px(g.position, thinned(smooth), g.window) < 0.5;
}

/// What undoes an encoding of P, and what a camera then misses.
struct Decoded {
  std::string_view name;
  double miss_px = INFINITY;
};

/// The encoding under which P fits a camera best, with or without the pixels where a coordinate is
/// 0 or less, which may have been clipped too.
Decoded find_encoding(const GBuffer& g, const Plane<unsigned char>& mask) {
  Plane<unsigned char> above_0 = mask;
  for (std::size_t i = 0; i < mask.size(); ++i)
    above_0[i] &= std::min({g.position[i].x, g.position[i].y, g.position[i].z}) > 0;
  Decoded best;
  for (const Encoding& encoding : kEncodings) {
    Plane<glm::vec3> decoded = g.position;
    for (std::size_t i = 0; i < decoded.size(); ++i) {
      if (!mask[i]) continue;
      for (int c = 0; c < 3; ++c) {
        const double v = g.position[i][c];
        decoded[i][c] = float(std::copysign(encoding.decode(std::abs(v)), v));
      }
    }
    const double miss =
        std::min(least_miss_px(decoded, mask, g.window), least_miss_px(decoded, above_0, g.window));
    if (miss < best.miss_px) best = {encoding.name, miss};
  }
  return best;
}

/// What a P that misses its pixels by `miss_px` looks like, and what to do; empty if nothing is
/// recognised. `miss_px` is infinite if no camera was found.
std::string recognise(const GBuffer& g, double miss_px) {
  const Plane<unsigned char> mask = thinned(g.valid);
  std::vector<glm::vec3> values, as_vectors;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    values.push_back(g.position[i]);
    as_vectors.push_back(2.0f * g.position[i] - 1.0f);
  }
  if (values.size() < kFewestPixels) return "";
  const bool stored = has_length_1(values);
  if (stored || has_length_1(as_vectors))
    return fmt::format(
        "has length 1 everywhere{}: looks like normals; name the layer of P with "
        "--aov position=LAYER",
        stored ? "" : ", as 2P - 1");
  const bool open = !std::isfinite(miss_px);
  const double enough = open ? kExactPx : kExplained * miss_px;
  const std::string as_it_is =
      open ? "as it is, P fits none"
           : fmt::format("as it is, half of P misses by {:.2g} px", miss_px);
  const Decoded encoding = find_encoding(g, mask);
  const double stretched = open ? INFINITY : projective_miss_px(g.position, mask, g.window);
  if (encoding.miss_px < std::min(enough, stretched))
    return fmt::format(
        "looks gamma-encoded: {} fits a camera to {:.2g} px, and {}; export it as "
        "data, without a colour transform",
        encoding.name, encoding.miss_px, as_it_is);
  if (stretched < enough)
    return fmt::format(
        "looks {}: with a scale for each axis it fits a camera to {:.2g} px, and "
        "{}; export P in scene units",
        fills_unit_cube(g) ? "normalised to its bounding box" : "stretched or sheared", stretched,
        as_it_is);
  return "";
}

/// Whether P was scaled to its bounding box, each axis separately. Seen by a level camera, such a P
/// still fits a camera, but one with pixels of another shape.
bool is_stretched_to_unit_cube(const GBuffer& g, const Camera& camera) {
  const double aspect = camera.fy / camera.fx / double(g.pixel_aspect);
  return std::abs(std::log(aspect)) > kSameAspect && fills_unit_cube(g);
}

}  // namespace

std::string find_fault_of_positions(const GBuffer& g, const Camera* camera) {
  if (is_in_8_bits(g))
    return "has steps of 1/255: looks stored in 8 bits; export P in 32-bit float";
  const double miss_px = camera ? median_miss_px(*camera, g.position, g.valid, g.window) : INFINITY;
  const bool fits = camera && (miss_px < 0.5 || explains(*camera, g.position, g.valid, g.window,
                                                         rounding_of_positions(g)));
  const std::string clipping =
      find_clipping(g, fits ? Fitted{*camera, miss_px} : Fitted{std::nullopt, INFINITY});
  if (!clipping.empty()) return clipping;
  if (fits && is_stretched_to_unit_cube(g, *camera))
    return "looks normalised to its bounding box: each axis goes from 0 to 1, and the camera that "
           "fits has pixels of another shape; export P in scene units";
  if (fits) return "";
  const std::string finding = recognise(g, miss_px);
  const double diagonal = std::hypot(g.window.width(), g.window.height());
  if (!finding.empty() || !camera || miss_px < kNoCamera * diagonal || is_right_where_smooth(g))
    return finding;
  return fmt::format(
      "fits no camera: half of it misses its pixels by {:.2g} px or more; is it P of "
      "this camera, without a filter? --aov position=LAYER names its layer",
      miss_px);
}

}  // namespace ssdo
