// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/measure.h"
#include "bench/shot/shot_settings.h"
#include "metrics/flicker.h"

namespace ssdo {

/// What was measured of a product over the frames of a shot, in the units of the product. Reports
/// tell those of light relative to its mean.
struct ShotFigures {
  FlickerFigures flicker;
  Difference error;                 ///< over the frames with a truth; count is 0 without one
  Difference error_near_moving;     ///< the same over near_moving(); count is 0 where nothing moves
  FlickerFigures flicker_of_error;  ///< of the product minus its truth; 0 points without one
};

/// One setting that was measured.
struct ShotRow {
  ShotSetting setting;
  Cost cost;  ///< of the whole run, reading and writing included
  std::map<std::string, ShotFigures> products;
  std::string command;
};

/// A truth of a product in some frames.
struct ShotTruth {
  std::string picture;  ///< PATTERN:LAYER
  std::vector<int> frames;
};

struct ShotBenchReport {
  std::string input, method, filter;
  std::vector<int> frames;
  int width = 0, height = 0;  ///< of the display window
  std::string processor, isa;
  int processors = 0, threads = 0;
  double seconds = 0;  ///< of the whole bench
  std::vector<std::string> products;
  std::map<std::string, ShotTruth> truths;  ///< by product
  std::vector<ShotRow> rows;

  /// Time of one frame, in seconds.
  Cost seconds_per_frame(const ShotRow& row) const;
};

/// The table for a terminal.
std::string to_table(const ShotBenchReport& report);

/// One line per row and product.
std::string to_csv(const ShotBenchReport& report);

nlohmann::json to_json(const ShotBenchReport& report);

/// A page that needs no other file and no network.
std::string to_html(const ShotBenchReport& report);

}  // namespace ssdo
