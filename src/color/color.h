// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "color/color_options.h"
#include "io/pictures/primaries.h"

namespace ssdo {

/// The way from a frame's scene-linear colours to a display, through OpenColorIO.
///
/// The input's colour space is --colorspace, else the tag colorInteropID, else the ACES container
/// flag, else the chromaticities, else a file rule of the config other than its default, else the
/// role scene_linear. Primaries of which the config has no space are converted to one that it has,
/// white to white. Any other tag that names data, or a space that the config lacks, is passed over.
/// A look takes the place of those that the view brings along.
class DisplayTransform {
 public:
  /// Errors: ExitCode::usage for a colour space, display, view or look that the config does not
  /// have (the message lists those it has); ExitCode::input for a config that is missing, cannot be
  /// read, or does not lead from the colour space to the view.
  DisplayTransform(const ColorOptions& options, const ColorTags& tags);
  ~DisplayTransform();
  DisplayTransform(DisplayTransform&&) noexcept;
  DisplayTransform& operator=(DisplayTransform&&) noexcept;

  /// Scene-linear to display values, in place. RGB is not premultiplied. Thread-safe. What does not
  /// fit a half float counts as the largest one. Results are not clipped to 0..1.
  void apply(std::span<glm::vec3> colors) const;

  /// One line: config, input space and the rule that chose it, display, view, look, and what tags
  /// were passed over.
  const std::string& description() const { return description_; }

  /// One line where the file says what its colours are and that could not be followed; else empty.
  const std::string& warning() const { return warning_; }

 private:
  struct Processor;
  std::unique_ptr<Processor> processor_;
  std::string description_, warning_;
};

}  // namespace ssdo
