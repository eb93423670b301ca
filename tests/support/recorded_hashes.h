// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "math/plane.h"

namespace ssdo::test {

/// The table tests/recorded_hashes.txt: a line for each output, with the hash of its bits by one
/// lane and by vectors. NEON, AVX2 and AVX-512 have the same.
class RecordedHashes {
 public:
  RecordedHashes();

  /// Tells the test that runs if the bits of `output` by an instruction set are others than those
  /// recorded, or none are. With $SSDO_WRITE_TABLES, they are to be recorded instead.
  void expect(const std::string& output, const std::string& isa, const std::string& hash);

  /// With $SSDO_WRITE_TABLES, writes the table anew, of the outputs that were expected.
  void write() const;

 private:
  struct Row {
    std::string scalar, vectors;
  };
  std::map<std::string, Row> recorded_, found_;
};

/// The hash of a plane's values, byte by byte.
std::string hash_of(const void* values, std::size_t bytes);

template <class T>
std::string hash_of(const Plane<T>& plane) {
  return hash_of(plane.pixels.data(), plane.size() * sizeof(T));
}

}  // namespace ssdo::test
