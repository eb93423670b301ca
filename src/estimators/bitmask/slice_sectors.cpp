// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/slice_sectors.h"

#include <algorithm>
#include <cmath>

namespace ssdo {
namespace {

constexpr int kCount = SliceSectors::kCount;

/// int_0^theta cos(k t) sin t dt, and with sin(k t).
double cosine_integral(int k, double theta) {
  const auto term = [&](int n) { return n == 0 ? 0.0 : (1 - std::cos(n * theta)) / n; };
  return 0.5 * (term(k + 1) - term(k - 1));
}

double sine_integral(int k, double theta) {
  const auto term = [&](int n) { return n == 0 ? theta : std::sin(n * theta) / n; };
  return 0.5 * (term(k - 1) - term(k + 1));
}

SliceSectors make_sectors() {
  SliceSectors sectors{};
  for (int moment = 0; moment < SliceSectors::kMoments; ++moment) {
    const bool sine = moment > SliceSectors::kDegree;
    const int k = sine ? moment - SliceSectors::kDegree : moment;
    const auto up_to = [&](int i) {
      const double theta = std::acos(std::max(-1.0, 1 - double(i) / SliceSectors::kPerCosine));
      const double integral = sine ? sine_integral(k, theta) : cosine_integral(k, theta);
      return integral * double(SliceSectors::kPerCosine);
    };
    for (int i = 0; i < kCount; ++i) {
      sectors.of_first[std::size_t(moment)][std::size_t(i)] = float(up_to(i));
      const double one = up_to(i + 1) - up_to(i);
      for (int n = 0; n < 16; ++n) {
        if (n >> (i & 3) & 1)
          sectors.of_group[std::size_t(moment)][std::size_t(i / 4 * 16 + n)] += float(one);
      }
    }
  }
  return sectors;
}

}  // namespace

const SliceSectors& slice_sectors() {
  static const SliceSectors sectors = make_sectors();
  return sectors;
}

}  // namespace ssdo
