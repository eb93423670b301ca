// SPDX-License-Identifier: Apache-2.0
#include "scene/normals/world_of_normals.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "scene/camera/metadata/check.h"
#include "scene/normals/normal_space.h"

namespace ssdo {
namespace {

enum class Verdict { none, proved, refuted };

/// Rotations closer than this are one: shading normals lean by as much on average.
constexpr float kSameTurnDegrees = 3;

/// The normals of back faces may be turned round, which is no rotation.
bool is_same_turn(const glm::mat3& a, const glm::mat3& b) {
  const glm::mat3 turn = glm::transpose(a) * b * glm::determinant(a) * glm::determinant(b);
  const float cosine = 0.5f * (turn[0][0] + turn[1][1] + turn[2][2] - 1);
  return cosine > std::cos(glm::radians(kSameTurnDegrees));
}

/// What normals say of a pose: they lie in its world with their axes as they are, in camera space,
/// or in a space that is turned against both.
Verdict judge(const GBuffer& g, const Surfaces& surfels, const HeaderCamera& reading,
              const Placement& found) {
  constexpr const char* kWorld = "the world";
  std::vector<NamedRotation> spaces = {{glm::mat3(1), "camera space"}};
  if (!g.position.empty())
    spaces.push_back({glm::mat3(found.position_camera.rotation), "the space of P"});
  spaces.push_back({glm::mat3(reading.camera.rotation), kWorld});
  const NormalSpace space = find_normal_space(g.normal, surfels, spaces, found.camera.orthographic);
  if (!space.is_known()) return Verdict::none;
  if (space.name == kWorld) return Verdict::proved;
  if (!space.is_own) return Verdict::none;
  for (const NamedRotation& named : spaces) {
    if (is_same_turn(space.to_camera, named.to_camera))
      return named.name == kWorld ? Verdict::proved : Verdict::none;
  }
  return Verdict::refuted;
}

void set_pose(const Camera& pose, Placement& placement) {
  placement.camera.rotation = pose.rotation, placement.camera.origin = pose.origin;
}

/// The frame stays in the space of P, or of the camera where there is depth alone.
void refuse(const HeaderCamera& reading, bool has_positions, GeometryReport& report) {
  Placement& placement = report.placement;
  set_pose(has_positions ? placement.position_camera : Camera(), placement);
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

void settle_world(const GBuffer& g, const Surfaces& surfels,
                  const std::vector<HeaderCamera>& readings, GeometryReport& report) {
  const HeaderCamera& first = readings.front();
  if (!g.normal.empty() && !g.space) {
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
