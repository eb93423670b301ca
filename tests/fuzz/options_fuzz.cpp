// SPDX-License-Identifier: Apache-2.0
//
// A command line, one word on each line up to an empty line, and a config file, which is the rest;
// that is read as a file of lights too. Each word is read as what words may be: a frame pattern, a
// list of frames, FILE:LAYER, a lamp.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "cli/parse_options.h"
#include "fuzz/target.h"
#include "io/pictures/picture_layers.h"
#include "io/sequence.h"
#include "scene/layers/layers.h"
#include "scene/light/lamps/read_lamps.h"
#include "support/temp_dir.h"

namespace ssdo::fuzz {
namespace {

/// A folder, with its slash, of a sequence whose numbers have any length and sign.
const std::string& folder() {
  static const test::TempDir dir;
  static const std::string path = [] {
    for (const char* number : {"1", "0001", "-1", "-0012", "2147483647", "-2147483648",
                               "2147483648", "99999999999999999999", "-", "", "1.5"})
      std::ofstream(dir / (std::string("in.") + number + ".exr"));
    std::filesystem::create_directory(dir / "in.0007.exr");
    return dir.path().string() + '/';
  }();
  return path;
}

/// Frames that are found have files. Above the folder, files come and go.
void find_files(const std::string& word) {
  if (word.find("..") != std::string::npos) return;
  const std::string pattern = folder() + word;
  for (const int frame : find_frames(pattern)) {
    require(std::filesystem::is_regular_file(expand_pattern(pattern, frame)),
            "a frame is found that has no file");
  }
}

/// What is taken for a lamp gives light that is finite, wherever a surface is.
void light_with(const Lamp& lamp) {
  const auto source = make_source(lamp, WorldToCamera(), 0);
  for (const float x : {0.0f, 1e-6f, 1.0f, 1e6f}) {
    const glm::vec3 light = source->unoccluded({x, -x, -2 * x}, {0, 0.6f, 0.8f});
    require(std::isfinite(light.x + light.y + light.z), "a lamp gives light that is not finite");
    const SourcePoint point = source->sample({x, -x, -2 * x}, {0.3f, 0.9f});
    require(std::isfinite(point.weight) && point.distance > 0, "a lamp has no point");
  }
}

void read_word(const std::string& word) {
  may_refuse([&] { is_pattern(word); });
  may_refuse([&] { expand_pattern(word, -17); });
  may_refuse([&] { find_files(word); });
  may_refuse([&] { parse_frames(word); });
  may_refuse([&] { parse_picture_name(word); });
  may_refuse([&] { parse_layer_request(word); });
  may_refuse([&] { light_with(parse_lamp(word)); });
}

void parse(const std::vector<std::string>& words) {
  std::vector<const char*> arguments;
  for (const std::string& word : words) arguments.push_back(word.c_str());
  may_refuse([&] { parse_options(int(arguments.size()), arguments.data()); });
}

}  // namespace

void read_input(Bytes input) {
  static MemoryFile config;
  const std::string text(input.begin(), input.end());
  const std::size_t end = std::min(text.find("\n\n"), text.size());
  std::vector<std::string> words = {"ssdo"};
  std::istringstream lines(text.substr(0, end));
  for (std::string word; std::getline(lines, word);) words.emplace_back(word.c_str());
  for (const std::string& word : words) read_word(word);
  if (end < text.size()) {
    config.hold(input.subspan(end + 2));
    words.insert(words.end(), {"--config", config.path()});
    may_refuse([&] {
      for (const Lamp& lamp : read_lamps(config.path())) light_with(lamp);
    });
  }
  parse(words);
}

std::vector<std::string> seeds() {
  return {
      "in.exr\n-o\nout.exr\n\nquality = \"final\"\nbounces = 2\n",
      "in.####.exr\n-o\nout.%04d.png\n--frames\n1-10x2,20,-5--1\n--on-error\ncontinue\n",
      "in.exr\n-o\nout.exr\n--aov\nposition=P\n--aov\nnormal=n.exr:N\n--env\nsky.exr:left.sky\n",
      "info\nin.exr\n--json\n--depth-kind\nnormalized:1,20\n--camera\nc.json\n--part\n2\n",
      "compare\na.exr:P\nb.exr:P\n--fail-above\n0.1\n--mask\nm.exr:A\n",
      "bench\nin.exr\n--report\nr.html\n",
      "in.exr\n-o\nout.exr\n--light\nsphere name=key position=1,2,3 radius=0 normalize=true\n"
      "--lights\na.json\n--light\nrect width=2 direction=0,-1,0 color_temperature=3000\n",
      "in.exr\n\n{\"lights\": [{\"name\": \"a\", \"type\": \"disk\", \"radius\": 1e-6, "
      "\"up\": [0, 1, 0], \"cone_angle\": 30, \"cone_softness\": 1}, {\"type\": \"rect\", "
      "\"matrix\": [[1, 0, 0, 4], [0, 0, -1, 5], [0, 1, 0, 6], [0, 0, 0, 1]], \"height\": 1e6}, "
      "{\"type\": \"distant\", \"angle\": 359, \"exposure\": -100}]}",
      "in.exr\n--dry-run\n--set\nfalloff=2\n--method\ngtao\n--save\nao=ao.png\n--mem-limit\n2G\n",
      "in.exr\n-o\nout.exr\n--compression\nzip:9\n--shot\n2x3\n--motion-scale\n1,-1\n"
      "--thickness\nauto\n--radius\ninf\n--env\n1,2,3\n\n"
      "aov = [\"position=P\", \"normal=N\"]\nframes = \"1-3\"\nverbose = true\nradius = 0.5\n"};
}

}  // namespace ssdo::fuzz
