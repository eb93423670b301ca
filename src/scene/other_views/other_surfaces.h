// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <vector>

namespace ssdo {

/// A place on a surface that a pixel of another view shows, in the camera space of the frame.
struct Vertex {
  glm::vec3 position{0}, normal{0};  ///< the normal is unit, on the side that is seen
  glm::vec3 albedo{0};
  float footprint = 0;       ///< width of what its pixel shows, in scene units
  std::uint32_t sender = 0;  ///< the vertex whose light it sends: the middle of its pixel
  /// The pixel of the frame that shows it; kOfOtherView for a vertex of another view.
  std::uint32_t frame_pixel = kOfOtherView;

  static constexpr std::uint32_t kOfOtherView = ~0u;
};

/// What other views show of a scene: surfaces as triangles.
struct OtherSurfaces {
  using Triangle = std::array<std::uint32_t, 3>;

  std::vector<Vertex> vertices;
  std::vector<Triangle> added;  ///< of what the frame does not show
  std::vector<Triangle> all;    ///< these, what the frame shows as well, and the frame, coarsely

  /// For vertices of other views, the share that linked lamps light, 0..1, by the text of the
  /// selection (OtherPicture::receives).
  std::map<std::string, std::vector<float>> receives;

  bool empty() const { return added.empty(); }
};

}  // namespace ssdo
