// SPDX-License-Identifier: Apache-2.0
#include "parallel/background.h"

#include <oneapi/tbb/task_group.h>

#include <utility>

namespace ssdo {

struct Background::Group {
  tbb::task_group tasks;
};

Background::Background() : group_(std::make_unique<Group>()) {}

Background::~Background() {
  try {
    wait();
  } catch (...) {  // nobody has waited for it who could be told
  }
}

void Background::start(std::function<void()> job) { group_->tasks.run(std::move(job)); }

void Background::wait() { group_->tasks.wait(); }

}  // namespace ssdo
