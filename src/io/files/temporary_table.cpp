// SPDX-License-Identifier: Apache-2.0
#include "io/files/temporary_table.h"

#include <sched.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <cstring>

namespace ssdo {
namespace {

struct Slot {
  bool taken = false;
  char path[PATH_MAX] = {};
};

// A frame writes one file per product; 128 leaves room for a dozen frames at once.
std::array<Slot, 128> g_slots;
std::atomic_flag g_in_use;

/// What terminals, users and schedulers send, and what ends a process that does not handle it.
constexpr std::array kEndings = {SIGHUP,  SIGINT,  SIGQUIT, SIGTERM,
                                 SIGALRM, SIGXCPU, SIGUSR1, SIGUSR2};

void wait_for_table() {
  while (g_in_use.test_and_set()) sched_yield();
}

void remove_and_exit(int signal) {
  remove_temporaries();
  _exit(128 + signal);
}

bool is_ignored(int signal) {
  struct sigaction inherited = {};
  return sigaction(signal, nullptr, &inherited) == 0 && inherited.sa_handler == SIG_IGN;
}

}  // namespace

TableInUse::TableInUse() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &before_);
  wait_for_table();
}

TableInUse::~TableInUse() {
  g_in_use.clear();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

int enter_temporary(const char* path, const TableInUse&) {
  const std::size_t length = std::strlen(path);
  if (length >= PATH_MAX) return -1;
  for (std::size_t i = 0; i < g_slots.size(); ++i) {
    if (g_slots[i].taken) continue;
    std::memcpy(g_slots[i].path, path, length + 1);
    g_slots[i].taken = true;
    return int(i);
  }
  return -1;
}

void leave_temporary(int slot, const TableInUse&) {
  if (slot >= 0) g_slots[std::size_t(slot)].taken = false;
}

void remove_temporaries() {
  wait_for_table();
  for (const Slot& slot : g_slots) {
    if (slot.taken) unlink(slot.path);
  }
}

void remove_temporaries_on_signals() {
  struct sigaction action = {};
  action.sa_handler = remove_and_exit;
  sigfillset(&action.sa_mask);
  for (const int signal : kEndings) {
    const bool stays_ignored = signal == SIGHUP && is_ignored(SIGHUP);  // under nohup(1)
    if (!stays_ignored) sigaction(signal, &action, nullptr);
  }
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace ssdo
