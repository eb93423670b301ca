// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <glm/mat3x3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "color/color_options.h"

namespace ssdo {

/// The colour space of a frame's colours.
struct InputSpace {
  std::string name;                       ///< as the config spells it
  std::string chosen_by;                  ///< the rule that won, such as "role scene_linear"
  std::vector<std::string> passed_over;   ///< rules that came first but had to yield, and why
  std::optional<glm::mat3> conversion{};  ///< of the input's primaries to those of the space
  std::string warning{};  ///< where the file claims a space of colours and gets another
};

/// What messages call a set of primaries: "Rec.2020", or its numbers.
std::string describe_primaries(const Chromaticities& chromaticities);

/// Chooses the input's colour space by the order that DisplayTransform documents. `colorspace` is
/// --colorspace, which is obeyed whatever it names; `config_label` names the config in messages.
/// Errors: ExitCode::usage if `colorspace` does not exist, or if nothing decides and the config has
/// no role scene_linear.
InputSpace choose_input_space(const OCIO_NAMESPACE::Config& config, const std::string& config_label,
                              const std::string& colorspace, const ColorTags& tags);

}  // namespace ssdo
