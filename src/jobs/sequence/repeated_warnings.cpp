// SPDX-License-Identifier: Apache-2.0
#include "jobs/sequence/repeated_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

namespace ssdo {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Whether a number begins a word, so that it stands for itself; others belong to names.
bool is_number_at(std::string_view text, std::size_t at) {
  if (at > 0 && text[at - 1] != ' ' && text[at - 1] != '(') return false;
  const std::size_t digit = text[at] == '-' ? at + 1 : at;
  return digit < text.size() && is_digit(text[digit]);
}

/// What warnings of one kind have in common: the text without its numbers, and without that of the
/// frame in names of files.
std::string kind_of(std::string_view text, int number) {
  const std::string own = fmt::format("{}", std::abs(std::int64_t(number)));
  const auto end_of = [&](std::size_t at, std::string_view characters) {
    return std::min(text.find_first_not_of(characters, at), text.size());
  };
  std::string kind;
  for (std::size_t i = 0, end; i < text.size(); i = end) {
    const std::size_t past = end_of(i, "0123456789.eE+-");
    const bool is_whole_word = past == text.size() || std::string_view(" ,;:)%").find(text[past]) !=
                                                          std::string_view::npos;
    const bool counts = is_whole_word && is_number_at(text, i);
    end = counts ? past : end_of(i, "0123456789");
    if (end == i) {
      kind += text[end++];
      continue;
    }
    std::string_view digits = text.substr(i, end - i);
    const std::string_view rest = text.substr(end, text.find(' ', end) - end);
    const bool in_file_name = rest.find('.') != rest.npos && rest.find('/') == rest.npos;
    const bool is_own = in_file_name && digits.substr(std::min(digits.find_first_not_of('0'),
                                                               digits.size() - 1)) == own;
    kind += counts || is_own ? "#" : digits;
  }
  return kind;
}

}  // namespace

bool RepeatedWarnings::add(std::size_t place, int number, const std::string& warning) {
  const auto [at, is_new] = index_.try_emplace(kind_of(warning, number), kinds_.size());
  if (is_new) kinds_.push_back({warning});
  Kind& kind = kinds_[at->second];
  kind.varies |= warning != kind.first;
  kind.frames[place] = number;
  return kind.frames.begin()->first == place;
}

std::vector<std::string> RepeatedWarnings::summary() const {
  std::vector<std::string> lines;
  for (const Kind& kind : kinds_) {
    if (kind.frames.size() < 2) continue;
    const std::string own = kind.varies ? ", with numbers of their own" : "";
    lines.push_back(fmt::format("{}: {}{}", kind.first, text_of(kind.frames), own));
  }
  return lines;
}

}  // namespace ssdo
