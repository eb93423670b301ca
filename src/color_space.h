// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <string>
#include <vector>

#include "color.h"

namespace ssdo {

/// The colour space of a frame's colours.
struct InputSpace {
  std::string name;                      ///< as the config spells it
  std::string chosen_by;                 ///< the rule that won, such as "role scene_linear"
  std::vector<std::string> passed_over;  ///< rules that came first but had to yield, and why
};

/// Chooses the input's colour space by the order that DisplayTransform documents. A tag that names
/// data, or a space that the config lacks, is passed over. `colorspace` is --colorspace, which is
/// obeyed whatever it names; `config_label` names the config in messages.
/// Errors: ExitCode::usage if `colorspace` does not exist, or if nothing decides and the config has
/// no role scene_linear.
InputSpace choose_input_space(const OCIO_NAMESPACE::Config& config, const std::string& config_label,
                              const std::string& colorspace, const ColorTags& tags);

}  // namespace ssdo
