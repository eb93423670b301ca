// SPDX-License-Identifier: Apache-2.0
#include "support/color_fixture.h"

#include <cstdlib>
#include <fstream>

namespace ssdo::test {

namespace {

std::string times(int gain) {
  const std::string g = std::to_string(gain);
  return "!<MatrixTransform> {matrix: [" + g + ",0,0,0, 0," + g + ",0,0, 0,0," + g +
         ",0, 0,0,0,1]}";
}

}  // namespace

std::string space(const std::string& name, int gain) {
  return "  - !<ColorSpace>\n    name: " + name + "\n    to_reference: " + times(gain) + "\n";
}

static std::string look(const std::string& name, int gain) {
  return "  - !<Look>\n    name: " + name +
         "\n    process_space: Reference\n    transform: " + times(gain) + "\n";
}

std::string config_of_gains(const std::string& scene_linear_role) {
  return "ocio_profile_version: 2\n"
         "roles:\n  default: Reference\n  data: Raw\n" +
         scene_linear_role +
         "file_rules:\n"
         "  - !<Rule> {name: plates, colorspace: Plate, pattern: '*_plate*', extension: exr}\n"
         "  - !<Rule> {name: masks, colorspace: Raw, pattern: '*_mask*', extension: exr}\n"
         "  - !<Rule> {name: Default, colorspace: Default space}\n"
         "displays:\n"
         "  Monitor:\n"
         "    - !<View> {name: Plain, colorspace: Reference}\n"
         "    - !<View> {name: Tripled, colorspace: Reference, looks: triple}\n"
         "    - !<View> {name: Broken, colorspace: Cube}\n"
         "  Projector:\n"
         "    - !<View> {name: Bright, colorspace: Reference, looks: triple}\n"
         "looks:\n" +
         look("double", 2) + look("triple", 3) +
         "colorspaces:\n"
         "  - !<ColorSpace> {name: Reference}\n"
         "  - !<ColorSpace> {name: Raw, isdata: true}\n"
         "  - !<ColorSpace> {name: Cube, from_reference: !<FileTransform> {src: gone.cube}}\n" +
         space("lin_rec709", 3) + space("ACES - ACEScg", 5) + space("ACES2065-1", 7) +
         space("Plate", 11) + space("Linear P3-D65", 19) +
         space("Utility - Linear - Rec.2020", 23) + space("Linear", 13) +
         space("Default space", 17);
}

ColorFixture::ColorFixture() {
  if (const char* value = std::getenv("OCIO")) before_ = value;
  unsetenv("OCIO");
}

ColorFixture::~ColorFixture() {
  unsetenv("OCIO");
  if (before_) setenv("OCIO", before_->c_str(), 1);
}

std::string ColorFixture::write(const std::string& name, const std::string& text) const {
  std::ofstream(dir_ / name) << text;
  return (dir_ / name).string();
}

glm::vec3 shown(const DisplayTransform& display, glm::vec3 color) {
  display.apply({&color, 1});
  return color;
}

float shown_grey(const ColorOptions& options, float grey, const ColorTags& tags) {
  return shown(DisplayTransform(options, tags), glm::vec3(grey)).y;
}

std::string description(const ColorOptions& options, const ColorTags& tags) {
  return DisplayTransform(options, tags).description();
}

Error refusal(const ColorOptions& options, const ColorTags& tags) {
  return error_of([&] { DisplayTransform(options, tags); });
}

}  // namespace ssdo::test
