// SPDX-License-Identifier: Apache-2.0
#include "fuzz/exr_layout.h"

#include <algorithm>

namespace ssdo::fuzz {
namespace {

constexpr std::uint32_t kTiledFlag = 0x200, kDeepFlag = 0x800, kPartsFlag = 0x1000;

std::uint32_t flags_of(const ExrLayout& layout) {
  return number_at<std::uint32_t>(layout.start, 4);
}

/// Reads one piece after another; what lies beyond the end is empty and ends it.
class Pieces {
 public:
  explicit Pieces(std::string_view bytes) : bytes_(bytes) {}

  std::string take(std::size_t count) {
    if (count > bytes_.size() - place_) return fail();
    place_ += count;
    return std::string(bytes_.substr(place_ - count, count));
  }
  std::string take_text() {
    const std::size_t end = bytes_.find('\0', place_);
    if (end == std::string_view::npos) return fail();
    std::string text = take(end - place_);
    ++place_;
    return text;
  }
  template <class Number>
  Number take_number() {
    const std::string piece = take(sizeof(Number));
    return piece.empty() ? Number(0) : number_at<Number>(piece, 0);
  }
  std::size_t place() const { return place_; }
  bool ended() const { return ended_; }

 private:
  std::string fail() {
    ended_ = true;
    return {};
  }

  std::string_view bytes_;
  std::size_t place_ = 0;
  bool ended_ = false;
};

/// Up to the empty name that ends a header; the last of several headers is empty.
std::vector<RawAttribute> take_header(Pieces& pieces) {
  std::vector<RawAttribute> header;
  while (!pieces.ended()) {
    RawAttribute attribute{pieces.take_text(), {}, {}};
    if (attribute.name.empty()) break;
    attribute.type = pieces.take_text();
    attribute.value = pieces.take(pieces.take_number<std::uint32_t>());
    header.push_back(std::move(attribute));
  }
  return header;
}

/// The table, which ends where the first chunk begins.
std::vector<std::uint64_t> take_table(Pieces& pieces) {
  std::vector<std::uint64_t> table;
  std::uint64_t first = ~std::uint64_t(0);
  while (!pieces.ended() && pieces.place() < first) {
    table.push_back(pieces.take_number<std::uint64_t>());
    if (table.back() > pieces.place()) first = std::min(first, table.back());
  }
  return table;
}

}  // namespace

bool ExrLayout::has_many_parts() const { return (flags_of(*this) & kPartsFlag) != 0; }

const std::vector<RawAttribute>& ExrLayout::header_of(const std::string& chunk) const {
  if (!has_many_parts() || chunk.size() < 4) return headers.front();
  return headers[number_at<std::uint32_t>(chunk, 0) % headers.size()];
}

bool ExrLayout::is_deep(const std::string& chunk) const {
  return (flags_of(*this) & kDeepFlag) != 0 &&
         value_of(header_of(chunk), "type").starts_with("deep");
}

std::size_t ExrLayout::sizes_of(const std::string& chunk) const {
  const std::string_view type = value_of(header_of(chunk), "type");
  const bool tiled =
      type.empty() ? (flags_of(*this) & kTiledFlag) != 0 : type.find("tile") != type.npos;
  return (has_many_parts() ? 4 : 0) + (tiled ? 16 : 4);
}

std::string_view value_of(const std::vector<RawAttribute>& header, std::string_view name) {
  const auto found = std::find_if(header.begin(), header.end(),
                                  [&](const RawAttribute& a) { return a.name == name; });
  return found == header.end() ? std::string_view() : found->value;
}

std::optional<ExrLayout> take_apart(std::string_view bytes) {
  Pieces pieces(bytes);
  ExrLayout layout{pieces.take(8), {}, {}};
  if (pieces.ended()) return std::nullopt;
  do {
    layout.headers.push_back(take_header(pieces));
  } while (layout.has_many_parts() && !layout.headers.back().empty());
  if (layout.has_many_parts()) layout.headers.pop_back();
  const std::vector<std::uint64_t> table = take_table(pieces);
  if (pieces.ended() || layout.headers.empty()) return std::nullopt;
  std::vector<std::uint64_t> ends = table;
  ends.push_back(bytes.size());
  std::sort(ends.begin(), ends.end());
  for (const std::uint64_t begin : table) {
    const auto end = std::upper_bound(ends.begin(), ends.end(), begin);
    const bool there = begin >= pieces.place() && end != ends.end() && *end <= bytes.size();
    layout.chunks.emplace_back(there ? bytes.substr(begin, *end - begin) : std::string_view());
  }
  return layout;
}

std::string put_together(const ExrLayout& layout) {
  std::string out = layout.start;
  for (const std::vector<RawAttribute>& header : layout.headers) {
    for (const auto& [name, type, value] : header)
      out += name + '\0' + type + '\0' + stored(std::uint32_t(value.size())) + value;
    out += '\0';
  }
  if (layout.has_many_parts()) out += '\0';
  std::uint64_t place = out.size() + 8 * layout.chunks.size();
  for (const std::string& chunk : layout.chunks) {
    out += stored(chunk.empty() ? std::uint64_t(0) : place);
    place += chunk.size();
  }
  for (const std::string& chunk : layout.chunks) out += chunk;
  return out;
}

}  // namespace ssdo::fuzz
