// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "cli/options.h"

namespace ssdo {

// What the texts of the command line mean. Errors of all: ExitCode::usage, naming the option.

/// A length in scene units: a positive number or inf; nothing for auto.
std::optional<double> read_length(const std::string& option, std::string_view text);

/// planar, ray, inverse or normalized:NEAR,FAR.
void read_depth_kind(const std::string& text, GBufferOptions& out);

/// X,Y: two factors.
glm::vec2 read_motion_scale(const std::string& text);

/// draft, standard or final.
Quality read_quality(std::string_view text);

/// none, tractor, alfred, openjd; all else is auto.
ProgressStyle read_progress_style(std::string_view text);

Imf::Compression read_compression(const std::string& name);

/// PRODUCT=FILE.
SaveRequest read_save(const std::string& text);

/// Accepts finite numbers in a range; CLI11's own checks let pass what is not a number.
CLI::Validator between(double low, double high);

/// Accepts lengths and the like.
CLI::Validator positive();

}  // namespace ssdo
