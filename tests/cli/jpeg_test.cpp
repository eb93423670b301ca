// SPDX-License-Identifier: Apache-2.0
//
// Issue 12, number 8: a JPEG had the straight colours of the composite without their alpha, so that
// soft edges were hard and bright.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <cmath>

#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::jpeg_test {
namespace {

double srgb(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

/// Interleaved 0..1, alpha not multiplied.
std::vector<float> read_values(const std::string& path, int channels) {
  OIIO::ImageSpec as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  const auto image = OIIO::ImageInput::open(path, &as_stored);
  EXPECT_TRUE(image && image->spec().nchannels == channels) << path;
  std::vector<float> values(std::size_t(64 * 48 * channels));
  EXPECT_TRUE(image && image->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, values.data()));
  return values;
}

TEST(Jpeg, IsTheCompositeOverBlack) {
  const TempDir dir;
  FramePart part = frame_of(small_picture());
  // Alpha falls from 1 on the left to 0 on the right.
  Plane<float> alpha(64, 48), black(64, 48, 0);
  for (std::size_t i = 0; i < alpha.size(); ++i) alpha[i] = 1 - float(i % 64) / 63;
  part.channels["A"] = alpha;
  for (const char* c : {"R", "G", "B"}) part.channels[c] = black;
  write_frame(dir / "in.exr", part);
  const Finished done =
      run_tool({dir / "in.exr", "-o", dir / "out.exr", "-o", dir / "out.jpg", "-o", dir / "out.png",
                "--view", "Un-tone-mapped", "--bits", "16", "--pixel-type", "float"});
  ASSERT_EQ(done.code, 0) << done.err;
  const Plane<float> red = channel(dir / "out.exr", "R");  // premultiplied
  const std::vector<float> jpeg = read_values(dir / "out.jpg", 3),
                           png = read_values(dir / "out.png", 4);
  double largest = 0;
  for (std::size_t i = 0; i < red.size(); ++i) {
    // What a viewer shows of the EXR; JPEG loses a code or two.
    largest = std::max(largest, std::abs(double(jpeg[3 * i]) - srgb(red[i])));
    if (alpha[i] > 0.01f) {
      ASSERT_NEAR(png[4 * i], srgb(red[i] / alpha[i]), 2e-3) << "PNG stays straight";
      ASSERT_NEAR(png[4 * i + 3], alpha[i], 1e-4);
    }
  }
  EXPECT_LT(largest, 0.03);
  EXPECT_LT(jpeg[3 * 63], 0.03) << "black where alpha is 0";
}

}  // namespace
}  // namespace ssdo::test::jpeg_test
