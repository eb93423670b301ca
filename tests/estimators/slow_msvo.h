// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "scene/geometry.h"

namespace ssdo::test {

/// Multi-scale volumetric obscurance in double, pixel by pixel of each scale, in the source's
/// order: samples in groups of equal distance, weights normalised at the end, background at 10^5
/// far planes.
class SlowMsvo {
 public:
  double intensity = 1, thickness = 1, far = 1000;
  double noise = 0, blur = -4.6, tolerance = -12;  ///< log10

  explicit SlowMsvo(const Geometry& g)
      : g_(g), x0_(g.window.x0 - g.display.x0), y0_(g.window.y0 - g.display.y0) {}

  Plane<double> ao() {
    Scale coarse = obscured(4);
    for (int k = 3; k >= 0; --k) {
      Scale fine = k > 0 ? obscured(k) : scale_of(0);
      upsample(coarse, k + 1, fine);
      coarse = std::move(fine);
    }
    for (std::size_t i = 0; i < coarse.open.size(); ++i)
      if (!g_.is_surface(i)) coarse.open[i] = 1;
    return coarse.open;
  }

 private:
  /// Depths over the far plane.
  struct Scale {
    int x0, y0;  ///< first pixel, counted from the display window's corner
    Plane<double> depth, open;

    static double at(const Plane<double>& plane, int x, int y) {
      return plane(std::clamp(x, 0, plane.width - 1), std::clamp(y, 0, plane.height - 1));
    }
  };

  static int down(int i, int k) { return int(std::floor(std::ldexp(i, -k))); }

  Scale scale_of(int k) const {
    const int w = g_.window.width(), h = g_.window.height();
    Scale s{down(x0_, k), down(y0_, k), {}, {}};
    s.depth = s.open =
        Plane<double>(down(x0_ + w - 1, k) - s.x0 + 1, down(y0_ + h - 1, k) - s.y0 + 1, 1.0);
    for (int y = 0; y < s.depth.height; ++y) {
      for (int x = 0; x < s.depth.width; ++x) {
        const Surfel& surfel =
            g_.surfaces(std::max(((s.x0 + x) << k) - x0_, 0), std::max(((s.y0 + y) << k) - y0_, 0));
        s.depth(x, y) = surfel.is_surface() ? -double(surfel.position.z) / far : 1e5;
      }
    }
    return s;
  }

  static double clamp01(double x) { return std::clamp(x, 0.0, 1.0); }

  Scale obscured(int k) const {
    Scale s = scale_of(k);
    const double diameter = 10 * 4 * (1 << k) / g_.camera.fx;
    for (int y = 0; y < s.depth.height; ++y) {
      for (int x = 0; x < s.depth.width; ++x) {
        const double centre = s.depth(x, y),
                     sphere = g_.camera.orthographic ? diameter / far : diameter * centre;
        const auto pair = [&](int dx, int dy, double chord) {
          const auto gap = [&](int sign) {
            const double z = Scale::at(s.depth, x + sign * 4 * dx, y + sign * 4 * dy);
            return (z - centre) / (sphere * chord) + 0.5;
          };
          const double d1 = gap(1), d2 = gap(-1), q1 = clamp01(-d1 / thickness),
                       q2 = clamp01(-d2 / thickness);
          return clamp01(std::clamp(d1, q2, 1.0) + std::clamp(d2, q1, 1.0) - q1 * q2);
        };
        double sum = 0, weights = 0;
        for (const auto& [i, j] :
             {std::pair(2, 0), {4, 0}, {1, 1}, {2, 2}, {3, 3}, {3, 1}, {4, 2}}) {
          const double chord = std::sqrt(1 - (i * i + j * j) / 25.0);
          const int count = j == 0 || i == j ? 4 : 8;
          double mean;
          if (j == 0) {
            mean = (pair(i, 0, chord) + pair(0, i, chord)) / 2;
          } else if (i == j) {
            mean = (pair(i, i, chord) + pair(-i, i, chord)) / 2;
          } else {
            mean =
                (pair(i, j, chord) + pair(-i, j, chord) + pair(j, i, chord) + pair(-j, i, chord)) /
                4;
          }
          sum += count * chord * mean;
          weights += count * chord;
        }
        s.open(x, y) = clamp01(1 + intensity * (sum / weights - 1));
        if (centre >= 1e5) s.open(x, y) = 1;
      }
    }
    return s;
  }

  /// The middle one of five values, blurred where three depths lie in line.
  static double blurred(const double (&v)[5], const double (&z)[5], double step, double limit) {
    const auto in_line = [&](int i) {
      const double d1 = 1 / z[i + 1] - 1 / z[i], d2 = 1 / z[i + 2] - 1 / z[i + 1];
      return std::pow(d1 * d2 + step, 2) > (d1 * d1 + step) * (d2 * d2 + step) * limit;
    };
    const double c = v[2], b = in_line(0) || in_line(1) ? v[1] : c, a = in_line(0) ? v[0] : b,
                 d = in_line(2) || in_line(1) ? v[3] : c, e = in_line(2) ? v[4] : d;
    return ((a + e) / 2 + b + c + d) / 4;
  }

  void upsample(const Scale& coarse, int k, Scale& fine) const {
    const double step = 1920.0 / ((g_.display.width() + (1 << k) - 1) / (1 << k)),
                 limit = std::pow(1 - std::pow(10, blur) * step, 2), near = std::pow(10, tolerance),
                 open = 1 / (std::pow(10, noise) + near);
    std::map<std::pair<int, int>, double> known;
    const auto row_blurred = [&](int x, int y) {
      double v[5], z[5];
      for (int i = 0; i < 5; ++i) {
        v[i] = Scale::at(coarse.open, x + i - 2, y);
        z[i] = Scale::at(coarse.depth, x + i - 2, y);
      }
      return blurred(v, z, step, limit);
    };
    const auto both_blurred = [&](int x, int y) {
      const auto [it, added] = known.try_emplace({x, y});
      if (!added) return it->second;
      double v[5], z[5];
      for (int i = 0; i < 5; ++i) {
        v[i] = row_blurred(x, y + i - 2);
        z[i] = Scale::at(coarse.depth, x, y + i - 2);
      }
      return it->second = blurred(v, z, step, limit);
    };
    for (int y = 0; y < fine.depth.height; ++y) {
      for (int x = 0; x < fine.depth.width; ++x) {
        const int cx = down(fine.x0 + x, 1) - coarse.x0, cy = down(fine.y0 + y, 1) - coarse.y0,
                  sx = (fine.x0 + x) % 2 != 0 ? 1 : -1, sy = (fine.y0 + y) % 2 != 0 ? 1 : -1;
        double sum = open, weights = open;
        for (const bool across : {false, true}) {
          for (const bool along : {false, true}) {
            const int qx = cx + (across ? sx : 0), qy = cy + (along ? sy : 0);
            const double w = (across ? 1 : 3) * (along ? 1 : 3) /
                             (std::abs(fine.depth(x, y) - Scale::at(coarse.depth, qx, qy)) + near);
            sum += w * both_blurred(qx, qy), weights += w;
          }
        }
        fine.open(x, y) = clamp01(fine.open(x, y) * sum / weights);
        if (fine.depth(x, y) >= 1e5) fine.open(x, y) = 1;
      }
    }
  }

  const Geometry& g_;
  int x0_, y0_;
};

}  // namespace ssdo::test
