// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/ray_pattern.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "estimators/bitmask/slice_pattern.h"
#include "math/sobol.h"

namespace ssdo {

namespace {

/// A rank with its bits in reverse order.
int reversed(int rank) {
  int bits = 0;
  for (int most = Interleaving::kMembers; most > 1; most /= 2, rank /= 2)
    bits = 2 * bits + rank % 2;
  return bits;
}

}  // namespace

int rays_to_source(int slices) { return int(std::bit_floor(unsigned(std::max(1, slices / 2)))); }

// Points of Sobol's sequence: any power of two of them are spread evenly in both coordinates, among
// the rays of a pixel, of neighbours in the pattern and of consecutive seeds.
std::vector<PointsOfSource> points_of(const Source& source, int rays, unsigned seed, RaySet set) {
  std::vector<PointsOfSource> points(static_cast<std::size_t>(rays));
  for (std::size_t block = 0; block < points[0].size(); ++block) {
    for (int m = 0; m < Interleaving::kMembers; ++m) {
      const int number = int(block) * Interleaving::kMembers + reversed(SlicePattern::rank(m));
      const std::uint32_t place = std::uint32_t(number) ^ seed;
      for (std::uint32_t k = 0; k < std::uint32_t(rays); ++k)
        points[k][block][std::size_t(m)] =
            source.point(sobol_point(place * std::uint32_t(rays) + k, std::uint32_t(set)));
    }
  }
  return points;
}

}  // namespace ssdo
