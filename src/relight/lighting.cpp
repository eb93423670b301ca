// SPDX-License-Identifier: Apache-2.0
#include "relight/lighting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/gtc/constants.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "color/color_space.h"
#include "error.h"
#include "io/pictures/picture_layers.h"
#include "math/light_range.h"
#include "math/number.h"
#include "parallel/tiles.h"
#include "scene/layers/names.h"
#include "scene/light/environment_map.h"
#include "scene/light/lamps/read_lamps.h"

namespace ssdo {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == text.npos ? std::string_view() : text.substr(first, last - first + 1);
}

/// Whether a text that names no file can only be meant as numbers.
bool is_like_numbers(const std::string& text) {
  std::string rest = lower(text);
  for (const std::string_view word : {"infinity", "inf", "nan"}) {
    for (auto at = rest.find(word); at != rest.npos; at = rest.find(word))
      rest.erase(at, word.size());
  }
  std::error_code ignored;  // of a name that is too long for a file
  return rest.find_first_not_of("0123456789.,;+-e \t") == rest.npos &&
         (rest.empty() || rest.find_first_of("0123456789,;") != rest.npos) &&
         !std::filesystem::exists(text, ignored);
}

/// "0.2,0.3,0.5", or one number for grey; blanks do not count. Nothing for what may be a file.
/// Errors: ExitCode::usage for other numbers.
std::optional<glm::vec3> parse_color(const std::string& text) {
  std::vector<float> values;
  bool numbers = true;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    const auto value = parse_number(trimmed(std::string_view(text).substr(start, comma - start)));
    numbers = numbers && value;
    values.push_back(float(value.value_or(0)));
    start = comma + 1;
  }
  if (numbers && values.size() == 1) return glm::vec3(values[0]);
  if (numbers && values.size() == 3) return glm::vec3(values[0], values[1], values[2]);
  if (!is_like_numbers(text)) return std::nullopt;
  throw Error(ExitCode::usage,
              fmt::format("--env {}: a colour of light is R,G,B or one number for grey, each from "
                          "0 to {:g}; {}",
                          text, kBrightest,
                          numbers ? fmt::format("these are {} numbers", values.size())
                                  : "these are not such numbers"));
}

/// Smaller values are 0 in half.
constexpr float kSmallestHalf = 5.9604645e-08f;

float brightest_channel(const glm::vec3& c) { return std::max({c.x, c.y, c.z}); }

/// The most light that a surface can get, as irradiance over pi, by the brightest channels: the
/// light of all directions as if from a single one, or the brightest texel from everywhere if that
/// is less.
double most_light(const Plane<glm::vec3>& map) {
  double sum = 0, weights = 0, brightest = 0;
  for (int y = 0; y < map.height; ++y) {
    const double weight = std::sin((y + 0.5) / map.height * glm::pi<double>());
    for (int x = 0; x < map.width; ++x) {
      const double light = brightest_channel(map(x, y));
      sum += weight * light, weights += weight;
      brightest = std::max(brightest, light);
    }
  }
  return std::min(brightest, 4 * sum / weights);
}

void warn_if_dim(double light, std::vector<std::string>& warnings) {
  if (!(light > 0 && light < kSmallestHalf)) return;
  warnings.push_back(
      fmt::format("surfaces get a light of {:.2g} at most, less than half floats hold ({:.2g}): "
                  "colours in 16 bits are black; give more --env-exposure",
                  light, kSmallestHalf));
}

/// The texels in other primaries; colours outside their gamut get negative channels.
Plane<glm::vec3> convert(const Plane<glm::vec3>& map, const glm::mat3& matrix) {
  auto out = Plane<glm::vec3>::like(map);
  for_each_row(map.height, [&](int y) {
    for (int x = 0; x < map.width; ++x) out(x, y) = within_range(matrix * map(x, y));
  });
  return out;
}

}  // namespace

Lighting::Lighting(const LightOptions& options) : options_(options) {
  read_environment();
  for (const std::string& file : options.lamp_files) {
    for (Lamp& lamp : read_lamps(file)) lamps_.push_back(std::move(lamp));
  }
  for (const std::string& text : options.lamps) lamps_.push_back(parse_lamp(text));
  name_lamps(lamps_);
}

void Lighting::read_environment() {
  const auto color = parse_color(options_.env);
  if (!color) {
    read_map();
    return;
  }
  for (int c = 0; c < 3; ++c) {
    if ((*color)[c] >= 0 && (*color)[c] <= kBrightest) continue;
    throw Error(ExitCode::usage,
                fmt::format("--env {}: a colour of light has values from 0 to {:g}", options_.env,
                            kBrightest));
  }
  check_exposure(brightest_channel(*color));
  constant_ = *color * float(std::exp2(options_.exposure_stops));
  warn_if_dim(brightest_channel(constant_), warnings_);
  description_ = fmt::format("constant {:g},{:g},{:g}", constant_.x, constant_.y, constant_.z);
}

void Lighting::read_map() {
  EnvironmentMap map = read_environment_map(options_.env);
  primaries_ = map.primaries;
  warnings_ = std::move(map.warnings);
  float brightest = 0;
  for (const glm::vec3& texel : map.texels.pixels)
    brightest = std::max(brightest, brightest_channel(texel));
  check_exposure(brightest);
  warn_if_dim(most_light(map.texels) * std::exp2(options_.exposure_stops), warnings_);
  if (brightest == 0) {
    warnings_.push_back(fmt::format("{}: is black: it lights nothing", options_.env));
  }
  const std::string file = parse_picture_name(options_.env).file;
  description_ = map.layer.empty() ? file : file + ":" + map.layer;
  description_ += fmt::format(", {} x {}", map.texels.width, map.texels.height);
  for (const std::string& how : map.converted) description_ += ", " + how;
  map_ = std::make_shared<const Plane<glm::vec3>>(std::move(map.texels));
}

void Lighting::check_exposure(float brightest) {
  const double exposed = brightest * std::exp2(options_.exposure_stops);
  if (exposed > kBrightest) {
    throw Error(
        ExitCode::usage,
        fmt::format("--env-exposure {:g}: makes the brightest light of --env {} {:.2g}, and "
                    "{:g} is the most; give {:.0f} stops or less",
                    options_.exposure_stops, options_.env, exposed, kBrightest,
                    std::floor(std::log2(kBrightest / brightest))));
  }
}

FrameEnvironment Lighting::around(UpAxis up_of_frame,
                                  const std::optional<Chromaticities>& primaries) const {
  EnvironmentFrame frame;
  frame.up = options_.up.value_or(up_of_frame);
  if (!map_) {
    return {Environment::constant(constant_, frame.up), description_, warnings_};
  }
  frame.rotate_degrees = float(std::fmod(options_.rotate_degrees, 360.0));
  frame.exposure_stops = float(options_.exposure_stops);
  FrameEnvironment light{Environment(map_, frame), description_, warnings_};
  light.description += frame.up == UpAxis::z ? ", z up" : ", y up";
  if (!primaries_ || same_chromaticities(*primaries_, primaries.value_or(kRec709))) return light;
  const auto matrix = primaries ? conversion_of_primaries(*primaries_, *primaries) : std::nullopt;
  if (matrix) {
    light.environment =
        Environment(std::make_shared<const Plane<glm::vec3>>(convert(*map_, *matrix)), frame);
    light.description += ", converted from " + describe_primaries(*primaries_);
  } else {
    light.warnings.push_back(fmt::format(
        "{}: has the primaries of {}, and the frame {}: its values are taken as they are",
        options_.env, describe_primaries(*primaries_),
        primaries ? "those of " + describe_primaries(*primaries) : "does not say which it has"));
  }
  return light;
}

}  // namespace ssdo
