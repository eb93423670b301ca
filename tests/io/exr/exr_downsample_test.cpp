// SPDX-License-Identifier: Apache-2.0
//
// What the writer refuses to make smaller.
#include <gtest/gtest.h>

#include "io/exr/exr_writer.h"
#include "support/error_matchers.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::exr_downsample_test {
namespace {

using Imath::Box2i;

/// Writes one plane at half the size of part 0 of a file with these parts.
void write_half(const std::vector<Imf::Header>& headers, bool keep_channels) {
  const TempDir dir;
  write_test_exr(dir / "in.exr", headers);
  const ExrReader input(dir / "in.exr");
  const Plane<float> plane(8, 4, 1);
  ExrOutput output;
  output.input = &input;
  output.planes = {{"new", Imf::HALF, &plane}};
  output.keep_channels = keep_channels;
  output.downsampling = {2, input.parts()[0].display_window};
  write_exr(SafeFile(dir / "out.exr", {}), {output});
}

const Box2i kWindow({0, 0}, {15, 7});

Imf::Header deep_header() {
  Imf::Header deep = named(test_header(kWindow, {{"Z"}}, Imf::ZIPS_COMPRESSION), "deep");
  deep.setType(Imf::DEEPSCANLINE);
  return deep;
}

TEST(ExrDownsample, DeepPartsAreRefusedWhereTheyWouldBeKept) {
  const Imf::Header flat = named(test_header(kWindow, {{"R"}}), "flat");
  EXPECT_THAT(error_of([&] {
                write_half({flat, deep_header()}, true);
              }),
              IsError(ExitCode::input, "'deep' is deep"));
  EXPECT_NO_THROW(write_half({flat, deep_header()}, false));
}

TEST(ExrDownsample, SubsampledChannelsAreRefusedWhereTheyWouldBeKept) {
  const Imf::Header header = test_header(kWindow, {{"Y"}, {"RY", Imf::HALF, 2}});
  EXPECT_THAT(error_of([&] { write_half({header}, true); }),
              IsError(ExitCode::input, "subsampled channel 'RY'"));
  EXPECT_NO_THROW(write_half({header}, false));
}

}  // namespace
}  // namespace ssdo::test::exr_downsample_test
