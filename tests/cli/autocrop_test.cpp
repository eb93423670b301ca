// SPDX-License-Identifier: Apache-2.0
//
// Renderers that crop every layer to what it shows: the outputs cover what they are made of, and
// P that is cropped away is background.
#include <gmock/gmock.h>

#include <algorithm>

#include "support/frame_file.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::autocrop_test {
namespace {

using testing::ElementsAre;

const Window kDisplay{0, 0, 64, 48}, kShown{6, 8, 58, 44};

/// A ball on a round table before a sky, seen through `window`.
Picture ball_on_table(const Window& window) {
  const Surface table =
      cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) { return glm::length(p) < 1.2; });
  return take_picture(
      all_of({table, sphere({0.2, 0, 0.5}, 0.5)}),
      look_at(camera_from_fov(55, kDisplay, 1), {0, -3, 2.2}, {0, 0, 0.3}, {0, 0, 1}), window);
}

FramePart part_of(const std::string& name, const Window& data) {
  FramePart part;
  part.name = name, part.data = data, part.display = kDisplay;
  return part;
}

/// Beauty, ambient light and geometry in parts of their own; `geometry` is the window of the last,
/// `around` that of the others.
std::vector<FramePart> parts(const Window& geometry, const Window& around = kDisplay) {
  FramePart beauty = part_of("rgba", around), ambient = part_of("Sky", around),
            shown = part_of("data", geometry);
  const int w = around.width(), h = around.height();
  for (const auto& [name, value] : {std::pair{"R", 0.5f}, {"G", 0.25f}, {"B", 1.0f}, {"A", 0.75f}})
    beauty.channels[name] = Plane<float>(w, h, value);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) beauty.channels["B"](x, y) = float(x + y) / 128;
  ambient.add("Sky", Plane<glm::vec3>(w, h, glm::vec3(0.125f)), "RGB");
  for (const auto& [name, pixels] : frame_of(ball_on_table(geometry)).channels)
    shown.channels[name.substr(name.find('.') + 1)] = pixels;
  return {beauty, ambient, shown};
}

class Autocrop : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_ / name; }

  void run(const std::string& in, const std::string& out, const Words& flags = {}) const {
    const Finished done = run_tool(
        Words{path(in), "-o", path(out), "--aov", "ambient=Sky", "--quality", "draft"} + flags);
    ASSERT_EQ(done.code, 0) << done.err;
  }

  /// Every channel of the part with the products.
  void expect_same_bits(const std::string& a, const std::string& b, int part = 0) const {
    const ExrReader one(path(a)), other(path(b));
    EXPECT_EQ(one.parts()[std::size_t(part)].data_window,
              other.parts()[std::size_t(part)].data_window);
    ASSERT_EQ(channel_names(path(a), part), channel_names(path(b), part));
    for (const std::string& name : channel_names(path(a), part)) {
      EXPECT_TRUE(channel(path(a), name, part).pixels == channel(path(b), name, part).pixels)
          << name;
    }
  }

  TempDir dir_;
};

TEST_F(Autocrop, GivesWhatAFrameWithBackgroundGives) {
  write_frame(path("cropped.exr"), parts(kShown));
  write_frame(path("whole.exr"), parts(kDisplay));
  for (const Words& flags :
       {Words{"--compose", "occlude"}, Words{"--compose", "add"}, Words{"--downsample", "2"},
        Words{"--keep-channels"}, Words{"--pixel-type", "float"}}) {
    run("cropped.exr", "a.exr", flags + Words{"--overwrite"});
    run("whole.exr", "b.exr", flags + Words{"--overwrite"});
    if (flags[0] != "--keep-channels") {
      expect_same_bits("a.exr", "b.exr");
      continue;
    }
    // P of 0 and P cropped away are alike; a depth of 1e10 is 0 then.
    ASSERT_EQ(ExrReader(path("a.exr")).parts().size(), 3u);
    EXPECT_TRUE(channel(path("a.exr"), "Position.X", 2).pixels ==
                channel(path("b.exr"), "Position.X", 2).pixels);
    EXPECT_TRUE(channel(path("a.exr"), "R", 2).pixels == channel(path("b.exr"), "R", 2).pixels);
    EXPECT_TRUE(channel(path("a.exr"), "R", 0).pixels == channel(path("cropped.exr"), "R").pixels);
  }
}

TEST_F(Autocrop, KeepsTheBeautyAroundTheGeometry) {
  write_frame(path("in.exr"), parts(kShown));
  run("in.exr", "out.exr", {"--pixel-type", "float"});
  const ExrReader out(path("out.exr"));
  EXPECT_EQ(out.parts()[0].data_window, kDisplay);
  int around = 0;
  for (const char* name : {"R", "G", "B", "A"}) {
    const Plane<float> before = channel(path("in.exr"), name),
                       after = channel(path("out.exr"), name);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        if (kShown.contains(x, y)) continue;
        ASSERT_EQ(after(x, y), before(x, y)) << name << " " << x << " " << y;
        ++around;
      }
    }
  }
  EXPECT_EQ(around, 4 * (64 * 48 - int(kShown.area())));
  EXPECT_EQ(channel(path("out.exr"), "ao.Y")(1, 1), 1);
}

/// Where P ends with the display window nothing tells what lies beyond: the surfaces get the light
/// that they get without the overscan.
TEST_F(Autocrop, CoversOverscanOfTheBeauty) {
  const Window overscan{-8, -4, 70, 52};
  for (const Window& geometry : {kShown, kDisplay}) {
    write_frame(path("in.exr"), parts(geometry));
    write_frame(path("wide.exr"), parts(geometry, overscan));
    for (const Words& flags : {Words{"--keep-channels"}, Words{"--downsample", "2"}}) {
      run("in.exr", "in_out.exr", flags + Words{"--overwrite"});
      run("wide.exr", "out.exr", flags + Words{"--overwrite"});
      const int part = flags.size() == 1 ? 2 : 0, factor = flags.size() == 1 ? 1 : 2,
                left = 8 / factor, top = 4 / factor;
      const Plane<float> ao = channel(path("out.exr"), "ao.Y", part),
                         same = channel(path("in_out.exr"), "ao.Y", part),
                         red = channel(path("out.exr"), "R", part),
                         alpha = channel(path("out.exr"), "A", part);
      ASSERT_EQ(ao.width, 78 / factor);
      ASSERT_EQ(ao.height, 56 / factor);
      for (int y = 0; y < ao.height; ++y) {
        for (int x = 0; x < ao.width; ++x) {
          const bool inside =
              x >= left && x < left + same.width && y >= top && y < top + same.height;
          if (inside) {
            EXPECT_TRUE(geometry != kDisplay || ao(x, y) == same(x - left, y - top));
            continue;
          }
          EXPECT_EQ(ao(x, y), 1);
          EXPECT_EQ(red(x, y), 0.5f);
          EXPECT_EQ(alpha(x, y), 0.75f);
        }
      }
    }
    run("wide.exr", "crop.exr", {"--crop", "--overwrite"});
    EXPECT_EQ(ExrReader(path("crop.exr")).parts()[0].data_window, kDisplay);
  }
}

/// Nothing of the beauty is in a relit picture.
TEST_F(Autocrop, IsTheWindowOfTheGeometryWithoutABeauty) {
  write_frame(path("in.exr"), parts(kShown));
  const Finished done = run_tool({path("in.exr"), "-o", path("out.exr"), "--compose", "relight"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(ExrReader(path("out.exr")).parts()[0].data_window, kShown);
}

/// The eyes share a part, and the beauty of one reaches farther.
TEST_F(Autocrop, OfEyesInOnePartCoversBoth) {
  const Window wide{0, 4, 64, 48}, high{4, 0, 60, 48};
  FramePart eyes = part_of("data", kShown), left = part_of("left", wide),
            right = part_of("right", high);
  for (const auto& [name, pixels] : frame_of(ball_on_table(kShown), "").channels) {
    eyes.channels["left." + name] = pixels;
    eyes.channels["right." + name] = pixels;
  }
  for (auto& [part, window] : {std::pair<FramePart&, Window>{left, wide}, {right, high}}) {
    part.add(part.name, Plane<glm::vec3>(window.width(), window.height(), glm::vec3(0.5f)), "RGB");
    part.add(part.name + ".Sky",
             Plane<glm::vec3>(window.width(), window.height(), glm::vec3(0.25f)), "RGB");
  }
  write_frame(path("in.exr"), {eyes, left, right});
  run("in.exr", "out.exr", {"--stereo", "all"});
  EXPECT_EQ(ExrReader(path("out.exr")).parts()[0].data_window, kDisplay);
  EXPECT_EQ(channel(path("out.exr"), "left.R")(0, 4), 0.5f);
  EXPECT_EQ(channel(path("out.exr"), "left.R")(0, 3), 0);
  EXPECT_EQ(channel(path("out.exr"), "right.R")(4, 0), 0.5f);
  EXPECT_EQ(channel(path("out.exr"), "right.R")(3, 0), 0);
  EXPECT_EQ(channel(path("out.exr"), "right.ao.Y")(0, 0), 1);
}

}  // namespace
}  // namespace ssdo::test::autocrop_test
