// SPDX-License-Identifier: Apache-2.0
#include "compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/exr_writer.h"
#include "io/json_text.h"
#include "io/picture_layers.h"
#include "io/run_files.h"

namespace ssdo {
namespace {

struct Pair {
  PictureLayer a, b;
};

/// The layers that are named, or all that both pictures have.
std::vector<Pair> pair_layers(const LayeredPicture& a, const LayeredPicture& b,
                              const std::string& layer_a, const std::string& layer_b) {
  if (!layer_a.empty() || !layer_b.empty())
    return {
        {a.find(layer_a.empty() ? layer_b : layer_a), b.find(layer_b.empty() ? layer_a : layer_b)}};
  std::vector<Pair> pairs;
  for (const PictureLayer& l : a.layers()) {
    const auto same = [&](const PictureLayer& m) {
      return m.name == l.name && m.components == l.components;
    };
    const auto& others = b.layers();
    // Layers of the same name in several parts belong to the parts of the same name.
    auto match = std::find_if(others.begin(), others.end(), [&](const PictureLayer& m) {
      return same(m) && m.part_name == l.part_name;
    });
    if (match == others.end()) match = std::find_if(others.begin(), others.end(), same);
    if (match != others.end()) pairs.push_back({l, *match});
  }
  if (!pairs.empty()) return pairs;
  throw Error(ExitCode::layer,
              fmt::format("{} and {} have no layer in common; pair two by name: {}:LAYER {}:LAYER",
                          a.file(), b.file(), a.file(), b.file()));
}

/// Pixels that count, over a window of their own.
struct Mask {
  Window window;
  std::vector<Plane<float>> planes;

  bool holds(int x, int y) const {
    if (planes.empty()) return true;
    if (!window.contains(x, y)) return false;
    return std::any_of(planes.begin(), planes.end(), [&](const Plane<float>& p) {
      return p(x - window.x0, y - window.y0) != 0;  // and not a number counts
    });
  }
};

Mask read_mask(const std::string& text) {
  if (text.empty()) return {};
  const PictureName name = parse_picture_name(text);
  const LayeredPicture picture(name.file);
  if (name.layer.empty() && picture.layers().size() != 1) {
    throw Error(ExitCode::layer, fmt::format("--mask {}: has {} layers; name one: {}:LAYER", text,
                                             picture.layers().size(), name.file));
  }
  const PictureLayer layer = name.layer.empty() ? picture.layers()[0] : picture.find(name.layer);
  return {picture.window(layer), picture.read(layer)};
}

/// A pair with its figures.
struct Compared {
  Pair pair;
  ChannelsDifference difference;
};

Compared compare_pair(const LayeredPicture& a, const LayeredPicture& b, const Pair& pair,
                      const Mask& mask) {
  const std::size_t in_a = pair.a.channels.size(), in_b = pair.b.channels.size();
  if (in_a != in_b && in_a != 1 && in_b != 1) {
    throw Error(
        ExitCode::layer,
        fmt::format("{}:{} has {} channels and {}:{} has {}; name one channel of each, such "
                    "as {}",
                    a.file(), shown_name(pair.a), in_a, b.file(), shown_name(pair.b), in_b,
                    pair.a.channels[0]));
  }
  Compared out{
      pair, compare_channels({a.window(pair.a), a.read(pair.a)}, {b.window(pair.b), b.read(pair.b)},
                             [&](int x, int y) { return mask.holds(x, y); })};
  if (out.difference.pixels == 0) {
    throw Error(ExitCode::failed,
                fmt::format("{}:{} and {}:{}: no pixel is valid in both", a.file(),
                            shown_name(pair.a), b.file(), shown_name(pair.b)));
  }
  return out;
}

void write_difference(const std::string& path, const OutputPolicy& policy, const LayeredPicture& a,
                      const std::vector<Compared>& all) {
  ExrOutput output;
  output.input = &*a.exr();
  output.part = all[0].pair.a.part;
  for (const Compared& c : all) {
    if (c.pair.a.part != output.part) {
      throw Error(ExitCode::usage,
                  fmt::format("--diff {}: the layers stand in several parts of {}; name one: "
                              "{}:LAYER",
                              path, a.file(), a.file()));
    }
    const auto& planes = c.difference.a_minus_b;
    const auto& names =
        c.pair.a.channels.size() >= planes.size() ? c.pair.a.channels : c.pair.b.channels;
    for (std::size_t k = 0; k < planes.size(); ++k)
      output.planes.push_back({names[k], Imf::FLOAT, &planes[k]});
  }
  SafeFile file(path, policy);
  write_exr(file, output);
  file.commit();
}

nlohmann::json to_json(const CompareOptions& options, const std::vector<Compared>& all) {
  nlohmann::json layers = nlohmann::json::array();
  // JSON knows no infinity: nothing to be relative to, or no error at all.
  const auto number = [](double v) {
    return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(nullptr);
  };
  for (const Compared& c : all) {
    const Difference& d = c.difference.figures;
    layers.push_back({{"a", shown_name(c.pair.a)},
                      {"b", shown_name(c.pair.b)},
                      {"pixels", c.difference.pixels},
                      {"channels", c.difference.a_minus_b.size()},
                      {"rmse", number(d.rmse)},
                      {"relative_rmse", number(d.relative_rmse())},
                      {"bias", number(d.bias)},
                      {"max", number(d.largest)},
                      {"p99", number(d.p99)},
                      {"psnr", number(d.psnr())}});
  }
  return {{"a", options.a}, {"b", options.b}, {"layers", layers}};
}

std::string to_table(const std::vector<Compared>& all) {
  std::string text = fmt::format("{:<32} {:>9} {:>11} {:>10} {:>11} {:>11} {:>11} {:>8}\n", "layer",
                                 "pixels", "RMSE", "relative", "bias", "max", "99 %", "PSNR");
  for (const Compared& c : all) {
    const Difference& d = c.difference.figures;
    const std::string a = shown_name(c.pair.a), b = shown_name(c.pair.b);
    text +=
        fmt::format("{:<32} {:>9} {:>11.6g} {:>10.4g} {:>+11.4g} {:>11.6g} {:>11.6g} {:>8.2f}\n",
                    a == b ? a : a + " - " + b, c.difference.pixels, d.rmse, d.relative_rmse(),
                    d.bias, d.largest, d.p99, d.psnr());
  }
  return text;
}

}  // namespace

double Difference::relative_rmse() const { return rmse / std::abs(mean_b); }
double Difference::psnr() const { return 20 * std::log10(peak / rmse); }

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
  const std::size_t in_a = a.planes.size(), in_b = b.planes.size();
  const std::size_t channels = std::max(in_a, in_b);
  const Window &wa = a.window, &wb = b.window;
  ChannelsDifference out;
  out.a_minus_b.assign(channels, Plane<float>(wa.width(), wa.height()));
  std::vector<float> values_a, values_b;
  for (int y = std::max(wa.y0, wb.y0); y < std::min(wa.y1, wb.y1); ++y) {
    for (int x = std::max(wa.x0, wb.x0); x < std::min(wa.x1, wb.x1); ++x) {
      const auto at_a = [&](std::size_t c) {
        return a.planes[in_a == 1 ? 0 : c](x - wa.x0, y - wa.y0);
      };
      const auto at_b = [&](std::size_t c) {
        return b.planes[in_b == 1 ? 0 : c](x - wb.x0, y - wb.y0);
      };
      bool valid = counts(x, y);
      for (std::size_t c = 0; valid && c < channels; ++c)
        valid = std::isfinite(at_a(c)) && std::isfinite(at_b(c));
      if (!valid) continue;
      ++out.pixels;
      for (std::size_t c = 0; c < channels; ++c) {
        values_a.push_back(at_a(c));
        values_b.push_back(at_b(c));
        out.a_minus_b[c](x - wa.x0, y - wa.y0) = at_a(c) - at_b(c);
      }
    }
  }
  out.figures = measure_difference(values_a, values_b);
  return out;
}

CompareReport compare(const CompareOptions& options) {
  const PictureName name_a = parse_picture_name(options.a), name_b = parse_picture_name(options.b);
  const LayeredPicture a(name_a.file), b(name_b.file);
  if (!options.diff.empty()) {
    if (!a.exr()) {
      throw Error(ExitCode::usage,
                  fmt::format("--diff {}: {} is no EXR, whose header it would take", options.diff,
                              a.file()));
    }
    check_run_files({{{"A", name_a.file},
                      {"B", name_b.file},
                      {"--mask", parse_picture_name(options.mask).file}},
                     {{"--diff", options.diff}}});
    check_output(options.diff, options.policy);
  }
  const Mask mask = read_mask(options.mask);
  std::vector<Compared> all;
  for (const Pair& pair : pair_layers(a, b, name_a.layer, name_b.layer))
    all.push_back(compare_pair(a, b, pair, mask));
  if (!options.diff.empty()) write_difference(options.diff, options.policy, a, all);
  CompareReport report;
  report.text = options.json ? json_text(to_json(options, all), 2) + "\n" : to_table(all);
  for (const Compared& c : all) {
    if (options.fail_above && !(c.difference.figures.rmse <= *options.fail_above))
      report.code = ExitCode::failed;
  }
  return report;
}

}  // namespace ssdo
