// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/ladder.h"
#include "bench/measure.h"

namespace ssdo {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// The error of a product against three references: the limit of its own method, ray tracing of the
/// same geometry, and given truth.
struct ErrorSplit {
  double noise = kNotMeasured, approximation = kNotMeasured, model = kNotMeasured;

  /// The error by which settings are ranked: against truth where given, else against ray tracing.
  double total() const { return model == model ? model : approximation; }
};

/// By product.
using Errors = std::map<std::string, ErrorSplit>;

/// PNG files of one product: what it looks like, and its error around middle grey.
struct Pictures {
  std::string picture, error;
};

/// One setting that was measured.
struct BenchRow {
  Setting setting;
  int samples_per_pixel = 0;
  Cost estimate, filter;
  int runs = 0;
  Errors errors;
  std::string command;
  std::map<std::string, Pictures> pictures;  ///< by product; for a page only

  Cost cost() const { return {estimate.cpu_ms + filter.cpu_ms, estimate.wall_ms + filter.wall_ms}; }
};

/// The limit of a method. Its noise is what several seeds leave.
struct BenchLimit {
  Setting setting;
  int seeds = 1;
  Errors errors;
};

/// What a page shows pictures of in addition to the rows.
struct BenchReference {
  std::string name;                             ///< "truth", "trace"
  std::map<std::string, std::string> pictures;  ///< PNG by product
};

struct BenchReport {
  std::string input;
  std::string frame;          ///< JSON of what was found and decided, for method bitmask
  StageTimes stages;          ///< all but estimate and filter, of the main job to one EXR
  int width = 0, height = 0;  ///< of the display window
  std::size_t pixels = 0, surface_pixels = 0;
  std::string processor, isa, filter;
  int processors = 0, threads = 0;
  double seconds = 0;  ///< of the whole bench
  std::vector<std::string> products;
  std::map<std::string, std::string> truths;  ///< FILE:LAYER by product
  std::map<std::string, double> error_scale;  ///< what the end of a map of errors stands for
  std::vector<BenchLimit> limits;
  std::vector<BenchRow> rows;
  std::vector<BenchReference> references;
  std::string wanted;                      ///< "ao 0.05", or nothing
  std::optional<std::size_t> recommended;  ///< row
  std::optional<std::size_t> best;         ///< row, where none has the wanted error

  double megapixels() const { return double(pixels) * 1e-6; }
  double cpu_ms_per_megapixel(const BenchRow& row) const {
    return row.cost().cpu_ms / megapixels();
  }
  double wall_ms_per_megapixel(const BenchRow& row) const {
    return row.cost().wall_ms / megapixels();
  }

  /// The rows on the front of cost and error of a product, cheapest first.
  std::vector<std::size_t> front(const std::string& product) const;
};

/// The table for a terminal, with the recommendation.
std::string to_table(const BenchReport& report);

/// One line per row and product.
std::string to_csv(const BenchReport& report);

nlohmann::json to_json(const BenchReport& report);

/// A page that needs no other file and no network.
std::string to_html(const BenchReport& report);

}  // namespace ssdo
