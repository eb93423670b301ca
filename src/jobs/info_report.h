// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "error.h"
#include "filters/shot/seen_by_others.h"
#include "jobs/progress.h"
#include "relight/frame.h"

namespace ssdo {

/// What `ssdo info` says of the frames of a run: text as it comes, or JSON at the end.
class InfoReport {
 public:
  InfoReport(bool as_json, ProgressLine& progress);
  ~InfoReport();

  /// The layers of a frame's files, before anything that can fail.
  void list(const FrameFiles& files);

  /// What was found in the frame that was listed last. Of several views, each has an entry.
  void show(const Frame& frame);

  /// What the frames around it show of a frame that show() had, which may be some frames ago.
  void show(const Frame& frame, const SeenByOthers& shown);

  /// Why the frame that was listed last has failed.
  void note(const Error& error);

  /// The entries, or the only one, as JSON where that is asked for.
  void finish() const;

 private:
  void print(const std::string& text);

  bool as_json_;
  ProgressLine& progress_;
  std::vector<nlohmann::json> entries_;
};

}  // namespace ssdo
