// SPDX-License-Identifier: Apache-2.0
#include "jobs/info_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/json_text.h"
#include "io/standard_output.h"
#include "jobs/describe.h"
#include "jobs/listing.h"
#include "jobs/object_listing.h"

namespace ssdo {

InfoReport::InfoReport(bool as_json, ProgressLine& progress)
    : as_json_(as_json), progress_(progress) {}

InfoReport::~InfoReport() = default;

void InfoReport::list(const FrameFiles& files) {
  const std::deque<ExrReader> opened = open_files(files);
  entries_.push_back(listing_json(files.input, opened));
  print(list_layers(opened));
}

void InfoReport::show(const Frame& frame) {
  if (entries_.back().contains("view") && entries_.back()["view"] != frame.view)
    entries_.push_back(entries_.back());
  const ObjectListing objects = list_objects(frame);
  entries_.back().update(to_json(frame));
  entries_.back()["objects"] = to_json(objects);
  for (const std::string& warning : objects.warnings)
    entries_.back()["warnings"].push_back(warning);
  print(describe(frame));
  print(text_of(objects));
}

void InfoReport::show(const Frame& frame, const SeenByOthers& shown) {
  for (nlohmann::json& entry : entries_) {
    if (entry["file"] != frame.input || entry["view"] != frame.view) continue;
    entry["shot"] = {{"frames", shown.frames},
                     {"shown", shown.some},
                     {"times", shown.times},
                     {"through", shown.through}};
  }
  const std::string name =
      frame.view.empty() ? frame.input : fmt::format("{} (view {})", frame.input, frame.view);
  if (shown.frames == 0)
    return print(fmt::format("{}: no frame around it knows its world\n", name));
  print(
      fmt::format("{}: {} frames around it show {:.3g} % of its surfaces, {:.3g} of them each in "
                  "the mean, and look through {:.2g} %, which move\n",
                  name, shown.frames, 100 * shown.some, shown.times, 100 * shown.through));
}

void InfoReport::note(const Error& error) {
  if (entries_.empty()) return;
  entries_.back()["error"] = {{"code", int(error.code)}, {"message", error.what()}};
}

void InfoReport::finish() const {
  if (!as_json_ || entries_.empty()) return;
  print_out(json_text(entries_.size() == 1 ? entries_[0] : nlohmann::json(entries_), 2) + "\n");
}

void InfoReport::print(const std::string& text) {
  if (as_json_) return;
  progress_.clear();
  print_out(text);
}

}  // namespace ssdo
