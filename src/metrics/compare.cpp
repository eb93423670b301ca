// SPDX-License-Identifier: Apache-2.0
#include "metrics/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "io/exr/exr_writer.h"
#include "io/files/run_files.h"
#include "io/images/image_file.h"
#include "io/json_text.h"
#include "io/one_line.h"
#include "io/pictures/picture_layers.h"
#include "metrics/difference.h"
#include "nearest_name.h"
#include "scene/layers/names.h"

namespace ssdo {
namespace {

struct Pair {
  PictureLayer a, b;
};

/// The layer with only those components that `other` has too.
PictureLayer common_components(const PictureLayer& layer, const PictureLayer& other) {
  PictureLayer common = layer;
  common.channels.clear(), common.components.clear();
  for (std::size_t c = 0; c < layer.channels.size(); ++c) {
    const auto& others = other.components;
    if (std::find(others.begin(), others.end(), layer.components[c]) == others.end()) continue;
    common.channels.push_back(layer.channels[c]);
    common.components.push_back(layer.components[c]);
  }
  return common;
}

/// The layer among `layers` that `wanted` is compared with, or none. Layers of the same name in
/// several parts belong to the parts of the same name.
const PictureLayer* counterpart(const PictureLayer& wanted,
                                const std::vector<PictureLayer>& layers) {
  const PictureLayer* best = nullptr;
  int best_rank = 0;
  for (const PictureLayer& layer : layers) {
    if (layer.name != wanted.name || common_components(layer, wanted).channels.empty()) continue;
    const int rank =
        1 + (layer.part_name == wanted.part_name) + 2 * (layer.components == wanted.components);
    if (rank <= best_rank) continue;
    best = &layer;
    best_rank = rank;
  }
  return best;
}

/// The channels that are measured together: colours, or a coordinate; an alpha, a depth and all
/// else alone. `layer` has one of them.
std::vector<std::size_t> channels_beside(const PictureLayer& layer, std::size_t channel) {
  const auto kind = [&](std::size_t c) {
    const std::string name = lower(layer.components[c]);
    for (const char* color : {"r", "g", "b", "red", "green", "blue"})
      if (name == color) return std::string("color");
    return name == "x" || name == "y" || name == "z" ? std::string("coordinate") : "alone " + name;
  };
  const auto has = [&](std::string_view component) {
    return std::ranges::any_of(layer.components,
                               [&](const std::string& own) { return lower(own) == component; });
  };
  const bool alone = kind(channel) == "coordinate" && !(has("x") && has("y"));
  std::vector<std::size_t> beside;
  for (std::size_t c = 0; c < layer.channels.size(); ++c)
    if (c == channel || (!alone && kind(c) == kind(channel))) beside.push_back(c);
  return beside;
}

/// Some channels of a layer; called after the channel where it is one of several.
PictureLayer piece_of(const PictureLayer& layer, const std::vector<std::size_t>& channels) {
  PictureLayer piece = layer;
  piece.channels.clear(), piece.components.clear();
  for (const std::size_t c : channels) {
    piece.channels.push_back(layer.channels[c]);
    piece.components.push_back(layer.components[c]);
  }
  if (channels.size() == 1 && layer.channels.size() > 1) {
    const std::string& of = layer.name.empty() ? layer.part_name : layer.name;
    piece.name = (of.empty() ? "" : of + ".") + piece.components[0];
  }
  return piece;
}

/// A pair by what its channels are, where both layers have the same.
std::vector<Pair> split_by_kind(const Pair& pair) {
  if (pair.a.components != pair.b.components) return {pair};
  std::vector<Pair> pieces;
  for (std::size_t c = 0; c < pair.a.channels.size(); ++c) {
    const std::vector<std::size_t> beside = channels_beside(pair.a, c);
    if (beside[0] == c) pieces.push_back({piece_of(pair.a, beside), piece_of(pair.b, beside)});
  }
  return pieces;
}

/// The layers that are named, or all that both pictures have.
std::vector<Pair> pair_layers(const LayeredPicture& a, const LayeredPicture& b,
                              const std::string& layer_a, const std::string& layer_b) {
  if (!layer_a.empty() || !layer_b.empty())
    return {
        {a.find(layer_a.empty() ? layer_b : layer_a), b.find(layer_b.empty() ? layer_a : layer_b)}};
  std::vector<Pair> pairs;
  for (const PictureLayer& layer : a.layers()) {
    if (const PictureLayer* match = counterpart(layer, b.layers()))
      pairs.push_back({common_components(layer, *match), common_components(*match, layer)});
  }
  if (!pairs.empty()) return pairs;
  throw Error(ExitCode::layer,
              fmt::format("{} and {} have no layer in common; pair two by name: {}:LAYER {}:LAYER",
                          a.file(), b.file(), a.file(), b.file()));
}

/// The channels that no pair compares, of the picture whose layer of a pair is `side`.
std::vector<std::string> unpaired(const LayeredPicture& picture, const std::vector<Pair>& pairs,
                                  PictureLayer Pair::*side) {
  std::set<std::pair<int, std::string>> paired;
  for (const Pair& pair : pairs)
    for (const std::string& channel : (pair.*side).channels)
      paired.insert({(pair.*side).part, channel});
  std::vector<std::string> names;
  for (const PictureLayer& layer : picture.layers()) {
    for (const std::string& channel : layer.channels) {
      if (!paired.contains({layer.part, channel}))
        names.push_back(layer.part_name.empty() ? channel : layer.part_name + "." + channel);
    }
  }
  return names;
}

/// Whether the picture has colours, vectors or values that no pair compares. Not an alpha alone,
/// which one kind of picture has and another has not.
bool lacks_counterpart(const LayeredPicture& picture, const std::vector<Pair>& pairs,
                       PictureLayer Pair::*side) {
  for (const std::string& channel : unpaired(picture, pairs, side)) {
    const std::string component = lower(channel.substr(channel.rfind('.') + 1));
    if (component != "a" && component != "alpha") return true;
  }
  return false;
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
  PictureLayer layer = name.layer.empty() ? picture.layers()[0] : picture.find(name.layer);
  // An opaque PNG is no mask of everything.
  if (!picture.exr() && name.layer.empty()) layer.channels = {"R", "G", "B"};
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
  write_exr(file, {output});
  file.commit();
}

/// All that the report tells.
struct Comparison {
  std::vector<Compared> layers;
  std::vector<std::string> only_in_a, only_in_b;  ///< channels without a counterpart
  bool lacks_layers = false;                      ///< which fails the gate
};

nlohmann::json to_json(const CompareOptions& options, const Comparison& all) {
  nlohmann::json layers = nlohmann::json::array();
  // JSON knows no infinity: nothing to be relative to, or no error at all.
  const auto number = [](double v) {
    return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(nullptr);
  };
  for (const Compared& c : all.layers) {
    const Difference& d = c.difference.figures;
    const LeftOut& left_out = c.difference.left_out;
    layers.push_back({{"a", shown_name(c.pair.a)},
                      {"b", shown_name(c.pair.b)},
                      {"pixels", c.difference.pixels},
                      {"left_out", left_out.all()},
                      {"not_finite_in_both", left_out.in_both},
                      {"not_finite_in_one", left_out.in_one},
                      {"outside_one", left_out.outside},
                      {"channels", c.difference.a_minus_b.size()},
                      {"rmse", number(d.rmse)},
                      {"relative_rmse", number(d.relative_rmse())},
                      {"bias", number(d.bias)},
                      {"max", number(d.largest)},
                      {"p99", number(d.p99)},
                      {"psnr", number(d.psnr())}});
  }
  return {{"a", options.a},
          {"b", options.b},
          {"layers", layers},
          {"only_in_a", all.only_in_a},
          {"only_in_b", all.only_in_b},
          {"lacks_layers", all.lacks_layers}};
}

/// "only in B: a, b, c and 7 more", or nothing.
std::string list_channels(std::string_view where, const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;
  if (names.empty()) return "";
  return printable(fmt::format("only in {}: {}", where, some_of(names, kMost))) + "\n";
}

std::string to_table(const Comparison& all) {
  std::string text =
      fmt::format("{:<32} {:>9} {:>9} {:>11} {:>10} {:>11} {:>11} {:>11} {:>8}\n", "layer",
                  "pixels", "left out", "RMSE", "relative", "bias", "max", "99 %", "PSNR");
  std::string notes;
  for (const Compared& c : all.layers) {
    const Difference& d = c.difference.figures;
    const LeftOut& left_out = c.difference.left_out;
    const std::string a = printable(shown_name(c.pair.a)), b = printable(shown_name(c.pair.b));
    const std::string name = a == b ? a : fmt::format("{} - {}", a, b);
    text += fmt::format(
        "{:<32} {:>9} {:>9} {:>11.6g} {:>10.4g} {:>+11.4g} {:>11.6g} {:>11.6g} {:>8.2f}\n", name,
        c.difference.pixels, left_out.all(), d.rmse, d.relative_rmse(), d.bias, d.largest, d.p99,
        d.psnr());
    if (left_out.without_counterpart() == 0) continue;
    notes += fmt::format(
        "{}: {} pixels have no counterpart ({} are not finite in one picture, {} "
        "outside the window of one)\n",
        name, left_out.without_counterpart(), left_out.in_one, left_out.outside);
  }
  if (all.lacks_layers)
    notes += "fails: a layer is in one file only; name the layers to compare, FILE:LAYER\n";
  return text + notes + list_channels("A", all.only_in_a) + list_channels("B", all.only_in_b);
}

/// Whether a gate lets the pair pass.
bool passes(const CompareOptions& options, const ChannelsDifference& difference) {
  return !options.fail_above || (difference.figures.rmse <= *options.fail_above &&
                                 difference.invalid_share() <= options.max_invalid);
}

void check_diff(const CompareOptions& options, const LayeredPicture& a, const LayeredPicture& b) {
  if (options.diff.empty()) return;
  if (!has_exr_ending(options.diff)) {
    throw Error(ExitCode::usage,
                fmt::format("--diff {}: differences are written as EXR; end the name in .exr",
                            options.diff));
  }
  if (!a.exr()) {
    throw Error(ExitCode::usage, fmt::format("--diff {}: {} is no EXR, whose header it would take",
                                             options.diff, a.file()));
  }
  check_run_files(
      {{{"A", a.file()}, {"B", b.file()}, {"--mask", parse_picture_name(options.mask).file}},
       {{"--diff", options.diff}}});
  check_output(options.diff, options.policy);
}

}  // namespace

CompareReport compare(const CompareOptions& options) {
  const PictureName name_a = parse_picture_name(options.a), name_b = parse_picture_name(options.b);
  const LayeredPicture a(name_a.file), b(name_b.file);
  check_diff(options, a, b);
  const Mask mask = read_mask(options.mask);
  const std::vector<Pair> pairs = pair_layers(a, b, name_a.layer, name_b.layer);
  Comparison all;
  for (const Pair& pair : pairs)
    for (const Pair& piece : split_by_kind(pair))
      all.layers.push_back(compare_pair(a, b, piece, mask));
  CompareReport report;
  if (name_a.layer.empty() && name_b.layer.empty()) {
    all.only_in_a = unpaired(a, pairs, &Pair::a);
    all.only_in_b = unpaired(b, pairs, &Pair::b);
    all.lacks_layers = options.fail_above && (lacks_counterpart(a, pairs, &Pair::a) ||
                                              lacks_counterpart(b, pairs, &Pair::b));
    if (all.lacks_layers) report.code = ExitCode::failed;
  }
  if (!options.diff.empty()) write_difference(options.diff, options.policy, a, all.layers);
  report.text = options.json ? json_text(to_json(options, all), 2) + "\n" : to_table(all);
  for (const Compared& c : all.layers) {
    if (!passes(options, c.difference)) report.code = ExitCode::failed;
  }
  return report;
}

}  // namespace ssdo
