// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "estimators/estimator.h"

namespace ssdo {

/// Every method, in the order of --list-methods. The first is the default.
std::span<const Method> methods();

/// Errors: ExitCode::usage with the names that exist.
const Method& find_method(std::string_view name);

/// The method that bench compares all others with.
const Method& reference_method();

/// Whether the method makes what the product is made of.
bool makes(const Method& method, const Product& product);

/// Whether a method takes light of lamps. It needs rays to the lamps, which methods without solids
/// do not trace: their ao says how much is open, not whether a lamp is visible.
bool takes_lamps(const Method& method);

/// Null where the method has none of that name.
const Parameter* find_parameter(const Method& method, std::string_view name);

/// `written` is what the user wrote, for the message.
/// Errors: ExitCode::usage for a value out of the parameter's range or that has no word.
void check_value(const Parameter& parameter, double value, const std::string& written);

/// The method's defaults with `settings` ("NAME=VALUE") laid over them; a value is a number or one
/// of the parameter's words. Errors: ExitCode::usage for a name the method does not have or a value
/// out of its range.
ParameterValues resolve_parameters(const Method& method, const std::vector<std::string>& settings);

/// The text of --list-methods.
std::string describe_methods();

}  // namespace ssdo
