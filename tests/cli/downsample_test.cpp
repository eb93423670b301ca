// SPDX-License-Identifier: Apache-2.0
//
// --downsample: the G-buffer is larger than what is written.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "io/exr/pixel_filter.h"
#include "support/crop.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"
#include "support/typed_frame.h"

namespace ssdo::test::downsample_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const Window kDisplay{0, 0, 96, 64}, kOverscan{-13, -7, 111, 75};
const Downsampling kHalf{2, kDisplay};

class DownsampleOption : public testing::Test {
 protected:
  DownsampleOption() { write("in.exr", kOverscan); }

  std::string path(const std::string& name) const { return dir_ / name; }

  static FramePart frame(const Window& data) {
    FramePart part = frame_of(small_picture(data, kDisplay));
    part.data = data, part.display = kDisplay;
    return part;
  }

  void write(const std::string& name, const Window& data) const {
    write_frame(path(name), frame(data));
  }

  /// A picture of one colour, with or without an ambient layer in it.
  void write_beauty(const std::string& name, const Window& window) const {
    FramePart part{"", window, window, {}, Imf::FLOAT, {}};
    part.add("Beauty", Plane<glm::vec3>(window.width(), window.height(), glm::vec3(1)), "RGB");
    part.add("Ambient", Plane<glm::vec3>(window.width(), window.height(), glm::vec3(0.5)), "RGB");
    write_frame(path(name), part);
  }

  Finished run(const std::string& out, const std::vector<std::string>& flags) const {
    std::vector<std::string> words = {path("in.exr"), "-o",           path(out),
                                      "--overwrite",  "--pixel-type", "float"};
    words.insert(words.end(), flags.begin(), flags.end());
    return run_tool(words);
  }

  void refused(const std::vector<std::string>& flags, int code,
               const testing::Matcher<std::string>& says) const {
    const Finished done = run("refused.exr", flags);
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_THAT(done.error_line(), says);
    EXPECT_FALSE(std::filesystem::exists(path("refused.exr")));
  }

  TempDir dir_;
};

TEST_F(DownsampleOption, TheCompositeIsThatOfTheGBufferFiltered) {
  ASSERT_EQ(run("large.exr", {}).code, 0);
  const Finished done = run("small.exr", {"--downsample", "2"});
  ASSERT_EQ(done.code, 0) << done.err;
  const ExrPart part = ExrReader(path("small.exr")).parts()[0];
  EXPECT_EQ(part.data_window, (Window{-7, -4, 56, 38}));
  EXPECT_EQ(part.display_window, (Window{0, 0, 48, 32}));
  EXPECT_EQ(channel_names(path("small.exr")), channel_names(path("large.exr")));
  for (const char* name : {"R", "G", "B", "A"}) {
    EXPECT_EQ(channel(path("small.exr"), name).pixels,
              filter_pixels(channel(path("large.exr"), name), kOverscan, kHalf).pixels)
        << name;
  }
}

TEST_F(DownsampleOption, ByOneIsWithout) {
  ASSERT_EQ(run("without.exr", {"--products", "all"}).code, 0);
  ASSERT_EQ(run("one.exr", {"--products", "all", "--downsample", "1"}).code, 0);
  EXPECT_EQ(read_file(path("without.exr")), read_file(path("one.exr")));
}

/// Pixels of overscan that only the pixel filter sees are estimated as well.
TEST_F(DownsampleOption, CroppedIsACropOfTheWhole) {
  for (const char* filter : {"none", "geometry"}) {
    SCOPED_TRACE(filter);
    const std::vector<std::string> flags = {
        "--products", "ao,bent,direct,bounce,composite", "--downsample", "2", "--filter", filter};
    ASSERT_EQ(run("whole.exr", flags).code, 0);
    std::vector<std::string> cropping = flags;
    cropping.push_back("--crop");
    ASSERT_EQ(run("crop.exr", cropping).code, 0);
    EXPECT_EQ(ExrReader(path("crop.exr")).parts()[0].data_window, (Window{0, 0, 48, 32}));
    for (const std::string& name : channel_names(path("whole.exr"))) {
      EXPECT_EQ(channel(path("crop.exr"), name).pixels,
                crop(channel(path("whole.exr"), name), {7, 4, 55, 36}).pixels)
          << name;
    }
  }
}

TEST_F(DownsampleOption, PicturesAndPlanSayTheSize) {
  const Finished done = run("out.exr", {"-o", path("out.png"), "-v", "--downsample", "2", "--save",
                                        "ao=" + path("ao.jpg")});
  ASSERT_EQ(done.code, 0) << done.err;
  for (const char* name : {"out.png", "ao.jpg"}) {
    const auto image = OIIO::ImageInput::open(path(name));
    ASSERT_TRUE(image);
    EXPECT_EQ(image->spec().width, 48);
    EXPECT_EQ(image->spec().height, 32);
  }
  EXPECT_THAT(done.err, HasSubstr("downsample 2: the frame's 96x64 pixels become 48x32"));
  const Finished info = run_tool({"info", path("in.exr"), "--json", "--downsample", "2"});
  EXPECT_EQ(parse_json(info.out)["plan"]["downsample"], 2);
}

/// Ids and geometry are those of one place, colours are filtered, in all parts.
TEST_F(DownsampleOption, KeptChannelsComeAtTheSize) {
  const Window small{3, 2, 60, 50};
  FramePart lead = frame(kOverscan), other{"other", small, kDisplay, {}, Imf::FLOAT, {}};
  lead.name = "main";
  for (const char* name : {"Tangent.X", "glow.R"}) {
    other.channels[name] = Plane<float>(small.width(), small.height());
    for (std::size_t i = 0; i < small.area(); ++i) other.channels[name][i] = float(i * 7 % 11);
  }
  Plane<float> object(kOverscan.width(), kOverscan.height());
  for (std::size_t i = 0; i < object.size(); ++i) object[i] = float(i * 7 % 5);
  lead.channels["CryptoObject00.r"] = object;
  lead.channels["mask.R"] = object;
  lead.channels["single.Y"] = object;
  TypedFrame typed_lead = typed_frame(lead);
  std::vector<unsigned> ids(kOverscan.area());
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = 0xfffffff0u - unsigned(i);
  typed_lead.channels["id"] = typed(Imf::UINT, ids);
  typed_lead.header.setName("main");
  TypedFrame typed_other = typed_frame(other);
  typed_other.header.setName("other");
  write_typed(path("in.exr"), {typed_lead, typed_other});
  const Finished done = run("out.exr", {"--downsample", "2", "--keep-channels"});
  ASSERT_EQ(done.code, 0) << done.err;

  const ExrReader in(path("in.exr")), out(path("out.exr"));
  const auto expect = [&](int part, const std::string& name, bool nearest) {
    const Window& from = in.parts()[std::size_t(part)].data_window;
    const std::vector<std::string> names = {name};
    EXPECT_EQ(out.read_stored(part, names)[0].pixels,
              filter_stored(in.read_stored(part, names)[0], from, kHalf, nearest).pixels)
        << name << " of part " << part;
  };
  for (const char* name : {"CryptoObject00.r", "id", "ViewLayer.Position.Y", "ViewLayer.Normal.X",
                           "ViewLayer.Depth.Z"})
    expect(0, name, true);
  for (const char* name : {"mask.R", "single.Y", "ViewLayer.DiffCol.G"}) expect(0, name, false);
  EXPECT_NE(stored(path("out.exr"), "mask.R"), stored(path("out.exr"), "CryptoObject00.r"));
  EXPECT_EQ(out.parts()[1].data_window, (Window{1, 1, 30, 25}));
  EXPECT_EQ(out.parts()[1].display_window, (Window{0, 0, 48, 32}));
  expect(1, "Tangent.X", true);
  expect(1, "glow.R", false);
}

/// Renderers may call the components of a position or a normal colours.
TEST_F(DownsampleOption, GeometryIsNotFilteredWhateverItsChannels) {
  FramePart part = frame(kOverscan);
  for (const auto& [from, to] : {std::pair{"X", "R"}, {"Y", "G"}, {"Z", "B"}}) {
    part.channels[std::string("P.") + to] =
        part.channels.extract(std::string("ViewLayer.Position.") + from).mapped();
  }
  write_frame(path("in.exr"), part);
  const Finished done =
      run("out.exr", {"--downsample", "2", "--keep-channels", "--aov", "position=P"});
  ASSERT_EQ(done.code, 0) << done.err;
  const ExrReader in(path("in.exr"));
  const std::vector<std::string> names = {"P.R"};
  EXPECT_EQ(stored(path("out.exr"), "P.R").second,
            filter_stored(in.read_stored(0, names)[0], kOverscan, kHalf, true).pixels);
}

TEST_F(DownsampleOption, ABeautyMayHaveEitherSize) {
  write_beauty("small.exr", {0, 0, 48, 32});
  write_beauty("large.exr", kDisplay);
  for (const char* compose : {"occlude", "add"}) {
    SCOPED_TRACE(compose);
    const auto with = [&](const std::string& beauty) {
      return std::vector<std::string>{"--downsample",
                                      "2",
                                      "--crop",
                                      "--compose",
                                      compose,
                                      "--aov",
                                      "beauty=" + path(beauty) + ":Beauty",
                                      "--aov",
                                      "ambient=" + path(beauty) + ":Ambient"};
    };
    const Finished done = run("a.exr", with("small.exr"));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.err, HasSubstr("4024 of 10168 surfaces")) << "those of overscan";
    ASSERT_EQ(run("b.exr", with("large.exr")).code, 0);
    const Plane<float> a = channel(path("a.exr"), "G"), b = channel(path("b.exr"), "G");
    float darkest = 1;
    for (int y = 1; y < a.height - 1; ++y) {
      for (int x = 1; x < a.width - 1; ++x) {
        EXPECT_NEAR(a(x, y), b(x, y), 1e-6);
        darkest = std::min(darkest, a(x, y));
      }
    }
    EXPECT_EQ(darkest < 0.95f, compose == std::string("occlude"));
  }
}

TEST_F(DownsampleOption, ABeautyOfAnotherSizeIsRefused) {
  write_beauty("third.exr", {0, 0, 32, 21});
  write_beauty("half.exr", {0, 0, 48, 32});
  const auto with = [&](const std::string& beauty) { return "beauty=" + path(beauty) + ":Beauty"; };
  refused({"--downsample", "2", "--compose", "add", "--aov", with("third.exr")}, 4,
          AllOf(HasSubstr("0,0 to 31,20"), HasSubstr("0,0 to 95,63"), HasSubstr("0,0 to 47,31")));
  refused({"--compose", "add", "--aov", with("half.exr")}, 4, HasSubstr("give --downsample 2"));
  refused({"--compose", "add", "--aov", with("third.exr")}, 4, Not(HasSubstr("--downsample")));
  refused({"--downsample", "2", "--aov", "albedo=" + path("half.exr") + ":Beauty"}, 4,
          HasSubstr("layers of a frame share one"));
}

TEST_F(DownsampleOption, FactorsThatDoNotFitAreRefused) {
  refused({"--downsample", "5"}, 2,
          AllOf(HasSubstr("in.exr"), HasSubstr("--downsample 5"), HasSubstr("96 x 64")));
  refused({"--downsample", "3"}, 2, HasSubstr("96 x 64"));
  for (const char* factor : {"0", "9", "-2", "two", "1.5"})
    refused({"--downsample", factor}, 2, HasSubstr("--downsample"));
  EXPECT_EQ(run_tool({"bench", path("in.exr"), "--downsample", "2"}).code, 2);
}

}  // namespace
}  // namespace ssdo::test::downsample_test
