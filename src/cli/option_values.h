// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/options.h"

namespace CLI {
class Validator;
}

namespace ssdo {

// Parses the texts of options. Errors of all: ExitCode::usage, naming the option.

/// A length in scene units: a positive number or inf; nothing for auto.
std::optional<double> read_length(const std::string& option, std::string_view text);

/// The kinds of --depth-kind that are one word.
std::vector<std::string> depth_kind_names();

/// The forms of --depth-kind, for help and messages: "planar, ray, inverse or ...".
std::string depth_kind_forms();

/// One of those forms.
void read_depth_kind(const std::string& text, GBufferOptions& out);

/// The compressions, without levels.
std::vector<std::string> compression_names();

/// The forms of --compression, for help and messages: "none, ..., zip[:1..12], ...".
std::string compression_forms();

/// One of those forms.
void read_compression(const std::string& text, OutputOptions& out);

/// X,Y: two factors.
glm::vec2 read_motion_scale(const std::string& text);

/// K or KxSTEP: whole numbers from 1 on.
ShotWindow read_shot(const std::string& text);

/// A size as parse_size() takes it, in bytes.
std::size_t read_mem_limit(const std::string& text);

/// PRODUCT=FILE.
SaveRequest read_save(const std::string& text);

/// Accepts finite numbers in a range; CLI11's own checks accept NaN.
CLI::Validator between(double low, double high);

/// Accepts numbers from 1e-30 to 1e30.
CLI::Validator positive();

}  // namespace ssdo
