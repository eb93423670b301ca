// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "jobs/run_options.h"
#include "relight/frame.h"

namespace ssdo {

/// Prepares the frames of a run. What a frame of a sequence does not tell, others on disk do, so
/// that a shot is of one kind however it is cut into runs:
///
///   the camera, where P leaves it open: that of the nearest frame whose P tells it, moved to fit P
///   which axis is up, where no header tells it: by the first, the middle and the last frame
///   the space of N, where the frame does not tell it: that which N of these has, if one is sure
///   --radius auto of a method that needs a limit: the median of five frames spread over the shot
class SequenceFrames {
 public:
  /// The arguments have to outlive it.
  SequenceFrames(const RunOptions& options, OtherPictures& pictures)
      : options_(options), pictures_(pictures) {}

  /// prepare_frame(), of the frame `number` of a sequence or of one alone. Not for several threads
  /// at once. Errors: those of prepare_frame().
  Frame prepare(const Lighting& light, const FrameFiles& files, std::optional<int> number);

 private:
  /// What a frame on disk tells of its shot.
  struct ShotClues {
    bool of_three;  ///< it is the first, the middle or the last of the shot
    std::optional<UpEvidence> up;
    std::optional<double> clearance;  ///< Backdrop::clearance
    float radius;
  };

  Frame prepare(const FrameOptions& options, const Lighting& light, const FrameFiles& files,
                int number);
  std::optional<View> read(const FrameFiles& files, std::size_t most_pixels) const;
  std::optional<NeighbourCamera> camera_of(const FrameFiles& files) const;
  void look(const std::string& view, std::size_t most_pixels,
            const std::function<void(const View&, bool of_three)>& at,
            std::size_t count = kThree) const;
  const std::vector<ShotClues>& clues(const std::string& view);
  std::optional<UpEvidence> up(const std::string& view);
  std::string normal_space(const std::string& view);
  std::optional<float> radius(const std::string& view);
  std::optional<double> backdrop(const std::string& view);

  static constexpr std::size_t kThree = 3;

  const RunOptions& options_;
  OtherPictures& pictures_;
  std::map<std::string, std::vector<ShotClues>> clues_;  ///< by view, once something was asked for
  std::optional<std::optional<UpEvidence>> up_;          ///< of the shot, once it was asked for
  std::optional<std::string> normal_space_;              ///< the same; empty: no frame is sure
  std::map<std::string, std::optional<float>> radius_;   ///< the same, by view
  std::optional<std::optional<double>> backdrop_;        ///< the same: Backdrop::clearance
};

}  // namespace ssdo
