// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace ssdo::test {

/// The bytes of an EXR that a test breaks. Numbers are little endian.
class ExrBytes {
 public:
  explicit ExrBytes(const std::filesystem::path& file);

  /// `chunks` are those of all parts together: where each begins, and where the table of these
  /// places stands.
  std::vector<std::uint64_t> places(std::size_t chunks) const;
  std::size_t table(std::size_t chunks) const;

  /// Where the value of the first attribute of this name begins, and the place of its size.
  std::size_t value_of(const std::string& attribute) const;
  std::size_t size_of(const std::string& attribute) const;

  /// Where the first name of this text stands.
  std::size_t place_of(const std::string& name) const;

  void put_text(std::size_t place, const std::string& text);
  void put_int(std::size_t place, std::int32_t value);
  void put_place(std::size_t place, std::uint64_t value);

  void cut(std::size_t bytes) { bytes_.resize(bytes); }
  void append(const std::string& bytes) { bytes_ += bytes; }
  std::string slice(std::size_t begin, std::size_t end) const {
    return bytes_.substr(begin, end - begin);
  }
  void write(const std::filesystem::path& file) const;
  std::size_t size() const { return bytes_.size(); }

 private:
  std::string bytes_;
};

}  // namespace ssdo::test
