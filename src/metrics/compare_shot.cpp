// SPDX-License-Identifier: Apache-2.0
#include "metrics/compare_shot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "io/sequence.h"

namespace ssdo {
namespace {

/// `text`, FILE or FILE:LAYER, with the frame's number in FILE.
std::string at_frame(const std::string& text, int frame) {
  if (text.empty()) return "";
  const PictureName name = parse_picture_name(text);
  const std::string file = expand_pattern(name.file, frame);
  return name.layer.empty() ? file : file + ":" + name.layer;
}

CompareOptions options_at(const CompareOptions& options, int frame) {
  CompareOptions at = options;
  at.a = at_frame(options.a, frame);
  at.b = at_frame(options.b, frame);
  at.mask = at_frame(options.mask, frame);
  if (!options.diff.empty()) at.diff = expand_pattern(options.diff, frame);
  return at;
}

/// The frames that are named, or those that at least one of the sequences has.
std::vector<int> frames_of(const CompareOptions& options) {
  if (options.frames) return *options.frames;
  std::set<int> all;
  for (const std::string& picture : {options.a, options.b}) {
    if (picture.empty()) continue;
    for (const int frame : find_frames(parse_picture_name(picture).file)) all.insert(frame);
  }
  if (all.empty())
    throw Error(ExitCode::input, fmt::format("{}: no frame of this sequence exists",
                                             parse_picture_name(options.a).file));
  return {all.begin(), all.end()};
}

void check_exists(const std::string& picture) {
  if (picture.empty()) return;
  const std::string file = parse_picture_name(picture).file;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored))
    throw Error(ExitCode::input, fmt::format("{}: this frame does not exist", file));
}

std::string size_of(const Window& w) { return fmt::format("{} x {}", w.width(), w.height()); }

/// The layers of a frame as they are needed for the next one.
struct FrameChannels {
  std::map<std::string, Channels> a, a_minus_b;  ///< by the layer's name
};

class Shot {
 public:
  explicit Shot(const CompareOptions& options) : options_(options) {
    shot_.has_b = !options.b.empty();
    shot_.has_points = !options.points.empty();
  }

  ShotComparison run() {
    for (const int frame : frames_of(options_)) {
      shot_.frames.emplace_back().number = frame;
      measure(shot_.frames.back());
    }
    note_missing_layers();
    return std::move(shot_);
  }

 private:
  void measure(ShotFrame& frame) {
    const FrameChannels before = std::exchange(before_, {});
    try {
      const CompareOptions at = options_at(options_, frame.number);
      check_exists(at.a);
      check_exists(at.b);
      const Window display = note_size(at, frame);
      const PictureMask mask(at.mask);
      FrameChannels now = compare(at, mask, frame);
      if (shot_.has_points) measure_flicker(before, now, display, mask, frame);
      before_ = std::move(now);
    } catch (const Error& error) {
      frame.error = error;
    }
  }

  /// The display window of the frame. Errors: ExitCode::layer where B has another one.
  Window note_size(const CompareOptions& at, ShotFrame& frame) {
    const auto display_of = [](const std::string& picture) {
      const LayeredPicture opened(parse_picture_name(picture).file);
      return opened.display(opened.layers().front());
    };
    const Window display = display_of(at.a);
    if (!at.b.empty()) {
      const Window other = display_of(at.b);
      if (!(other == display))
        throw Error(ExitCode::layer,
                    fmt::format("{} is {}, and {} is {}; they have to show the same", at.a,
                                size_of(display), at.b, size_of(other)));
    }
    if (display_ && !(display == *display_))
      frame.notes.push_back(fmt::format("{}: is {}, and the frame before is {}", at.a,
                                        size_of(display), size_of(*display_)));
    display_ = display;
    return display;
  }

  /// Compares with B, or reads A alone.
  FrameChannels compare(const CompareOptions& at, const PictureMask& mask, ShotFrame& frame) {
    FrameChannels now;
    if (!shot_.has_b) {
      const PictureName name = parse_picture_name(at.a);
      const LayeredPicture a(name.file);
      for (const LayerPair& piece : split_by_kind(layers_alone(a, name.layer))) {
        add_layer(piece.name(), frame);
        now.a[piece.name()] = {a.window(piece.a), a.read(piece.a)};
      }
      return now;
    }
    frame.compared = compare_pictures(at, mask, shot_.has_points);
    for (Compared& c : frame.compared.layers) {
      const std::string name = c.pair.name();
      add_layer(name, frame);
      add_error(c.difference.figures, frame.number, shot_.errors[name]);
      if (shot_.has_points) now.a_minus_b[name] = subtract(c.a, c.b);
      now.a[name] = std::exchange(c.a, {});
      c.b = {};
      for (Plane<float>& plane : c.difference.a_minus_b) plane = {};
    }
    return now;
  }

  void add_layer(const std::string& name, ShotFrame& frame) {
    frame.layers.push_back(name);
    if (std::ranges::find(shot_.layers, name) == shot_.layers.end()) shot_.layers.push_back(name);
  }

  static void add_error(const Difference& frame, int number, ShotError& all) {
    all.figures.add(frame);
    if (frame.rmse <= all.worst) return;
    all.worst = frame.rmse;
    all.worst_frame = number;
  }

  void measure_flicker(const FrameChannels& before, const FrameChannels& now, const Window& display,
                       const PictureMask& mask, ShotFrame& frame) {
    CameraOptions camera;
    camera.file = options_.camera;
    FrameFiles files;
    files.input = expand_pattern(options_.points, frame.number);
    const auto shared = points_.next(
        frame.number, read_points(files, {}, camera), display,
        [&](int x, int y) { return mask.holds(x, y); }, frame.notes);
    if (!shared) return;
    for (const auto& [name, channels] : now.a) {
      const std::optional<FlickerFigures> of_a =
          add_flicker(*shared, before.a, now.a, name, shot_.flicker[name].a);
      if (!of_a) continue;
      frame.flicker[name] = {*of_a, add_flicker(*shared, before.a_minus_b, now.a_minus_b, name,
                                                shot_.flicker[name].a_minus_b)};
    }
  }

  /// Adds the change of a layer to that of the shot, where both frames have the layer.
  static std::optional<FlickerFigures> add_flicker(const SharedPoints& shared,
                                                   const std::map<std::string, Channels>& before,
                                                   const std::map<std::string, Channels>& now,
                                                   const std::string& layer, Flicker& sum) {
    const auto earlier = before.find(layer), present = now.find(layer);
    if (earlier == before.end() || present == now.end() ||
        earlier->second.planes.size() != present->second.planes.size())
      return std::nullopt;
    const Flicker flicker = ssdo::measure_flicker(shared, earlier->second, present->second);
    sum.add(flicker);
    return flicker.figures();
  }

  /// A layer that some frames have has to be in all.
  void note_missing_layers() {
    for (ShotFrame& frame : shot_.frames) {
      if (frame.error) continue;
      for (const std::string& name : shot_.layers) {
        if (std::ranges::find(frame.layers, name) != frame.layers.end()) continue;
        const CompareOptions at = options_at(options_, frame.number);
        frame.notes.push_back(fmt::format("{}: has no {}, as other frames have",
                                          at.b.empty() ? at.a : at.a + " or " + at.b, name));
        frame.misses_layer = true;
      }
    }
  }

  const CompareOptions& options_;
  ShotPoints points_;
  std::optional<Window> display_;
  FrameChannels before_;
  ShotComparison shot_;
};

}  // namespace

ShotComparison compare_shot(const CompareOptions& options) { return Shot(options).run(); }

ExitCode exit_code_of(const CompareOptions& options, const ShotComparison& shot) {
  for (const ShotFrame& frame : shot.frames) {
    if (frame.error) return frame.error->code;
    if (frame.misses_layer) return ExitCode::layer;
    if (!passes(options, frame.compared)) return ExitCode::failed;
  }
  return ExitCode::done;
}

}  // namespace ssdo
