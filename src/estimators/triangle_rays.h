// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "estimators/triangle_hit.h"

namespace ssdo {

/// Triangles that answer rays through Embree. May be asked from many threads at once.
class TriangleRays {
 public:
  /// Corners lie `stride` bytes apart, and four floats can be read from the last one. What is
  /// pointed at must outlive the rays.
  struct Mesh {
    const glm::vec3* corners;
    std::size_t count, stride;
    const std::vector<std::array<std::uint32_t, 3>>& triangles;

    const glm::vec3& corner(std::uint32_t number) const;
  };

  /// Errors: ExitCode::failed where memory does not suffice; `what` begins the message.
  TriangleRays(std::vector<Mesh> meshes, std::string_view what);
  ~TriangleRays();

  /// It ends `reach`, which may be infinite, times the length of `direction` from its origin.
  struct Ray {
    glm::vec3 origin, direction;
    float reach;
  };

  /// Which of the hits within reach count; null: all of them.
  class Rule {
   public:
    virtual bool counts(const TriangleHit& hit) const = 0;

   protected:
    ~Rule() = default;
  };

  bool is_blocked(const Ray& ray, const Rule* rule) const;
  std::optional<TriangleHit> first_hit(const Ray& ray, const Rule* rule) const;

  /// The number of the corner that counts most in a hit.
  std::uint32_t corner_of(const TriangleHit& hit) const;

 private:
  struct Embree;
  class Query;
  std::vector<Mesh> meshes_;
  std::unique_ptr<Embree> embree_;
};

}  // namespace ssdo
