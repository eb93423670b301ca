// SPDX-License-Identifier: Apache-2.0
#include <ImfStringAttribute.h>
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <half.h>

#include <cmath>
#include <fstream>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::main_job_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<std::string> kSky = {"--env", data("environments/sky.exr")};

Finished relight(std::vector<std::string> arguments, const Surroundings& around = {}) {
  const Finished done = run_tool(arguments, around);
  EXPECT_EQ(done.code, 0) << done.err;
  return done;
}

std::string string_attribute(const std::filesystem::path& path, const char* name) {
  const ExrReader file(path);
  const auto* attribute = file.parts()[0].header.findTypedAttribute<Imf::StringAttribute>(name);
  return attribute ? attribute->value() : "";
}

TEST(MainJob, RelightsTheStillLifeWithoutFurtherFlags) {
  const TempDir dir;
  const std::string exr = dir / "out.exr", png = dir / "out.png";
  const Finished done = relight({data("still_life.exr"), "-o", exr, "-o", png, kSky[0], kSky[1]});
  EXPECT_EQ(done.out, "");
  EXPECT_EQ(done.err, "");
  EXPECT_THAT(listing(dir.path()), ElementsAre("out.exr", "out.png"));
  EXPECT_THAT(channel_names(exr), ElementsAre("A", "B", "G", "R", "ao.Y", "bounce.B", "bounce.G",
                                              "bounce.R", "direct.B", "direct.G", "direct.R"));
  EXPECT_EQ(string_attribute(exr, "Scene"), "still_life") << "the input's header is kept";
  EXPECT_NE(string_attribute(exr, "ssdo/version"), "");
  EXPECT_EQ(parse_json(string_attribute(exr, "ssdo/plan")).at("method"), "bitmask");

  const auto image = OIIO::ImageInput::open(png);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->spec().width, 576);
  EXPECT_EQ(image->spec().height, 324);
  EXPECT_EQ(image->spec().nchannels, 4);
}

TEST(MainJob, TheCompositeIsAlbedoTimesLightTimesAlpha) {
  const TempDir dir;
  const std::string in = data("still_life.exr"), exr = dir / "out.exr";
  relight({in, "-o", exr, kSky[0], kSky[1], "--pixel-type", "float"});
  const Plane<float> depth = channel(in, "ViewLayer.Depth.Z"), alpha = channel(exr, "A"),
                     ao = channel(exr, "ao.Y");
  for (const std::string c : {"R", "G", "B"}) {
    const Plane<float> rgb = channel(exr, c), albedo = channel(in, "ViewLayer.DiffCol." + c);
    const Plane<float> direct = channel(exr, "direct." + c), bounce = channel(exr, "bounce." + c);
    for (std::size_t i = 0; i < rgb.size(); ++i) {
      ASSERT_TRUE(std::isfinite(rgb[i]) && std::isfinite(direct[i]) && std::isfinite(bounce[i]));
      ASSERT_TRUE(ao[i] >= 0 && ao[i] <= 1);
      const float held = half(albedo[i]);
      ASSERT_NEAR(rgb[i], held * (direct[i] + bounce[i]) * alpha[i], 1e-5 * (1 + rgb[i]));
      if (depth[i] > 1e9f) {
        ASSERT_EQ(rgb[i] + direct[i] + bounce[i] + alpha[i], 0) << "outside the geometry";
        ASSERT_EQ(ao[i], 1);
      } else {
        ASSERT_EQ(alpha[i], 1);
      }
    }
  }
}

TEST(MainJob, ThreadsAndRepetitionDoNotChangeABit) {
  const TempDir dir;
  const auto run = [&](const std::string& threads, const std::string& name) {
    relight({data("room_corner.exr"), "-o", dir / (name + ".exr"), "-o", dir / (name + ".png"),
             kSky[0], kSky[1], "--bounces", "2", "--threads", threads});
    return read_file(dir / (name + ".exr")) + read_file(dir / (name + ".png"));
  };
  const std::string one = run("1", "a");
  EXPECT_GT(one.size(), 100000u);
  EXPECT_TRUE(run("2", "b") == one);
  EXPECT_TRUE(run("7", "c") == one);
  EXPECT_TRUE(run("7", "d") == one);
}

TEST(MainJob, ACropSeesWhatTheWholeFrameSees) {
  const TempDir dir;
  const Window whole{0, 0, 96, 72};
  write_frame(dir / "whole.exr", frame_of(small_picture(whole, whole)));
  // The camera that the tool itself finds in the whole frame.
  const auto info = parse_json(relight({"info", dir / "whole.exr", "--json"}).out);
  std::ofstream(dir / "camera.json") << info.at("camera");
  const auto run = [&](const std::string& name) {
    relight({dir / (name + ".exr"), "-o", dir / (name + "_out.exr"), "--overwrite", "--camera",
             dir / "camera.json", "--radius", "0.3", "--thickness", "1", "--pixel-type", "float",
             "--products", "all", kSky[0], kSky[1]});
  };
  run("whole");
  struct Reach {
    Window crop, same;
    std::vector<std::string> channels;
  };
  // The radius is 10 to 16 pixels wide. A bounce takes it twice, for the light and for the bounce.
  for (const Reach& reach :
       {Reach{{19, 14, 83, 65}, {37, 32, 65, 47}, {"ao.Y", "bent.X", "direct.R"}},
        {{10, 8, 96, 72}, {43, 41, 96, 72}, {"bounce.R", "R"}}}) {
    const Window &crop = reach.crop, &same = reach.same;
    FramePart part = frame_of(small_picture(crop, whole));
    part.display = whole;
    write_frame(dir / "crop.exr", part);
    run("crop");
    for (const std::string& c : reach.channels) {
      const Plane<float> a = channel(dir / "whole_out.exr", c),
                         b = channel(dir / "crop_out.exr", c);
      double seen = 0;
      for (int y = same.y0; y < same.y1; ++y) {
        for (int x = same.x0; x < same.x1; ++x) {
          ASSERT_EQ(a(x, y), b(x - crop.x0, y - crop.y0)) << c << " at " << x << "," << y;
          seen += c == "ao.Y" ? 1 - a(x, y) : std::abs(a(x, y));
        }
      }
      EXPECT_GT(seen, 0.3) << c << ": something is there";
    }
  }
}

TEST(MainJob, LightFollowsItsFlags) {
  const TempDir dir;
  const auto direct = [&](const std::string& name, std::vector<std::string> flags,
                          const std::string& c = "direct.R") {
    flags.insert(flags.begin(), {data("room_corner.exr"), "-o", dir / name, "--products",
                                 "ao,direct", "--pixel-type", "float"});
    relight(flags);
    return channel(dir / name, c);
  };
  const auto differ = [](const Plane<float>& a, const Plane<float>& b) {
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]), all += std::abs(b[i]);
    return sum / all;
  };
  const Plane<float> ao = direct("a.exr", {}, "ao.Y"), white = direct("b.exr", {}),
                     red = direct("c.exr", {"--env", "4,0,0"});
  for (std::size_t i = 0; i < ao.size(); ++i) {
    if (white[i] == 0) continue;  // the background
    ASSERT_NEAR(white[i], ao[i], 1e-6);
    ASSERT_NEAR(red[i], 4 * ao[i], 1e-5);
  }
  const Plane<float> sky = direct("d.exr", {kSky[0], kSky[1]});
  const Plane<float> brighter = direct("e.exr", {kSky[0], kSky[1], "--env-exposure", "1"});
  for (std::size_t i = 0; i < ao.size(); ++i)
    ASSERT_NEAR(brighter[i], 2 * sky[i], 1e-5 * (1 + sky[i]));
  EXPECT_LT(differ(direct("f.exr", {kSky[0], kSky[1], "--env-rotate", "360"}), sky), 1e-6);
  EXPECT_GT(differ(direct("g.exr", {kSky[0], kSky[1], "--env-rotate", "-90"}), sky), 0.05);
  EXPECT_LT(differ(direct("h.exr", {kSky[0], kSky[1], "--env-up", "z"}), sky), 1e-6)
      << "Blender's axis is the default here";
  EXPECT_GT(differ(direct("i.exr", {kSky[0], kSky[1], "--env-up", "y"}), sky), 0.05);
}

TEST(MainJob, ProductsGoWhereTheyAreAskedFor) {
  const TempDir dir;
  write_frame(dir / "in.exr", frame_of(small_picture()));
  relight({dir / "in.exr", "-o", dir / "ao.exr", "--products", "ao", "--save",
           "bounce=" + std::string(dir / "bounce.exr"), "--save",
           "ao=" + std::string(dir / "ao.png"), "--bits", "16"});
  EXPECT_THAT(channel_names(dir / "bounce.exr"), ElementsAre("bounce.B", "bounce.G", "bounce.R"));
  EXPECT_THAT(channel_names(dir / "ao.exr"), ElementsAre("ao.Y"));
  const auto image = OIIO::ImageInput::open((dir / "ao.png").string());
  ASSERT_TRUE(image);
  EXPECT_EQ(image->spec().nchannels, 1);
  EXPECT_EQ(image->spec().format, OIIO::TypeDesc::UINT16);
  std::vector<float> values(64 * 48);
  ASSERT_TRUE(image->read_image(0, 0, 0, 1, OIIO::TypeDesc::FLOAT, values.data()));
  const Plane<float> ao = channel(dir / "ao.exr", "ao.Y");
  for (std::size_t i = 0; i < ao.size(); ++i)
    ASSERT_NEAR(values[i], ao[i], 1e-3) << "no display transform on visibility";
}

TEST(MainJob, PicturesGoThroughTheColourPipeline) {
  const TempDir dir;
  FramePart part = frame_of(small_picture());
  part.channels["A"] = Plane<float>(64, 48, 0.5f);
  part.add("ViewLayer.DiffCol", Plane<glm::vec3>(64, 48, glm::vec3(0.25f)), "RGB");
  for (const char* c : {"R", "G", "B"}) part.channels[c] = Plane<float>(64, 48, 0);
  write_frame(dir / "in.exr", part);
  // Open ground of albedo 1/2, premultiplied, under 0.36 gives 0.18, whatever its alpha.
  const auto ground = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {dir / "in.exr", "-o", dir / "out.png", "--overwrite", "--env",
                                 "0.36", "--bounces", "0"});
    relight(flags);
    OIIO::ImageSpec as_written;  // releases of OpenImageIO multiply by alpha in different ways
    as_written.attribute("oiio:UnassociatedAlpha", 1);
    const auto image = OIIO::ImageInput::open((dir / "out.png").string(), &as_written);
    std::vector<float> values(64 * 48 * 4);
    EXPECT_TRUE(image && image->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, values.data()));
    EXPECT_NEAR(values[3], 0.5, 0.003);
    return values[0];
  };
  EXPECT_NEAR(ground({"--bits", "16"}), 0.3560, 1e-3) << "ACES, SDR";
  EXPECT_NEAR(ground({}), 0.3560, 0.005);
  EXPECT_NEAR(ground({"--view", "Un-tone-mapped", "--bits", "16"}), 0.4614, 1e-3) << "sRGB";
  EXPECT_NEAR(
      ground({"--view", "Un-tone-mapped", "--bits", "16", "--ocio", data("color/config.ocio")}),
      0.4614, 1e-3);
}

TEST(MainJob, WritesEveryCompressionAndBothTypes) {
  const TempDir dir;
  write_frame(dir / "in.exr", frame_of(small_picture()));
  for (const std::string name :
       {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
    for (const std::string type : {"half", "float"}) {
      relight({dir / "in.exr", "-o", dir / "out.exr", "--overwrite", "--compression", name,
               "--pixel-type", type});
      const ExrReader out(dir / "out.exr");
      EXPECT_EQ(out.parts()[0].channels[0].type, type == "half" ? Imf::HALF : Imf::FLOAT);
      EXPECT_NEAR(channel(dir / "out.exr", "ao.Y")(0, 0), 1, 0.01) << name;
    }
  }
}

TEST(MainJob, PacksAsTightAsItIsTold) {
  const TempDir dir;
  write_frame(dir / "in.exr", frame_of(small_picture()));
  const auto size = [&](const std::string& compression) {
    relight({dir / "in.exr", "-o", dir / "out.exr", "--overwrite", "--compression", compression});
    return std::filesystem::file_size(dir / "out.exr");
  };
  EXPECT_EQ(size("zip"), size("zip:1"));
  EXPECT_GT(size("zip:1"), size("zip:12"));
}

TEST(MainJob, KeptChannelsStandBesideTheProducts) {
  const TempDir dir;
  FramePart part = frame_of(small_picture());
  for (const char* name : {"R", "G", "B", "A", "ao.Y", "id.Y"}) {
    part.channels[name] = Plane<float>(64, 48, name[0] == 'A' ? 0.5f : 0.25f);
  }
  write_frame(dir / "in.exr", part);
  relight({dir / "in.exr", "-o", dir / "out.exr", "--keep-channels"});
  EXPECT_EQ(channel(dir / "out.exr", "input.R")(3, 3), 0.25f);
  EXPECT_EQ(channel(dir / "out.exr", "input.ao.Y")(3, 3), 0.25f);
  EXPECT_EQ(channel(dir / "out.exr", "id.Y")(3, 3), 0.25f);
  EXPECT_EQ(channel(dir / "out.exr", "A")(3, 3), 0.5f) << "the input's alpha";
  EXPECT_NEAR(channel(dir / "out.exr", "ao.Y")(3, 3), 1, 0.1);
  relight({dir / "in.exr", "-o", dir / "plain.exr"});
  EXPECT_THAT(channel_names(dir / "plain.exr"), testing::Not(testing::Contains("input.R")));
}

TEST(MainJob, TakesPartsAndWindowsAsTheyCome) {
  const TempDir dir;
  const Window data_window{-5, -3, 59, 45}, display{0, 0, 50, 40};
  FramePart p = frame_of(small_picture(data_window, display)), n = p, rest = p;
  p.display = n.display = rest.display = display;
  p.name = "P", n.name = "N", rest.name = "rest";
  for (const char* c : {"X", "Y", "Z"}) {
    n.channels.erase(std::string("ViewLayer.Position.") + c);
    p.channels.erase(std::string("ViewLayer.Normal.") + c);
    rest.channels.erase(std::string("ViewLayer.Position.") + c);
    rest.channels.erase(std::string("ViewLayer.Normal.") + c);
    p.channels.erase(std::string("ViewLayer.DiffCol.") + "RGB"[c[0] - 'X']);
    n.channels.erase(std::string("ViewLayer.DiffCol.") + "RGB"[c[0] - 'X']);
  }
  p.channels.erase("ViewLayer.Depth.Z"), n.channels.erase("ViewLayer.Depth.Z");
  write_frame(dir / "in.exr", {n, p, rest});
  relight({dir / "in.exr", "-o", dir / "out.exr", "-o", dir / "out.png", "--keep-channels"});
  const ExrReader out(dir / "out.exr");
  ASSERT_EQ(out.parts().size(), 3u);
  EXPECT_EQ(out.parts()[1].data_window, data_window);
  EXPECT_EQ(out.parts()[1].display_window, display);
  EXPECT_THAT(channel_names(dir / "out.exr", 1),
              testing::IsSupersetOf({"R", "A", "ao.Y", "ViewLayer.Position.X"}));
  EXPECT_THAT(channel_names(dir / "out.exr", 0), testing::Not(testing::Contains("ao.Y")));
  const auto image = OIIO::ImageInput::open((dir / "out.png").string());
  ASSERT_TRUE(image);
  EXPECT_EQ(image->spec().width, 50) << "a picture shows the display window";
}

TEST(MainJob, FramesWithoutASurfaceAndOfOnePixelAreDone) {
  const TempDir dir;
  FramePart empty = frame_of(small_picture());
  for (float& z : empty.channels["ViewLayer.Depth.Z"].pixels) z = 1e10f;
  write_frame(dir / "empty.exr", empty);
  const Finished done = relight({dir / "empty.exr", "-o", dir / "out.exr"});
  EXPECT_THAT(done.err, HasSubstr("no surface"));
  EXPECT_EQ(channel(dir / "out.exr", "ao.Y")(5, 5), 1);
  EXPECT_EQ(channel(dir / "out.exr", "A")(5, 5), 0);

  FramePart pixel = frame_of(small_picture({30, 20, 31, 21}));
  for (const char* c : {"X", "Y", "Z"})
    pixel.channels.erase(std::string("ViewLayer.Position.") + c);
  write_frame(dir / "pixel.exr", pixel);
  relight({dir / "pixel.exr", "-o", dir / "pixel_out.exr", "--fov", "40"});
  EXPECT_NEAR(channel(dir / "pixel_out.exr", "ao.Y")(0, 0), 1, 0.01);
}

TEST(MainJob, BrokenPixelsAreCountedAndMakeNoNaN) {
  const TempDir dir;
  FramePart part = frame_of(small_picture());
  part.channels["ViewLayer.Position.X"](10, 10) = NAN;
  part.channels["ViewLayer.Position.Y"](11, 10) = INFINITY;
  part.channels["ViewLayer.Normal.Z"](12, 10) = NAN;
  part.channels["ViewLayer.DiffCol.G"](13, 10) = NAN;
  part.channels["ViewLayer.DiffCol.G"](14, 10) = INFINITY;
  write_frame(dir / "in.exr", part);
  relight({dir / "in.exr", "-o", dir / "out.exr", "--stats", dir / "stats.json"});
  EXPECT_EQ(parse_json(read_file(dir / "stats.json"))[0].at("bad_pixels"), 5);
  for (const std::string& name : channel_names(dir / "out.exr")) {
    for (const float v : channel(dir / "out.exr", name).pixels)
      ASSERT_TRUE(std::isfinite(v)) << name;
  }
}

TEST(MainJob, ValuesBeyondHalfAreClampedAndSaid) {
  const TempDir dir;
  write_frame(dir / "in.exr", frame_of(small_picture()));
  const Finished done = relight(
      {dir / "in.exr", "-o", dir / "out.exr", "--env", "1e6", "--stats", dir / "stats.json"});
  EXPECT_THAT(done.err, HasSubstr("clamped"));
  EXPECT_THAT(parse_json(read_file(dir / "stats.json"))[0].at("warnings").dump(),
              HasSubstr("clamped to 65504"));
  EXPECT_EQ(channel(dir / "out.exr", "direct.R")(0, 0), 65504);
}

}  // namespace
}  // namespace ssdo::test::main_job_test
