// SPDX-License-Identifier: Apache-2.0
#include "scene/light/lamps/read_lamps.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <utility>

#include "error.h"
#include "io/one_line.h"
#include "io/size_guard.h"
#include "math/number.h"
#include "nearest_name.h"
#include "scene/light/lamps/lamp_keys.h"

namespace ssdo {
namespace {

using nlohmann::json;

/// Largest JSON file of lamps, in bytes; a lamp takes less than 1 KiB.
constexpr std::size_t kMostLampBytes = 1 << 20;

/// What a value of the command line stands for: a number, several, a word.
json value_of(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  if (const auto number = parse_number(text)) return *number;
  if (text.find(',') == text.npos) return text;
  json numbers = json::array();
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto number = parse_number(part);
    if (number)
      numbers.push_back(*number);
    else
      numbers.push_back(part);
  }
  return numbers;
}

/// The next word of a text; blanks within quotes are part of it.
std::string next_word(std::istringstream& text) {
  std::string word;
  bool quoted = false;
  text >> std::ws;
  for (int c = text.get(); c != EOF && (quoted || !std::isspace(c)); c = text.get()) {
    if (c == '"') quoted = !quoted;
    word += char(c);
  }
  return word;
}

/// Whether the value of a key is taken as it stands: names may be spelt as numbers, and selections
/// hold commas.
bool is_text(const std::string& key) { return key == "name" || key == "receive" || key == "cast"; }

[[noreturn]] void refuse_text(const std::string& text, const std::string& what) {
  throw Error(ExitCode::usage, fmt::format("--light '{}': {}", printable(text), what));
}

}  // namespace

std::vector<Lamp> read_lamps(const std::string& file) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ExitCode::input, fmt::format("{}: {}", printable(file), what));
  };
  std::ifstream in(file);
  in.peek();  // a folder can be opened, but not read
  if (in.bad() || !in.is_open()) refuse("file of lights cannot be read; check --lights");
  const std::string text = read_text(in, file, kMostLampBytes, ExitCode::input);
  json all;
  try {
    all = json::parse(text);
  } catch (const json::exception& e) {
    refuse("not JSON: " + printable(one_line(e.what())));
  }
  if (!all.is_object() || !all.contains("lights") || !all["lights"].is_array())
    refuse("not a file of lights: it needs an object with 'lights', an array");
  for (const auto& [key, value] : all.items()) {
    if (key != "lights") {
      refuse(fmt::format("unknown key '{}'; {}the object has 'lights' only", printable(key),
                         did_you_mean(key, {"lights"})));
    }
  }
  std::vector<Lamp> lamps;
  for (const json& light : all["lights"]) {
    const std::string which = fmt::format("{}: light {}", printable(file), lamps.size() + 1);
    lamps.push_back(read_lamp(light, {ExitCode::input, which}));
  }
  return lamps;
}

Lamp parse_lamp(const std::string& text) {
  std::istringstream words(text);
  std::string type;
  if (!(words >> type)) refuse_text(text, "is empty; give TYPE KEY=VALUE ...");
  if (type.find('=') != type.npos)
    refuse_text(
        text, fmt::format("begins with '{}'; the type of the light comes first", printable(type)));
  json light = {{"type", type}};
  for (std::string word = next_word(words); !word.empty(); word = next_word(words)) {
    const std::size_t equals = word.find('=');
    if (equals == word.npos || equals == 0)
      refuse_text(text, fmt::format("'{}' is not KEY=VALUE", printable(word)));
    const std::string key = word.substr(0, equals);
    if (light.contains(key)) refuse_text(text, fmt::format("{} is given twice", printable(key)));
    const std::string value = word.substr(equals + 1);
    light[key] = is_text(key) ? json(value) : value_of(value);
  }
  return read_lamp(light, {ExitCode::usage, "--light " + printable(type)});
}

void name_lamps(std::vector<Lamp>& lamps) {
  if (lamps.size() > kMostLamps) {
    throw Error(
        ExitCode::usage,
        fmt::format("{}: is light {} of {}, and {} is the most; leave lights out, or render "
                    "far ones into the map of --env",
                    lamps[kMostLamps].given_by, kMostLamps + 1, lamps.size(), kMostLamps));
  }
  std::map<std::string, const Lamp*> named;
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    Lamp& lamp = lamps[i];
    if (lamp.name.empty()) lamp.name = fmt::format("light{}", i + 1);
    const auto [other, is_new] = named.emplace(lamp.name, &lamp);
    if (!is_new) {
      throw Error(ExitCode::usage,
                  fmt::format("{}: name '{}' is also that of {}; names have to differ",
                              lamp.given_by, lamp.name, other->second->given_by));
    }
  }
}

}  // namespace ssdo
