// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/object_hash.h"

#include <gtest/gtest.h>

#include "scene/objects/cryptomatte.h"

namespace ssdo::test::object_hash_test {
namespace {

/// Values of the reference implementation, of every length modulo 4.
TEST(ObjectHash, IsMurmur3OfTheSeedZero) {
  EXPECT_EQ(murmur3_32(""), 0u);
  EXPECT_EQ(murmur3_32("a"), 0x3c2569b2u);
  EXPECT_EQ(murmur3_32("abc"), 0xb3dd93fau);
  EXPECT_EQ(murmur3_32("test"), 0xba6bd213u);
  EXPECT_EQ(murmur3_32("Hello, world!"), 0xc0363e43u);
  EXPECT_EQ(murmur3_32("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

/// No id may be a denormal, infinite or not-a-number, so that it passes through any program.
TEST(ObjectHash, HasAnExponentThatAFloatKeeps) {
  int flipped = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string name = "object" + std::to_string(i);
    const std::uint32_t id = cryptomatte_id(name), exponent = id >> 23 & 255;
    EXPECT_NE(exponent, 0u);
    EXPECT_NE(exponent, 255u);
    flipped += id != murmur3_32(name);
    if (id != murmur3_32(name)) {
      EXPECT_EQ(id ^ murmur3_32(name), 1u << 23);
    }
  }
  EXPECT_GT(flipped, 50);
}

TEST(ObjectHash, IsThatOfBlender) {
  const ExrReader file(std::string(SSDO_SOURCE_DIR) + "/data/objects.exr");
  const std::vector<Cryptomatte> all = find_cryptomattes(file, "");
  ASSERT_EQ(all.size(), 3u);
  for (const Cryptomatte& matte : all) {
    EXPECT_EQ(matte.ranks.size(), 6u) << matte.name;
    EXPECT_GT(matte.ids.size(), 5u) << matte.name;
    for (const auto& [name, id] : matte.ids) EXPECT_EQ(cryptomatte_id(name), id) << name;
  }
}

}  // namespace
}  // namespace ssdo::test::object_hash_test
