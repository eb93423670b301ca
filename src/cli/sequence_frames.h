// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/options.h"
#include "frame.h"

namespace ssdo {

/// Prepares the frames of a run. What a frame of a sequence does not tell, others on disk do, so
/// that a shot is of one kind however it is cut into runs:
///
///   the camera, where P leaves it open: that of the nearest frame whose P tells it, moved to fit P
///   which axis is up, where no header tells it: by the first, the middle and the last frame
///   the space of N, where the frame does not tell it: that which N of these has, if one is sure
class SequenceFrames {
 public:
  /// The arguments have to outlive it.
  SequenceFrames(const Options& options, FurtherPictures& pictures)
      : options_(options), pictures_(pictures) {}

  /// prepare_frame(), of the frame `number` of a sequence or of one alone. Not for several threads
  /// at once. Errors: those of prepare_frame().
  Frame prepare(const Lighting& light, const FrameFiles& files, std::optional<int> number);

 private:
  /// What a frame says of those of its sequence.
  struct Evidence {
    std::optional<UpEvidence> up;
    std::string normal_space;  ///< empty: not known
    double normal_agreement = 0;
  };

  Frame prepare(const FrameOptions& options, const Lighting& light, const FrameFiles& files,
                int number);
  const std::vector<Evidence>& evidence(const std::string& view);
  std::optional<UpEvidence> up(const std::string& view);
  std::string normal_space(const std::string& view);
  std::optional<View> read(const FrameFiles& files) const;
  std::optional<CameraBeside> camera_of(const FrameFiles& files) const;

  const Options& options_;
  FurtherPictures& pictures_;
  std::optional<std::vector<Evidence>> evidence_;  ///< of the first, the middle and the last frame
};

}  // namespace ssdo
