// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "scene/objects/selection.h"

namespace ssdo {

/// What becomes of a backdrop (scene/objects/backdrop.h).
enum class BackdropChoice {
  leave_out,  ///< it casts nothing
  any,        ///< nor does what has the shape of one, however near it is
  cast,       ///< it casts, with a warning
  ignore,     ///< it is not looked for
};

/// Which objects of a frame cast, receive, or are left alone. Each selection may be empty.
struct ObjectOptions {
  Selection no_cast;     ///< hide nothing and send nothing
  Selection no_receive;  ///< stay as they are, but cast
  Selection only;        ///< all else stays as it is; empty: nothing does
  Selection holdout;     ///< have alpha 0 in the composite
  Selection shadow_of;   ///< whose shadow is a product of its own

  BackdropChoice backdrop = BackdropChoice::leave_out;

  /// Whether pixels are to stay as they were rendered.
  bool keeps_pixels() const { return !no_receive.empty() || !only.empty(); }

  std::array<const Selection*, 5> all() const {
    return {&no_cast, &no_receive, &only, &holdout, &shadow_of};
  }
};

/// These options at a frame of a sequence.
inline ObjectOptions at_frame(const ObjectOptions& options, int frame) {
  return {at_frame(options.no_cast, frame),   at_frame(options.no_receive, frame),
          at_frame(options.only, frame),      at_frame(options.holdout, frame),
          at_frame(options.shadow_of, frame), options.backdrop};
}

}  // namespace ssdo
