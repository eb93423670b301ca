// SPDX-License-Identifier: Apache-2.0
#include "cli/main_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <type_traits>
#include <utility>

#include "cli/option_values.h"
#include "estimators/products.h"
#include "estimators/registry.h"
#include "filters/registry.h"
#include "io/sequence.h"
#include "jobs/machine/threads.h"
#include "nearest_name.h"
#include "scene/layers/groups.h"

namespace ssdo {
namespace {

using Text = std::string;
using Texts = std::vector<std::string>;

/// The names that an option takes, with their values.
template <class T>
using Choices = std::vector<std::pair<Text, T>>;

/// Adds options to one group of the help. `type` is what the help calls the value.
class Group {
 public:
  Group(CLI::App& app, const Text& name) : app_(app), name_(name) {}

  /// Sets `field`; the help shows its default where that is a number or a text.
  template <class T>
  CLI::Option* value(const Text& flag, const Text& type, T& field, const Text& help) {
    CLI::Option* option = app_.add_option(flag, field, help)->type_name(type)->group(name_);
    if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, Text>) option->capture_default_str();
    return option;
  }

  /// Calls `read` with the text.
  CLI::Option* text(const Text& flag, const Text& type, std::function<void(const Text&)> read,
                    const Text& help) {
    return app_.add_option_function<Text>(flag, read, help)->type_name(type)->group(name_);
  }

  /// May be given several times, with one value each.
  CLI::Option* repeatable(const Text& flag, const Text& type, Texts& field, const Text& help) {
    return value(flag, type, field, help)->allow_extra_args(false);
  }

  /// May be given several times; calls `read` with each text.
  CLI::Option* each(const Text& flag, const Text& type, std::function<void(const Text&)> read,
                    const Text& help) {
    const auto read_all = [read](const Texts& texts) {
      for (const Text& text : texts) read(text);
    };
    return app_.add_option_function<Texts>(flag, read_all, help)
        ->type_name(type)
        ->allow_extra_args(false)
        ->group(name_);
  }

  /// Sets `field` to the value of one of the names, which help and errors list.
  template <class T>
  void choice(const Text& flag, T& field, const std::type_identity_t<Choices<T>>& choices,
              const Text& help) {
    Texts names;
    for (const auto& [name, value] : choices) names.push_back(name);
    const auto set = [flag, &field, choices, names](const Text& text) {
      for (const auto& [name, value] : choices) {
        if (name != text) continue;
        field = value;
        return;
      }
      throw Error(ExitCode::usage, fmt::format("{} {}: {}expected one of {}", flag, text,
                                               did_you_mean(text, names), fmt::join(names, ", ")));
    };
    CLI::Option* option = text(flag, fmt::format("{{{}}}", fmt::join(names, ",")), set, help);
    for (const auto& [name, value] : choices) {
      if (value == field) option->default_str(name);
    }
  }

  CLI::Option* flag(const Text& name, bool& field, const Text& help) {
    return app_.add_flag(name, field, help)->group(name_);
  }

 private:
  CLI::App& app_;
  Text name_;
};

void add_input(CLI::App& app, InputOptions& o) {
  Group group(app, "Input");
  group.each(
      "--aov", "ROLE=LAYER", [&](const Text& text) { o.aovs.push_back(parse_layer_request(text)); },
      fmt::format("ROLE=LAYER or ROLE=FILE:LAYER, roles {}; albedo:straight=LAYER or "
                  "albedo:premultiplied=LAYER states how alpha is in it; light:NAME=LAYER is what "
                  "a lamp gave to the beauty without shadow",
                  fmt::join(role_names(), " ")));
  group.repeatable("--also", "FILE", o.also,
                   "another G-buffer of the same scene with P in world space: another camera, a "
                   "panorama, or a deep image of this frame");
  CLI::Option* part = group.value("--part", "NAME|N", o.part,
                                  "look for layers in this part or view, and what completes it");
  const Text left(kEyes[0]), right(kEyes[1]);
  group.choice("--stereo", o.views, {{left, {left}}, {right, {right}}, {"all", {left, right}}},
               "relight this view of a stereo file, or both, with the other as another G-buffer");
  app.get_option("--stereo")->excludes(part);
  group.choice("--space", o.gbuffer.space, {{"world", Space::world}, {"camera", Space::camera}},
               "that P and N are stored in; default: as they agree with each other and the camera");
  group.text(
      "--depth-kind", "KIND", [&](const Text& text) { read_depth_kind(text, o.gbuffer); },
      "what a depth layer measures: " + depth_kind_forms());
  group
      .text(
          "--motion-scale", "X,Y",
          [&](const Text& text) { o.gbuffer.motion_scale = read_motion_scale(text); },
          "turns a motion layer into pixels to the frame before, x right, y up; default 1,1")
      ->allow_extra_args(false);
  group.flag(
      "--allow-partial", o.allow_partial,
      "take missing rows of files that are cut short or damaged as background; exits with 3");
  group
      .value("--background-depth", "Z", o.gbuffer.background_depth,
             "depth from which on a pixel is background")
      ->check(positive());
}

void add_objects(CLI::App& app, ObjectOptions& o) {
  Group group(app, "Objects");
  const auto selection = [&](const Text& flag, Selection& field, const Text& help) {
    group.text(
        flag, "SEL", [flag, &field](const Text& text) { field = parse_selection(flag, text); },
        help);
  };
  selection("--no-cast", o.no_cast, "this hides nothing and sends nothing; see --only");
  selection("--shadow-of", o.shadow_of,
            "add shadow_of: the light with this over the light without it");
  selection("--only", o.only,
            "change what is selected only: crypto:NAME (patterns), id:LAYER=1,5-7, LAYER or "
            "FILE:LAYER (a matte), joined by + and -");
  selection("--no-receive", o.no_receive, "keep this as it was rendered; it casts all the same");
  selection("--holdout", o.holdout, "alpha 0 in the composite; it casts all the same");
  group.choice("--backdrop", o.backdrop,
               {{"auto", BackdropChoice::leave_out},
                {"any", BackdropChoice::any},
                {"cast", BackdropChoice::cast},
                {"off", BackdropChoice::ignore}},
               "a dome, card or sweep that stands for the sky casts nothing where it is far (auto) "
               "or wherever it is (any), casts with a warning, or is not looked for");
}

void add_camera(CLI::App& app, CameraOptions& o) {
  Group group(app, "Camera");
  CLI::Option* file =
      group.value("--camera", "FILE.json", o.file,
                  "camera as JSON; without it, fitted from P or read from the header");
  CLI::Option* fov =
      group.value("--fov", "DEG", o.fov, "horizontal field of view, where P does not tell")
          ->check(between(0.01, 179))
          ->excludes(file);
  group.value("--ortho", "WIDTH", o.ortho, "width of an orthographic frame in scene units")
      ->check(positive())
      ->excludes(file)
      ->excludes(fov);
}

void add_light(CLI::App& app, LightOptions& o, OutputOptions& output) {
  Group group(app, "Light");
  group.value("--env", "FILE[:LAYER]|R,G,B", o.env, "lat-long or cube map, or a constant colour");
  group
      .value("--env-rotate", "DEG", o.rotate_degrees,
             "turn the map about the up axis, counter-clockwise from above")
      ->check(between(-1e6, 1e6));
  group.choice(
      "--env-up", o.up, {{"auto", std::nullopt}, {"y", UpAxis::y}, {"z", UpAxis::z}},
      "axis that points up; auto: by the header of Blender or Unreal, else by the camera, else y");
  group.value("--env-exposure", "STOPS", o.exposure_stops, "brighten the environment")
      ->check(between(-100, 100));
  group.repeatable("--lights", "FILE.json", o.lamp_files, "lamps: see LIGHTS in man ssdo");
  group.repeatable("--light", "'TYPE KEY=VALUE ...'", o.lamps,
                   "a lamp: sphere, disk, rect or distant, with the keys of such a file");
  group.flag("--per-light", output.per_light,
             "add direct, bounce, shadow and unshadowed of each light, the environment's as env");
}

/// The options that decide the number of samples.
void add_quality(Group& group, ModelOptions& o) {
  Choices<Quality> names;
  Text sizes;
  for (const QualityLevel& level : kQualities) {
    names.emplace_back(level.name, level.quality);
    sizes += fmt::format("{} {} {} x {}", sizes.empty() ? ":" : ",", level.name, level.slices,
                         level.steps);
  }
  group.choice("--quality", o.quality, names, "slices x steps per side" + sizes);
  group.value("--slices", "K", o.slices, "slices of each pixel, in place of the quality's")
      ->check(CLI::Range(1, 256));
  group
      .value("--steps", "S", o.steps,
             "steps from a pixel to the frame's diagonal, in place of the quality's")
      ->check(CLI::Range(1, 256));
  group
      .value("--error", "E", o.error,
             "take more slices and steps until the error of direct + bounce is E or less")
      ->check(positive());
}

void add_model(CLI::App& app, ModelOptions& o) {
  Group group(app, "Model");
  group
      .text(
          "--method", "NAME", [&](const Text& text) { o.method = find_method(text).name; },
          "estimator; see --list-methods")
      ->default_str(o.method);
  group
      .text(
          "--radius", "R|auto|inf",
          [&](const Text& text) { o.radius = read_length("--radius", text); },
          "reach of occluders in scene units; auto: chosen from the frame")
      ->default_str("auto");
  group
      .text(
          "--thickness", "T|auto|inf",
          [&](const Text& text) { o.thickness = read_length("--thickness", text); },
          "of what is seen, in scene units; auto: from the width of its picture")
      ->default_str("auto");
  group.choice("--offscreen", o.extend_offscreen, {{"extend", true}, {"open", false}},
               "beyond the frame surfaces go on (extend) or end (open)");
  group.choice("--prior", o.prior, {{"rules", Prior::rules}, {"learned", Prior::learned}},
               "what fills directions that no picture shows: what was learned from made scenes, or "
               "rules; not given: learned, but by method bitmask only, and not if --offscreen open "
               "or --thickness says what is there");
  add_quality(group, o);
  group.value("--bounces", "N", o.bounces, "bounces of light between surfaces")
      ->check(CLI::Range(0, 8));
  group.value("--seed", "N", o.seed, "of the sampling pattern");
  group.repeatable("--set", "NAME=VALUE", o.set, "a parameter of the method; see --list-methods");
  Text filter_list;
  for (const Filter& filter : filters())
    filter_list += fmt::format("\n{}: {}", filter.name, filter.summary);
  filter_list += fmt::format("\n{}: that of the method's source, in its order", kPublishedFilter);
  group
      .text(
          "--filter", "NAME",
          [&](const Text& text) {
            find_filter(text, methods().front());
            o.filter = text;
          },
          "of the sampling pattern:" + filter_list)
      ->default_str(o.filter);
  CLI::Option* shot = group.text(
      "--shot", "K[xSTEP]", [&](const Text& text) { o.shot = read_shot(text); },
      "average what K frames before and K after find of the same surface, every STEP-th");
  group
      .flag("--temporal", o.temporal,
            "average over the frames so far, as games do; light that moves lags")
      ->excludes(shot);
}

Text describe_products() {
  Text usual;
  for (const Product& product : kProducts) {
    if (product.usual) usual += (usual.empty() ? "" : ",") + Text(product.name);
  }
  return fmt::format("of {}, or {}; default: {} as far as the inputs allow", product_names(),
                     kAllProducts, usual);
}

void add_output(CLI::App& app, OutputOptions& o) {
  Group group(app, "Output");
  group.repeatable("-o,--output", "OUTPUT", o.files,
                   "output, repeatable: .exr holds the products, .png .jpg .tif the composite");
  group.repeatable("--products", "LIST", o.products, describe_products())->delimiter(',');
  Choices<std::optional<Compose>> composites;
  Text meanings;
  for (const ComposeRow& row : kComposites) {
    composites.emplace_back(row.name, row.compose);
    meanings += fmt::format("\n{}: {}", row.name, row.meaning);
  }
  group.choice(
      "--compose", o.compose, composites,
      "what the composite is; default: occlude with an ambient layer, else relight" + meanings);
  group.each(
      "--save", "PRODUCT=FILE", [&](const Text& text) { o.saves.push_back(read_save(text)); },
      "a product in a file of its own, repeatable");
  group.choice("--pixel-type", o.pixel_type, {{"half", Imf::HALF}, {"float", Imf::FLOAT}},
               "of EXR outputs");
  group.text(
      "--compression", "NAME", [&](const Text& text) { read_compression(text, o); },
      "of EXR outputs: " + compression_forms() + "; default: the input's");
  group.choice("--bits", o.bits, {{"8", 8}, {"16", 16}}, "per channel of PNG and TIFF outputs");
  group.flag("--keep-channels", o.keep_channels,
             "pass the input's other channels and parts through");
  group.flag("--crop", o.crop, "write the display window only; overscan still blocks and sends");
  group
      .value("--downsample", "N", o.downsample,
             "the G-buffer is N times as large as the outputs, whose edges are then antialiased")
      ->check(CLI::Range(1, 8));
  group.flag("--overwrite", o.policy.overwrite, "replace outputs that exist");
  group.flag("--create-dirs", o.policy.create_dirs, "make missing folders of outputs");
}

void add_color(CLI::App& app, ColorOptions& o) {
  Group group(app, "Colour");
  group.value("--ocio", "FILE", o.ocio, "OpenColorIO config; over $OCIO over the built-in one");
  group.value("--colorspace", "NAME", o.colorspace, "of the input's colours");
  group.value("--display", "NAME", o.display, "display of PNG, JPEG and TIFF outputs");
  group.value("--view", "NAME", o.view, "view of that display");
  group.value("--look", "NAME", o.look, "look applied before the view");
}

void add_batch(CLI::App& app, BatchOptions& o) {
  Group group(app, "Batch");
  group.text(
      "--frames", "RANGE", [&](const Text& text) { o.frames = parse_frames(text); },
      "frames of a sequence: 1001-1010,1020-1030x2; default: all that exist");
  group.flag("--skip-existing", o.skip_existing, "skip frames whose outputs exist and can be read");
  group.choice("--on-error", o.on_error,
               {{"stop", OnError::stop}, {"continue", OnError::keep_going}},
               "stop or continue with the next frame");
  group.choice("--progress", o.progress,
               {{"auto", ProgressStyle::automatic},
                {"none", ProgressStyle::none},
                {"tractor", ProgressStyle::tractor},
                {"alfred", ProgressStyle::alfred},
                {"openjd", ProgressStyle::openjd}},
               "auto is a bar on a terminal; others are lines for a scheduler");
}

void add_resources(CLI::App& app, Options& o) {
  Group group(app, "Resources");
  group
      .value("--threads", "N", o.threads,
             "over $SSDO_THREADS, $CUE_THREADS, $SLURM_CPUS_PER_TASK; default: all processors")
      ->check(CLI::Range(1, kMostThreads));
  group.text(
      "--mem-limit", "SIZE", [&](const Text& text) { o.mem_limit = read_mem_limit(text); },
      "memory to use, such as 8G, over $SSDO_MEM_LIMIT; default: three quarters of what there is");
}

void add_messages(CLI::App& app, Verbosity& o) {
  Group group(app, "Messages");
  CLI::Option* verbose = group.flag("-v,--verbose", o.verbose, "print what was found and decided");
  group.flag("-q,--quiet", o.quiet, "print errors only")->excludes(verbose);
  group.flag("--dry-run", o.dry_run, "print what would be done, and stop");
  group.value("--stats", "FILE.json", o.stats,
              "write times, memory and the plan of every frame; replaced if it exists");
}

}  // namespace

void add_main_options(CLI::App& app, Options& o) {
  add_input(app, o.input);
  add_objects(app, o.input.objects);
  add_camera(app, o.camera);
  add_light(app, o.light, o.output);
  add_model(app, o.model);
  add_output(app, o.output);
  add_color(app, o.color);
  add_batch(app, o.batch);
  add_resources(app, o);
  add_messages(app, o.verbosity);
  Group(app, "Messages")
      .value("--config", "FILE.toml", o.config_file,
             "options from a TOML file; the command line wins")
      ->configurable(false);
}

}  // namespace ssdo
