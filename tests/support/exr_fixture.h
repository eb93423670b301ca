// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledOutputPart.h>
#include <half.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "math/plane.h"

namespace ssdo::test {

/// What every test image holds in channel `c` (counted in the order of the header) at pixel (x, y):
/// a whole number that half, float and uint all store exactly.
int test_value(int c, int x, int y);

inline Imath::Box2i box_of(const Window& w) { return {{w.x0, w.y0}, {w.x1 - 1, w.y1 - 1}}; }

struct TestChannel {
  std::string name;
  Imf::PixelType type = Imf::FLOAT;
  int sampling = 1;
};

Imf::Header test_header(const Imath::Box2i& data_window, const std::vector<TestChannel>& channels,
                        Imf::Compression compression = Imf::ZIP_COMPRESSION);

Imf::Header tiled(Imf::Header header, int tile_size, Imf::LevelMode mode = Imf::ONE_LEVEL);

Imf::Header named(Imf::Header header, const std::string& name);

/// The test values of all channels over a window, as stored.
class TestPixels {
 public:
  TestPixels(const Imf::Header& header, const Imath::Box2i& window);
  const Imf::FrameBuffer& frame_buffer() const { return frame_buffer_; }

 private:
  std::vector<std::vector<std::byte>> channels_;
  Imf::FrameBuffer frame_buffer_;
};

void write_lines(Imf::MultiPartOutputFile& file, int index);

void write_tiles(Imf::MultiPartOutputFile& file, int index);

/// One sample in every pixel, of the value 1 in every channel.
void write_deep_lines(Imf::MultiPartOutputFile& file, int index);
void write_deep_tiles(Imf::MultiPartOutputFile& file, int index);

/// Writes an EXR of test values, one part for each header. The type of a header says how.
void write_test_exr(const std::filesystem::path& path, const std::vector<Imf::Header>& headers);

}  // namespace ssdo::test
