// SPDX-License-Identifier: Apache-2.0
#include "scene/light/light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <memory>

#include "math/pi.h"
#include "parallel/tiles.h"
#include "scene/light/distant_source.h"
#include "scene/light/sky_grid.h"
#include "scene/light/take_suns.h"

namespace ssdo {
namespace {

constexpr int kBandColumns = 256;    ///< patches of 1.4 degrees dim band 4 by 1/2000
constexpr int kLobeColumns = 128;    ///< patches of 2.8 degrees
constexpr int kIrradianceSize = 65;  ///< odd, so that every node has a node opposite to it
constexpr int kResidualNodes = 512;  ///< 9 degrees apart
constexpr std::size_t kLanes = 8;

using Patch = Environment::Patch;

/// Patches, one quantity after the other, for sums over the whole sky that fill vector registers.
class Sky {
 public:
  explicit Sky(const std::vector<Patch>& patches)
      : blocks_((patches.size() + kLanes - 1) / kLanes) {
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const Patch& patch = patches[i];
      Block& block = blocks_[i / kLanes];
      for (int c = 0; c < 3; ++c) {
        block.direction[c][i % kLanes] = patch.direction[c];
        block.power[c][i % kLanes] = patch.power[c];
      }
      block.solid_angle[i % kLanes] = patch.solid_angle;
    }
  }

  /// Radiance averaged over a lobe about `d`, `lobe` being its value at a cosine.
  template <class Lobe>
  glm::vec3 average(const glm::vec3& d, const Lobe& lobe) const {
    float red[kLanes] = {}, green[kLanes] = {}, blue[kLanes] = {}, weights[kLanes] = {};
    for (const Block& block : blocks_) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        const float w = lobe(d.x * block.direction[0][k] + d.y * block.direction[1][k] +
                             d.z * block.direction[2][k]);
        red[k] += w * block.power[0][k];
        green[k] += w * block.power[1][k];
        blue[k] += w * block.power[2][k];
        weights[k] += w * block.solid_angle[k];
      }
    }
    glm::vec3 sum(0);
    float weight = 0;
    for (std::size_t k = 0; k < kLanes; ++k) {
      sum += glm::vec3(red[k], green[k], blue[k]);
      weight += weights[k];
    }
    // A map of a few texels may have none in the lobe.
    return weight > 0 ? sum / weight : glm::vec3(0);
  }

 private:
  /// Unused lanes have no power and no solid angle.
  struct Block {
    float direction[3][kLanes] = {}, power[3][kLanes] = {}, solid_angle[kLanes] = {};
  };
  std::vector<Block> blocks_;
};

/// A small map with each texel split into several: projected as points, large texels would add
/// light to bands in which the map has none.
Environment refined(const Environment& environment) {
  const Plane<glm::vec3>& map = *environment.map();
  const int across = std::max(1, kBandColumns / map.width);
  const int down = std::max(1, kBandColumns / 2 / map.height);
  if (across == 1 && down == 1) return environment;
  auto fine = std::make_shared<Plane<glm::vec3>>(map.width * across, map.height * down);
  for (int y = 0; y < fine->height; ++y) {
    for (int x = 0; x < fine->width; ++x) (*fine)(x, y) = map(x / across, y / down);
  }
  return Environment(fine, environment.frame());
}

/// The bands first..last of the model in direction `d`.
glm::vec3 bands(const Light& model, const glm::vec3& d, int first, int last) {
  const std::array<float, kShCount> basis = sh_basis(d);
  glm::vec3 sum(0);
  for (int i = first * first; i < sh_count(last); ++i) sum += basis[i] * model.coefficients[i];
  return sum;
}

void project(const std::vector<Patch>& patches, Light& model) {
  std::array<glm::dvec3, kShCount> sums{};
  double energy = 0;
  for (const Patch& patch : patches) {
    const std::array<float, kShCount> basis = sh_basis(patch.direction);
    for (int i = 0; i < kShCount; ++i) sums[i] += glm::dvec3(basis[i] * patch.power);
    energy += std::pow(double(brightness(patch.power)), 2) / patch.solid_angle;
  }
  for (int i = 0; i < kShCount; ++i) model.coefficients[i] = glm::vec3(sums[i]);
  if (energy == 0) return;
  for (int l = 0; l <= kShOrder; ++l) {
    double in_band = 0;
    for (int i = l * l; i < sh_count(l); ++i) {
      in_band += std::pow(double(brightness(model.coefficients[i])), 2);
    }
    model.band_energy[l] = in_band / energy;
  }
}

/// Fills the residuals and chooses the order.
void measure_residuals(const std::vector<Patch>& patches, const Sky& sky, Light& model) {
  double mean = 0;
  for (const Patch& patch : patches) mean += std::abs(brightness(patch.power)) / (4 * kPif);
  if (mean == 0) return;
  // The lobe max(0, cos - edge) is as wide as the cone if their weights agree: pi (1 - edge) is
  // 2 pi (1 - cos 30).
  const float edge = float(std::sqrt(3.0)) - 1;
  const std::array<double, kShOrder + 1> kept = sh_lobe_factors(edge);
  std::vector<std::array<double, kShOrder + 1>> squares(kResidualNodes);
  for_each_row(kResidualNodes, [&](int i) {
    // A golden spiral: directions of equal area.
    const float z = 1 - (2 * float(i) + 1) / kResidualNodes, across = std::sqrt(1 - z * z);
    const float azimuth = float(i) * kPif * (3 - std::sqrt(5.0f));
    const glm::vec3 d(across * std::cos(azimuth), across * std::sin(azimuth), z);
    glm::vec3 missing = sky.average(d, [&](float c) { return std::max(0.0f, c - edge); });
    for (int l = 0; l <= kShOrder; ++l) {
      missing -= float(kept[l]) * bands(model, d, l, l);
      squares[i][l] = glm::dot(missing, missing) / 3;
    }
  });
  for (int l = 0; l <= kShOrder; ++l) {
    double sum = 0;
    for (const auto& node : squares) sum += node[l];
    model.residuals[l] = std::sqrt(sum / kResidualNodes) / mean;
  }
  const double bound = model.residuals[kShOrder] <= kBandLimited ? kBandLimited : kLightResidual;
  while (model.order < kShOrder && model.residual() > bound) ++model.order;
}

/// The irradiance of the sky. max(0, x) is (x + |x|) / 2: x has only band 1, and |x| is the same
/// for opposite normals, so that half of the nodes are enough.
OctahedralMap irradiance(const Sky& sky, const Light& model) {
  OctahedralMap out(kIrradianceSize);
  constexpr int kEnd = kIrradianceSize - 1;
  const auto for_each_node = [](bool front, const auto& visit) {
    for_each_row(kIrradianceSize, [&](int y) {
      for (int x = 0; x < kIrradianceSize; ++x) {
        const bool in_diamond = std::abs(2 * x - kEnd) + std::abs(2 * y - kEnd) <= kEnd;
        if (in_diamond == front) visit(x, y);
      }
    });
  };
  for_each_node(true, [&](int x, int y) {
    out(x, y) = sky.average(out.direction_of(x, y), [](float c) { return std::abs(c); });
  });
  for_each_node(false, [&](int x, int y) {
    // Unfolded and mirrored, in units of half a node from the middle of the square.
    const int across = kEnd - std::abs(2 * y - kEnd), down = kEnd - std::abs(2 * x - kEnd);
    const int opposite_x = (2 * x > kEnd ? -across : across),
              opposite_y = 2 * y > kEnd ? -down : down;
    out(x, y) = out((opposite_x + kEnd) / 2, (opposite_y + kEnd) / 2);
  });
  for_each_row(kIrradianceSize, [&](int y) {
    for (int x = 0; x < kIrradianceSize; ++x) {
      out(x, y) += kCosineFactors[1] * bands(model, out.direction_of(x, y), 1, 1);
    }
  });
  return out;
}

}  // namespace

glm::vec3 Light::unoccluded_sky(const glm::vec3& normal) const {
  // Looking a constant up would round.
  return environment.is_constant() ? environment.constant_radiance() : irradiance(normal);
}

glm::vec3 Light::unoccluded(const glm::vec3& position, const glm::vec3& normal) const {
  glm::vec3 sum = unoccluded_sky(normal);
  for (const auto& source : sources) sum += source->unoccluded(position, normal);
  return sum;
}

glm::vec3 Light::unoccluded_in(std::size_t pixel, const glm::vec3& position,
                               const glm::vec3& normal) const {
  glm::vec3 sum = unoccluded_sky(normal);
  for (const auto& source : sources)
    sum += source->link_weight(pixel) * source->unoccluded(position, normal);
  return sum;
}

Light model_light(const Environment& environment, const glm::mat3& world_to_camera) {
  Light model;
  model.environment = model.sky = environment;
  if (environment.is_constant()) {
    const glm::vec3& radiance = environment.constant_radiance();
    model.coefficients[0] = radiance / sh_basis(glm::vec3(0, 0, 1))[0];
    model.band_energy[0] = brightness(radiance) != 0 ? 1 : 0;
    for (int i = 0; i < 4; ++i) model.irradiance(i % 2, i / 2) = radiance;
    return model;
  }
  SunsAndRest parts = take_suns(environment);
  model.sky = parts.rest;
  for (DistantSource& sun : parts.suns) {
    sun.turn(world_to_camera);
    model.sources.push_back(std::make_shared<DistantSource>(std::move(sun)));
  }
  const SkyGrid grid(refined(parts.rest), world_to_camera, kBandColumns);
  project(grid.patches, model);
  const std::vector<Patch> patches = grid.merged(kLobeColumns).patches;
  const Sky sky(patches);
  measure_residuals(patches, sky, model);
  model.irradiance = irradiance(sky, model);
  return model;
}

}  // namespace ssdo
