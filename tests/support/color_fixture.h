// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

#include "color/color.h"
#include "error.h"
#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace ssdo::test {

inline std::string times(int gain) {
  const std::string g = std::to_string(gain);
  return "!<MatrixTransform> {matrix: [" + g + ",0,0,0, 0," + g + ",0,0, 0,0," + g +
         ",0, 0,0,0,1]}";
}

inline std::string space(const std::string& name, int gain) {
  return "  - !<ColorSpace>\n    name: " + name + "\n    to_reference: " + times(gain) + "\n";
}

inline std::string look(const std::string& name, int gain) {
  return "  - !<Look>\n    name: " + name +
         "\n    process_space: Reference\n    transform: " + times(gain) + "\n";
}

/// A config whose spaces differ by a gain, so that what becomes of 1 tells the space it was taken
/// in. View Plain shows the reference; Tripled has a look of its own.
inline std::string config_of_gains(
    const std::string& scene_linear_role = "  scene_linear: Linear\n") {
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

/// Every test starts without $OCIO.
class ColorFixture : public testing::Test {
 protected:
  ColorFixture() {
    if (const char* value = std::getenv("OCIO")) before_ = value;
    unsetenv("OCIO");
  }
  ~ColorFixture() override {
    unsetenv("OCIO");
    if (before_) setenv("OCIO", before_->c_str(), 1);
  }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ / name) << text;
    return (dir_ / name).string();
  }
  std::string gains() const { return write("gains.ocio", config_of_gains()); }

  TempDir dir_;

 private:
  std::optional<std::string> before_;
};

inline glm::vec3 shown(const DisplayTransform& display, glm::vec3 color) {
  display.apply({&color, 1});
  return color;
}

inline float shown_grey(const ColorOptions& options, float grey, const ColorTags& tags = {}) {
  return shown(DisplayTransform(options, tags), glm::vec3(grey)).y;
}

inline std::string description(const ColorOptions& options, const ColorTags& tags = {}) {
  return DisplayTransform(options, tags).description();
}

inline Error refusal(const ColorOptions& options, const ColorTags& tags = {}) {
  return error_of([&] { DisplayTransform(options, tags); });
}

}  // namespace ssdo::test
