// SPDX-License-Identifier: Apache-2.0
#include "jobs/sequence/shot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "relight/relight.h"

namespace ssdo {

Shot::Shot(const std::vector<Job>& jobs, const ShotWindow& window, bool only_looks)
    : jobs_(jobs),
      is_shot_(window.count > 0),
      only_looks_(only_looks && is_shot_),
      follows_(is_shot_ && !only_looks && window.step == 1),
      around_(jobs.size()),
      wanting_(jobs.size()) {
  if (!is_shot_) return;
  std::map<int, std::size_t> at_frame;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    if (jobs[i].frame) at_frame.emplace(*jobs[i].frame, i);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (jobs[i].is_lent || !jobs[i].frame) continue;
    for (const int frame : frames_around(window, *jobs[i].frame))
      if (const auto found = at_frame.find(frame); found != at_frame.end())
        around_[i].push_back(found->second);
    for (const std::size_t other : around_[i]) ++wanting_[other];
  }
  count();
}

/// Goes through the run as complete() will.
void Shot::count() {
  std::vector<int> wanting = wanting_;
  std::size_t first = 0, kept = 0;  // the job that has waited longest
  for (std::size_t now = 0; now < jobs_.size(); ++now) {
    kept += wanting[now] > 0;
    most_kept_ = std::max(most_kept_, kept);
    most_waiting_ = std::max(most_waiting_, now - first + 1);
    for (; first <= now && complete_after(first) <= now; ++first)
      for (const std::size_t other : around_[first]) kept -= --wanting[other] == 0;
  }
}

std::vector<Work> Shot::complete(Work work) {
  const std::size_t now = work.index;
  if (is_shot_ && is_wanted(now)) {
    attempt(work, jobs_[now].input(), [&] {
      for (std::size_t v = 0; v < work.views.size(); ++v) {
        findings_.insert_or_assign({now, v}, take_findings(work.views[v]));
        if (follows_) find_motion(now, v, work);
      }
    });
  }
  if (jobs_[now].is_lent) work.views.clear();
  waiting_.push_back(std::move(work));
  std::vector<Work> made;
  while (!waiting_.empty() && complete_after(waiting_.front().index) <= now) {
    Work& first = waiting_.front();
    if (is_shot_) make(first);
    made.push_back(std::move(first));
    waiting_.pop_front();
  }
  return made;
}

Findings Shot::take_findings(WorkOnView& work) const {
  if (!only_looks_) return ssdo::take_findings(work.relit);
  Findings findings;
  findings.surfaces = keep_surfaces(std::exchange(work.frame.scene, {}).geometry);
  return findings;
}

/// Where the frame before in time is not there, nothing that moves is followed through the gap.
void Shot::find_motion(std::size_t job, std::size_t view, Work& work) {
  Frame& frame = work.views[view].frame;
  const Plane<glm::vec2> layer = std::exchange(frame.gbuffer.motion, {});
  if (layer.empty() || job == 0 || std::int64_t(*jobs_[job - 1].frame) + 1 != *jobs_[job].frame)
    return;
  const auto before = findings_.find({job - 1, view});
  if (before == findings_.end()) return;
  Findings& own = findings_.at({job, view});
  own.motion = find_own_motion(layer, own.surfaces, before->second.surfaces);
  if (!own.motion.contradicts) return;
  work.messages.warn(
      {fmt::format("{} moves other ways than the cameras say, and is not used; are its units "
                   "pixels to the frame before, y up? give --motion-scale",
                   frame.layers[Role::motion]->name)},
      frame.view);
}

/// The job after which a job has all that it wants.
std::size_t Shot::complete_after(std::size_t job) const {
  return around_[job].empty() ? job : *std::ranges::max_element(around_[job]);
}

void Shot::make(Work& work) {
  const std::size_t job = work.index;
  attempt(work, jobs_[job].input(), [&] {
    for (std::size_t v = 0; v < work.views.size(); ++v) make(job, v, work.views[v]);
  });
  release(job);
}

void Shot::make(std::size_t job, std::size_t view, WorkOnView& work) {
  std::vector<OtherFindings> others;
  std::vector<const KeptSurfaces*> surfaces;
  for (const std::size_t other : around_[job]) {
    const auto found = findings_.find({other, view});
    if (other == job || found == findings_.end()) continue;
    surfaces.push_back(&found->second.surfaces);
    if (only_looks_) continue;
    others.push_back({&found->second, *jobs_[other].frame - *jobs_[job].frame,
                      &pieces(job, other, view), &pieces(other, job, view)});
  }
  const Findings& own = findings_.at({job, view});
  if (only_looks_)
    work.shown = seen_by(surfaces, own.surfaces);
  else
    relight_in_shot(own, others, work.relit);
}

/// What `looks` looks through of what stands in another job: found once for both of them.
const std::vector<MovedPiece>& Shot::pieces(std::size_t stands, std::size_t looks,
                                            std::size_t view) {
  const auto [place, is_new] = pieces_.try_emplace({stands, looks, view});
  if (!is_new) return place->second;
  const Findings& standing = findings_.at({stands, view});
  place->second =
      find_pieces(standing.surfaces, findings_.at({looks, view}).surfaces, standing.motion);
  return place->second;
}

/// A job wants nothing any more.
void Shot::release(std::size_t job) {
  for (const std::size_t other : around_[job]) {
    if (--wanting_[other] > 0) continue;
    findings_.erase(findings_.lower_bound({other, 0}), findings_.lower_bound({other + 1, 0}));
    std::erase_if(pieces_, [&](const auto& of_two) {
      return of_two.first[0] == other || of_two.first[1] == other;
    });
  }
}

}  // namespace ssdo
