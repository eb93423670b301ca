// SPDX-License-Identifier: Apache-2.0
#include "parallel/background_task.h"

#include <oneapi/tbb/task_group.h>

#include <utility>

#include "parallel/fork_join.h"

namespace ssdo {

struct BackgroundTask::Group {
  tbb::task_group tasks;
  ForkJoin order;
};

BackgroundTask::BackgroundTask() : group_(std::make_unique<Group>()) {}

BackgroundTask::~BackgroundTask() {
  try {
    wait();
  } catch (...) {  // lost: the owner has not called wait()
  }
}

void BackgroundTask::start(std::function<void()> job) {
  group_->order.fork();
  group_->tasks.run([group = group_.get(), job = std::move(job)] {
    const ForkJoin::Task task(group->order);
    job();
  });
}

void BackgroundTask::wait() {
  const ForkJoin::Join join(group_->order);
  group_->tasks.wait();
}

}  // namespace ssdo
