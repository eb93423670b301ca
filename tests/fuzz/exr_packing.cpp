// SPDX-License-Identifier: Apache-2.0
#include "fuzz/exr_packing.h"

#include <ImfCompression.h>
#include <libdeflate.h>

#include <algorithm>
#include <memory>

// What ZIP and RLE pack: the bytes with even places before those with odd ones, each the difference
// to the one before, plus 128. (OpenEXR file layout.)

namespace ssdo::fuzz {
namespace {

std::string from_differences(std::string bytes) {
  for (std::size_t i = 1; i < bytes.size(); ++i) bytes[i] = char(bytes[i - 1] + bytes[i] - 128);
  std::string out(bytes.size(), '\0');
  const std::size_t evens = (bytes.size() + 1) / 2;
  for (std::size_t i = 0; i < bytes.size(); ++i) out[i] = bytes[i % 2 == 0 ? i / 2 : evens + i / 2];
  return out;
}

std::string to_differences(const std::string& pixels) {
  const std::size_t evens = (pixels.size() + 1) / 2;
  std::string bytes(pixels.size(), '\0');
  for (std::size_t i = 0; i < pixels.size(); ++i)
    bytes[i % 2 == 0 ? i / 2 : evens + i / 2] = pixels[i];
  for (std::size_t i = bytes.size(); i-- > 1;) bytes[i] = char(bytes[i] - bytes[i - 1] + 128);
  return bytes;
}

std::optional<std::string> inflate(const std::string& data) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflater(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  std::string out(std::size_t(1) << 18, '\0');
  std::size_t size = 0;
  if (libdeflate_zlib_decompress(inflater.get(), data.data(), data.size(), out.data(), out.size(),
                                 &size) != LIBDEFLATE_SUCCESS)
    return std::nullopt;
  out.resize(size);
  return out;
}

std::string deflate(const std::string& bytes) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> deflater(
      libdeflate_alloc_compressor(1), libdeflate_free_compressor);
  std::string out(libdeflate_zlib_compress_bound(deflater.get(), bytes.size()), '\0');
  out.resize(
      libdeflate_zlib_compress(deflater.get(), bytes.data(), bytes.size(), out.data(), out.size()));
  return out;
}

/// Runs: a count n >= 0 and a byte that stands n + 1 times, or -n and n bytes.
std::optional<std::string> expand_runs(const std::string& data) {
  std::string out;
  for (std::size_t i = 0; i + 1 < data.size();) {
    const auto count = static_cast<signed char>(data[i++]);
    if (count >= 0) {
      out.append(std::size_t(count) + 1, data[i++]);
    } else {
      if (std::size_t(-count) > data.size() - i) return std::nullopt;
      out.append(data, i, std::size_t(-count));
      i += std::size_t(-count);
    }
  }
  return out;
}

std::string make_runs(const std::string& bytes) {
  constexpr std::size_t kLongest = 127;
  std::string out;
  for (std::size_t i = 0; i < bytes.size();) {
    std::size_t count = 1;
    while (count < kLongest && i + count < bytes.size() && bytes[i + count] == bytes[i]) ++count;
    if (count > 2) {
      out += char(count - 1);
      out += bytes[i];
    } else {
      count = std::min(kLongest, bytes.size() - i);
      out += char(-int(count));
      out.append(bytes, i, count);
    }
    i += count;
  }
  return out;
}

}  // namespace

std::optional<std::string> unpack(int compression, const std::string& data) {
  if (compression == Imf::NO_COMPRESSION) return data;
  if (compression == Imf::RLE_COMPRESSION) {
    const auto bytes = expand_runs(data);
    return bytes ? std::optional(from_differences(*bytes)) : std::nullopt;
  }
  if (compression != Imf::ZIP_COMPRESSION && compression != Imf::ZIPS_COMPRESSION)
    return std::nullopt;
  const auto bytes = inflate(data);
  return bytes ? std::optional(from_differences(*bytes)) : std::nullopt;
}

std::string pack(int compression, const std::string& pixels) {
  if (compression == Imf::NO_COMPRESSION) return pixels;
  const std::string bytes = to_differences(pixels);
  const std::string packed =
      compression == Imf::RLE_COMPRESSION ? make_runs(bytes) : deflate(bytes);
  return packed.size() < pixels.size() ? packed : pixels;
}

}  // namespace ssdo::fuzz
