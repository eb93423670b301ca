// SPDX-License-Identifier: Apache-2.0
#include "scene/normals/world_of_normals.h"

#include <fmt/format.h>

#include "scene/camera/metadata/check.h"
#include "scene/normals/normal_space.h"

namespace ssdo {
namespace {

enum class Verdict { none, proved, refuted };

/// What normals say of a pose: they lie in its world with their axes as they are, in camera space,
/// or in a space that is turned against both.
Verdict judge(const GBuffer& g, const Plane<Surfel>& surfels, const HeaderCamera& reading,
              const Placement& found) {
  constexpr const char* kWorld = "the world";
  std::vector<NamedRotation> spaces = {{glm::mat3(1), "camera space"}};
  if (!g.position.empty())
    spaces.push_back({glm::mat3(found.of_positions.rotation), "the space of P"});
  spaces.push_back({glm::mat3(reading.camera.rotation), kWorld});
  const NormalSpace space = find_normal_space(g.normal, surfels, spaces, found.camera.orthographic);
  if (!space.is_known()) return Verdict::none;
  if (space.name == kWorld) return Verdict::proved;
  return space.is_own ? Verdict::refuted : Verdict::none;
}

void set_pose(const Camera& pose, Placement& placement) {
  placement.camera.rotation = pose.rotation, placement.camera.origin = pose.origin;
}

/// The frame stays in the space of P, or of the camera where there is depth alone.
void refuse(const HeaderCamera& reading, bool has_positions, GeometryReport& report) {
  Placement& placement = report.placement;
  set_pose(has_positions ? placement.of_positions : Camera(), placement);
  placement.world_given = false;
  report.header.reset();
  report.warnings.push_back(
      fmt::format("{}: normals are of another world than its pose; the pose is not used: give "
                  "--camera FILE.json",
                  describe(reading)));
}

void use(const HeaderCamera& reading, GeometryReport& report) {
  set_pose(reading.camera, report.placement);
  report.header->reading = reading.reading;
  report.header->proof = HeaderProof::normals;
}

}  // namespace

void settle_world(const GBuffer& g, const Plane<Surfel>& surfels,
                  const std::vector<HeaderCamera>& readings, GeometryReport& report) {
  const HeaderCamera& first = readings.front();
  if (!g.normal.empty()) {
    for (const HeaderCamera& reading : readings) {
      const Verdict verdict = judge(g, surfels, reading, report.placement);
      if (verdict == Verdict::none) break;
      if (verdict == Verdict::proved) return use(reading, report);
      if (&reading == &readings.back()) return refuse(first, !g.position.empty(), report);
    }
  }
  if (first.pose_agrees) return;
  report.warnings.push_back(
      fmt::format("{}: nothing proves the pose, which is read as its renderer means it; give "
                  "--camera FILE.json to be sure",
                  describe(first)));
}

}  // namespace ssdo
