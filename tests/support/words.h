// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace ssdo::test {

/// Arguments of a command line.
using Words = std::vector<std::string>;

/// `b` behind `a`.
inline Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace ssdo::test
