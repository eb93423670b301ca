// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "estimators/ladder.h"
#include "estimators/products.h"
#include "parallel/tiles.h"
#include "scene/scene.h"

namespace ssdo {

/// A parameter of one method, set with --set NAME=VALUE.
struct Parameter {
  std::string_view name;
  double value;  ///< default
  double low, high;
  std::string_view unit;
  std::string_view meaning;
  bool whole = false;           ///< takes whole numbers only
  std::string_view words = "";  ///< names of the values 0, 1, ..., between blanks, to write them by
};

/// The parameter `roughness`, which every method with reflections has.
inline constexpr Parameter kRoughness = {
    "roughness", 0.5, 0, 1, "", "of what mirrors, where there is no layer of it"};

/// The index of refraction, which every method with specular light has.
inline constexpr Parameter kIndexOfRefraction = {
    "ior", 1.5, 1,
    1e6,   "",  "of what mirrors, where there is no layer specular-color; 1e6: F0 is 1"};

using ParameterValues = std::map<std::string, double, std::less<>>;

/// A filter of a map of ao. `guide` has the size of the map: what each of its pixels shows.
using MapFilter = std::function<Plane<float>(Plane<float> map, const Surfaces& guide)>;

/// What a method keeps of an overview of a frame whose rows come one band after the other: each
/// method that works on bands has its own.
struct OverviewScene;

/// Sums over the pixels of a frame, from which offscreen_sun_visibility() estimates how enclosed it
/// is.
struct Enclosure {
  double ao = 0, surfaces = 0;  ///< the ao of surfaces, and their number
  /// Sums of the squared sine of elevation over pixels above the horizon: those that show surfaces,
  /// and those that show sky.
  double walls = 0, sky = 0;
  double above = 0, pixels = 0;  ///< pixels above the horizon, which those near it count for in
                                 ///< part, and all pixels that tell
};

/// What is known of a frame around a band of its rows.
struct AroundBand {
  std::shared_ptr<const OverviewScene> far;  ///< of the whole frame
  bool continues_in_overview = false;        ///< marches go on in `far` beyond `reach_rows`; false:
                                             ///< nothing there is within reach
  int reach_rows = 0;  ///< rows above and below a pixel that may block its light
  std::optional<Enclosure> enclosure = {};  ///< of the frame; not known: that of `far`
};

/// What a method has found at a pixel: ao; `open_ao`, the ao if surfaces end at the border of the
/// frame; the bent normal, unit, in camera space.
struct FoundVisibility {
  float ao, open_ao;
  glm::vec3 bent;
};

/// What a learned prior says of the pixels of a geometry, for the light that they send.
struct LearnedVisibility {
  Plane<float> change;  ///< of ao
  Plane<float>
      offscreen_sun;  ///< share of a sun that comes past the border where nothing shown hides it
};

/// What a method asks a prior.
struct PriorQuestion {
  const Scene& scene;
  Window part;  ///< pixels that are asked about, counted from the first of the geometry
  std::function<FoundVisibility(std::size_t pixel)> found;  ///< by number in the geometry
  bool for_light;                                           ///< whether the answer is looked at
  float offscreen_sun;  ///< by rules: share of a sun that comes past the border where nothing hides
                        ///< it
};
using AskPrior = std::function<LearnedVisibility(const PriorQuestion&)>;

/// What is asked of a method.
struct Request {
  ProductSet products;
  ProductSet by_light = {};  ///< those of direct and bounce that are also made by light
  float radius = 0;          ///< scene units; infinity: without limit
  int bounces = 0;
  unsigned seed = 0;             ///< of the sampling pattern
  ParameterValues parameters{};  ///< every one that the method has

  // For methods that march through slices of the frame.
  int slices = 2;                ///< per pixel
  int steps = 16;                ///< per side of a slice, from one pixel to the frame's diagonal
  bool extend_offscreen = true;  ///< surfaces go on beyond the frame
  /// Filter between ao at half resolution and its upsampling, for methods that work so. May be
  /// empty.
  MapFilter filter_half = {};
  bool visibility_suffices =
      false;                ///< `direct` may stay empty where Products::visibility make it up
  AskPrior ask_prior = {};  ///< by methods that take it; empty: there is no prior
  /// Pixels that gather light: a part of the geometry's window. Products have the size of the part.
  /// All pixels of the geometry occlude and send light. Area 0: the whole window.
  Window receivers = {};
  /// Set where the geometry is a band: its rows reach at least (1 + bounces) x reach_rows beyond
  /// the receivers, or to the frame's border.
  std::optional<AroundBand> around_band = {};
};

/// The options of the model that a method takes.
struct SupportedOptions {
  bool radius = false;           ///< --radius; without it, the method's sizes are its own
  bool infinite_radius = false;  ///< --radius inf; `auto` then means inf
  bool thickness = false;        ///< --thickness: the method uses Scene::solids
  bool march = false;            ///< --quality, --slices, --steps, --offscreen and --error
  bool receivers = false;        ///< Request::receivers; without it, all pixels gather
  bool prior = false;            ///< --prior learned: the method makes what that asks of it
};

/// The filter with which a method's source ends.
struct PublishedFilter {
  std::string_view name;  ///< of a row in the table of filters
  /// Whether it is Request::filter_half for these parameters; null: always after the estimate.
  bool (*at_half_resolution)(const ParameterValues&) = nullptr;
};

/// What a method needs to work on the bands of a frame.
struct BandSupport {
  /// Prepares an overview of the frame, in which marches of bands continue from `from_px` pixels of
  /// the frame on. Null: the method works on whole frames only.
  std::shared_ptr<const OverviewScene> (*overview)(const Scene&, const Request&, float from_px,
                                                   const Progress&) = nullptr;
  /// How many rows above and below a pixel may hold what blocks its light within the radius, at
  /// most as many as the frame has. `some` pixels of the frame, rows or one of every `stride` x
  /// `stride`, tell how near its surfaces come.
  int (*reach_rows)(const Geometry& some, int stride, const Window& frame, const Window& display,
                    const Request&) = nullptr;
  /// Whether light depends on the enclosure of the frame, more than Request::around_band tells.
  bool (*needs_enclosure)(const Scene& overview, const Request&) = nullptr;
  /// Adds the enclosure of the receivers in a band. If bands come from top to bottom, the sums have
  /// the same bits as those of the frame in one piece.
  void (*add_enclosure)(const Scene& band, const Request&, Enclosure&) = nullptr;
};

/// A row in the table of methods.
struct Method {
  std::string_view name, summary;
  ProductSet products;  ///< what it can make
  SupportedOptions supports;
  int pattern_size = 1;  ///< its noise repeats every pattern_size pixels
  PublishedFilter published_filter;
  std::vector<Parameter> parameters = {};
  int (*samples_per_pixel)(const Request&) = nullptr;
  Products (*estimate)(const Scene&, const Request&, const Progress&) = nullptr;
  BandSupport bands = {};
  Ladder ladder;
  double sample_cost = 1;     ///< time of a sample relative to other methods, about
  bool is_reference = false;  ///< the one that bench holds all others to
};

}  // namespace ssdo
