// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfCompression.h>
#include <ImfPixelType.h>

#include <optional>
#include <string>
#include <vector>

#include "bench/bench_options.h"
#include "color.h"
#include "compare.h"
#include "io/exr_reader.h"
#include "io/safe_file.h"
#include "scene/environment.h"
#include "scene/geometry.h"
#include "scene/read_gbuffer.h"

namespace ssdo {

enum class Command { relight, info, compare, bench, list_methods };

/// Which layers are read, and how.
struct InputOptions {
  std::vector<LayerRequest> aovs;
  std::string part;  ///< name or number; empty: all
  GBufferOptions gbuffer;
};

struct LightOptions {
  std::string env = "1,1,1";  ///< a lat-long map, or R,G,B
  double rotate_degrees = 0;  ///< about the up axis, counter-clockwise from above
  std::optional<UpAxis> up;   ///< from the header where not given
  double exposure_stops = 0;  ///< -100 to 100
};

/// Slices per pixel, and steps on each side of a slice out to the frame's diagonal.
enum class Quality { draft, standard, final };
constexpr int slices_of(Quality q) { return q == Quality::final ? 6 : 2; }
constexpr int steps_of(Quality q) {
  return q == Quality::draft ? 8 : q == Quality::standard ? 16 : 48;
}

struct ModelOptions {
  std::string method = "bitmask";
  std::optional<double> radius;     ///< scene units or infinity; chosen from the frame if not given
  std::optional<double> thickness;  ///< scene units or infinity; found in the frame if not given
  bool extend_offscreen = true;     ///< surfaces go on beyond the frame
  Quality quality = Quality::standard;
  std::optional<int> slices, steps;  ///< in place of those of the quality
  std::optional<double> error;       ///< largest standard error of direct + bounce
  int bounces = 1;                   ///< 0 to 8
  unsigned seed = 0;
  std::vector<std::string> set;  ///< NAME=VALUE of the method
  std::string filter = "geometry";
  bool temporal = false;  ///< frames of a sequence share what they find
};

/// A product and the file that it alone goes to.
struct SaveRequest {
  std::string product, path;
};

struct OutputOptions {
  std::vector<std::string> files;     ///< -o
  std::vector<SaveRequest> saves;     ///< --save
  std::vector<std::string> products;  ///< empty: all that the inputs allow
  Imf::PixelType pixel_type = Imf::HALF;
  std::optional<Imf::Compression> compression;  ///< the input's where not given
  int bits = 8;                                 ///< per channel of PNG and TIFF: 8 or 16
  bool keep_channels = false;
  OutputPolicy policy;
};

enum class OnError { stop, keep_going };
enum class ProgressStyle { automatic, none, tractor, alfred, openjd };

struct BatchOptions {
  std::optional<std::vector<int>> frames;  ///< every frame that exists where not given
  bool skip_existing = false;
  OnError on_error = OnError::stop;
  ProgressStyle progress = ProgressStyle::automatic;
};

/// How much the tool says.
struct SayOptions {
  bool verbose = false, quiet = false;
  bool dry_run = false;
  bool json = false;  ///< of `info`
  std::string stats;  ///< file for the statistics; empty: none
};

struct Options {
  Command command = Command::relight;
  std::string input_file;
  InputOptions input;
  CameraOptions camera;
  LightOptions light;
  ModelOptions model;
  OutputOptions output;
  ColorOptions color;
  BatchOptions batch;
  SayOptions say;
  CompareOptions compare;
  BenchOptions bench;
  int threads = 0;                    ///< 0: choose
  std::string config_file;            ///< that was read; empty: none
  std::vector<std::string> warnings;  ///< options that have no effect beside the others
};

/// What the command line asks for: work, or a text to print (--help, --version).
struct ParsedOptions {
  Options options;
  std::optional<std::string> print;
};

/// Parses and validates. Errors: ExitCode::usage, one line.
ParsedOptions parse_options(int argc, const char* const* argv);

}  // namespace ssdo
