// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <exception>
#include <memory>
#include <new>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "error.h"
#include "filters/shot/seen_by_others.h"
#include "io/files/safe_file.h"
#include "jobs/machine/memory.h"
#include "jobs/messages.h"
#include "relight/frame.h"
#include "relight/job.h"

namespace ssdo {

/// A view of a job on its way.
struct WorkOnView {
  Frame frame;
  Relit relit = {};
  std::optional<SeenByOthers> shown =
      {};  ///< by the other frames of its shot, once that was looked at
};

/// A job on its way from its files to its outputs.
struct Work {
  std::size_t index = 0;               ///< of the job
  OutputPolicy policy;                 ///< of its outputs
  std::vector<WorkOnView> views = {};  ///< while there is something left to do with them
  Messages messages;                   ///< to be printed
  std::string advice = {};             ///< to be printed once the outputs are made
  std::shared_ptr<nlohmann::json> statistics = {};  ///< of its views; null unless they were made
  std::set<std::string> losses = {};  ///< what --allow-partial has taken as background
  std::optional<Error> error = {};
};

/// Calls `step`; what it throws becomes the error of the job whose input this is.
template <class Step>
void attempt(Work& work, const std::string& input, const Step& step) {
  try {
    step();
    return;
  } catch (const Error& e) {
    work.error = e;
  } catch (const std::bad_alloc&) {
    work.error = Error(ExitCode::failed, fmt::format("{}: {}", input, kNoMemory));
  } catch (const std::exception& e) {
    work.error = Error(ExitCode::failed, fmt::format("{}: {}", input, e.what()));
  }
  work.views.clear();
}

}  // namespace ssdo
