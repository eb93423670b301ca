// SPDX-License-Identifier: Apache-2.0
//
// Nothing of OpenImageIO's Filesystem is used here. Measured with 2.4.7:
//   enumerate_sequence           ignores the step of "1-10:3", takes "1-10x0" for a step of 1,
//                                drops the 7 of "1-3 7", accepts "1-3a", clamps what overflows
//   parse_pattern                makes "####" 16 digits wide, takes the digits of "sh010####" for a
//                                range, replaces the first of two patterns only
//   enumerate_file_sequence      ends the process at "%04d/beauty.%04d.exr"
//   scan_for_matching_filenames  misses negative frames, cannot scan "%d", takes a.00003.exr for
//                                "a.%04d.exr"

#include "io/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <unordered_set>
#include <utility>

#include "error.h"

namespace ssdo {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxFrames = 1'000'000;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// 64 bits, so that neither the length nor a step past the end overflows.
struct Range {
  std::int64_t first, last;
  std::int64_t step = 1;  ///< magnitude
  std::int64_t count() const { return std::abs(last - first) / step + 1; }
  int frame(std::int64_t i) const { return int(first + (first <= last ? i * step : -i * step)); }
};

/// Reads a list of frames from left to right.
class FrameListReader {
 public:
  explicit FrameListReader(std::string text) : text_(std::move(text)) {
    // A list may come out of `$(seq 5)`, and a message has one line.
    const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
    std::replace_if(text_.begin(), text_.end(), is_space, ' ');
  }

  std::vector<int> read() {
    do {
      append(read_range());
    } while (take_separator());
    return std::move(frames_);
  }

 private:
  Range read_range() {
    const int first = read_number();
    if (!take_dash()) return {first, first};
    Range range{first, read_number()};
    if (!take('x') && !take(':')) return range;
    const std::int64_t step = read_number();
    if (step == 0) fail("a step of 0 does not advance; use 1 or more");
    if (step < 0 && range.first < range.last) {
      fail(fmt::format("a step of {} leads away from {}; drop its minus", step, range.last));
    }
    range.step = std::abs(step);
    return range;
  }

  void append(const Range& range) {
    if (range.count() > kMaxFrames) fail_too_many();
    for (std::int64_t i = 0; i < range.count(); ++i) {
      const int frame = range.frame(i);
      if (seen_.insert(frame).second) frames_.push_back(frame);
    }
    if (std::int64_t(frames_.size()) > kMaxFrames) fail_too_many();
  }

  int read_number() {
    at_ = std::min(text_.find_first_not_of(' ', at_), text_.size());
    int number = 0;
    const char* const end = text_.data() + text_.size();
    const auto [next, error] = std::from_chars(text_.data() + at_, end, number);
    if (error == std::errc::result_out_of_range) fail("a number is beyond 32 bits");
    if (error != std::errc()) fail("expected a number");
    at_ = std::size_t(next - text_.data());
    return number;
  }

  /// Steps over `sign` and the spaces before it, where it is next.
  bool take(char sign) {
    const std::size_t next = text_.find_first_not_of(' ', at_);
    if (next == std::string::npos || text_[next] != sign) return false;
    at_ = next + 1;
    return true;
  }

  bool take_dash() {
    const std::size_t before = at_;
    if (!take('-')) return false;
    const bool apart = at_ > before + 1;
    const bool joined = at_ < text_.size() && is_digit(text_[at_]);
    if (apart && joined) {
      at_ = before;
      fail("may be a range or a negative frame; write 1-3 or 1,-3");
    }
    return true;
  }

  /// Whether another range follows.
  bool take_separator() {
    if (take(',')) return true;
    const std::size_t next = text_.find_first_not_of(' ', at_);
    if (next == std::string::npos) return false;
    if (next == at_) fail("expected a comma");
    return true;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    const std::string place = at_ < text_.size() ? "'" + text_.substr(at_) + "'" : "its end";
    fail_whole(fmt::format("at {}: {}", place, reason));
  }

  [[noreturn]] void fail_too_many() const {
    fail_whole(fmt::format("more than {} frames; split the job", kMaxFrames));
  }

  [[noreturn]] void fail_whole(const std::string& reason) const {
    throw Error(ExitCode::usage,
                fmt::format("--frames '{}': {}; a list is 1001-1010,1020-1030x2", text_, reason));
  }

  std::string text_;
  std::size_t at_ = 0;
  std::vector<int> frames_;
  std::unordered_set<int> seen_;
};

/// A piece of a path: literal text, or the frame number.
struct Piece {
  std::string text;
  int digits = 0;            ///< least digits of the number; 0: literal
  bool sign_counts = false;  ///< as in printf, the minus of a negative frame is one of the digits
};

bool has_pattern(const std::vector<Piece>& pieces) {
  return std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return p.digits > 0; });
}

std::string expand(const std::vector<Piece>& pieces, int frame) {
  std::string path;
  for (const Piece& p : pieces) {
    const int width = p.digits + (frame < 0 && !p.sign_counts ? 1 : 0);
    path += p.digits > 0 ? fmt::format("{:0{}}", frame, width) : p.text;
  }
  return path;
}

/// Literal text is kept in one piece, so that the first holds all that precedes the first number.
void append_literal(std::vector<Piece>& pieces, std::string_view text) {
  if (pieces.empty() || pieces.back().digits > 0) pieces.emplace_back();
  pieces.back().text += text;
}

/// Takes the `%` conversion that `text` begins with; returns its length, 0 for one that is refused.
std::size_t take_conversion(std::string_view text, std::vector<Piece>& pieces) {
  if (text.starts_with("%%")) {
    append_literal(pieces, "%");
    return 2;
  }
  if (text.starts_with("%d")) {
    pieces.push_back({"", 1});
    return 2;
  }
  // A name on disk has at most 255 bytes: two digits of width are enough.
  const std::size_t end = text.find_first_not_of("0123456789", 1);
  if (end == text.npos || end < 3 || end > 4) return 0;
  if (text[1] != '0' || text[2] == '0' || text[end] != 'd') return 0;
  pieces.push_back({"", std::stoi(std::string(text.substr(2, end - 2))), true});
  return end + 1;
}

[[noreturn]] void refuse_conversion(std::string_view text, const std::string& path) {
  throw Error(
      ExitCode::usage,
      fmt::format("{}: no frame pattern begins at '{}'; use ####, @, %d or %04d, %% for a percent "
                  "sign beside one, and %V or %v in outputs under --stereo",
                  path, text));
}

/// Adds the pieces of `text`, a component of `path`.
void append_component(std::vector<Piece>& pieces, std::string_view text, const std::string& path) {
  while (!text.empty()) {
    const char sign = text[0];
    std::size_t length = std::min(text.find_first_of("#@%"), text.size());
    if (length > 0) {
      append_literal(pieces, text.substr(0, length));
    } else if (sign == '%') {
      length = take_conversion(text, pieces);
      if (length == 0) refuse_conversion(text, path);
    } else {
      length = std::min(text.find_first_not_of(sign), text.size());
      pieces.push_back({"", sign == '#' && length == 1 ? 4 : int(length)});
    }
    text.remove_prefix(length);
  }
}

bool exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool is_file(const std::string& path) {
  std::error_code ignored;
  return exists(path) && !fs::is_directory(path, ignored);
}

std::vector<Piece> parse_pattern(const std::string& path) {
  std::vector<Piece> pieces;
  std::string_view rest = path;
  while (!rest.empty()) {
    // The slash stays with its folder: a file is not taken for one.
    const std::string component(rest.substr(0, std::min(rest.find('/'), rest.size() - 1) + 1));
    if (!has_pattern(pieces) && exists(expand(pieces, 0) + component)) {
      append_literal(pieces, component);
    } else {
      append_component(pieces, component, path);
    }
    rest.remove_prefix(component.size());
  }
  return pieces;
}

/// The frame whose path begins with `start`, a file or folder that exists, if there is one. Its
/// first number stands at `at`.
std::optional<int> match(const std::vector<Piece>& pieces, const std::string& start,
                         std::size_t at) {
  const std::size_t digits = at + (at < start.size() && start[at] == '-' ? 1 : 0);
  // Where digits follow the pattern ("b%d5"), the number may end before they do.
  for (std::size_t end = digits; end < start.size() && is_digit(start[end]); ++end) {
    int frame = 0;
    const auto [stop, error] = std::from_chars(&start[at], &start[end + 1], frame);
    if (error != std::errc()) break;
    const std::string path = expand(pieces, frame);
    if (path == start || path.starts_with(start + '/')) {
      return is_file(path) ? std::optional(frame) : std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<int> parse_frames(const std::string& text) { return FrameListReader(text).read(); }

bool is_pattern(const std::string& path) { return has_pattern(parse_pattern(path)); }

std::string expand_pattern(const std::string& path, int frame) {
  const auto pieces = parse_pattern(path);
  return has_pattern(pieces) ? expand(pieces, frame) : path;
}

std::vector<int> find_frames(const std::string& pattern) {
  const auto pieces = parse_pattern(pattern);
  if (!has_pattern(pieces)) return {};
  // The first number decides; the others, further down the path, are the same.
  const std::string& before = pieces[0].text;
  const std::string folder = before.substr(0, before.rfind('/') + 1);
  const std::string listed = folder.empty() ? "." : folder;
  std::vector<int> frames;
  if (!exists(listed)) return frames;
  std::error_code error;
  fs::directory_iterator entry(listed, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string start = folder + entry->path().filename().string();
    if (const auto frame = match(pieces, start, before.size())) frames.push_back(*frame);
  }
  if (error) {
    throw Error(ExitCode::input,
                fmt::format("{}: cannot list this folder ({}); check its permissions", listed,
                            error.message()));
  }
  std::sort(frames.begin(), frames.end());
  return frames;
}

}  // namespace ssdo
