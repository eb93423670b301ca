// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

namespace ssdo {

/// Runs a job beside its owner, on the threads that ThreadLimit allows: none is added. Parallel
/// loops of the job and of the owner use the threads that the other leaves idle.
class BackgroundTask {
 public:
  BackgroundTask();
  ~BackgroundTask();  ///< waits
  BackgroundTask(const BackgroundTask&) = delete;
  BackgroundTask& operator=(const BackgroundTask&) = delete;

  /// Starts `job`. Its owner waits for it before it starts another.
  void start(std::function<void()> job);

  /// Helps with the job until it is done, if there is one. Errors: those of the job.
  void wait();

 private:
  struct Group;
  std::unique_ptr<Group> group_;
};

}  // namespace ssdo
