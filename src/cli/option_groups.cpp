// SPDX-License-Identifier: Apache-2.0
#include "cli/option_groups.h"

#include <fmt/format.h>

#include "cli/option_values.h"
#include "cli/threads.h"
#include "estimators/registry.h"
#include "filters/registry.h"
#include "io/sequence.h"

namespace ssdo {
namespace {

using Text = std::string;
using Texts = std::vector<std::string>;

std::string describe_qualities() {
  std::string text = "slices x steps per side: ";
  for (const auto& [name, level] : {std::pair{"draft", Quality::draft},
                                    {"standard", Quality::standard},
                                    {"final", Quality::final}}) {
    text += fmt::format("{}{} {} x {}", level == Quality::draft ? "" : ", ", name, slices_of(level),
                        steps_of(level));
  }
  return text;
}

std::string describe_filters() {
  std::string text = "of the sampling pattern:";
  for (const Filter& filter : filters())
    text += fmt::format("\n{}: {}", filter.name, filter.summary);
  return text;
}

void add_input(CLI::App& app, Options& o) {
  app.add_option_function<Texts>(
         "--aov",
         [&](const Texts& texts) {
           for (const Text& text : texts) o.input.aovs.push_back(parse_layer_request(text));
         },
         "ROLE=LAYER or ROLE=FILE:LAYER, roles position normal albedo depth alpha beauty radiance "
         "ambient roughness")
      ->type_name("ROLE=LAYER")
      ->allow_extra_args(false)
      ->group("Input");
  app.add_option("--part", o.input.part,
                 "look for layers in this part or view, and what completes it")
      ->type_name("NAME|N")
      ->group("Input");
  app.add_option_function<Text>(
         "--depth-kind", [&](const Text& text) { read_depth_kind(text, o.input.gbuffer); },
         "what a depth layer measures: planar, ray, inverse, normalized:NEAR,FAR")
      ->type_name("KIND")
      ->group("Input");
  app.add_option_function<Text>(
         "--motion-scale",
         [&](const Text& text) { o.input.gbuffer.motion_scale = read_motion_scale(text); },
         "turns a motion layer into pixels to the frame before, x right, y up; default 1,1")
      ->type_name("X,Y")
      ->allow_extra_args(false)
      ->group("Input");
  app.add_option("--background-depth", o.input.gbuffer.background_depth,
                 "depth from which on a pixel is background")
      ->type_name("Z")
      ->check(positive())
      ->group("Input");
}

void add_camera(CLI::App& app, Options& o) {
  auto* file =
      app.add_option("--camera", o.camera.file, "camera as JSON; without it, fitted from P")
          ->type_name("FILE.json")
          ->group("Camera");
  auto* fov =
      app.add_option("--fov", o.camera.fov, "horizontal field of view, where P does not tell")
          ->type_name("DEG")
          ->check(between(0.01, 179))
          ->excludes(file)
          ->group("Camera");
  app.add_option("--ortho", o.camera.ortho, "width of an orthographic frame in scene units")
      ->type_name("WIDTH")
      ->check(positive())
      ->excludes(file)
      ->excludes(fov)
      ->group("Camera");
}

void add_light(CLI::App& app, Options& o) {
  app.add_option("--env", o.light.env, "lat-long map, or a constant colour")
      ->type_name("FILE[:LAYER]|R,G,B")
      ->capture_default_str()
      ->group("Light");
  app.add_option("--env-rotate", o.light.rotate_degrees,
                 "turn the map about the up axis, counter-clockwise from above")
      ->type_name("DEG")
      ->capture_default_str()
      ->check(between(-1e6, 1e6))
      ->group("Light");
  app.add_option_function<Text>(
         "--env-up",
         [&](const Text& text) {
           if (text != "auto") o.light.up = text == "z" ? UpAxis::z : UpAxis::y;
         },
         "auto, y or z; auto is z for Blender's files, else y")
      ->type_name("AXIS")
      ->default_str("auto")
      ->check(CLI::IsMember({"auto", "y", "z"}))
      ->group("Light");
  app.add_option("--env-exposure", o.light.exposure_stops, "brighten the environment")
      ->type_name("STOPS")
      ->capture_default_str()
      ->check(between(-100, 100))
      ->group("Light");
}

void add_model(CLI::App& app, Options& o) {
  app.add_option_function<Text>(
         "--method", [&](const Text& text) { o.model.method = find_method(text).name; },
         "estimator; see --list-methods")
      ->type_name("NAME")
      ->default_str(o.model.method)
      ->group("Model");
  app.add_option_function<Text>(
         "--radius", [&](const Text& text) { o.model.radius = read_length("--radius", text); },
         "reach of occluders in scene units; auto: chosen from the frame")
      ->type_name("R|auto|inf")
      ->default_str("auto")
      ->group("Model");
  app.add_option_function<Text>(
         "--thickness",
         [&](const Text& text) { o.model.thickness = read_length("--thickness", text); },
         "of what is seen, in scene units; auto: from the width of its picture")
      ->type_name("T|auto|inf")
      ->default_str("auto")
      ->group("Model");
  app.add_option_function<Text>(
         "--offscreen", [&](const Text& text) { o.model.extend_offscreen = text == "extend"; },
         "beyond the frame surfaces go on (extend) or end (open)")
      ->type_name("WHAT")
      ->default_str("extend")
      ->check(CLI::IsMember({"extend", "open"}))
      ->group("Model");
  app.add_option_function<Text>(
         "--quality", [&](const Text& text) { o.model.quality = read_quality(text); },
         describe_qualities())
      ->type_name("LEVEL")
      ->default_str("standard")
      ->check(CLI::IsMember({"draft", "standard", "final"}))
      ->group("Model");
  app.add_option("--slices", o.model.slices, "slices of each pixel, in place of the quality's")
      ->type_name("K")
      ->check(CLI::Range(1, 256))
      ->group("Model");
  app.add_option("--steps", o.model.steps,
                 "steps from a pixel to the frame's diagonal, in place of the quality's")
      ->type_name("S")
      ->check(CLI::Range(1, 256))
      ->group("Model");
  app.add_option("--error", o.model.error,
                 "take more slices and steps until the error of direct + bounce is E or less")
      ->type_name("E")
      ->check(positive())
      ->group("Model");
  app.add_option("--bounces", o.model.bounces, "bounces of light between surfaces")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::Range(0, 8))
      ->group("Model");
  app.add_option("--seed", o.model.seed, "of the sampling pattern")
      ->type_name("N")
      ->capture_default_str()
      ->group("Model");
  app.add_option("--set", o.model.set, "a parameter of the method; see --list-methods")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)
      ->group("Model");
  app.add_option_function<Text>(
         "--filter", [&](const Text& text) { o.model.filter = find_filter(text).name; },
         describe_filters())
      ->type_name("NAME")
      ->default_str(o.model.filter)
      ->group("Model");
  app.add_flag("--temporal", o.model.temporal,
               "average over the frames of a sequence what they show of the same surface")
      ->group("Model");
}

void add_output(CLI::App& app, Options& o) {
  app.add_option("-o,--output", o.output.files,
                 "output, repeatable: .exr holds the products, .png .jpg .tif the composite")
      ->type_name("OUTPUT")
      ->allow_extra_args(false)
      ->group("Output");
  app.add_option("--products", o.output.products,
                 "of ao, bent, reflection, direct, bounce, error, composite, or all; default: "
                 "ao,direct,bounce,composite as far as the inputs allow")
      ->type_name("LIST")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Output");
  app.add_option_function<Texts>(
         "--save",
         [&](const Texts& texts) {
           for (const Text& text : texts) o.output.saves.push_back(read_save(text));
         },
         "a product in a file of its own, repeatable")
      ->type_name("PRODUCT=FILE")
      ->allow_extra_args(false)
      ->group("Output");
  app.add_option_function<Text>(
         "--pixel-type",
         [&](const Text& text) { o.output.pixel_type = text == "half" ? Imf::HALF : Imf::FLOAT; },
         "of EXR outputs: half or float")
      ->type_name("TYPE")
      ->default_str("half")
      ->check(CLI::IsMember({"half", "float"}))
      ->group("Output");
  app.add_option_function<Text>(
         "--compression", [&](const Text& text) { o.output.compression = read_compression(text); },
         "of EXR outputs: none rle zips zip piz pxr24 b44 b44a dwaa dwab; default: the input's")
      ->type_name("NAME")
      ->group("Output");
  app.add_option("--bits", o.output.bits, "per channel of PNG and TIFF outputs: 8 or 16")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::IsMember({8, 16}))
      ->group("Output");
  app.add_flag("--keep-channels", o.output.keep_channels,
               "pass the input's other channels and parts through")
      ->group("Output");
  app.add_flag("--overwrite", o.output.policy.overwrite, "replace outputs that exist")
      ->group("Output");
  app.add_flag("--create-dirs", o.output.policy.create_dirs, "make missing folders of outputs")
      ->group("Output");
}

void add_color(CLI::App& app, Options& o) {
  app.add_option("--ocio", o.color.ocio, "OpenColorIO config; over $OCIO over the built-in one")
      ->type_name("FILE")
      ->group("Colour");
  app.add_option("--colorspace", o.color.colorspace, "of the input's colours")
      ->type_name("NAME")
      ->group("Colour");
  app.add_option("--display", o.color.display, "display of PNG, JPEG and TIFF outputs")
      ->type_name("NAME")
      ->group("Colour");
  app.add_option("--view", o.color.view, "view of that display")
      ->type_name("NAME")
      ->group("Colour");
  app.add_option("--look", o.color.look, "look applied before the view")
      ->type_name("NAME")
      ->group("Colour");
}

void add_batch(CLI::App& app, Options& o) {
  app.add_option_function<Text>(
         "--frames", [&](const Text& text) { o.batch.frames = parse_frames(text); },
         "frames of a sequence: 1001-1010,1020-1030x2; default: all that exist")
      ->type_name("RANGE")
      ->group("Batch");
  app.add_flag("--skip-existing", o.batch.skip_existing,
               "skip frames whose outputs exist and can be read")
      ->group("Batch");
  app.add_option_function<Text>(
         "--on-error",
         [&](const Text& text) {
           o.batch.on_error = text == "stop" ? OnError::stop : OnError::keep_going;
         },
         "stop or continue with the next frame")
      ->type_name("WHAT")
      ->default_str("stop")
      ->check(CLI::IsMember({"stop", "continue"}))
      ->group("Batch");
  app.add_option_function<Text>(
         "--progress", [&](const Text& text) { o.batch.progress = read_progress_style(text); },
         "auto (a bar on a terminal), none, tractor, alfred or openjd")
      ->type_name("STYLE")
      ->default_str("auto")
      ->check(CLI::IsMember({"auto", "none", "tractor", "alfred", "openjd"}))
      ->group("Batch");
}

void add_say(CLI::App& app, Options& o) {
  app.add_option("--threads", o.threads,
                 "over $SSDO_THREADS, $CUE_THREADS, $SLURM_CPUS_PER_TASK; default: all processors")
      ->type_name("N")
      ->check(CLI::Range(1, kMostThreads))
      ->group("Resources");
  auto* verbose =
      app.add_flag("-v,--verbose", o.say.verbose, "say what was found and decided")->group("Say");
  app.add_flag("-q,--quiet", o.say.quiet, "say nothing but errors")
      ->excludes(verbose)
      ->group("Say");
  app.add_flag("--dry-run", o.say.dry_run, "say what would be done, and stop")->group("Say");
  app.add_option("--stats", o.say.stats,
                 "write times, memory and the plan of every frame; replaced if it exists")
      ->type_name("FILE.json")
      ->group("Say");
  app.add_option("--config", o.config_file, "options from a TOML file; the command line wins")
      ->type_name("FILE.toml")
      ->configurable(false)
      ->group("Say");
}

}  // namespace

void add_main_options(CLI::App& app, Options& o) {
  add_input(app, o);
  add_camera(app, o);
  add_light(app, o);
  add_model(app, o);
  add_output(app, o);
  add_color(app, o);
  add_batch(app, o);
  add_say(app, o);
}

}  // namespace ssdo
