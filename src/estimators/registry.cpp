// SPDX-License-Identifier: Apache-2.0
#include "estimators/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "error.h"
#include "estimators/bitmask.h"
#include "estimators/gtao.h"
#include "estimators/hbao.h"
#include "estimators/msvo.h"
#include "estimators/sao.h"
#include "estimators/ssao.h"
#include "estimators/ssao_fade.h"
#include "estimators/ssao_range.h"
#include "estimators/ssdo.h"
#include "estimators/trace.h"
#include "math/number.h"
#include "nearest_name.h"

namespace ssdo {
namespace {

std::vector<std::string> parameter_names(const Method& method) {
  std::vector<std::string> names;
  for (const Parameter& p : method.parameters) names.emplace_back(p.name);
  return names;
}

std::vector<std::string_view> words_of(const Parameter& parameter) {
  std::vector<std::string_view> words;
  for (std::string_view rest = parameter.words; !rest.empty();) {
    words.push_back(rest.substr(0, rest.find(' ')));
    rest.remove_prefix(std::min(words.back().size() + 1, rest.size()));
  }
  return words;
}

/// NaN for what is neither a word of the parameter nor a number.
double value_of(const Parameter& parameter, std::string_view text) {
  const std::vector<std::string_view> words = words_of(parameter);
  const auto word = std::find(words.begin(), words.end(), text);
  return word != words.end() ? double(word - words.begin()) : parse_number(text).value_or(NAN);
}

std::string describe_range(const Parameter& p) {
  if (!p.words.empty()) return fmt::format("{}", fmt::join(words_of(p), " or "));
  return fmt::format("{:g} to {:g}", p.low, p.high);
}

std::string describe_default(const Parameter& p) {
  if (!p.words.empty()) return std::string(words_of(p)[std::size_t(p.value)]);
  return fmt::format("{:g}", p.value);
}

}  // namespace

std::span<const Method> methods() {
  static const std::array all = {
      bitmask_method(),   trace_method(), ssdo_method(), ssao_method(), ssao_range_method(),
      ssao_fade_method(), hbao_method(),  gtao_method(), sao_method(),  msvo_method()};
  return all;
}

const Method& find_method(std::string_view name) {
  std::vector<std::string> names;
  for (const Method& method : methods()) {
    if (method.name == name) return method;
    names.emplace_back(method.name);
  }
  throw Error(ExitCode::usage, fmt::format("--method {}: no such method; {}there is {}", name,
                                           did_you_mean(name, names), fmt::join(names, ", ")));
}

const Method& reference_method() {
  const auto all = methods();
  return *std::find_if(all.begin(), all.end(), [](const Method& m) { return m.is_reference; });
}

bool makes(const Method& method, const Product& product) {
  return contains(method.products, product.made_of);
}

bool takes_lamps(const Method& method) { return method.supports.thickness; }

const Parameter* find_parameter(const Method& method, std::string_view name) {
  for (const Parameter& parameter : method.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

void check_value(const Parameter& parameter, double value, const std::string& written) {
  if (value >= parameter.low && value <= parameter.high &&
      (!parameter.whole || value == std::floor(value)))
    return;
  const std::string_view kind = !parameter.words.empty() ? ""
                                : parameter.whole        ? "whole numbers from "
                                                         : "values from ";
  throw Error(ExitCode::usage, fmt::format("{}: {} takes {}{}", written, parameter.name, kind,
                                           describe_range(parameter)));
}

ParameterValues resolve_parameters(const Method& method, const std::vector<std::string>& settings) {
  ParameterValues values;
  for (const Parameter& p : method.parameters) values[std::string(p.name)] = p.value;
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    const std::string name = setting.substr(0, equals);
    const Parameter* parameter = find_parameter(method, name);
    if (equals == std::string::npos || !parameter) {
      const std::vector<std::string> names = parameter_names(method);
      throw Error(ExitCode::usage,
                  fmt::format("--set {}: {}method {} has the parameters {}", setting,
                              parameter ? "expected NAME=VALUE; " : did_you_mean(name, names),
                              method.name, fmt::join(names, ", ")));
    }
    const double value = value_of(*parameter, std::string_view(setting).substr(equals + 1));
    check_value(*parameter, value, "--set " + setting);
    values[name] = value;
  }
  return values;
}

std::string describe_methods() {
  std::string text;
  for (const Method& method : methods()) {
    std::string products;
    for (const Product& product : kProducts) {
      if (product.in && method.products.*product.in)
        products += (products.empty() ? "" : ", ") + std::string(product.name);
    }
    text += fmt::format("{}  {}\n  products: {}\n  source filter: {}{}\n", method.name,
                        method.summary, products, method.published_filter.name,
                        method.published_filter.at_half_resolution
                            ? ", on the map at half resolution before it goes up"
                            : "");
    for (const Parameter& p : method.parameters) {
      text += fmt::format("  {:<20} {:>8}  {} {}  {}\n", p.name, describe_default(p),
                          describe_range(p), p.unit, p.meaning);
    }
  }
  return text;
}

}  // namespace ssdo
