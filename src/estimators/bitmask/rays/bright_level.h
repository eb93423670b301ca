// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/bitmask/rays/sent_light.h"

namespace ssdo {

/// Luminance that is bright in a frame, and from which on rays gather light: see rays/emitters.h.
struct BrightLevel {
  float bright = 0, level = 0;  ///< the level is infinite where the march has all light
};

/// The level in a frame. A band has that of its frame.
BrightLevel bright_level(const SentLight& sent);

}  // namespace ssdo
