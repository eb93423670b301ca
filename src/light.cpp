// SPDX-License-Identifier: Apache-2.0
#include "light.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "error.h"
#include "io/image_file.h"
#include "math/number.h"

namespace ssdo {
namespace {

/// "0.2,0.3,0.5", or one number for grey. Nothing for a text that is no list of numbers.
std::optional<glm::vec3> parse_color(const std::string& text) {
  std::vector<float> values;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    const auto value = parse_number(std::string_view(text).substr(start, comma - start));
    if (!value) return std::nullopt;
    values.push_back(float(*value));
    start = comma + 1;
  }
  if (values.size() == 1) return glm::vec3(values[0]);
  if (values.size() == 3) return glm::vec3(values[0], values[1], values[2]);
  return std::nullopt;
}

std::shared_ptr<const Plane<glm::vec3>> read_map(const std::string& file) {
  auto map = std::make_shared<Plane<glm::vec3>>(read_image(file));
  for (glm::vec3& c : map->pixels) {
    for (int i = 0; i < 3; ++i) c[i] = std::isfinite(c[i]) ? c[i] : 0.0f;
  }
  return map;
}

}  // namespace

Light::Light(const LightOptions& options) : options_(options) {
  if (const auto color = parse_color(options.env)) {
    if (color->x < 0 || color->y < 0 || color->z < 0) {
      throw Error(ExitCode::usage,
                  fmt::format("--env {}: a colour of light has no negative value", options.env));
    }
    constant_ = *color * float(std::exp2(options.exposure_stops));
    description_ = fmt::format("constant {:g},{:g},{:g}", constant_.x, constant_.y, constant_.z);
    return;
  }
  map_ = read_map(options.env);
  description_ = fmt::format("{}, {} x {}", options.env, map_->width, map_->height);
}

Environment Light::around(UpAxis up_of_frame) const {
  if (!map_) return Environment::constant(constant_);
  EnvironmentFrame frame;
  frame.up = options_.up.value_or(up_of_frame);
  frame.rotate_degrees = float(std::fmod(options_.rotate_degrees, 360.0));
  frame.exposure_stops = float(options_.exposure_stops);
  return Environment(map_, frame);
}

}  // namespace ssdo
