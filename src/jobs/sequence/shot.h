// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "filters/shot/findings.h"
#include "filters/shot/moved.h"
#include "jobs/jobs.h"
#include "jobs/work.h"

namespace ssdo {

/// The frames of a run with --shot: what each has found is kept as long as frames that are still to
/// be made want it, and a frame waits until those around it have found what they can. Without
/// --shot none waits.
class Shot {
 public:
  /// `jobs` as plan_jobs() orders them; they have to outlive it.
  /// With `only_looks`, frames find nothing, and are told what the others show of them.
  Shot(const std::vector<Job>& jobs, const ShotWindow& window, bool only_looks);

  bool only_looks() const { return only_looks_; }

  /// Whether a job that is still to be made wants what this one finds.
  bool is_wanted(std::size_t job) const { return wanting_[job] > 0; }

  /// The most frames that wait at one time, and the most whose findings are kept.
  std::size_t most_waiting() const { return most_waiting_; }
  std::size_t most_kept() const { return most_kept_; }

  bool is_waiting() const { return !waiting_.empty(); }

  /// The frames that have all that they want, now that `work` has found what it can, made up to
  /// their outputs and in order.
  std::vector<Work> complete(Work work);

 private:
  void count();
  std::size_t complete_after(std::size_t job) const;
  Findings take_findings(WorkOnView& work) const;
  void find_motion(std::size_t job, std::size_t view, Work& work);
  void make(Work& work);
  void make(std::size_t job, std::size_t view, WorkOnView& work);
  const std::vector<MovedPiece>& pieces(std::size_t stands, std::size_t looks, std::size_t view);
  void release(std::size_t job);

  const std::vector<Job>& jobs_;
  const bool is_shot_, only_looks_, follows_;
  std::vector<std::vector<std::size_t>> around_;  ///< of each job that makes something, by frame
  std::vector<int> wanting_;                      ///< how many jobs want each
  std::map<std::pair<std::size_t, std::size_t>, Findings> findings_;  ///< by job and view
  /// What the second of two jobs looks through in the first: by both, and view.
  std::map<std::array<std::size_t, 3>, std::vector<MovedPiece>> pieces_;
  std::deque<Work> waiting_;
  std::size_t most_waiting_ = 0, most_kept_ = 0;
};

}  // namespace ssdo
