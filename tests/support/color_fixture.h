// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "color/color.h"
#include "error.h"
#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace ssdo::test {

/// A colour space of a config that is the reference times a gain.
std::string space(const std::string& name, int gain);

/// A config whose spaces differ by a gain, so that what becomes of 1 tells the space it was taken
/// in. View Plain shows the reference; Tripled has a look of its own.
std::string config_of_gains(const std::string& scene_linear_role = "  scene_linear: Linear\n");

/// Every test starts without $OCIO.
class ColorFixture : public testing::Test {
 protected:
  ColorFixture();
  ~ColorFixture() override;

  /// Writes a text file into dir_; gives its path.
  std::string write(const std::string& name, const std::string& text) const;
  std::string gains() const { return write("gains.ocio", config_of_gains()); }

  TempDir dir_;

 private:
  std::optional<std::string> before_;
};

glm::vec3 shown(const DisplayTransform& display, glm::vec3 color);

float shown_grey(const ColorOptions& options, float grey, const ColorTags& tags = {});

std::string description(const ColorOptions& options, const ColorTags& tags = {});

Error refusal(const ColorOptions& options, const ColorTags& tags = {});

}  // namespace ssdo::test
