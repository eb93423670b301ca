// SPDX-License-Identifier: Apache-2.0
#include "jobs/sequence/shot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "plan/band_plan.h"
#include "relight/relight.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// Findings in memory: those that are kept, or `copy`, which is filled with those on disk.
/// The first `arrays` of these suffice.
const Findings& in_memory(const auto& kept, Findings& copy,
                          std::size_t arrays = std::numeric_limits<std::size_t>::max()) {
  if (!kept.arrays) return kept.findings;
  copy = kept.findings;
  kept.arrays->read(copy, arrays);
  return copy;
}

}  // namespace

Shot::Shot(const std::vector<Job>& jobs, const ShotWindow& window, bool only_looks,
           const ShotMemory& memory)
    : jobs_(jobs),
      memory_(memory),
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
    if (jobs[i].has_no_outputs || !jobs[i].frame) continue;
    for (const int frame : frames_around(window, *jobs[i].frame))
      if (const auto found = at_frame.find(frame); found != at_frame.end())
        around_[i].push_back(found->second);
    for (const std::size_t other : around_[i]) ++wanting_[other];
  }
  count();
}

/// Counts for most_kept_, by going through the run as its frames will.
void Shot::count() {
  std::vector<int> wanting = wanting_;
  std::size_t first = 0, kept = 0;  // the job that has waited longest
  for (std::size_t now = 0; now < jobs_.size(); ++now) {
    kept += wanting[now] > 0;
    most_kept_ = std::max(most_kept_, kept);
    for (; first <= now && complete_after(first) <= now; ++first)
      for (const std::size_t other : around_[first]) kept -= --wanting[other] == 0;
  }
}

/// Bytes left for everything that waits, besides the frames at work, each as large as this one.
std::size_t Shot::room_beside(const Work& work) const {
  double of_frame = 0;
  for (const WorkOnView& view : work.views) {
    const Scene& scene = only_looks_ ? view.frame.scene : view.relit.found.scene;
    of_frame += bytes_in_one_piece(view.frame.plan, scene, scene.geometry.surfaces.size());
  }
  return std::size_t(std::max(0.0, double(memory_.bytes) - memory_.frames * of_frame));
}

Findings Shot::take_findings(WorkOnView& work) const {
  if (!only_looks_) return ssdo::take_findings(work.relit);
  Findings findings;
  findings.surfaces = keep_surfaces(std::exchange(work.frame.scene, {}).geometry);
  work.frame.gbuffer = {};
  return findings;
}

/// Finds how things move from the frame before in time; nothing where that frame is missing.
void Shot::find_motion(std::size_t job, std::size_t view, Work& work, Findings& own) const {
  Frame& frame = work.views[view].frame;
  const Plane<glm::vec2> layer = std::exchange(frame.gbuffer.motion, {});
  if (layer.empty() || job == 0 || std::int64_t(*jobs_[job - 1].frame) + 1 != *jobs_[job].frame)
    return;
  const auto before = findings_.find({job - 1, view});
  if (before == findings_.end()) return;
  Findings copy;
  const Findings& then = in_memory(before->second, copy, kArraysOfGeometry);
  own.motion = find_object_motion(layer, own.surfaces, then.surfaces);
  if (!own.motion.contradicts) return;
  work.messages.warn(
      {fmt::format("{} moves other ways than the cameras say, and is not used; are its units "
                   "pixels to the frame before, y up? give --motion-scale",
                   frame.layers[Role::motion]->name)},
      frame.view);
}

void Shot::keep(Waiting& waiting) {
  const std::size_t job = waiting.work.index, room = room_beside(waiting.work);
  std::size_t found = 0, waits = 0;
  for (std::size_t v = 0; v < waiting.work.views.size(); ++v) {
    KeptFindings kept{take_findings(waiting.work.views[v]), {}, 0};
    if (follows_) find_motion(job, v, waiting.work, kept.findings);
    const std::size_t bytes = bytes_of(kept.findings);
    if (kept_bytes_ + waiting_bytes_ + bytes > room)
      kept.arrays.emplace(kept.findings);
    else
      kept.bytes = bytes;
    kept_bytes_ += kept.bytes, found += bytes;
    findings_.emplace(std::pair(job, v), std::move(kept));
  }
  if (jobs_[job].has_no_outputs) return;
  for (WorkOnView& view : waiting.work.views) waits += bytes_of(view);
  if (waiting_bytes_ + waits + most_kept_ * found <= room)
    waiting_bytes_ += waiting.bytes = waits;
  else
    for (WorkOnView& view : waiting.work.views) waiting.arrays.emplace_back(view);
}

void Shot::add(Work work) {
  latest_ = work.index;
  Waiting waiting{std::move(work), {}, 0};
  if (is_shot_ && is_wanted(latest_))
    attempt(waiting.work, jobs_[latest_].input(), [&] { keep(waiting); });
  if (jobs_[latest_].has_no_outputs) waiting.work.views.clear();
  waiting_.push_back(std::move(waiting));
}

/// The job after which everything is there that this job wants.
std::size_t Shot::complete_after(std::size_t job) const {
  return around_[job].empty() ? job : *std::ranges::max_element(around_[job]);
}

bool Shot::has_complete() const {
  return !waiting_.empty() && complete_after(waiting_.front().work.index) <= latest_;
}

Work Shot::next_complete() {
  Waiting first = std::move(waiting_.front());
  waiting_.pop_front();
  waiting_bytes_ -= first.bytes;
  if (is_shot_) make(first);
  return std::move(first.work);
}

void Shot::make(Waiting& waiting) {
  Work& work = waiting.work;
  attempt(work, jobs_[work.index].input(), [&] {
    for (std::size_t v = 0; v < work.views.size(); ++v) {
      if (!waiting.arrays.empty()) waiting.arrays[v].read(work.views[v]);
      only_looks_ ? look(work.index, v, work.views[v]) : make(work.index, v, work.views[v]);
    }
  });
  release(work.index);
}

/// Calls visit(job, findings, whether they are read from disk) for the frames around one, in their
/// order. Of findings from disk, surfaces and motion live until the call after the next.
template <class Visit>
void Shot::for_each_other(std::size_t job, std::size_t view, const Visit& visit) const {
  Findings copies[2];
  int next = 0;
  for (const std::size_t other : around_[job]) {
    const auto found = findings_.find({other, view});
    if (other == job || found == findings_.end()) continue;
    const bool is_copy = found->second.arrays.has_value();
    visit(other, in_memory(found->second, copies[next]), is_copy);
    if (!is_copy) continue;
    copies[next].values = {}, copies[next].glow = {};
    next = 1 - next;
    copies[next] = {};
  }
}

void Shot::make(std::size_t job, std::size_t view, WorkOnView& work) {
  Stopwatch watch;
  Findings copy;
  const Findings& own = in_memory(findings_.at({job, view}), copy);
  Fusion fusion(own, work.relit.found.scene.light);
  std::vector<OtherFindings> others;
  for_each_other(job, view, [&](std::size_t other, const Findings& findings, bool is_copy) {
    others.push_back({&findings, *jobs_[other].frame - *jobs_[job].frame,
                      &pieces({job, other, view}, own, findings),
                      &pieces({other, job, view}, findings, own)});
    if (is_copy) fusion.add(std::exchange(others, {}), false);
  });
  fusion.add(others, true);
  work.relit.found.filter_ms += watch.lap();
  relight_in_shot(fusion, work.relit);
}

/// Counts, for `info`, what the other frames show of this one.
void Shot::look(std::size_t job, std::size_t view, WorkOnView& work) {
  Findings copy;
  ShownPoints shown(in_memory(findings_.at({job, view}), copy).surfaces);
  for_each_other(job, view, [&](std::size_t, const Findings& findings, bool) {
    shown.add(findings.surfaces);
  });
  work.shown = shown.count();
}

/// The pieces that stand in the first job and that the second looks through, in a view. They are
/// found once for both jobs.
const std::vector<MovedPiece>& Shot::pieces(const std::array<std::size_t, 3>& of,
                                            const Findings& shown_in,
                                            const Findings& seen_through_by) {
  const auto [place, is_new] = pieces_.try_emplace(of);
  if (is_new)
    place->second = find_pieces(shown_in.surfaces, seen_through_by.surfaces, shown_in.motion);
  return place->second;
}

/// Frees the findings that only this job still wanted.
void Shot::release(std::size_t job) {
  for (const std::size_t other : around_[job]) {
    if (--wanting_[other] > 0) continue;
    for (auto at = findings_.lower_bound({other, 0});
         at != findings_.end() && at->first.first == other; at = findings_.erase(at))
      kept_bytes_ -= at->second.bytes;
    std::erase_if(pieces_, [&](const auto& of_two) {
      return of_two.first[0] == other || of_two.first[1] == other;
    });
  }
}

}  // namespace ssdo
