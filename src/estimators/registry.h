// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "estimators/estimator.h"

namespace ssdo {

/// Every method, in the order of --list-methods.
std::span<const Method> methods();

/// Errors: ExitCode::usage with the names that exist.
const Method& find_method(std::string_view name);

/// The method's defaults with `settings` ("NAME=VALUE") laid over them.
/// Errors: ExitCode::usage for a name the method does not have or a value out of its range.
ParameterValues resolve_parameters(const Method& method, const std::vector<std::string>& settings);

/// The text of --list-methods.
std::string describe_methods();

}  // namespace ssdo
