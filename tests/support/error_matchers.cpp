// SPDX-License-Identifier: Apache-2.0
#include "support/error_matchers.h"

namespace ssdo::test {

Error error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error;
  }
  ADD_FAILURE() << "expected an ssdo::Error";
  return Error(ExitCode::done, "");
}

}  // namespace ssdo::test
