// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace ssdo {

/// A file of a run, and what names it there: "-o", "--stats", "INPUT".
struct RunFile {
  std::string option, path;
};

/// All files that a run reads and writes, every frame's.
struct RunFiles {
  std::vector<RunFile> inputs, outputs;
};

/// Refuses outputs that would replace an input or each other, before any work is done. Two paths
/// are one file where they lead to the same name in the same folder, once links are followed and
/// whether or not that file and its folders exist yet; an input is also every other hard link to
/// it. (Outputs that are hard links to each other are not: a rename replaces one of the names.)
/// Errors: ExitCode::usage for a file that is named twice, ExitCode::output for an input.
void check_run_files(const RunFiles& files);

}  // namespace ssdo
