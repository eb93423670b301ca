// SPDX-License-Identifier: Apache-2.0
#include "support/exr_bytes.h"

#include <cstring>
#include <fstream>
#include <stdexcept>

#include "support/run_tool.h"

namespace ssdo::test {

ExrBytes::ExrBytes(const std::filesystem::path& file) : bytes_(read_file(file)) {}

/// The first chunk follows the table, whose first place is therefore that of its own end.
std::size_t ExrBytes::table(std::size_t chunks) const {
  const std::size_t table_bytes = 8 * chunks;
  for (std::size_t place = 8; place + table_bytes < bytes_.size(); ++place) {
    std::uint64_t first;
    std::memcpy(&first, &bytes_[place], 8);
    if (first == place + table_bytes) return place;
  }
  throw std::runtime_error("no table of chunks");
}

std::vector<std::uint64_t> ExrBytes::places(std::size_t chunks) const {
  std::vector<std::uint64_t> places(chunks);
  std::memcpy(places.data(), &bytes_[table(chunks)], 8 * chunks);
  return places;
}

std::size_t ExrBytes::place_of(const std::string& name) const {
  const std::size_t place = bytes_.find(name + '\0');
  if (place == bytes_.npos) throw std::runtime_error("nothing is called " + name);
  return place;
}

std::size_t ExrBytes::size_of(const std::string& attribute) const {
  const std::size_t name = place_of(attribute);
  return bytes_.find('\0', name + attribute.size() + 1) + 1;  // after its type
}

std::size_t ExrBytes::value_of(const std::string& attribute) const {
  return size_of(attribute) + 4;
}

void ExrBytes::put_text(std::size_t place, const std::string& text) {
  bytes_.replace(place, text.size(), text);
}

void ExrBytes::put_int(std::size_t place, std::int32_t value) {
  std::memcpy(&bytes_.at(place), &value, 4);
}

void ExrBytes::put_place(std::size_t place, std::uint64_t value) {
  std::memcpy(&bytes_.at(place), &value, 8);
}

void ExrBytes::write(const std::filesystem::path& file) const {
  std::ofstream(file, std::ios::binary) << bytes_;
}

}  // namespace ssdo::test
