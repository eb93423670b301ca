// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "color/composition.h"
#include "estimators/registry.h"
#include "filters/registry.h"
#include "plan/outputs.h"

namespace ssdo {

struct PriorContext;

enum class Quality { draft, standard, final };

/// What --quality means.
struct QualityLevel {
  std::string_view name;
  Quality quality;
  int slices;  ///< per pixel
  int steps;   ///< on each side of a slice, out to the frame's diagonal; see steps_of()
};
inline constexpr std::array<QualityLevel, 3> kQualities = {{{"draft", Quality::draft, 2, 8},
                                                            {"standard", Quality::standard, 2, 16},
                                                            {"final", Quality::final, 6, 48}}};
constexpr int slices_of(Quality quality) { return kQualities[std::size_t(quality)].slices; }

/// Steps are laid out to the frame's diagonal, and a march with a limit leaves out those beyond its
/// radius. So with a limit there are half as many steps again: ao of five path-traced frames errs
/// by 0.057 and 0.069 at two radii, for 0.059 and 0.071, and a run takes 3 to 10 % longer with
/// radii of 0.03 to 0.3 of the frame's height.
constexpr int steps_of(Quality quality, bool is_limited) {
  const int steps = kQualities[std::size_t(quality)].steps;
  return is_limited ? steps * 3 / 2 : steps;
}

/// What fills the directions that no picture shows.
enum class Prior { rules, learned };

/// The frames around a frame of a sequence whose findings it uses.
struct ShotWindow {
  int count = 0;  ///< before, and as many after; 0: none
  int step = 1;   ///< frames from one to the next
};

/// What the user says about the method.
struct ModelOptions {
  std::string method{methods().front().name};
  std::optional<double> radius;  ///< scene units or infinity; chosen from the frame if not given
  /// The radius of `auto` by frames of the sequence; empty: by this frame alone.
  std::optional<float> radius_of_shot = {};
  std::optional<double> thickness;  ///< scene units or infinity; found in the frame if not given
  bool extend_offscreen = true;     ///< surfaces go on beyond the frame
  std::optional<Prior> prior;       ///< found by prior_of() if not given
  Quality quality = Quality::standard;
  std::optional<int> slices, steps;  ///< in place of those of the quality
  std::optional<double> error;       ///< largest standard error of direct + bounce
  int bounces = 1;                   ///< 0 to 8
  unsigned seed = 0;
  std::vector<std::string> set;     ///< NAME=VALUE of the method
  std::string filter = "geometry";  ///< may be kPublishedFilter
  bool temporal = false;            ///< frames of a sequence share what they find with later ones
  ShotWindow shot = {};             ///< frames that share what they find with each other
};

/// What a learned prior needs to know of a frame besides the estimate.
struct LearnedPrior {
  std::optional<glm::vec3> up;                        ///< unit, camera space; not known: nothing
  std::shared_ptr<const PriorContext> of_frame = {};  ///< where a band of it is computed
};

/// The prior that is used. Where nothing is said: `learned`, if the method takes one and neither
/// --offscreen open nor --thickness says what is there.
Prior prior_of(const ModelOptions& model);

/// What will be computed for a frame, and why.
struct Plan {
  const Method* method = nullptr;
  Request request;                    ///< what the method is asked for
  std::optional<float> radius_alone;  ///< where auto chose the radius: what the frame alone tells
  std::optional<double> error;        ///< largest error of direct + bounce; empty: no bound
  const Filter* filter = nullptr;     ///< after the estimate
  /// The filter of a map at half resolution (Request::filter_half); null where there is none.
  const Filter* half_filter = nullptr;
  std::optional<LearnedPrior> prior;  ///< where it is used
  bool temporal = false;              ///< then the mean with the frames before
  bool shot = false;                  ///< then the mean with the frames before and after
  std::vector<std::string> make;      ///< products for any of the outputs
  std::vector<std::string> write;     ///< those that every EXR of -o holds, in their order there
  std::string show;                   ///< the one that every picture of -o holds
  Composition composition;            ///< how the composite is made, where it is
  int downsample = 1;                 ///< how many times as large as the outputs the frame is
  std::vector<std::string> reasons;   ///< one line per decision

  int samples_per_pixel() const;
  /// The name of the filter that removes the noise of the pattern, at full or half resolution.
  std::string_view filter_name() const { return (half_filter ? half_filter : filter)->name; }
};

/// `history` is what a temporal plan takes from the frame before, and why: it ends the reasons.
nlohmann::json to_json(const Plan& plan, const std::vector<std::string>& history = {});

}  // namespace ssdo
