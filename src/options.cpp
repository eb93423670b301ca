// SPDX-License-Identifier: Apache-2.0
#include "options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "bench/bench_cli.h"
#include "error.h"
#include "filters/registry.h"
#include "option_values.h"

namespace ssdo {
namespace {

/// Texts that become values of other types once the line has been read.
struct RawOptions {
  std::vector<std::string> aov, save;
  std::string depth_kind = "planar", env_up = "auto", radius = "auto";
  std::string thickness = "auto", offscreen = "extend", quality = "standard";
  std::string pixel_type = "half", compression, motion_scale, on_error = "stop", progress = "auto";
  std::optional<double> background_depth;
};

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

void add_input(CLI::App& app, Options& o, RawOptions& raw) {
  app.add_option(
         "--aov", raw.aov,
         "ROLE=LAYER or ROLE=FILE:LAYER, roles position normal albedo depth alpha beauty radiance "
         "ambient roughness")
      ->type_name("ROLE=LAYER")
      ->allow_extra_args(false)
      ->group("Input");
  app.add_option("--part", o.input.part, "look for layers in this part only")
      ->type_name("NAME|N")
      ->group("Input");
  app.add_option("--depth-kind", raw.depth_kind,
                 "what a depth layer measures: planar, ray, inverse, normalized:NEAR,FAR")
      ->type_name("KIND")
      ->group("Input");
  app.add_option("--motion-scale", raw.motion_scale,
                 "turns a motion layer into pixels to the frame before, x right, y up; default 1,1")
      ->type_name("X,Y")
      ->allow_extra_args(false)
      ->group("Input");
  app.add_option("--background-depth", raw.background_depth,
                 "depth from which on a pixel is background")
      ->type_name("Z")
      ->check(positive())
      ->group("Input");
}

void add_camera(CLI::App& app, Options& o) {
  app.add_option("--camera", o.camera.file, "camera as JSON; without it, fitted from P")
      ->type_name("FILE.json")
      ->group("Camera");
  auto* fov =
      app.add_option("--fov", o.camera.fov, "horizontal field of view, where P does not tell")
          ->type_name("DEG")
          ->check(between(0.01, 179))
          ->group("Camera");
  app.add_option("--ortho", o.camera.ortho, "width of an orthographic frame in scene units")
      ->type_name("WIDTH")
      ->check(positive())
      ->excludes(fov)
      ->group("Camera");
}

void add_light(CLI::App& app, Options& o, RawOptions& raw) {
  app.add_option("--env", o.light.env, "lat-long map, or a constant colour")
      ->type_name("FILE|R,G,B")
      ->capture_default_str()
      ->group("Light");
  app.add_option("--env-rotate", o.light.rotate_degrees,
                 "turn the map about the up axis, counter-clockwise from above")
      ->type_name("DEG")
      ->capture_default_str()
      ->check(between(-1e6, 1e6))
      ->group("Light");
  app.add_option("--env-up", raw.env_up, "auto, y or z; auto is z for Blender's files, else y")
      ->type_name("AXIS")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "y", "z"}))
      ->group("Light");
  app.add_option("--env-exposure", o.light.exposure_stops, "brighten the environment")
      ->type_name("STOPS")
      ->capture_default_str()
      ->check(between(-100, 100))
      ->group("Light");
}

void add_model(CLI::App& app, Options& o, RawOptions& raw) {
  app.add_option("--method", o.model.method, "estimator; see --list-methods")
      ->type_name("NAME")
      ->capture_default_str()
      ->group("Model");
  app.add_option("--radius", raw.radius,
                 "reach of occluders in scene units; auto: chosen from the frame")
      ->type_name("R|auto|inf")
      ->capture_default_str()
      ->group("Model");
  app.add_option("--thickness", raw.thickness,
                 "of what is seen, in scene units; auto: from the width of its picture")
      ->type_name("T|auto|inf")
      ->capture_default_str()
      ->group("Model");
  app.add_option("--offscreen", raw.offscreen,
                 "beyond the frame surfaces go on (extend) or end (open)")
      ->type_name("WHAT")
      ->capture_default_str()
      ->check(CLI::IsMember({"extend", "open"}))
      ->group("Model");
  app.add_option("--quality", raw.quality, describe_qualities())
      ->type_name("LEVEL")
      ->capture_default_str()
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
  app.add_option("--filter", o.model.filter, describe_filters())
      ->type_name("NAME")
      ->capture_default_str()
      ->group("Model");
  app.add_flag("--temporal", o.model.temporal,
               "average over the frames of a sequence what they show of the same surface")
      ->group("Model");
}

void add_output(CLI::App& app, Options& o, RawOptions& raw) {
  app.add_option("-o,--output", o.output.files,
                 "output, repeatable: .exr holds all products, .png .jpg .tif the composite")
      ->type_name("OUTPUT")
      ->allow_extra_args(false)
      ->group("Output");
  app.add_option("--products", o.output.products,
                 "of ao, bent, reflection, direct, bounce, error, composite; default: all that the "
                 "inputs allow")
      ->type_name("LIST")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Output");
  app.add_option("--save", raw.save, "a product in a file of its own, repeatable")
      ->type_name("PRODUCT=FILE")
      ->allow_extra_args(false)
      ->group("Output");
  app.add_option("--pixel-type", raw.pixel_type, "of EXR outputs: half or float")
      ->type_name("TYPE")
      ->capture_default_str()
      ->check(CLI::IsMember({"half", "float"}))
      ->group("Output");
  app.add_option(
         "--compression", raw.compression,
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

void add_batch(CLI::App& app, Options& o, RawOptions& raw) {
  app.add_option("--frames", o.batch.frames,
                 "frames of a sequence: 1001-1010,1020-1030x2; default: all that exist")
      ->type_name("RANGE")
      ->group("Batch");
  app.add_flag("--skip-existing", o.batch.skip_existing,
               "skip frames whose outputs exist and can be read")
      ->group("Batch");
  app.add_option("--on-error", raw.on_error, "stop or continue with the next frame")
      ->type_name("WHAT")
      ->capture_default_str()
      ->check(CLI::IsMember({"stop", "continue"}))
      ->group("Batch");
  app.add_option("--progress", raw.progress,
                 "auto (a bar on a terminal), none, tractor, alfred or openjd")
      ->type_name("STYLE")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "none", "tractor", "alfred", "openjd"}))
      ->group("Batch");
}

void add_say(CLI::App& app, Options& o) {
  app.add_option("--threads", o.threads,
                 "over $SSDO_THREADS, $CUE_THREADS, $SLURM_CPUS_PER_TASK; default: all processors")
      ->type_name("N")
      ->check(CLI::Range(1, 4096))
      ->group("Resources");
  app.add_flag("-v,--verbose", o.say.verbose, "say what was found and decided")->group("Say");
  app.add_flag("-q,--quiet", o.say.quiet, "say nothing but errors")->group("Say");
  app.add_flag("--dry-run", o.say.dry_run, "say what would be done, and stop")->group("Say");
  app.add_option("--stats", o.say.stats,
                 "write times, memory and the plan of every frame; replaced if it exists")
      ->type_name("FILE.json")
      ->group("Say");
  app.set_config("--config", "", "options from a TOML file; the command line wins")
      ->type_name("FILE.toml")
      ->group("Say");
}

CLI::App* add_compare(CLI::App& app, CompareOptions& o) {
  CLI::App* compare =
      app.add_subcommand("compare", "error between two images, layer by layer: FILE or FILE:LAYER");
  compare->add_option("A", o.a, "image or layer to measure")->required();
  compare->add_option("B", o.b, "image or layer to hold it to")->required();
  compare->add_option("--mask", o.mask, "compare only pixels where this is not 0")
      ->type_name("FILE[:LAYER]");
  compare->add_option("--diff", o.diff, "write A - B")->type_name("OUT.exr");
  compare->add_option("--fail-above", o.fail_above, "exit with 1 if the RMSE of a layer is above")
      ->type_name("RMSE")
      ->check(between(0, 1e38));
  compare->add_flag("--json", o.json, "as JSON");
  compare->add_flag("--overwrite", o.policy.overwrite, "replace the output of --diff");
  compare->add_flag("--create-dirs", o.policy.create_dirs, "make its folder");
  return compare;
}

/// Turns texts into values and refuses what does not fit together.
void finish(Options& o, const RawOptions& raw, bool depth_kind_given) {
  for (const std::string& text : raw.aov) o.input.aovs.push_back(parse_layer_request(text));
  for (const std::string& text : raw.save) o.output.saves.push_back(read_save(text));
  if (depth_kind_given) read_depth_kind(raw.depth_kind, o.input.gbuffer);
  if (!raw.motion_scale.empty()) o.input.gbuffer.motion_scale = read_motion_scale(raw.motion_scale);
  if (raw.background_depth) o.input.gbuffer.background_depth = float(*raw.background_depth);
  if (raw.env_up != "auto") o.light.up = raw.env_up == "z" ? UpAxis::z : UpAxis::y;
  find_filter(o.model.filter);
  o.model.radius = read_length("--radius", raw.radius);
  o.model.thickness = read_length("--thickness", raw.thickness);
  o.model.extend_offscreen = raw.offscreen == "extend";
  o.model.quality = raw.quality == "draft"   ? Quality::draft
                    : raw.quality == "final" ? Quality::final
                                             : Quality::standard;
  o.output.pixel_type = raw.pixel_type == "half" ? Imf::HALF : Imf::FLOAT;
  if (!raw.compression.empty()) o.output.compression = read_compression(raw.compression);
  o.batch.on_error = raw.on_error == "stop" ? OnError::stop : OnError::keep_going;
  o.batch.progress = raw.progress == "none"      ? ProgressStyle::none
                     : raw.progress == "tractor" ? ProgressStyle::tractor
                     : raw.progress == "alfred"  ? ProgressStyle::alfred
                     : raw.progress == "openjd"  ? ProgressStyle::openjd
                                                 : ProgressStyle::automatic;
  if (o.command == Command::list_methods) return;
  if (o.input_file.empty()) throw Error(ExitCode::usage, "no INPUT given; see ssdo --help");
  if (o.command == Command::relight && o.output.files.empty() && o.output.saves.empty() &&
      !o.say.dry_run) {
    throw Error(ExitCode::usage,
                fmt::format("{}: no output given; name one with -o OUTPUT", o.input_file));
  }
}

}  // namespace

ParsedOptions parse_options(int argc, const char* const* argv) {
  ParsedOptions parsed;
  Options& o = parsed.options;
  RawOptions raw;
  CLI::App app{
      "Puts light back into a rendered frame: occlusion, environment light and bounces from a "
      "G-buffer.",
      "ssdo"};
  app.set_version_flag("--version", std::string("ssdo ") + SSDO_VERSION);
  app.add_option("INPUT", o.input_file, "multilayer EXR, or a sequence: shot.####.exr")->group("");
  bool list = false;
  app.add_flag("--list-methods", list, "print the methods, their products and parameters")
      ->group("Model");
  add_input(app, o, raw);
  add_camera(app, o);
  add_light(app, o, raw);
  add_model(app, o, raw);
  add_output(app, o, raw);
  add_color(app, o);
  add_batch(app, o, raw);
  add_say(app, o);
  CLI::App* info =
      app.add_subcommand("info", "say what was found, what would be done and why; write nothing")
          ->fallthrough();
  info->add_option("INPUT", o.input_file, "as above")->group("");
  info->add_flag("--json", o.say.json, "as JSON");
  CLI::App* const bench = add_bench(app, o);
  CLI::App* const compare = add_compare(app, o.compare);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    parsed.print = app.help();
    return parsed;
  } catch (const CLI::CallForVersion&) {
    parsed.print = std::string("ssdo ") + SSDO_VERSION + "\n";
    return parsed;
  } catch (const CLI::ParseError& e) {
    std::string message = e.what();
    for (char& c : message) c = c == '\n' ? ' ' : c;
    throw Error(ExitCode::usage, message + "; see ssdo --help");
  }
  if (list) o.command = Command::list_methods;
  if (compare->parsed()) {
    o.command = Command::compare;
    return parsed;
  }
  if (info->parsed()) o.command = Command::info;
  if (bench->parsed()) {
    o.command = Command::bench;
    finish_bench(app, o);
  }
  finish(o, raw, app.count("--depth-kind") > 0);
  return parsed;
}

}  // namespace ssdo
