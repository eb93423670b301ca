// SPDX-License-Identifier: Apache-2.0
#include "io/temporary_table.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <cstring>

#include "io/safe_file.h"

namespace ssdo {
namespace {

enum class State { free, filling, armed };

struct Slot {
  std::atomic<State> state = State::free;
  char path[PATH_MAX] = {};
};
static_assert(std::atomic<State>::is_always_lock_free);

// A frame writes one file per product; 128 leaves room for a dozen frames at once.
std::array<Slot, 128> g_slots;

void remove_and_exit(int signal) {
  for (Slot& slot : g_slots) {
    if (slot.state == State::armed) unlink(slot.path);
  }
  _exit(128 + signal);
}

}  // namespace

int enter_temporary(const char* path) {
  const std::size_t length = std::strlen(path);
  if (length >= PATH_MAX) return -1;
  for (std::size_t i = 0; i < g_slots.size(); ++i) {
    State expected = State::free;
    if (!g_slots[i].state.compare_exchange_strong(expected, State::filling)) continue;
    std::memcpy(g_slots[i].path, path, length + 1);
    g_slots[i].state = State::armed;
    return int(i);
  }
  return -1;
}

void leave_temporary(int slot) {
  if (slot >= 0) g_slots[std::size_t(slot)].state = State::free;
}

void remove_temporaries_on_signals() {
  struct sigaction action = {};
  action.sa_handler = remove_and_exit;
  sigfillset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace ssdo
