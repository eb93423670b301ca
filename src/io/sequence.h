// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace ssdo {

/// The frames of "1001-1010,1020-1030x2,7": inclusive ranges, separated by commas or spaces, steps
/// after `x` or `:`, negative frames ("-5--1"), reversed ranges ("10-1", with a step of either
/// sign); spaces around `-`, `x` and `:` do not count. The order is kept and a frame that is named
/// twice is done once.
/// Errors: ExitCode::usage for text that is no list, a step of 0 or away from the range's end, a
/// number beyond 32 bits, more than 1,000,000 frames, and "1 -3", which may be 1-3 or 1,-3.
std::vector<int> parse_frames(const std::string& text);

/// Whether `path` holds a frame pattern: `#`, `####`, `@`, `@@@`, `%d` or `%04d`, in the file's
/// name, a folder's, or several of both. A leading part of the path that exists under its literal
/// name is taken literally: /jobs/ann@studio/a.exr is no pattern where it, or its folder, is there.
/// Below a folder that is a pattern nothing can be looked up, and all such signs are patterns.
/// Errors: ExitCode::usage for another `%` conversion.
bool is_pattern(const std::string& path);

/// `path` with each of its patterns replaced by `frame`: `####` pads to four digits (one `#` alone
/// too, as OpenImageIO has it), `@` to as many digits as there are; there a negative frame is "-"
/// and the padded digits of its magnitude, as Blender writes it (-0005). `%04d` is as printf and
/// Nuke have it (-005). `%%` beside a pattern is a percent sign. A path without a pattern comes
/// back as it is. Errors: those of is_pattern.
std::string expand_pattern(const std::string& path, int frame);

/// The frames whose file exists, ascending: those for which expand_pattern gives its very name.
/// None for a path without a pattern.
/// Errors: those of is_pattern; ExitCode::input for a folder that cannot be listed.
std::vector<int> find_frames(const std::string& pattern);

}  // namespace ssdo
