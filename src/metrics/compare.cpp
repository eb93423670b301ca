// SPDX-License-Identifier: Apache-2.0
#include "metrics/compare.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/json_text.h"
#include "io/sequence.h"
#include "metrics/compare_pictures.h"
#include "metrics/compare_report.h"
#include "metrics/compare_shot.h"
#include "metrics/shot_report.h"

namespace ssdo {
namespace {

/// Whether the pictures are those of a sequence. Errors: ExitCode::usage for what does not fit.
bool is_sequence(const CompareOptions& o) {
  const auto has_pattern = [](const std::string& picture) {
    return is_pattern(parse_picture_name(picture).file);
  };
  const auto refuse = [](const std::string& what) { throw Error(ExitCode::usage, what); };
  const bool is_shot = has_pattern(o.a);
  if (!o.b.empty() && has_pattern(o.b) != is_shot)
    refuse(fmt::format("{} and {}: one is a sequence, the other a picture; give two of a kind", o.a,
                       o.b));
  if (o.b.empty() && o.points.empty())
    refuse(
        fmt::format("{}: compare needs B; or give a sequence with --points GBUFFER.####.exr", o.a));
  if (o.b.empty() && (!o.diff.empty() || o.fail_above))
    refuse(fmt::format("{}: --diff and --fail-above are of A - B, and there is no B", o.a));
  if (!o.points.empty() && (!is_shot || !is_pattern(o.points)))
    refuse(
        fmt::format("--points {}: flicker is measured from frame to frame; give frame patterns, "
                    "such as shot.####.exr, for it and for A",
                    o.points));
  if (!o.camera.empty() && o.points.empty())
    refuse(fmt::format("--camera {}: is that of --points, which are not given", o.camera));
  if (o.frames && !is_shot)
    refuse(fmt::format("{}: --frames needs a pattern in the name, such as shot.####.exr", o.a));
  if (is_shot && !o.diff.empty() && !is_pattern(o.diff))
    refuse(
        fmt::format("--diff {}: all frames would go to this one file; put a pattern into its "
                    "name, such as diff.####.exr",
                    o.diff));
  return is_shot;
}

}  // namespace

CompareReport compare(const CompareOptions& options) {
  if (is_sequence(options)) {
    const ShotComparison shot = compare_shot(options);
    return {options.json ? json_text(to_json(options, shot), 2) + "\n" : to_table(shot),
            exit_code_of(options, shot)};
  }
  const Comparison all = compare_pictures(options, PictureMask(options.mask));
  return {options.json ? json_text(to_json(options, all), 2) + "\n" : to_table(all),
          passes(options, all) ? ExitCode::done : ExitCode::failed};
}

}  // namespace ssdo
