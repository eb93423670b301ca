// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <functional>
#include <string>

#include "error.h"

namespace ssdo::test {

/// What `action` throws as an ssdo::Error; a failure if it throws none, or a message of many lines.
Error error_of(const std::function<void()>& action);

/// Matches an ssdo::Error by its exit code and a part of its message.
MATCHER_P2(IsError, code, text, "") {
  *result_listener << "exit code " << int(arg.code) << ", message '" << arg.what() << "'";
  return arg.code == code && std::string(arg.what()).find(text) != std::string::npos;
}

/// Matches what the tool says about a frame if it warns of nothing but how much is guessed, which
/// begins with a number.
MATCHER(WarnsOfNothing, "") {
  return !testing::Value(arg, testing::ContainsRegex("warning +[^0-9 ]"));
}

}  // namespace ssdo::test
