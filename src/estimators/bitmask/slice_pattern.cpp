// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/slice_pattern.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "math/sequence_numbers.h"

namespace ssdo {
namespace {

/// An ordering of the pattern in which neighbours are far apart (Bayer's matrix, 1973): each of its
/// quarters holds every fourth rank, and so do theirs.
int order_of(int column, int row, int size) {
  int rank = 0;
  for (int bit = 1; bit < size; bit *= 2) {
    const bool right = column & bit, below = row & bit;
    rank = 4 * rank + (right != below ? 2 : 0) + (below ? 1 : 0);
  }
  return rank;
}

/// The number that a seed combines ranks with, by exclusive or: the seed's low bits in reverse
/// order. The new order spreads neighbours as well as the old one. Consecutive seeds give a member
/// ranks that are far apart, and in the end every rank, so that frames of a sequence, or runs that
/// are averaged, share no direction. Seed 0 changes nothing.
int turn_of(unsigned seed, int size) {
  int bits = 0;
  for (int most = size * size; most > 1; most /= 2, seed /= 2) bits = 2 * bits + int(seed & 1);
  return bits;
}

/// Alternates from one direction to the next, and on every scale of the pattern from row to row or
/// from column to column: by rows among 2 x 2 and among 8 x 8 members, by columns among 4 x 4.
/// Both have to alternate for filters that are narrower than the pattern.
float half_sign_of(int rank) {
  constexpr unsigned kRowsColumnsRows = 0b011101;
  return std::popcount(unsigned(rank) & kRowsColumnsRows) % 2 == 0 ? 1.0f : -1.0f;
}

/// Exponent of the spacing of steps. With 1, steps grow in proportion to the distance and are
/// longest where the largest occluders are. A smaller exponent lets them grow less: with 0.7 the
/// error against many steps fell by a third.
constexpr double kFarther = 0.7;

/// Phases keep a distance from the edges of sectors, so that the horizon of a plane, which rounding
/// moves a little, never passes the sample point of a sector.
float phase_in(double t) { return float(0.02 + 0.96 * t); }

/// Samples that are no farther apart than this, in pixels along the march, are neighbours.
constexpr float kNeighbours = 1.5f;

/// The whole number nearest to `x` for which place + x is the middle of a block of pixels.
int to_block(double x, int place, int block) {
  if (block == 1) return int(std::lround(x));
  const int middle = block / 2;
  return int(std::lround((x + place - middle) / block)) * block + middle - place;
}

/// Sets inner and outer of every step: the stretch of the march that it represents. The first
/// stretch begins outside the pixel where the march starts. Between steps to adjacent pixels no
/// pixel is skipped, so the stretch begins or ends at the pixel itself.
void share_the_way(std::vector<SliceStep>& steps) {
  const auto distance = [](const SliceStep& step) { return std::hypot(step.dx, step.dy); };
  float before = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const float here = distance(steps[k]),
                after = k + 1 < steps.size() ? distance(steps[k + 1]) : here;
    const auto half_way = [here](float other) { return std::sqrt(here * std::max(other, 0.5f)); };
    steps[k].inner = here - before > kNeighbours ? half_way(before) / here : 1;
    steps[k].outer = after - here > kNeighbours ? half_way(after) / here : 1;
    steps[k].inner_px = here * steps[k].inner;
    before = here;
  }
}

/// The side that starts at column `column_phase` and row `line` of a block. `start` in 0..1 places
/// each distance in its stratum.
SliceSide make_side(const Interleaving& layout, const OverviewRaster* far, int column_phase,
                    int line, double dx, double dy, int steps, double diagonal, double start,
                    float phase) {
  SliceSide side;
  side.phase = phase;
  double next = march_distance(start / steps, diagonal);
  for (int i = 0; i < steps; ++i) {
    const double distance = std::exchange(next, march_distance((i + 1 + start) / steps, diagonal));
    const bool is_long = next - distance > kLongStep, is_far = far && distance > far->from_px;
    const int block = is_far ? Interleaving::kPeriod : is_long ? kBlock : 1;
    const int x = to_block(distance * dx, column_phase, block),
              y = to_block(distance * dy, line, block);
    const bool repeated =
        !side.steps.empty() && side.steps.back().dx == float(x) && side.steps.back().dy == float(y);
    if (repeated || (x == 0 && y == 0)) continue;
    SliceStep step{};
    step.dx = float(x), step.dy = float(y);
    step.row = y;
    step.column_shift = (column_phase + x) >> Interleaving::kShift;
    if (is_far) {
      step.row = (line + y) >> Interleaving::kShift;
      step.offset = far->layout.stride() * step.row + step.column_shift;
    } else {
      step.offset =
          layout.index(y, (column_phase + x) & (Interleaving::kPeriod - 1), step.column_shift) -
          layout.index(0, column_phase, 0);
      side.near_steps = side.steps.size() + 1;
    }
    side.steps.push_back(step);
  }
  share_the_way(side.steps);
  return side;
}

}  // namespace

double march_distance(double t, double diagonal) {
  return std::pow(diagonal, std::pow(t, kFarther));
}

int SlicePattern::rows_within(float reach_px) const {
  float rows = reach_px;
  for (const std::vector<Slice>& slices : members_) {
    for (const Slice& slice : slices) {
      for (const SliceSide& side : slice.sides) {
        for (const SliceStep& step : side.steps)
          if (step.inner_px <= reach_px) rows = std::max(rows, std::abs(step.dy));
      }
    }
  }
  return int(std::ceil(rows));
}

int SlicePattern::rank(int member) {
  return order_of(member % Interleaving::kPeriod, member / Interleaving::kPeriod,
                  Interleaving::kPeriod);
}

SlicePattern::SlicePattern(const Interleaving& layout, const Window& display, int slices, int steps,
                           unsigned seed, int spacing, const OverviewRaster* far)
    : members_(Interleaving::kMembers),
      half_signs_(Interleaving::kMembers, 1.0f),
      spacing_(spacing) {
  const double diagonal = std::max(2.0, std::hypot(display.width(), display.height()));
  const double turn = start_of(3 * std::uint64_t(seed)),
               start1 = start_of(3 * std::uint64_t(seed) + 1),
               start2 = start_of(3 * std::uint64_t(seed) + 2);
  const int size = Interleaving::kPeriod / spacing;
  for (int row = 0; row < Interleaving::kPeriod; row += spacing) {
    for (int column = 0; column < Interleaving::kPeriod; column += spacing) {
      const int rank = order_of(column / spacing, row / spacing, size) ^ turn_of(seed, size);
      half_signs_[std::size_t(row * Interleaving::kPeriod + column)] = half_sign_of(rank);
      const double place = (rank + fraction(turn)) / (size * size);
      for (int k = 0; k < slices; ++k) {
        const double angle = glm::pi<double>() * (k + place) / slices;
        Slice slice{float(std::cos(angle)), float(std::sin(angle)), {}};
        for (int s = 0; s < 2; ++s) {
          const double n = (rank * slices + k) * 2 + s, sign = s == 0 ? 1 : -1;
          // Neighbouring directions, of consecutive ranks, have distances that are far apart.
          const double start = fraction(start1 + rank * kR1 + 0.25 * (2 * k + s));
          slice.sides[s] =
              make_side(layout, far, column, row, sign * slice.dx, sign * slice.dy, steps, diagonal,
                        start, phase_in(fraction(start2 + n * kR2Second)));
        }
        members_[std::size_t(row * Interleaving::kPeriod + column)].push_back(std::move(slice));
      }
    }
  }
}

}  // namespace ssdo
