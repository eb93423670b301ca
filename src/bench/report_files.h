// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "io/files/run_files.h"
#include "io/files/safe_file.h"

namespace ssdo {

/// Whether one of the reports is a page, which needs pictures.
bool wants_page(const std::vector<std::string>& paths);

/// Refuses what cannot be written before any work is done. Errors: ExitCode::usage for an ending
/// other than .html, .csv and .json; those of check_run_files and check_output.
void check_report_files(const std::vector<std::string>& paths, std::vector<RunFile> inputs,
                        const OutputPolicy& policy);

/// Writes what `text_of` gives for each ending, ".html", ".csv" or ".json": all files appear, or
/// none. Errors: ExitCode::output.
void write_reports(const std::function<std::string(const std::string& ending)>& text_of,
                   const std::vector<std::string>& paths, const OutputPolicy& policy);

}  // namespace ssdo
