// SPDX-License-Identifier: Apache-2.0
#include "scene/gbuffer/background.h"

#include <fmt/format.h>

#include <atomic>
#include <glm/geometric.hpp>
#include <utility>

#include "math/half_color.h"
#include "parallel/planes.h"
#include "parallel/tiles.h"
#include "scene/depth_model.h"

namespace ssdo {
namespace {

/// Alpha up to this is no coverage.
constexpr float kLeastAlpha = 1e-4f;

/// Where half floats end: what is stored in 16 bits and is this or more had no room.
constexpr float kLargestHalf = HalfColor::kMost;

/// The value from which on coordinates, or the depth that they are made from, show nothing.
float empty_from(const GBuffer& g) {
  return g.position_step < kStepHalf ? kEmptyDepth : kLargestHalf;
}

/// False for not-a-number.
bool is_missing(const glm::vec3& p, float empty) { return !(glm::length(p) < empty); }

bool shows_nothing(float depth, float background_depth) {
  return !(depth < background_depth && depth > 0);
}

/// Whether the layer of normals holds anything: one that is 0 at every position shows no
/// background.
bool has_normals(const GBuffer& g) {
  for (std::size_t i = 0; i < g.normal.size(); ++i) {
    if (g.normal[i] != glm::vec3(0)) return true;
  }
  return false;
}

/// How a depth that contradicts P relates to it, as far as that can be told.
std::string relation_to_position(const GBuffer& g, const Plane<unsigned char>& counts) {
  auto inverse = Plane<float>::like(g.depth);
  for (std::size_t i = 0; i < inverse.size(); ++i) inverse[i] = 1 / g.depth[i];
  if (DepthModel::fit(g.position, inverse, counts, g.position_step))
    return "it is 1 / Z: give --depth-kind inverse";
  const auto model = DepthModel::fit_in_any_unit(g.position, g.depth, counts, g.position_step);
  if (!model) return "remapped, or of another frame";
  return fmt::format(
      "it changes by {:.3g} per unit of P: of another unit, or remapped, for which "
      "there is --depth-kind normalized:NEAR,FAR",
      model->length_of_unit());
}

/// Finds the relation between P and the depth, or that the depth contradicts P.
void hold_depth_to_position(GBuffer& g) {
  if (g.position.empty() || g.depth.empty()) return;
  Plane<unsigned char> counts(g.window.width(), g.window.height());
  const float empty = empty_from(g);
  std::atomic<std::size_t> both = 0, without_depth = 0;
  for_each_row(counts.height, [&](int y) {
    std::size_t both_in_row = 0, without_in_row = 0;
    for (std::size_t i = counts.index(0, y), end = counts.index(0, y + 1); i < end; ++i) {
      const bool covered = g.alpha.empty() || g.alpha[i] > kLeastAlpha;
      if (!covered || is_missing(g.position[i], empty) || g.position[i] == glm::vec3(0)) continue;
      const bool in_depth = !shows_nothing(g.depth[i], kEmptyDepth);
      counts[i] = in_depth;
      both_in_row += in_depth;
      without_in_row += !(g.depth[i] > 0);
    }
    both += both_in_row, without_depth += without_in_row;
  });
  // A layer that is 0 or not a number wherever P shows a surface was never written.
  const bool unwritten = both == 0 && without_depth > 0;
  if (!unwritten && both < DepthModel::kFewestPixels) return;
  auto& model = g.encodings.depth_of_position;
  model = DepthModel::fit(g.position, g.depth, counts, g.position_step);
  if (model) {
    g.depth_kind = model->kind();
    g.depth_source = "P";
    return;
  }
  g.encodings.depth_is_wrong = true;
  g.warnings.push_back(fmt::format("depth contradicts P ({}) and is left out",
                                   unwritten ? "it is empty" : relation_to_position(g, counts)));
}

/// Whether P, or the depth where there is no P, has a surface at a pixel, whatever alpha says.
bool shows_surface(const GBuffer& g, std::size_t i, bool has_normals) {
  if (has_normals && g.normal[i] == glm::vec3(0)) return false;
  if (!g.depth.empty() && shows_nothing(g.depth[i], kEmptyDepth)) return false;
  return g.position.empty() ||
         (g.position[i] != glm::vec3(0) && !is_missing(g.position[i], empty_from(g)));
}

/// Whether alpha is 0 in all pixels, also where other layers show a surface: it was never written.
bool is_alpha_unwritten(const GBuffer& g) {
  // Normals that are 0 everywhere were not written either, and tell nothing.
  const bool has_normals =
      std::ranges::any_of(g.normal.pixels, [](const glm::vec3& n) { return n != glm::vec3(0); });
  bool shown = false;
  for (std::size_t i = 0; i < g.alpha.size(); ++i) {
    if (g.alpha[i] > kLeastAlpha) return false;
    shown = shown || shows_surface(g, i, has_normals);
  }
  return shown;
}

}  // namespace

void find_background(GBuffer& g, std::optional<float> background_depth,
                     const std::optional<Encodings>& known) {
  Encodings& found = g.encodings;
  if (known) {
    found = *known;
  } else {
    if (is_alpha_unwritten(g)) g.alpha = {};
    hold_depth_to_position(g);
    found.normals_tell = has_normals(g);
  }
  if (found.depth_is_wrong) g.depth = {};
  // A layer that was left out after a first reading is not there in the next.
  if (g.normal.empty()) found.normals_tell = false;
  const std::optional<DepthModel>& depth_of_position = found.depth_of_position;
  const float empty = empty_from(g), empty_depth = g.position.empty() ? empty : kEmptyDepth,
              far = background_depth ? *background_depth * (1 - 1e-6f) : empty_depth;
  g.valid = filled<unsigned char>(g.window.width(), g.window.height(), 0);
  Plane<unsigned char> broken_pixels = g.valid;
  std::atomic<std::size_t> background_pixels = 0, bad_pixels = 0;
  for_each_row(g.valid.height, [&](int y) {
    std::size_t background_in_row = 0, bad_in_row = 0;
    for (int x = 0; x < g.valid.width; ++x) {
      const std::size_t i = g.valid.index(x, y);
      if (g.lead_window && !g.lead_window->contains(g.window.x0 + x, g.window.y0 + y)) {
        ++background_in_row;
        continue;
      }
      const bool nothing_in_depth = !g.depth.empty() && shows_nothing(g.depth[i], far);
      bool background = nothing_in_depth || (!g.alpha.empty() && g.alpha[i] <= kLeastAlpha);
      const bool no_normal = found.normals_tell && g.normal[i] == glm::vec3(0);
      background |= no_normal && g.position.empty();
      bool broken = false;
      if (!g.position.empty()) {
        const glm::vec3& p = g.position[i];
        const bool suspect = no_normal || p == glm::vec3(0);
        background |= suspect && !(depth_of_position && depth_of_position->agrees(p, g.depth[i]));
        broken = is_missing(p, empty);
        background |= broken && !depth_of_position;
      }
      background_in_row += background;
      broken_pixels[i] = !background && broken;
      bad_in_row += broken_pixels[i];
      g.valid[i] = !background && !broken;
    }
    background_pixels += background_in_row, bad_pixels += bad_in_row;
  });
  g.background_pixels += background_pixels;
  g.bad_pixels += bad_pixels;
  g.broken = bad_pixels > 0 ? std::move(broken_pixels) : Plane<unsigned char>();
}

}  // namespace ssdo
