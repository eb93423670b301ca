// SPDX-License-Identifier: Apache-2.0
//
// What each *_fuzz.cpp defines, and the rest of it, which libFuzzer calls.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fuzz/chance.h"
#include "fuzz/memory_file.h"

namespace ssdo::fuzz {

/// Reads an input as the tool does.
void read_input(Bytes input);

/// The last two bytes of an input, by which targets choose options; 0 where there are none.
inline unsigned tail_of(Bytes input) {
  return input.size() < 2 ? 0 : input.back() + 256u * input[input.size() - 2];
}

/// Inputs to begin with, one of every kind that the target tells apart.
std::vector<std::string> seeds();

/// Calls `read`, which may refuse its input as the tool refuses files: with an Error whose code is
/// for inputs. Every other exception would reach the user as the text of a library and without a
/// hint: it ends the process as a crash does.
void may_refuse(const std::function<void()>& read);

/// Ends the process as a finding where `holds` is false.
void require(bool holds, const char* what);

}  // namespace ssdo::fuzz
