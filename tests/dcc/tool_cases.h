// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "support/stored_shot.h"

namespace ssdo::test {

/// What `ssdo` is to find in the file of a tool.
struct Found {
  std::string space = "world";             ///< of P; empty: there is no P
  std::string handedness = "right";        ///< of the space of P
  std::string normals = "the space of P";  ///< the space of N, as `info` names it
  std::string depth = "planar by P";       ///< its kind and what tells it; "left out"; empty: none
};

/// A tool, and a file as it writes it: a row of the table in the man page.
struct Tool {
  std::string name;
  StoredShot shot;
  Found found = {};
  std::vector<std::string> warnings = {};  ///< a part of each, in any order
  std::vector<std::string> flags = {};     ///< that the user has to give; DIR: the file's folder
  std::vector<std::string> refusal = {};   ///< parts of the error without the flags; empty: none
  std::vector<std::string> hints = {};     ///< parts of warnings without the flags
  std::string note = {};                   ///< what the man page adds
  double bound = 1e-3;  ///< most by which ao may differ (RMSE) from that of the plain shot
};

inline void PrintTo(const Tool& tool, std::ostream* out) { *out << tool.name; }

/// The flags of a tool for a file in `folder`.
std::vector<std::string> flags_in(const std::string& folder, const Tool& tool);

/// All tools whose conventions are known, Blender first.
std::vector<Tool> tools();

}  // namespace ssdo::test
