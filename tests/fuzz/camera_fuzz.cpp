// SPDX-License-Identifier: Apache-2.0
//
// Cameras as text: a JSON file, or, after a first line "header", the numbers of an EXR's header,
// "NAME NUMBER..." on each line.
#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "fuzz/real_files.h"
#include "fuzz/target.h"
#include "scene/camera/camera.h"
#include "scene/camera/metadata/candidates.h"
#include "support/header_camera.h"

namespace ssdo::fuzz {
namespace {

constexpr std::string_view kHeader = "header\n";
constexpr Window kDisplay{0, 0, 64, 48};

void read_header(const std::string& text) {
  std::map<std::string, std::vector<double>> header;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    std::vector<double> numbers;
    for (double number; numbers.size() < 16 && words >> number;) numbers.push_back(number);
    // As header_numbers() gives them.
    if (!name.empty() && !numbers.empty()) header[name] = numbers;
  }
  header_cameras(header, {kDisplay, kDisplay, 1});
  unusable_poses(header);
  unusable_lenses(header);
}

std::string header_text(const test::HeaderNumbers& numbers) {
  std::string text(kHeader);
  for (const auto& [name, values] : numbers) {
    text += name;
    for (const double value : values) text += fmt::format(" {:g}", value);
    text += '\n';
  }
  return text;
}

}  // namespace

void read_input(Bytes input) {
  const std::string text(input.begin(), input.end());
  if (text.starts_with(kHeader)) return read_header(text.substr(kHeader.size()));
  static MemoryFile memory;
  memory.hold(input);
  may_refuse([] {
    const Camera camera = read_camera(memory.path(), kDisplay, 1);
    require(std::isfinite(camera.fx) && std::isfinite(camera.fy), "a lens that is not finite");
    for (int i = 0; i < 3; ++i)
      require(std::isfinite(camera.origin[i]), "a place that is not finite");
  });
}

std::vector<std::string> seeds() {
  Camera camera;
  camera.fx = camera.fy = 60, camera.cx = 32, camera.cy = 24;
  camera.origin = {1, 2, 3};
  const std::vector<std::string> made = {
      header_text(test::standard_header(camera, kDisplay)),
      header_text(test::pbrt_header(camera, kDisplay)),
      header_text(test::vray_header(camera, kDisplay)),
      header_text(test::redshift_header(camera, kDisplay)),
      header_text(test::unreal_header({1, 2, 3, {4, 5, 6}}, camera, kDisplay)),
      R"({"type": "persp", "fx": 60, "fy": 60, "cx": 32, "cy": 24, "world_to_camera":
              [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -5], [0, 0, 0, 1]]})",
      R"({"hfov_deg": 50, "world_handedness": "left", "world_to_camera":
              [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -5]]})",
      R"({"type": "ortho", "ortho_width": 8})"};
  return joined(made, real_files(".", ".json"));
}

}  // namespace ssdo::fuzz
