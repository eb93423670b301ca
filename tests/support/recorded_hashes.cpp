// SPDX-License-Identifier: Apache-2.0
#include "support/recorded_hashes.h"

#include <OpenImageIO/hash.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace ssdo::test {
namespace {

const std::string kFile = std::string(SSDO_SOURCE_DIR) + "/tests/recorded_hashes.txt";

constexpr char kHead[] =
    "# What every method makes of tests/support/fixed_frame.h, as the hash of its bits by one "
    "lane\n"
    "# and by vectors: same_bits_test.cpp, which SSDO_WRITE_TABLES=1 has write this file.\n";

bool writes_tables() { return std::getenv("SSDO_WRITE_TABLES") != nullptr; }

}  // namespace

RecordedHashes::RecordedHashes() {
  std::ifstream in(kFile);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    std::string output;
    words >> output;
    words >> recorded_[output].scalar >> recorded_[output].vectors;
  }
}

void RecordedHashes::expect(const std::string& output, const std::string& isa,
                            const std::string& hash) {
  const auto place = isa == "scalar" ? &Row::scalar : &Row::vectors;
  std::string& found = found_[output].*place;
  EXPECT_TRUE(found.empty() || found == hash) << output << ": vectors have other bits";
  found = hash;
  if (writes_tables()) return;
  EXPECT_EQ(recorded_[output].*place, hash)
      << output << " by " << isa
      << " has other bits than tests/recorded_hashes.txt. If a change of "
      << "the method is meant, run this test with SSDO_WRITE_TABLES=1, commit the table, and say "
         "in "
      << "CHANGELOG.md what changes. If not, a compiler, a library or the order of work has "
         "changed "
      << "them";
}

void RecordedHashes::write() const {
  if (!writes_tables()) return;
  std::ofstream out(kFile);
  out << kHead;
  for (const auto& [output, row] : found_)
    out << fmt::format("{:<34} {} {}\n", output, row.scalar, row.vectors);
}

std::string hash_of(const void* values, std::size_t bytes) {
  return fmt::format("{:016x}", OIIO::xxhash::xxhash(values, bytes));
}

}  // namespace ssdo::test
