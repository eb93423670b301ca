// SPDX-License-Identifier: Apache-2.0
#include "scene/light/lamps/lamp_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "io/json_text.h"
#include "io/one_line.h"
#include "nearest_name.h"
#include "scene/light/lamps/blackbody.h"
#include "scene/light/light_group.h"
#include "scene/objects/selection.h"

namespace ssdo {
namespace {

using nlohmann::json;

/// Positions and sizes up to this have squares and products that floats hold.
constexpr double kLargest = 1e9;
constexpr std::size_t kLongestName = 100;  ///< a channel has at most 255 bytes
constexpr double kMostLight = 1e15;        ///< kBrightest, of which a float is a little less
constexpr double kMostStops = 100;
constexpr double kRigid = 1e-3;  ///< as for cameras

const std::vector<std::pair<std::string, LampType>> kTypes = {{"sphere", LampType::sphere},
                                                              {"disk", LampType::disk},
                                                              {"rect", LampType::rect},
                                                              {"distant", LampType::distant}};

/// The keys that lamps of a type may have.
std::vector<std::string> keys_of(LampType type) {
  std::vector<std::string> keys = {
      "name",      "type",     "position",  "direction",         "up",      "matrix", "color",
      "intensity", "exposure", "normalize", "color_temperature", "receive", "cast"};
  const auto add = [&](std::initializer_list<const char*> more) {
    keys.insert(keys.end(), more.begin(), more.end());
  };
  if (type == LampType::distant) add({"angle"});
  if (type == LampType::sphere || type == LampType::disk) add({"radius"});
  if (type == LampType::sphere) add({"soft_falloff"});
  if (type == LampType::rect) add({"width", "height"});
  if (type != LampType::distant) add({"cone_angle", "cone_softness", "cone_by_cosine"});
  return keys;
}

/// A value as it stands in the file, short enough for a message.
std::string shown(const json& value) {
  constexpr std::size_t kMost = 60;
  std::string text = json_text(value);
  if (text.size() > kMost) text.replace(kMost, text.npos, "...");
  return printable(text);
}

class LampReader {
 public:
  LampReader(const json& object, LampOption given_by)
      : object_(object), given_by_(std::move(given_by)) {}

  Lamp read() {
    if (!object_.is_object()) refuse("is " + shown(object_) + "; a light is an object with keys");
    read_name();
    read_type();
    check_keys();
    read_pose();
    lamp_.radius = number("radius", lamp_.radius, 0, kLargest);
    lamp_.width = size("width", lamp_.width);
    lamp_.height = size("height", lamp_.height);
    lamp_.angle = number("angle", lamp_.angle, 0, 360);
    lamp_.cone_by_cosine = is_set("cone_by_cosine");
    lamp_.has_cone =
        object_.contains("cone_angle") || object_.contains("cone_softness") || lamp_.cone_by_cosine;
    lamp_.cone_angle = number("cone_angle", lamp_.cone_angle, 0, 180);
    lamp_.cone_softness = number("cone_softness", lamp_.cone_softness, 0, 1);
    lamp_.soft_falloff = is_set("soft_falloff");
    if (lamp_.type == LampType::disk) lamp_.radius = size("radius", lamp_.radius);
    read_light();
    lamp_.receive = selection("receive");
    lamp_.cast = selection("cast");
    lamp_.given_by = given_by_.text;
    return lamp_;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(given_by_.code, fmt::format("{}: {}", given_by_.text, what));
  }

  void read_name() {
    if (!object_.contains("name")) return;
    const json& value = object_["name"];
    const auto is_fit = [](unsigned char c) { return c < 128 && (std::isalnum(c) || c == '_'); };
    if (value.is_string()) lamp_.name = value.get<std::string>();
    if (lamp_.name.empty() || !std::ranges::all_of(lamp_.name, is_fit) ||
        lamp_.name.size() > kLongestName) {
      refuse(fmt::format("name is {}; names of lights are 1 to {} letters, digits and _",
                         shown(value), kLongestName));
    }
    const std::size_t number = given_by_.text.rfind(' ') + 1;
    given_by_.text = given_by_.text.substr(0, number) + lamp_.name;
    if (lamp_.name == kEnvironmentName)
      refuse(
          fmt::format("name: '{}' is that of the environment map; give another", kEnvironmentName));
  }

  bool is_set(const char* key) const {
    if (!object_.contains(key)) return false;
    if (!object_[key].is_boolean())
      refuse(fmt::format("{} is {}; it is true or false", key, shown(object_[key])));
    return object_[key].get<bool>();
  }

  void read_type() {
    std::vector<std::string> names;
    for (const auto& [name, type] : kTypes) names.push_back(name);
    const std::string name =
        object_.contains("type") && object_["type"].is_string() ? object_["type"] : "";
    const auto found = std::ranges::find(kTypes, name, [](const auto& t) { return t.first; });
    if (found == kTypes.end()) {
      refuse(object_.contains("type")
                 ? fmt::format("type is {}; {}it is one of {}", shown(object_["type"]),
                               did_you_mean(name, names), fmt::join(names, ", "))
                 : fmt::format("has no type; it is one of {}", fmt::join(names, ", ")));
    }
    lamp_.type = found->second;
    type_ = name;
  }

  void check_keys() const {
    const std::vector<std::string> known = keys_of(lamp_.type);
    std::vector<std::string> of_all = known;
    for (const auto& [name, type] : kTypes) {
      for (const std::string& key : keys_of(type)) {
        if (std::ranges::find(of_all, key) == of_all.end()) of_all.push_back(key);
      }
    }
    for (const auto& [key, value] : object_.items()) {
      if (std::ranges::find(known, key) != known.end()) continue;
      if (std::ranges::find(of_all, key) != of_all.end())
        refuse(fmt::format("{}: a {} light has none", key, type_));
      refuse(fmt::format("unknown key '{}'; {}keys of a {} light are {}", printable(key),
                         did_you_mean(key, known), type_, fmt::join(known, ", ")));
    }
  }

  double number(const char* key, double otherwise, double low, double high) const {
    if (!object_.contains(key)) return otherwise;
    const json& value = object_[key];
    if (value.is_number()) {
      const double read = value.get<double>();
      if (read >= low && read <= high) return read;
    }
    refuse(fmt::format("{} is {}; it is a number from {:g} to {:g}", key, shown(value), low, high));
  }

  /// A length that is not 0.
  double size(const char* key, double otherwise) const {
    const double length = number(key, otherwise, 0, kLargest);
    if (length == 0) refuse(fmt::format("{} is 0: the light has no surface to send from", key));
    return length;
  }

  Selection selection(const char* key) const {
    if (!object_.contains(key)) return {};
    const json& value = object_[key];
    if (!value.is_string())
      refuse(
          fmt::format("{} is {}; it is a selection, such as \"crypto:ball\"", key, shown(value)));
    try {
      return parse_selection(fmt::format("{}: {}", given_by_.text, key), value.get<std::string>());
    } catch (const Error& error) {
      throw Error(given_by_.code, error.what());
    }
  }

  glm::dvec3 numbers(const char* key, double low, double high) const {
    const json& value = object_[key];
    glm::dvec3 read(0);
    bool fits = value.is_array() && value.size() == 3;
    for (int c = 0; fits && c < 3; ++c) {
      fits = value[c].is_number();
      if (fits) read[c] = value[c].get<double>();
      fits = fits && read[c] >= low && read[c] <= high;
    }
    if (fits) return read;
    refuse(fmt::format("{} is {}; it is three numbers from {:g} to {:g}", key, shown(value), low,
                       high));
  }

  glm::dvec3 direction(const char* key) const {
    const glm::dvec3 read = numbers(key, -kLargest, kLargest);
    if (!(glm::length(read) > 0)) refuse(fmt::format("{} is 0,0,0: it points nowhere", key));
    return read / std::max({std::abs(read.x), std::abs(read.y), std::abs(read.z)});
  }

  void read_pose() {
    if (object_.contains("matrix")) {
      for (const char* key : {"position", "direction", "up"}) {
        if (object_.contains(key))
          refuse(fmt::format("{} and matrix both place it; give one of them", key));
      }
      read_matrix();
      return;
    }
    if (object_.contains("position")) lamp_.position = numbers("position", -kLargest, kLargest);
    const glm::dvec3 back = object_.contains("direction") ? -glm::normalize(direction("direction"))
                                                          : glm::dvec3(0, 0, 1);
    // Without `up`, the axis that is farthest from the direction of the light; y where it can be.
    glm::dvec3 up = std::abs(back.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    if (object_.contains("up")) up = glm::normalize(direction("up"));
    const glm::dvec3 right = glm::cross(up, back);
    if (!(glm::length(right) > 1e-6))
      refuse("up is parallel to direction: it tells not where the height lies");
    lamp_.axes[0] = glm::normalize(right);
    lamp_.axes[1] = glm::cross(back, lamp_.axes[0]);
    lamp_.axes[2] = back;
  }

  /// Four rows of four, or the 16 numbers of them.
  void read_matrix() {
    const json& value = object_["matrix"];
    std::vector<double> read;
    const auto take = [&](const json& row) {
      for (const json& entry : row) {
        if (entry.is_number()) read.push_back(entry.get<double>());
      }
    };
    bool fits = value.is_array() && (value.size() == 4 || value.size() == 16);
    if (fits && value.size() == 16) take(value);
    if (fits && value.size() == 4) {
      for (const json& row : value) {
        fits = fits && row.is_array() && row.size() == 4;
        if (fits) take(row);
      }
    }
    if (!fits || read.size() != 16 ||
        !std::ranges::all_of(read, [](double v) { return std::abs(v) <= kLargest; })) {
      refuse(fmt::format("matrix is {}; it is four rows of four numbers, at most {:g}",
                         shown(value), kLargest));
    }
    if (read[12] != 0 || read[13] != 0 || read[14] != 0 || read[15] != 1) {
      refuse(
          fmt::format("matrix: its last row is {:g} {:g} {:g} {:g}, not 0 0 0 1; one for row "
                      "vectors has to be transposed",
                      read[12], read[13], read[14], read[15]));
    }
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        lamp_.axes[column][row] = read[std::size_t(4 * row + column)];
      lamp_.position[row] = read[std::size_t(4 * row + 3)];
    }
    const glm::dmat3 product = glm::transpose(lamp_.axes) * lamp_.axes;
    for (int i = 0; i < 9; ++i) {
      if (!(std::abs(product[i / 3][i % 3] - (i % 4 == 0 ? 1 : 0)) < kRigid)) {
        refuse(
            "matrix scales or shears: give a rigid one, and the size by radius, width and "
            "height");
      }
    }
    if (glm::determinant(lamp_.axes) < 0)
      refuse("matrix mirrors (its determinant is -1); flip an axis");
    for (int i = 0; i < 3; ++i) lamp_.axes[i] = glm::normalize(lamp_.axes[i]);
  }

  void read_light() {
    if (object_.contains("color")) lamp_.color = numbers("color", 0, kMostLight);
    if (lamp_.type == LampType::distant) lamp_.intensity = 50000;
    lamp_.intensity = number("intensity", lamp_.intensity, 0, kMostLight);
    lamp_.exposure = number("exposure", 0, -kMostStops, kMostStops);
    if (object_.contains("color_temperature")) {
      lamp_.temperature = blackbody_color(
          number("color_temperature", kWhiteKelvin, kCoolestKelvin, kHottestKelvin));
    }
    lamp_.normalize = is_set("normalize");
    const glm::dvec3 value = lamp_.value();
    const double brightest = std::max({value.x, value.y, value.z});
    if (brightest > kMostLight) {
      refuse(fmt::format("{}: makes its light {:.2g}, and {:g} is the most",
                         lamp_.exposure > 0 ? "exposure" : "intensity", brightest, kMostLight));
    }
    const bool has_no_size = (lamp_.type == LampType::sphere && lamp_.radius == 0) ||
                             (lamp_.type == LampType::distant && lamp_.angle == 0);
    if (has_no_size && !lamp_.normalize) {
      refuse(
          fmt::format("{} is 0: it gives no light; give it a size, or normalize true, with which "
                      "intensity does not depend on the size",
                      lamp_.type == LampType::sphere ? "radius" : "angle"));
    }
    if (lamp_.has_cone && lamp_.cone_angle == 0) refuse("cone_angle is 0: it gives no light");
  }

  const json& object_;
  LampOption given_by_;
  std::string type_;
  Lamp lamp_;
};

}  // namespace

Lamp read_lamp(const json& object, const LampOption& given_by) {
  return LampReader(object, given_by).read();
}

}  // namespace ssdo
