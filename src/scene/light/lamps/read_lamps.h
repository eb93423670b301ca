// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "scene/light/lamps/lamp.h"

namespace ssdo {

/// The most lamps of a frame. Each costs about a tenth of a run, and has planes and layers of its
/// own: instead of more, a map of them is cheaper and shows the same.
constexpr std::size_t kMostLamps = 64;

/// Reads a JSON object with `lights`, an array of objects with the keys of `man ssdo`, LIGHTS; a
/// lamp without a name is left without. Errors: ExitCode::input, in one line that names file, light
/// and key.
std::vector<Lamp> read_lamps(const std::string& file);

/// Reads "TYPE KEY=VALUE ...", numbers of one value separated by commas: what --light takes.
/// Errors: ExitCode::usage.
Lamp parse_lamp(const std::string& text);

/// Names the lamps that have no name light1, light2, ... by their place. Errors: ExitCode::usage
/// for two of one name and for more than kMostLamps.
void name_lamps(std::vector<Lamp>& lamps);

}  // namespace ssdo
