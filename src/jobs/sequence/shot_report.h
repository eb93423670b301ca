// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "jobs/sequence/frame_changes.h"
#include "jobs/sequence/repeated_warnings.h"

namespace ssdo {

/// What differs within the frames of a run: layers, sizes, spaces of N, views of --also, the
/// camera, the radius, and how much is guessed.
class ShotReport {
 public:
  /// Takes note of a frame, the `place`th of the run, as it was prepared; frames in their order.
  /// Returns how it differs from the one noted before: what no frame before has told.
  std::vector<std::string> add(std::size_t place, const FrameTraits& traits);

  /// What differs, with the frames that it holds for: few lines, none where nothing does. Each
  /// follows the name of the sequence, as those of RepeatedWarnings do.
  std::vector<std::string> summary() const;

  /// Adds `shot` to the entries of --stats that frames of a sequence have; see man ssdo,
  /// STATISTICS. `summary`: the lines that the run ends with.
  void add_to(nlohmann::json& entries, const std::vector<std::string>& summary) const;

 private:
  struct Noted {
    std::size_t place;
    FrameTraits traits;
    std::vector<std::string> changes;  ///< from the frame before in the run
  };
  using Frames = std::vector<Noted>;

  static std::vector<std::string> differences(const Frames& frames);

  std::map<std::string, Frames> views_;  ///< by the names of views; "" where there is one only
  RepeatedWarnings told_;                ///< changes
};

}  // namespace ssdo
