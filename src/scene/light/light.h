// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "math/octahedral_map.h"
#include "math/spherical_harmonics.h"
#include "scene/light/environment.h"
#include "scene/light/source.h"

namespace ssdo {

/// If order 4 misses at most kBandLimited of a light, the model keeps the smallest order that does
/// so too. Else it keeps the smallest order that misses at most kLightResidual: on seven frames lit
/// by four maps, direct light with order 4 is no closer to a path tracer.
constexpr double kBandLimited = 0.005, kLightResidual = 0.1;

/// The light that falls on a scene, in the forms that estimators ask for. Camera space, except for
/// the two environments.
struct Light {
  Environment environment = Environment::constant(glm::vec3(0));  ///< all of it
  Environment sky = Environment::constant(glm::vec3(0));          ///< without the sources
  std::vector<std::shared_ptr<const Source>> sources;  ///< at most 8 of a map, then lamps

  /// Spherical-harmonic coefficients of the sky's radiance. All orders are filled.
  std::array<glm::vec3, kShCount> coefficients{};

  int order = 0;  ///< 0..4: bands above it are not worth computing

  /// Share that each band has of the sky's energy: the brightness squared, over the sphere, seen in
  /// patches of 1.4 degrees. Zeros for a black map.
  std::array<double, kShOrder + 1> band_energy{};

  /// For each order, what the bands above it hold: RMS over directions and channels after a blur
  /// by a lobe as wide as a cone of 30 degrees about its axis, relative to the mean brightness.
  std::array<double, kShOrder + 1> residuals{};
  double residual() const { return residuals[order]; }

  /// unoccluded_sky() of a map. From its texels, not from the bands.
  OctahedralMap irradiance{2};

  bool has_local_lamps() const {
    return std::ranges::any_of(sources, [](const auto& source) { return source->local_lamp(); });
  }

  // The light of a surface that has nothing around it, as irradiance over pi; light-inl.h has the
  // same for vectors. Nothing else computes it.

  glm::vec3 unoccluded_sky(const glm::vec3& normal) const;

  /// unoccluded_sky() plus the light of the sources, as if each lit every surface.
  glm::vec3 unoccluded(const glm::vec3& position, const glm::vec3& normal) const;

  /// The same for the surface in a pixel, from each source as far as it lights this pixel.
  glm::vec3 unoccluded_in(std::size_t pixel, const glm::vec3& position,
                          const glm::vec3& normal) const;

  /// Whether the light is the same from all directions: one colour, and no sources.
  bool is_constant() const { return environment.is_constant() && sources.empty(); }
};

/// Errors: none; maps that are black or have negative texels give finite models.
Light model_light(const Environment& environment, const glm::mat3& world_to_camera);

}  // namespace ssdo
