// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "error.h"
#include "io/one_line.h"
#include "io/sequence.h"

namespace ssdo {
namespace {

constexpr std::string_view kCryptomatte = "crypto:", kIds = "id:";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// Whether the sign at `i` joins two terms, the first of which begins at `begin`.
bool joins(std::string_view text, std::size_t begin, std::size_t i) {
  if (text[i] == '+') return true;
  const std::string_view before = text.substr(begin, i - begin), behind = text.substr(i + 1);
  if (trimmed(before).empty()) return true;
  const std::string_view next = trimmed(behind);
  if (next.starts_with(kCryptomatte) || next.starts_with(kIds)) return true;
  // "id:L=-2" and "id:L=5-7" hold numbers.
  if (trimmed(before).starts_with(kIds) && before.find('=') != before.npos) {
    const std::string_view number = behind.starts_with('-') ? behind.substr(1) : behind;
    return is_digit(before.back()) ? number.empty() || !is_digit(number[0]) : before.back() == ' ';
  }
  return before.ends_with(' ');
}

/// A text between two signs, and the sign before it.
struct Piece {
  bool adds;
  std::string_view text;
};

std::vector<Piece> split(std::string_view text) {
  std::vector<Piece> pieces;
  bool adds = true, quoted = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    const bool sign = text[i] == '+' || text[i] == '-';
    if (quoted || !sign || !joins(text, begin, i)) continue;
    pieces.push_back({adds, trimmed(text.substr(begin, i - begin))});
    adds = text[i] == '+';
    begin = i + 1;
  }
  pieces.push_back({adds, trimmed(text.substr(begin))});
  return pieces;
}

/// Takes the file off the front of FILE:REST, if there is such a file or sequence.
std::string take_file(std::string& text) {
  for (auto colon = text.find(':'); colon != text.npos; colon = text.find(':', colon + 1)) {
    const std::string file = text.substr(0, colon);
    std::error_code ignored;
    const auto status = std::filesystem::status(file, ignored);
    if (file.empty() || !((exists(status) && !is_directory(status)) || is_pattern(file))) continue;
    text.erase(0, colon + 1);
    return file;
  }
  return {};
}

class TermParser {
 public:
  TermParser(const std::string& option, const std::string& text) : option_(option), text_(text) {}

  SelectionTerm parse(const Piece& piece) const {
    std::string rest(piece.text);
    std::erase(rest, '"');
    SelectionTerm term;
    term.adds = piece.adds;
    const auto take = [&](std::string_view prefix) {
      const bool is_it = rest.starts_with(prefix);
      if (is_it) rest.erase(0, prefix.size());
      return is_it;
    };
    if (take(kCryptomatte)) {
      term.kind = SelectionTerm::Kind::cryptomatte;
      term.file = take_file(rest);
      term.name = rest;
    } else if (take(kIds)) {
      term.kind = SelectionTerm::Kind::ids;
      term.file = take_file(rest);
      const auto equals = rest.rfind('=');
      if (equals == rest.npos) refuse("expected id:LAYER=1,5-7");
      term.layer = rest.substr(0, equals);
      term.ids = ids_of(std::string_view(rest).substr(equals + 1));
    } else {
      term.file = take_file(rest);
      term.layer = rest;
    }
    if (term.kind == SelectionTerm::Kind::cryptomatte ? term.name.empty() : term.layer.empty()) {
      refuse(
          "expected crypto:NAME, id:LAYER=1,5-7, LAYER or FILE:LAYER at the start and after "
          "each + and -");
    }
    return term;
  }

 private:
  [[noreturn]] void refuse(std::string_view what) const {
    throw Error(ExitCode::usage, fmt::format("{} {}: {}", option_, printable(text_), what));
  }

  std::vector<SelectionTerm::Range> ids_of(std::string_view list) const {
    std::vector<SelectionTerm::Range> ids;
    while (true) {
      const auto comma = list.find(',');
      const std::string_view one = trimmed(list.substr(0, comma));
      std::int64_t first = 0, last = 0;
      const char *at = one.data(), *end = at + one.size();
      auto [behind, fault] = std::from_chars(at, end, first);
      last = first;
      if (fault == std::errc() && behind != end && *behind == '-')
        std::tie(behind, fault) = parsed(behind + 1, end, last);
      if (fault != std::errc() || behind != end || last < first)
        refuse(fmt::format("'{}' is no id and no range of ids; expected such as 1,5-7",
                           printable(one)));
      ids.push_back({first, last});
      if (comma == list.npos) return ids;
      list.remove_prefix(comma + 1);
    }
  }

  static std::pair<const char*, std::errc> parsed(const char* at, const char* end,
                                                  std::int64_t& value) {
    const auto result = std::from_chars(at, end, value);
    return {result.ptr, result.ec};
  }

  const std::string &option_, &text_;
};

}  // namespace

Selection parse_selection(const std::string& option, const std::string& text) {
  Selection selection{option, text, {}};
  for (const Piece& piece : split(text))
    selection.terms.push_back(TermParser(option, text).parse(piece));
  return selection;
}

Selection at_frame(Selection selection, int frame) {
  for (SelectionTerm& term : selection.terms) term.file = expand_pattern(term.file, frame);
  return selection;
}

}  // namespace ssdo
