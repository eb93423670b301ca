// SPDX-License-Identifier: Apache-2.0
#include "io/exr/header_numbers.h"

#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>
#include <string_view>

namespace ssdo {
namespace {

using Numbers = std::vector<double>;

Numbers numbers_in(double value) { return {value}; }
Numbers numbers_in(const Imath::V2f& v) { return {v.x, v.y}; }
Numbers numbers_in(const Imath::V3f& v) { return {v.x, v.y, v.z}; }

template <class T>
Numbers numbers_in(const Imath::Matrix44<T>& m) {
  const T* first = m.getValue();
  return {first, first + 16};
}

/// One or 16 numbers with blanks, commas and brackets between them; nothing for any other text.
Numbers numbers_in(std::string text) {
  constexpr std::string_view kBetween = "[](){},;";
  std::replace_if(
      text.begin(), text.end(), [&](char c) { return kBetween.find(c) != std::string_view::npos; },
      ' ');
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  Numbers all;
  for (double number; in >> number;) all.push_back(number);
  return in.eof() && (all.size() == 1 || all.size() == 16) ? all : Numbers();
}

template <class Typed>
void read_as(const Imf::Attribute& attribute, Numbers& out) {
  if (const auto* typed = dynamic_cast<const Typed*>(&attribute)) out = numbers_in(typed->value());
}

/// Nothing for an attribute that holds no numbers, or one that is not finite.
Numbers numbers_of(const Imf::Attribute& attribute) {
  Numbers all;
  read_as<Imf::IntAttribute>(attribute, all);
  read_as<Imf::FloatAttribute>(attribute, all);
  read_as<Imf::DoubleAttribute>(attribute, all);
  read_as<Imf::V2fAttribute>(attribute, all);
  read_as<Imf::V3fAttribute>(attribute, all);
  read_as<Imf::M44fAttribute>(attribute, all);
  read_as<Imf::M44dAttribute>(attribute, all);
  read_as<Imf::StringAttribute>(attribute, all);
  const bool finite =
      std::all_of(all.begin(), all.end(), [](double value) { return std::isfinite(value); });
  return finite ? all : Numbers();
}

/// What Nuke puts before the names of attributes that it does not know, longest first.
constexpr std::array<std::string_view, 3> kPrefixes = {"nuke/exr/", "exr/", "nuke/"};

std::string_view without_prefix(std::string_view name) {
  for (const std::string_view prefix : kPrefixes)
    if (name.starts_with(prefix)) return name.substr(prefix.size());
  return name;
}

/// Adds the numbers of a header under names that `all` lacks.
void add_missing(const Imf::Header& header, std::map<std::string, Numbers>& all) {
  for (const bool prefixed : {false, true}) {
    for (auto it = header.begin(); it != header.end(); ++it) {
      const std::string_view name = without_prefix(it.name());
      if ((name != it.name()) != prefixed) continue;
      const Numbers numbers = numbers_of(it.attribute());
      if (!numbers.empty()) all.emplace(name, numbers);
    }
  }
}

}  // namespace

std::map<std::string, std::vector<double>> header_numbers(const ExrReader& file, int part) {
  const ExrPart& first = file.parts()[std::size_t(part)];
  std::map<std::string, Numbers> all;
  add_missing(first.header, all);
  for (const ExrPart& other : file.parts())
    if (other.view == first.view) add_missing(other.header, all);
  return all;
}

bool is_by_blender(const Imf::Header& header) {
  for (auto it = header.begin(); it != header.end(); ++it) {
    for (const char* mark : {"BlenderMultiChannel", "cycles."})
      if (std::string(it.name()).find(mark) != std::string::npos) return true;
  }
  return string_attribute(header, "Software").find("Blender") != std::string::npos;
}

}  // namespace ssdo
