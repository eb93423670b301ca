// SPDX-License-Identifier: Apache-2.0
#include "metrics/compare_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "error.h"
#include "io/exr/exr_writer.h"
#include "io/files/run_files.h"
#include "io/images/image_file.h"

namespace ssdo {

PictureMask::PictureMask(const std::string& text) {
  if (text.empty()) return;
  const PictureName name = parse_picture_name(text);
  const LayeredPicture picture(name.file);
  if (name.layer.empty() && picture.layers().size() != 1) {
    throw Error(ExitCode::layer, fmt::format("--mask {}: has {} layers; name one: {}:LAYER", text,
                                             picture.layers().size(), name.file));
  }
  PictureLayer layer = name.layer.empty() ? picture.layers()[0] : picture.find(name.layer);
  // Without its alpha, which would make an opaque PNG hold every pixel.
  if (!picture.exr() && name.layer.empty()) layer.channels = {"R", "G", "B"};
  window_ = picture.window(layer);
  planes_ = picture.read(layer);
}

bool PictureMask::holds(int x, int y) const {
  if (planes_.empty()) return true;
  if (!window_.contains(x, y)) return false;
  return std::any_of(planes_.begin(), planes_.end(), [&](const Plane<float>& p) {
    return p(x - window_.x0, y - window_.y0) != 0;  // NaN holds too
  });
}

namespace {

Compared compare_pair(const LayeredPicture& a, const LayeredPicture& b, const LayerPair& pair,
                      const PictureMask& mask) {
  const std::size_t in_a = pair.a.channels.size(), in_b = pair.b.channels.size();
  if (in_a != in_b && in_a != 1 && in_b != 1) {
    throw Error(
        ExitCode::layer,
        fmt::format("{}:{} has {} channels and {}:{} has {}; name one channel of each, such "
                    "as {}",
                    a.file(), shown_name(pair.a), in_a, b.file(), shown_name(pair.b), in_b,
                    pair.a.channels[0]));
  }
  Compared out{pair, {a.window(pair.a), a.read(pair.a)}, {b.window(pair.b), b.read(pair.b)}, {}};
  out.difference = compare_channels(out.a, out.b, [&](int x, int y) { return mask.holds(x, y); });
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

}  // namespace

void check_diff(const CompareOptions& options) {
  if (options.diff.empty()) return;
  const std::string a = parse_picture_name(options.a).file;
  if (!has_exr_ending(options.diff)) {
    throw Error(ExitCode::usage,
                fmt::format("--diff {}: differences are written as EXR; end the name in .exr",
                            options.diff));
  }
  if (!reads_as_exr(a)) {
    throw Error(ExitCode::usage, fmt::format("--diff {}: {} is no EXR, whose header it would take",
                                             options.diff, a));
  }
  check_run_files({{{"A", a},
                    {"B", parse_picture_name(options.b).file},
                    {"--mask", parse_picture_name(options.mask).file}},
                   {{"--diff", options.diff}}});
  check_output(options.diff, options.policy);
}

Comparison compare_pictures(const CompareOptions& options, const PictureMask& mask,
                            bool keeps_channels) {
  const PictureName name_a = parse_picture_name(options.a), name_b = parse_picture_name(options.b);
  const LayeredPicture a(name_a.file), b(name_b.file);
  check_diff(options);
  const std::vector<LayerPair> pairs = pair_layers(a, b, name_a.layer, name_b.layer);
  Comparison all;
  for (const LayerPair& piece : split_by_kind(pairs)) {
    all.layers.push_back(compare_pair(a, b, piece, mask));
    if (!keeps_channels) all.layers.back().a = {}, all.layers.back().b = {};
  }
  if (name_a.layer.empty() && name_b.layer.empty()) {
    all.only_in_a = unpaired(a, pairs, &LayerPair::a);
    all.only_in_b = unpaired(b, pairs, &LayerPair::b);
    all.lacks_layers = options.fail_above && (lacks_counterpart(a, pairs, &LayerPair::a) ||
                                              lacks_counterpart(b, pairs, &LayerPair::b));
  }
  if (!options.diff.empty()) write_difference(options.diff, options.policy, a, all.layers);
  return all;
}

bool passes(const CompareOptions& options, const Comparison& all) {
  return !all.lacks_layers && std::ranges::all_of(all.layers, [&](const Compared& c) {
    return !options.fail_above || (c.difference.figures.rmse <= *options.fail_above &&
                                   c.difference.invalid_share() <= options.max_invalid);
  });
}

}  // namespace ssdo
