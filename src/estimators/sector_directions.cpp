// SPDX-License-Identifier: Apache-2.0
#include "estimators/sector_directions.h"

#include <cmath>
#include <glm/gtc/constants.hpp>

namespace ssdo {
namespace {

/// Twice the integral of sin t cos(t - gamma) over t from 0 to theta.
double measure(double theta, double gamma) {
  const double s = std::sin(theta), c = std::cos(theta);
  return std::sin(gamma) * (theta - s * c) + std::cos(gamma) * s * s;
}

std::int32_t pack(double theta) {
  const auto cosine = std::int32_t(std::lround(32767 * std::cos(theta))),
             sine = std::int32_t(std::lround(32767 * std::sin(theta)));
  return sine * 65536 + (cosine & 0xffff);
}

SectorDirections make() {
  SectorDirections table;
  for (int row = 0; row < SectorDirections::kAngles; ++row) {
    const double gamma = glm::pi<double>() * ((row + 0.5) / SectorDirections::kAngles - 0.5);
    const double end = gamma + glm::half_pi<double>(), whole = measure(end, gamma);
    // The measure rises with theta: one walk finds all shares.
    constexpr int kFine = 1024;
    double before = 0;
    int column = 0;
    for (int i = 1; i <= kFine; ++i) {
      const double after = measure(end * i / kFine, gamma) / whole;
      for (; column < SectorDirections::kShares; ++column) {
        const double share = (column + 0.5) / SectorDirections::kShares;
        if (share > after && i < kFine) break;
        const double part = after > before ? (share - before) / (after - before) : 0.5;
        table.packed[std::size_t(row * SectorDirections::kShares + column)] =
            pack(end * (i - 1 + part) / kFine);
      }
      before = after;
    }
  }
  return table;
}

}  // namespace

const SectorDirections& sector_directions() {
  static const SectorDirections table = make();
  return table;
}

}  // namespace ssdo
