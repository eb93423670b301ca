// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ssdo::fuzz {

/// An attribute of a header, its value as stored.
struct RawAttribute {
  std::string name, type, value;
};

/// An EXR in its pieces, to change one and put the others around it again: the table of chunks and
/// sizes come right. (OpenEXR file layout.)
struct ExrLayout {
  std::string start;  ///< magic number, version and flags
  std::vector<std::vector<RawAttribute>> headers;
  std::vector<std::string> chunks;  ///< in the order of the table; empty: missing

  bool has_many_parts() const;

  /// The header of the part that a chunk belongs to.
  const std::vector<RawAttribute>& header_of(const std::string& chunk) const;

  bool is_deep(const std::string& chunk) const;

  /// Where the sizes of a chunk stand, behind the part and the place that it is for: a flat one has
  /// the size of its data (32 bits); a deep one those of its table of samples, of its samples, and
  /// of them unpacked (64 bits each). What has these sizes follows.
  std::size_t sizes_of(const std::string& chunk) const;
};

/// The value of an attribute; empty where there is none.
std::string_view value_of(const std::vector<RawAttribute>& header, std::string_view name);

/// Nothing for bytes that are no EXR up to its table of chunks.
std::optional<ExrLayout> take_apart(std::string_view bytes);

std::string put_together(const ExrLayout& layout);

/// A number as it stands in a file, and back. `bytes` holds at least as many.
template <class Number>
std::string stored(Number number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}
template <class Number>
Number number_at(std::string_view bytes, std::size_t place) {
  Number number;
  bytes.copy(reinterpret_cast<char*>(&number), sizeof number, place);
  return number;
}

}  // namespace ssdo::fuzz
