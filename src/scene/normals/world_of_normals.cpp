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

/// Depth alone has no space of its own: its positions are those of the camera.
void set_pose(const Camera& pose, bool has_positions, Placement& placement) {
  placement.camera.rotation = pose.rotation, placement.camera.origin = pose.origin;
  if (!has_positions) placement.of_positions = placement.camera;
}

void refuse(const HeaderCamera& reading, bool has_positions, GeometryReport& report) {
  Placement& placement = report.placement;
  set_pose(has_positions ? placement.of_positions : Camera(), has_positions, placement);
  placement.world_given = false;
  report.header.reset();
  report.warnings.push_back(
      fmt::format("{}: normals are of another world than its pose; the pose is not used: give "
                  "--camera FILE.json",
                  describe(reading)));
}

void use(const HeaderCamera& reading, bool has_positions, GeometryReport& report) {
  set_pose(reading.camera, has_positions, report.placement);
  report.header->reading = reading.reading;
  report.header->proof = HeaderProof::normals;
}

}  // namespace

void settle_world(const GBuffer& g, const Plane<Surfel>& surfels,
                  const std::vector<HeaderCamera>& readings, GeometryReport& report) {
  const HeaderCamera& first = readings.front();
  const bool has_positions = !g.position.empty();
  if (!g.normal.empty()) {
    for (const HeaderCamera& reading : readings) {
      const Verdict verdict = judge(g, surfels, reading, report.placement);
      if (verdict == Verdict::none) break;
      if (verdict == Verdict::proved) return use(reading, has_positions, report);
      if (&reading == &readings.back()) return refuse(first, has_positions, report);
    }
  }
  if (first.pose_agrees) return;
  report.warnings.push_back(
      fmt::format("{}: nothing proves the pose, which is read as its renderer means it; give "
                  "--camera FILE.json to be sure",
                  describe(first)));
}

}  // namespace ssdo
