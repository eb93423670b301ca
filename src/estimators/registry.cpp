// SPDX-License-Identifier: Apache-2.0
#include "estimators/registry.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "error.h"
#include "estimators/bitmask.h"
#include "estimators/gtao.h"
#include "estimators/msvo.h"
#include "estimators/sao.h"
#include "estimators/ssao.h"
#include "estimators/ssao_fade.h"
#include "estimators/ssao_range.h"
#include "estimators/ssdo.h"
#include "math/number.h"

namespace ssdo {
namespace {

std::string parameter_names(const Method& method) {
  std::string names;
  for (const Parameter& p : method.parameters)
    names += (names.empty() ? "" : ", ") + std::string(p.name);
  return names;
}

}  // namespace

std::span<const Method> methods() {
  static const std::array all = {bitmask_method(),    ssdo_method(),      ssao_method(),
                                 ssao_range_method(), ssao_fade_method(), sao_method(),
                                 msvo_method(),       gtao_method()};
  return all;
}

const Method& find_method(std::string_view name) {
  std::string names;
  for (const Method& method : methods()) {
    if (method.name == name) return method;
    names += (names.empty() ? "" : ", ") + std::string(method.name);
  }
  throw Error(ExitCode::usage,
              fmt::format("--method {}: no such method; there is {}", name, names));
}

ParameterValues resolve_parameters(const Method& method, const std::vector<std::string>& settings) {
  ParameterValues values;
  for (const Parameter& p : method.parameters) values[std::string(p.name)] = p.value;
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    const std::string name = setting.substr(0, equals);
    const Parameter* parameter = nullptr;
    for (const Parameter& p : method.parameters) {
      if (p.name == name) parameter = &p;
    }
    if (equals == std::string::npos || !parameter) {
      throw Error(ExitCode::usage, fmt::format("--set {}: method {} has the parameters {}", setting,
                                               method.name, parameter_names(method)));
    }
    const auto value = parse_number(std::string_view(setting).substr(equals + 1));
    if (!value || *value < parameter->low || *value > parameter->high ||
        (parameter->whole && *value != std::floor(*value))) {
      throw Error(ExitCode::usage, fmt::format("--set {}: {} takes {} from {:g} to {:g}", setting,
                                               name, parameter->whole ? "whole numbers" : "values",
                                               parameter->low, parameter->high));
    }
    values[name] = *value;
  }
  return values;
}

std::string describe_methods() {
  std::string text;
  for (const Method& method : methods()) {
    const ProductSet& can = method.products;
    text += fmt::format("{}  {}\n  products: ao{}{}{}{}{}\n", method.name, method.summary,
                        can.bent ? ", bent" : "", can.reflection ? ", reflection" : "",
                        can.direct ? ", direct" : "", can.bounce ? ", bounce" : "",
                        can.error ? ", error" : "");
    for (const Parameter& p : method.parameters) {
      text += fmt::format("  {:<20} {:>8g}  {:g} to {:g} {}  {}\n", p.name, p.value, p.low, p.high,
                          p.unit, p.meaning);
    }
  }
  return text;
}

}  // namespace ssdo
