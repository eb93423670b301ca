// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "filters/shot/findings.h"
#include "filters/shot/fusion.h"
#include "filters/shot/moved.h"
#include "jobs/jobs.h"
#include "jobs/sequence/on_disk.h"
#include "jobs/work.h"

namespace ssdo {

/// The memory of a run.
struct ShotMemory {
  std::size_t bytes;  ///< all that the run may take
  int frames;         ///< that are read, estimated, made or written at one time
};

/// The frames of a run with --shot: what each has found is kept as long as frames that are still to
/// be made want it, and a frame waits until those around it have found what they can. What does not
/// fit into memory is kept on disk: first frames that wait, which are read back once, then what
/// frames have found, which is read back for each frame around. Without --shot none waits.
class Shot {
 public:
  /// `jobs` as plan_jobs() orders them; they have to outlive it.
  /// With `only_looks`, frames find nothing, and are told what the others show of them.
  Shot(const std::vector<Job>& jobs, const ShotWindow& window, bool only_looks,
       const ShotMemory& memory);

  bool only_looks() const { return only_looks_; }

  /// Whether a job that is still to be made wants what this one finds.
  bool is_wanted(std::size_t job) const { return wanting_[job] > 0; }

  bool is_waiting() const { return !waiting_.empty(); }

  /// Takes the next frame, which has found what it can.
  void add(Work work);

  /// Whether the frame that has waited longest has all that it wants.
  bool has_complete() const;

  /// That frame, made up to its outputs.
  Work next_complete();

 private:
  struct KeptFindings {
    Findings findings;
    std::optional<OnDisk> arrays;  ///< where they are not in `findings`
    std::size_t bytes;             ///< in memory
  };
  struct Waiting {
    Work work;
    std::vector<OnDisk> arrays;  ///< of its views, where they are not in `work`
    std::size_t bytes;           ///< in memory
  };

  void count();
  std::size_t complete_after(std::size_t job) const;
  std::size_t room_beside(const Work& work) const;
  Findings take_findings(WorkOnView& work) const;
  void find_motion(std::size_t job, std::size_t view, Work& work, Findings& own) const;
  void keep(Waiting& waiting);
  void make(Waiting& waiting);
  void make(std::size_t job, std::size_t view, WorkOnView& work);
  void look(std::size_t job, std::size_t view, WorkOnView& work);
  template <class Visit>
  void for_each_other(std::size_t job, std::size_t view, const Visit& visit) const;
  const std::vector<MovedPiece>& pieces(const std::array<std::size_t, 3>& of,
                                        const Findings& shown_in, const Findings& seen_through_by);
  void release(std::size_t job);

  const std::vector<Job>& jobs_;
  const ShotMemory memory_;
  const bool is_shot_, only_looks_, follows_;
  std::vector<std::vector<std::size_t>> around_;  ///< of each job that makes something, by frame
  std::vector<int> wanting_;                      ///< how many jobs want each
  std::map<std::pair<std::size_t, std::size_t>, KeptFindings> findings_;  ///< by job and view
  /// What the second of two jobs looks through in the first: by both, and view.
  std::map<std::array<std::size_t, 3>, std::vector<MovedPiece>> pieces_;
  std::deque<Waiting> waiting_;
  std::size_t latest_ = 0;     ///< job that was added
  std::size_t most_kept_ = 0;  ///< most frames whose findings are kept at one time
  std::size_t kept_bytes_ = 0, waiting_bytes_ = 0;  ///< in memory
};

}  // namespace ssdo
