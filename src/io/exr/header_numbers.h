// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "io/exr/exr_reader.h"

namespace ssdo {

/// The numbers in the header of a part, and those that other parts of its view have besides: of an
/// attribute that is a number, a vector, a matrix (16, row by row as stored), or a string of one or
/// 16 numbers. The names are without the prefixes that Nuke gives them, "exr/", "nuke/" and
/// "nuke/exr/"; an attribute without a prefix goes before one with it.
std::map<std::string, std::vector<double>> header_numbers(const ExrReader& file, int part);

/// Whether Blender has written the file, or Nuke one that it has read of Blender. Files of several
/// views have the marks of Cycles alone.
bool is_by_blender(const Imf::Header& header);

}  // namespace ssdo
