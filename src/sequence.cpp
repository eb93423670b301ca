// SPDX-License-Identifier: Apache-2.0
//
// OpenImageIO 2.4.7 has functions of this kind in OIIO::Filesystem. They are not used, because:
//  - enumerate_sequence takes only x for a step (1-10:3 gives all ten), guesses at 1-10x-2 and
//    1-10x0, stops without an error at a space (1-3 7), repeats overlapping frames, and allocates
//    what the text asks for;
//  - parse_pattern makes #### sixteen digits, takes digits before it for a range, and of several
//    patterns sees one; enumerate_file_sequence ends the process at "100%.####.exr";
//  - scan_for_matching_filenames misses negative frames, cannot scan %d, and takes a.00007.exr for
//    a.%04d.exr.
#include "sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>
#include <unordered_set>

#include "error.h"

namespace ssdo {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Reads a list of frames from left to right.
class FrameList {
 public:
  explicit FrameList(const std::string& text) : text_(text), rest_(text) {}

  std::vector<int> read() {
    skip_spaces();
    read_range();
    while (true) {
      const bool space = skip_spaces();
      if (rest_.empty()) return std::move(frames_);
      if (take(",")) {
        skip_spaces();
      } else if (!space) {
        fail(fmt::format("cannot read on at '{}'", rest_));
      }
      read_range();
    }
  }

 private:
  [[noreturn]] void fail(const std::string& found) const {
    throw Error(ExitCode::usage, fmt::format("--frames '{}': {}; write frames and ranges as in "
                                             "1001-1010,1020-1030x2,7",
                                             text_, found));
  }

  bool skip_spaces() {
    const std::string_view before = rest_;
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_[0])))
      rest_.remove_prefix(1);
    return rest_.size() != before.size();
  }

  /// Takes one of `characters` with the spaces after it.
  bool take(std::string_view characters) {
    if (rest_.empty() || characters.find(rest_[0]) == characters.npos) return false;
    rest_.remove_prefix(1);
    return true;
  }

  int read_number() {
    int number = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
    if (error == std::errc::result_out_of_range) fail("a number is too large for a frame");
    if (error != std::errc())
      fail(rest_.empty() ? "a frame is missing at its end"
                         : fmt::format("'{}' is no frame", rest_));
    rest_.remove_prefix(std::size_t(end - rest_.data()));
    return number;
  }

  void read_range() {
    const int first = read_number();
    const bool space = skip_spaces();
    if (space && rest_.size() > 1 && rest_[0] == '-' && is_digit(rest_[1])) {
      fail(fmt::format("'{0} {1}' may be a range or two frames; write {0}{1} or {0},{1}", first,
                       rest_));
    }
    const bool range = take("-");
    if (range) skip_spaces();
    const int last = range ? read_number() : first;
    const std::string_view after = rest_;
    const bool more = skip_spaces();
    if (!take("x:")) {
      if (more) rest_ = after;  // this space separates
      return add(first, last, first <= last ? 1 : -1);
    }
    skip_spaces();
    const int step = read_number();
    if (!range) fail(fmt::format("a step of {} needs a range", step));
    if (step == 0) fail("a step of 0 never arrives");
    if (step < 0 && first <= last) fail(fmt::format("a step of {} leads away from {}", step, last));
    add(first, last, first <= last || step < 0 ? step : -std::int64_t(step));
  }

  void add(std::int64_t first, std::int64_t last, std::int64_t step) {
    constexpr std::int64_t kMost = 1'000'000;
    named_ += (last - first) / step + 1;
    if (named_ > kMost) fail(fmt::format("more than {} frames", kMost));
    for (std::int64_t frame = first; step > 0 ? frame <= last : frame >= last; frame += step) {
      if (seen_.insert(int(frame)).second) frames_.push_back(int(frame));
    }
  }

  const std::string& text_;
  std::string_view rest_;
  std::int64_t named_ = 0;
  std::vector<int> frames_;
  std::unordered_set<int> seen_;
};

}  // namespace

std::vector<int> parse_frames(const std::string& text) { return FrameList(text).read(); }

}  // namespace ssdo
