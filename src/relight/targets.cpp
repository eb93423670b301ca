// SPDX-License-Identifier: Apache-2.0
#include "relight/targets.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "color/display_image.h"
#include "color/kept_pixels.h"
#include "io/images/image_file.h"
#include "io/json_text.h"
#include "io/size_guard.h"
#include "parallel/tiles.h"
#include "scene/gbuffer/read_gbuffer.h"
#include "scene/layers/groups.h"
#include "scene/layers/windows.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

const std::string& product_of_picture(const Target& target, const Plan& plan) {
  return target.product ? *target.product : plan.show;
}

/// `opened` are the view's products with kept pixels open.
Results results_of(const ViewOutput& view, const std::optional<Products>& opened) {
  return {view.scene, view.job.frame.gbuffer, view.products, view.plan.composition,
          opened ? &*opened : nullptr};
}

/// The channels of the input that say where surfaces are and how they move.
std::vector<ChannelOfPart> geometry_channels(const Frame& frame) {
  std::vector<ChannelOfPart> channels;
  for (const Role role : {Role::position, Role::normal, Role::depth, Role::motion}) {
    const std::optional<Layer>& layer = frame.layers[role];
    if (!layer || layer->file != frame.lead().file) continue;
    for (const std::string& name : layer->channels) channels.push_back({layer->part, name});
  }
  return channels;
}

/// A line for each run of ssdo that the file has been through, where asked for.
std::string history_of(const Frame& frame, const std::string& made_by) {
  const std::string earlier = string_attribute(frame.part().header, "ssdo/history");
  return earlier.empty() ? made_by : earlier + "\n" + made_by;
}

/// Lays a plane over `from` onto a larger one.
void lay_onto(Plane<float>& wide, const Window& to, const ChannelView& pixels, const Window& from) {
  for_each_row(from.height(), [&](int y) {
    for (int x = 0; x < from.width(); ++x)
      wide(from.x0 - to.x0 + x, from.y0 - to.y0 + y) = *pixels.at(x, y);
  });
}

/// Lays the planes of a view onto the window `all`, in pixels of the file. Around composites of a
/// beauty, it goes on.
void widen(ExrContents& contents, const Window& all, const Rendered* around = nullptr) {
  ExrOutput& output = contents.output;
  const Window to = output.downsampling.small(all),
               from = output.downsampling.small(*output.window);
  output.window = all;
  if (to == from) return;
  std::size_t plane = 0;
  for (const NamedChannels& product : contents.products) {
    const bool goes_on = around && std::holds_alternative<Composite>(product.made);
    for (int c = 0; c < int(product.channels.size()); ++c) {
      auto& [name, type, pixels, background] = output.planes[plane++];
      Plane<float> wide(to.width(), to.height(), background);
      if (goes_on) lay_onto(wide, to, c < 3 ? ChannelView(around->color, c) : &around->alpha, to);
      lay_onto(wide, to, pixels, from);
      contents.laid.push_back(std::move(wide));
      pixels = &contents.laid.back();
    }
  }
}

/// What the outputs of a frame cover, in pixels of its files.
Window window_of_outputs(const Frame& frame) {
  const bool composites = frame.plan.composition.shows_rendered();
  return ssdo::window_of_outputs(frame.readers(), frame.layers, composites,
                                 frame.gbuffer.downsampling);
}

/// Views that share a part share its window.
void share_windows(std::vector<ExrContents>& views) {
  std::map<int, Window> by_part;
  for (const auto& [products, laid, output] : views) {
    const Window& own = *output.window;
    const auto [all, is_new] = by_part.try_emplace(output.part, own);
    if (!is_new) all->second = hull(all->second, own);
  }
  for (ExrContents& view : views) widen(view, by_part.at(view.output.part));
}

/// What goes into the parts of a file: views that share a part stand side by side in it.
std::vector<ExrOutput> by_part(const std::vector<ExrContents>& views) {
  std::vector<ExrOutput> parts;
  for (const ExrContents& view : views) {
    const ExrOutput& own = view.output;
    const auto same = std::ranges::find(parts, own.part, &ExrOutput::part);
    if (same == parts.end()) {
      parts.push_back(own);
      continue;
    }
    same->planes.insert(same->planes.end(), own.planes.begin(), own.planes.end());
    same->geometry.insert(same->geometry.end(), own.geometry.begin(), own.geometry.end());
    same->attributes.insert(same->attributes.end(), own.attributes.begin(), own.attributes.end());
  }
  std::ranges::sort(parts, {}, &ExrOutput::part);
  return parts;
}

/// A picture shows the whole display window, however little of it there are pixels for.
void check_display_size(const Frame& frame) {
  const double factor = frame.gbuffer.downsampling.factor,
               values = 4 * double(frame.part().display_window.area()) / (factor * factor);
  check_decoded_size(frame.input, 0, 0, values * sizeof(float));
}

}  // namespace

std::optional<DisplayTransform> make_display(const RelightJob& job) {
  for (const Target& target : job.targets) {
    if (has_exr_ending(target.path) || !target.shows(job.frame.view)) continue;
    check_display_size(job.frame);
    load_image_codec();
    if (needs_display(product_of_picture(target, job.frame.plan)))
      return DisplayTransform(job.options.color, color_tags(job.frame));
  }
  return std::nullopt;
}

ExrContents exr_contents(const RelightJob& job, const Plan& plan, const Target& target,
                         const Results& results) {
  const Frame& frame = job.frame;
  ExrContents contents;
  const auto names = target.product ? std::vector{*target.product} : plan.write;
  for (const std::string& product : names) {
    contents.products.push_back(product_channels(product, results));
    for (NamedChannels& light : light_channels(product, results))
      contents.products.push_back(std::move(light));
  }
  ExrOutput& output = contents.output;
  output.input = &frame.files[std::size_t(frame.lead().file)];
  output.part = frame.lead().part;
  output.window = frame.gbuffer.file_window;
  output.keep_channels = job.options.output.keep_channels;
  output.crop = job.options.output.crop;
  output.downsampling = frame.gbuffer.downsampling;
  output.geometry = geometry_channels(frame);
  output.compression = job.options.output.compression;
  output.compression_level = job.options.output.compression_level;
  const auto name = [&](const std::string& channel) {
    return frame.lead().file == 0
               ? in_view_of(*output.input, frame.part(), frame.lead().channels[0], channel)
               : channel;
  };
  output.attributes = {{"ssdo/version", SSDO_VERSION},
                       {"ssdo/" + name("plan"), json_text(to_json(plan, frame.history))}};
  if (!job.options.output.made_by.empty())
    output.attributes.emplace_back("ssdo/history", history_of(frame, job.options.output.made_by));
  for (const NamedChannels& product : contents.products) {
    for (const NamedChannel& channel : product.channels) {
      output.planes.push_back(
          {name(channel.name), job.options.output.pixel_type, channel.pixels, product.background});
    }
  }
  const Window all = window_of_outputs(frame);
  if (all == *output.window) return contents;
  const Rendered around = read_rendered(frame.readers(), frame.layers, all, output.downsampling);
  widen(contents, all, &around);
  return contents;
}

Written write_targets(const std::vector<ViewOutput>& views,
                      const std::function<void(double)>& on_progress) {
  Stopwatch watch;
  Written out;
  std::vector<std::optional<Products>> opened;
  for (const ViewOutput& view : views)
    opened.push_back(open_kept_pixels(view.products, view.scene, view.job.frame.gbuffer));
  const RelightJob& any = views.front().job;
  for (const Target& target : any.targets) {
    const SafeFile& file =
        *out.files.emplace_back(std::make_unique<SafeFile>(target.path, any.policy));
    std::vector<Results> shown;
    std::vector<const ViewOutput*> views_shown;
    for (std::size_t k = 0; k < views.size(); ++k) {
      if (!target.shows(views[k].job.frame.view)) continue;
      views_shown.push_back(&views[k]);
      shown.push_back(results_of(views[k], opened[k]));
    }
    if (has_exr_ending(target.path)) {
      std::vector<ExrContents> contents;
      for (std::size_t k = 0; k < shown.size(); ++k)
        contents.push_back(
            exr_contents(views_shown[k]->job, views_shown[k]->plan, target, shown[k]));
      share_windows(contents);
      out.clamped_values += write_exr(file, by_part(contents));
    } else {
      const ViewOutput& view = *views_shown.front();
      const DisplayImage image =
          make_display_image(product_of_picture(target, view.plan), shown.front(),
                             {view.display, keeps_alpha(target.path)});
      out.compose_ms += watch.lap();
      write_image(file, image.spec(any.options.output.bits), image.values);
    }
    out.write_ms += watch.lap();
    on_progress(double(out.files.size()) / double(any.targets.size()));
  }
  return out;
}

}  // namespace ssdo
