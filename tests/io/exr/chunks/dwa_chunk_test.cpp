// SPDX-License-Identifier: Apache-2.0
#include "io/exr/chunks/dwa_chunk.h"

#include <gmock/gmock.h>
#include <libdeflate.h>

#include <array>
#include <cmath>
#include <cstring>
#include <memory>

#include "io/exr/exr_reader.h"
#include "support/error_matchers.h"
#include "support/exr_bytes.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::dwa_chunk_test {
namespace {

constexpr int kWidth = 64, kHeight = 32;

std::string bytes_of(std::uint64_t number, std::size_t size) {
  std::string bytes;
  for (std::size_t i = 0; i < size; ++i) bytes += char(number >> 8 * i & 255);
  return bytes;
}

std::string deflated_zeros(std::size_t count) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> deflate(
      libdeflate_alloc_compressor(6), libdeflate_free_compressor);
  const std::string zeros(count, '\0');
  std::string packed(libdeflate_zlib_compress_bound(deflate.get(), count), '\0');
  packed.resize(
      libdeflate_zlib_compress(deflate.get(), zeros.data(), count, packed.data(), packed.size()));
  return packed;
}

/// A chunk that claims to be nothing but `count` bytes that are deflated.
std::string deflated_chunk(std::uint64_t version, std::size_t count) {
  const std::string packed = deflated_zeros(count);
  std::array<std::uint64_t, 11> numbers = {version, count, packed.size()};
  std::string chunk;
  for (const std::uint64_t number : numbers) chunk += bytes_of(number, 8);
  if (version == 2) chunk += bytes_of(2, 2);
  return chunk + packed;
}

std::span<const std::byte> as_span(const std::string& bytes) {
  return std::as_bytes(std::span(bytes));
}

class DwaChunks : public testing::Test {
 protected:
  void write(const std::vector<TestChannel>& channels) const {
    write_test_exr(dir_ / "a.exr", {test_header({{0, 0}, {kWidth - 1, kHeight - 1}}, channels,
                                                Imf::DWAA_COMPRESSION)});
  }

  /// The bytes of the only chunk of a file with these channels.
  std::string chunk_of(const std::vector<TestChannel>& channels) const {
    write(channels);
    const ExrBytes bytes(dir_ / "a.exr");
    return bytes.slice(bytes.places(1)[0] + 8, bytes.size());
  }

  /// Reads the first channel, with another chunk.
  void read_with(const std::vector<TestChannel>& channels, const std::string& chunk) const {
    write(channels);
    ExrBytes bytes(dir_ / "a.exr");
    const std::size_t place = bytes.places(1)[0];
    bytes.cut(place + 8);
    bytes.put_int(place + 4, int(chunk.size()));
    bytes.append(chunk);
    bytes.write(dir_ / "a.exr");
    const std::vector<std::string> names = {channels[0].name};
    ExrReader(dir_ / "a.exr").read(0, names);
  }

  Error error_with(const std::vector<TestChannel>& channels, const std::string& chunk) const {
    return error_of([&] { read_with(channels, chunk); });
  }

  TempDir dir_;
};

const auto kShort = IsError(ExitCode::input, "a chunk holds fewer bytes than its pixels take");
constexpr std::size_t kPixels = kWidth * kHeight;

TEST_F(DwaChunks, SayHowChannelsAreStored) {
  const std::string bytes = chunk_of(
      {{"A", Imf::HALF}, {"Z"}, {"x.B", Imf::HALF}, {"x.G", Imf::HALF}, {"x.R", Imf::HALF}, {"Y"}});
  const auto chunk = read_dwa_chunk(as_span(bytes));
  ASSERT_TRUE(chunk);
  EXPECT_EQ(chunk->runs, 2 * kPixels);
  EXPECT_EQ(chunk->blocks, 4 * kPixels / 64);
  EXPECT_TRUE(chunk->has_coefficients);
  const auto scheme = [&](const std::string& name, Imf::PixelType type) {
    return scheme_of({name, type}, chunk->rules);
  };
  EXPECT_EQ(scheme("A", Imf::HALF), DwaScheme::runs);
  EXPECT_EQ(scheme("x.A", Imf::HALF), DwaScheme::runs);
  EXPECT_EQ(scheme("a", Imf::HALF), DwaScheme::deflated);
  EXPECT_EQ(scheme("x.R", Imf::HALF), DwaScheme::transformed);
  EXPECT_EQ(scheme("x.R", Imf::UINT), DwaScheme::deflated);
  EXPECT_EQ(scheme("Z", Imf::FLOAT), DwaScheme::deflated);
}

TEST_F(DwaChunks, BeforeVersion2HaveRulesThatIgnoreCase) {
  const auto chunk = read_dwa_chunk(as_span(deflated_chunk(1, 4)));
  ASSERT_TRUE(chunk);
  EXPECT_EQ(scheme_of({"x.Red", Imf::HALF}, chunk->rules), DwaScheme::transformed);
  EXPECT_EQ(scheme_of({"a", Imf::UINT}, chunk->rules), DwaScheme::runs);
  EXPECT_EQ(scheme_of({"R", Imf::UINT}, chunk->rules), DwaScheme::deflated);
}

TEST_F(DwaChunks, TheLastRuleThatMatchesDecides) {
  const std::vector<DwaRule> rules = {{"Z", Imf::FLOAT, DwaScheme::runs, false},
                                      {"z", Imf::FLOAT, DwaScheme::transformed, true},
                                      {"z", Imf::FLOAT, DwaScheme::deflated, false}};
  EXPECT_EQ(scheme_of({"Z", Imf::FLOAT}, rules), DwaScheme::transformed);
}

TEST_F(DwaChunks, OfNoMeaningAreNothing) {
  const std::string whole = chunk_of({{"A", Imf::HALF}, {"Z"}});
  for (const std::size_t size : {0, 87, 88, 89, 92})
    EXPECT_FALSE(read_dwa_chunk(as_span(whole.substr(0, size)))) << size;
  EXPECT_TRUE(read_dwa_chunk(as_span(whole)));
}

TEST_F(DwaChunks, WithoutASubsampledChannelHoldFewerBytes) {
  const std::vector<TestChannel> channels = {{"P.X"}, {"P.Z"}, {"sub", Imf::HALF, 2}};
  EXPECT_THAT(error_with(channels, deflated_chunk(2, 8 * kPixels)), kShort);
  write(channels);
  const ExrReader whole(dir_ / "a.exr");
  EXPECT_EQ(whole.read(0, std::vector<std::string>{"P.Z"})[0](5, 6), float(test_value(1, 5, 6)));
}

TEST_F(DwaChunks, OfAsManyBytesButStoredInAnotherWayHoldFewer) {
  EXPECT_THAT(error_with({{"Z"}, {"A", Imf::HALF}}, deflated_chunk(1, 6 * kPixels)), kShort);
  EXPECT_THAT(error_with({{"Z"}, {"Y", Imf::HALF}}, deflated_chunk(1, 6 * kPixels)), kShort);
}

// The means of blocks stand at the end of a chunk of nothing but such channels. OpenEXR compares
// how many there are with what the chunk says, not with the pixels.
TEST_F(DwaChunks, OfFewerBlocksHoldFewerBytes) {
  const std::vector<TestChannel> channels = {{"Y", Imf::HALF}};
  const std::string whole = chunk_of(channels);
  const auto with_means = [&](std::size_t count) {
    constexpr std::size_t kPackedSize = 8 * 4, kCount = 8 * 9;
    std::uint64_t size = 0;
    std::memcpy(&size, &whole[kPackedSize], sizeof size);
    const std::string means = deflated_zeros(2 * count);
    std::string chunk = whole.substr(0, whole.size() - size) + means;
    chunk.replace(kPackedSize, 8, bytes_of(means.size(), 8));
    return chunk.replace(kCount, 8, bytes_of(count, 8));
  };
  EXPECT_NO_THROW(read_with(channels, with_means(kPixels / 64)));
  EXPECT_THAT(error_with(channels, with_means(kPixels / 64 - 1)), kShort);
}

}  // namespace
}  // namespace ssdo::test::dwa_chunk_test
