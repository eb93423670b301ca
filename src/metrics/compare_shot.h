// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "error.h"
#include "metrics/compare_options.h"
#include "metrics/compare_pictures.h"
#include "metrics/flicker.h"
#include "metrics/shot_points.h"

namespace ssdo {

/// The flicker of a layer of A, and of A - B where both frames of B are there.
struct LayerFlicker {
  Flicker a, a_minus_b;
};

/// The same as figures.
struct LayerFlickerFigures {
  FlickerFigures a;
  std::optional<FlickerFigures> a_minus_b;  ///< where there is a B
};

/// What was found of one frame. Without an error, `compared` is filled where there is a B.
struct ShotFrame {
  int number = 0;
  Comparison compared;
  std::vector<std::string> layers;                     ///< names, in the order of the table
  std::map<std::string, LayerFlickerFigures> flicker;  ///< by name; if there is a frame before
  std::vector<std::string> notes;                      ///< a line each
  bool misses_layer = false;                           ///< that other frames have
  std::optional<Error> error;  ///< why it, or a layer of it, was not measured
};

/// The error of a layer over all frames.
struct ShotError {
  Difference figures;  ///< without a percentile
  double worst = -1;   ///< the largest RMSE of a frame; negative: none was compared
  int worst_frame = 0;
};

struct ShotComparison {
  bool has_b = false, has_points = false;
  std::vector<ShotFrame> frames;
  std::vector<std::string> layers;  ///< of all frames, in the order of the first
  std::map<std::string, ShotError> errors;
  std::map<std::string, LayerFlicker> flicker;
};

/// Compares the frames of sequences, and measures their flicker where points are given: from each
/// frame to the one before it in the list. Errors of one frame are kept in its ShotFrame.
/// Errors: ExitCode::input where no frame exists.
ShotComparison compare_shot(const CompareOptions& options);

/// The exit code of the first frame that has an error or does not pass the gate.
ExitCode exit_code_of(const CompareOptions& options, const ShotComparison& shot);

}  // namespace ssdo
