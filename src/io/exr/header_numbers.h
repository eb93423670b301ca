// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "io/exr/exr_reader.h"

namespace ssdo {

/// The numbers in the header of a part, and those that only other parts of its view have. An
/// attribute may be a number, a vector, a matrix (16, row by row as stored), or a string of one or
/// 16 numbers. Names are without the prefixes that Nuke adds, "exr/", "nuke/" and "nuke/exr/"; an
/// attribute without a prefix goes before one with it.
std::map<std::string, std::vector<double>> header_numbers(const ExrReader& file, int part);

/// Whether the file was written by Blender, or by Nuke from a file of Blender. Files of several
/// views have only the marks of Cycles.
bool is_by_blender(const Imf::Header& header);

}  // namespace ssdo
