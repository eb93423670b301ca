// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>

namespace ssdo {

/// The temporaries that have to go when the process ends before its time. The table has a fixed
/// size, because a signal handler may not allocate.

/// While this object lives, no signal ends the process and no other thread uses the table: a
/// temporary is made and entered in one step, or neither. A signal handler waits for the table; it
/// would wait for ever if it interrupted the thread that holds the table.
class TableInUse {
 public:
  TableInUse();
  ~TableInUse();
  TableInUse(const TableInUse&) = delete;
  TableInUse& operator=(const TableInUse&) = delete;

 private:
  sigset_t before_ = {};
};

/// Enters `path` and returns its slot, or -1 if the path is too long or every slot is taken.
int enter_temporary(const char* path, const TableInUse&);

/// Frees the slot of a temporary that has been renamed or removed.
void leave_temporary(int slot, const TableInUse&);

/// Removes all temporaries; no other is made from then on, and the process has to end. May be
/// called by a signal handler.
void remove_temporaries();

/// Has SIGINT (130), SIGTERM (143) and the other signals that end a process, such as SIGHUP and
/// those of schedulers, remove every open temporary and end the process with 128 + their number.
/// SIGXFSZ and SIGPIPE are ignored: a full disk arrives as a write error.
void remove_temporaries_on_signals();

}  // namespace ssdo
