// SPDX-License-Identifier: Apache-2.0
#include "metrics/difference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ssdo {
namespace {

template <class Visit>
void for_each_pixel(const Window& w, const Visit& visit) {
  for (int y = w.y0; y < w.y1; ++y) {
    for (int x = w.x0; x < w.x1; ++x) visit(x, y);
  }
}

}  // namespace

double Difference::relative_rmse() const { return rmse / std::abs(mean_b); }
double Difference::psnr() const { return 20 * std::log10(peak / rmse); }

void Difference::add(const Difference& more) {
  if (more.count == 0) return;
  const double own = double(count), all = own + double(more.count);
  const auto mean = [&](double a, double b) { return (a * own + b * double(more.count)) / all; };
  rmse = std::sqrt(mean(rmse * rmse, more.rmse * more.rmse));
  bias = mean(bias, more.bias);
  mean_b = mean(mean_b, more.mean_b);
  largest = std::max(largest, more.largest);
  peak = std::max(peak, more.peak);
  p99 = std::numeric_limits<double>::quiet_NaN();
  count += more.count;
}

double ChannelsDifference::invalid_share() const {
  const auto missing = double(left_out.without_counterpart());
  return missing > 0 ? missing / (missing + double(pixels)) : 0;
}

Difference measure_difference(const std::vector<float>& a, const std::vector<float>& b) {
  Difference d;
  d.count = a.size();
  if (a.empty()) return d;
  std::vector<double> sizes(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = double(a[i]) - double(b[i]);
    d.rmse += difference * difference;
    d.bias += difference;
    d.mean_b += b[i];
    d.peak = std::max({d.peak, std::abs(double(a[i])), std::abs(double(b[i]))});
    sizes[i] = std::abs(difference);
  }
  const auto count = double(a.size());
  d.rmse = std::sqrt(d.rmse / count);
  d.bias /= count;
  d.mean_b /= count;
  d.largest = *std::max_element(sizes.begin(), sizes.end());
  const auto at = sizes.begin() + std::ptrdiff_t(std::ceil(0.99 * count)) - 1;
  std::nth_element(sizes.begin(), at, sizes.end());
  d.p99 = *at;
  return d;
}

ChannelsDifference compare_channels(const Channels& a, const Channels& b,
                                    const std::function<bool(int x, int y)>& counts) {
  const std::size_t channels = std::max(a.planes.size(), b.planes.size());
  ChannelsDifference out;
  out.a_minus_b.assign(channels, Plane<float>(a.window.width(), a.window.height()));
  std::vector<float> values_a, values_b;
  const auto compare_pixel = [&](int x, int y) {
    bool finite_a = true, finite_b = true;
    for (std::size_t c = 0; c < channels; ++c) {
      finite_a = finite_a && std::isfinite(a.at(c, x, y));
      finite_b = finite_b && std::isfinite(b.at(c, x, y));
    }
    if (!finite_a || !finite_b) {
      ++(finite_a || finite_b ? out.left_out.in_one : out.left_out.in_both);
      return;
    }
    ++out.pixels;
    for (std::size_t c = 0; c < channels; ++c) {
      values_a.push_back(a.at(c, x, y));
      values_b.push_back(b.at(c, x, y));
      out.a_minus_b[c](x - a.window.x0, y - a.window.y0) = a.at(c, x, y) - b.at(c, x, y);
    }
  };
  for_each_pixel(a.window, [&](int x, int y) {
    if (!counts(x, y)) return;
    if (b.window.contains(x, y))
      compare_pixel(x, y);
    else
      ++out.left_out.outside;
  });
  for_each_pixel(b.window, [&](int x, int y) {
    out.left_out.outside += !a.window.contains(x, y) && counts(x, y);
  });
  out.figures = measure_difference(values_a, values_b);
  return out;
}

}  // namespace ssdo
