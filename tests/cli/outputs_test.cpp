// SPDX-License-Identifier: Apache-2.0
//
// Which products are made, which files they go to, and that every flag of the model matters.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::outputs_test {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAreArray;

class Outputs : public testing::Test {
 protected:
  Outputs() { write_frame(dir_ / "in.exr", frame_of(small_picture())); }

  std::string path(const std::string& name) const { return dir_ / name; }

  /// Runs on the frame of the fixture; gives `channel` of the EXR that was written.
  Plane<float> run(std::vector<std::string> flags, const std::string& name = "ao.Y") const {
    flags.insert(flags.begin(),
                 {path("in.exr"), "-o", path("out.exr"), "--overwrite", "--pixel-type", "float"});
    const Finished done = run_tool(flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return channel(path("out.exr"), name);
  }
  TempDir dir_;
};

double sum(const Plane<float>& plane) {
  double all = 0;
  for (const float v : plane.pixels) all += v;
  return all;
}

TEST_F(Outputs, AnExrHoldsTheProductsThatAreNamedAndTheirValuesDoNotDependOnIt) {
  const std::map<std::string, std::vector<std::string>> channels = {
      {"ao", {"ao.Y"}},
      {"bent", {"bent.X", "bent.Y", "bent.Z"}},
      {"error", {"error.Y"}},
      {"guessed", {"guessed.Y"}},
      {"direct", {"direct.R", "direct.G", "direct.B"}},
      {"bounce", {"bounce.R", "bounce.G", "bounce.B"}},
      {"composite", {"R", "G", "B", "A"}}};
  const std::string sky = data("environments/sky.exr");
  run({"--env", sky, "--products", "all"});
  std::map<std::string, Plane<float>> all;
  for (const std::string& name : channel_names(path("out.exr")))
    all[name] = channel(path("out.exr"), name);
  EXPECT_EQ(all.size(), 22u);
  for (const std::vector<std::string>& wanted : {std::vector<std::string>{"ao"},
                                                 {"direct"},
                                                 {"bounce"},
                                                 {"composite"},
                                                 {"bent"},
                                                 {"error"},
                                                 {"guessed"},
                                                 {"bounce", "ao"}}) {
    std::string list;
    std::vector<std::string> expected;
    for (const std::string& product : wanted) {
      list += (list.empty() ? "" : ",") + product;
      expected.insert(expected.end(), channels.at(product).begin(), channels.at(product).end());
    }
    run({"--env", sky, "--products", list}, expected[0]);
    EXPECT_THAT(channel_names(path("out.exr")), UnorderedElementsAreArray(expected));
    for (const std::string& name : expected)
      EXPECT_EQ(channel(path("out.exr"), name).pixels, all[name].pixels) << list << " " << name;
  }
}

TEST_F(Outputs, PicturesComeInTheKindOfTheirEnding) {
  const Finished done =
      run_tool({path("in.exr"), "-o", path("a.png"), "-o", path("b.jpg"), "-o", path("c.TIFF"),
                "-o", path("d.jpeg"), "--save", "ao=" + path("e.tif"), "--save",
                "direct=" + path("f.png"), "--save", "bounce=" + path("g.exr"), "--bits", "16"});
  EXPECT_EQ(done.code, 0) << done.err;
  struct Kind {
    std::string name, format;
    int channels;
    OIIO::TypeDesc type;
  };
  for (const Kind& kind : {Kind{"a.png", "png", 4, OIIO::TypeDesc::UINT16},
                           {"b.jpg", "jpeg", 3, OIIO::TypeDesc::UINT8},
                           {"c.TIFF", "tiff", 4, OIIO::TypeDesc::UINT16},
                           {"d.jpeg", "jpeg", 3, OIIO::TypeDesc::UINT8},
                           {"e.tif", "tiff", 1, OIIO::TypeDesc::UINT16},
                           {"f.png", "png", 3, OIIO::TypeDesc::UINT16}}) {
    const auto image = OIIO::ImageInput::open(path(kind.name));
    ASSERT_TRUE(image) << kind.name;
    EXPECT_EQ(image->format_name(), kind.format) << kind.name;
    EXPECT_EQ(image->spec().nchannels, kind.channels) << kind.name;
    EXPECT_EQ(image->spec().format, kind.type) << kind.name;
    EXPECT_EQ(image->spec().width, 64);
    EXPECT_EQ(image->spec().height, 48);
  }
  EXPECT_THAT(channel_names(path("g.exr")), ElementsAre("bounce.B", "bounce.G", "bounce.R"));
}

TEST_F(Outputs, ThePictureIsTheOnlyProductThatIsNamed) {
  const Finished done =
      run_tool({path("in.exr"), "-o", path("ao.png"), "-o", path("ao.exr"), "--products", "ao"});
  EXPECT_EQ(done.code, 0) << done.err;
  const auto image = OIIO::ImageInput::open(path("ao.png"));
  ASSERT_TRUE(image);
  EXPECT_EQ(image->spec().nchannels, 1);
  EXPECT_THAT(channel_names(path("ao.exr")), ElementsAre("ao.Y"));
}

TEST_F(Outputs, WithoutABounceTheCompositeIsAlbedoTimesDirect) {
  const Plane<float> bounce = run({"--bounces", "0"}, "bounce.R");
  EXPECT_EQ(sum(bounce), 0);
  const Plane<float> direct = channel(path("out.exr"), "direct.R"),
                     composite = channel(path("out.exr"), "R");
  for (std::size_t i = 0; i < direct.size(); ++i) ASSERT_FLOAT_EQ(composite[i], 0.5f * direct[i]);
}

TEST_F(Outputs, EveryBounceAddsLight) {
  const double one = sum(run({"--bounces", "1"}, "bounce.R")),
               two = sum(run({"--bounces", "2"}, "bounce.R")),
               eight = sum(run({"--bounces", "8"}, "bounce.R"));
  EXPECT_GT(one, 1);
  EXPECT_GT(two, 1.01 * one);
  EXPECT_GT(eight, two);
  EXPECT_LT(eight, 2 * one) << "with albedo 1/2 a bounce has less than half of the one before";
}

TEST_F(Outputs, EveryFlagOfTheModelMatters) {
  const auto plain = run({}).pixels;
  EXPECT_EQ(run({"--method",    "bitmask",  "--seed",  "0",           "--filter",
                 "geometry",    "--radius", "auto",    "--thickness", "auto",
                 "--offscreen", "extend",   "--prior", "learned",     "--quality",
                 "standard",    "--slices", "2",       "--steps",     "16"})
                .pixels,
            plain)
      << "these are the defaults";
  for (const std::vector<std::string>& flags : {std::vector<std::string>{"--seed", "1"},
                                                {"--filter", "none"},
                                                {"--radius", "0.2"},
                                                {"--thickness", "0.05"},
                                                {"--thickness", "inf"},
                                                {"--offscreen", "open"},
                                                {"--prior", "rules"},
                                                {"--quality", "draft"},
                                                {"--quality", "final"},
                                                {"--slices", "5"},
                                                {"--steps", "9"},
                                                {"--method", "ssdo"}}) {
    EXPECT_NE(run(flags).pixels, plain) << flags[0] << " " << flags[1];
  }
}

TEST_F(Outputs, BentNormalsAreUnitOnSurfacesAndNothingElsewhere) {
  std::filesystem::copy_file(data("still_life.exr"), path("in.exr"),
                             std::filesystem::copy_options::overwrite_existing);
  const Plane<float> x = run({"--products", "bent"}, "bent.X"),
                     y = channel(path("out.exr"), "bent.Y"), z = channel(path("out.exr"), "bent.Z"),
                     depth = channel(path("in.exr"), "ViewLayer.Depth.Z");
  int outside = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool is_outside = depth[i] > 1e9f;
    ASSERT_NEAR(x[i] * x[i] + y[i] * y[i] + z[i] * z[i], is_outside ? 0 : 1, 1e-4);
    outside += is_outside;
  }
  EXPECT_GT(outside, 10000);
}

TEST_F(Outputs, APictureOfBentShowsDirectionsAsColours) {
  run({"--products", "bent", "-o", path("bent.png"), "--bits", "16"}, "bent.X");
  const auto image = OIIO::ImageInput::open(path("bent.png"));
  ASSERT_TRUE(image);
  ASSERT_EQ(image->spec().nchannels, 3);
  std::vector<float> values(64 * 48 * 3);
  ASSERT_TRUE(image->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, values.data()));
  for (std::size_t c = 0; c < 3; ++c) {
    const Plane<float> bent = channel(path("out.exr"), std::string("bent.") + "XYZ"[c]);
    for (std::size_t i = 0; i < bent.size(); ++i)
      ASSERT_NEAR(values[3 * i + c], 0.5f + 0.5f * bent[i], 1e-4) << "XYZ"[c];
  }
}

TEST_F(Outputs, EveryParameterOfMethodSsdoMatters) {
  const auto ssdo = [&](std::vector<std::string> flags, const std::string& name = "ao.Y") {
    flags.insert(flags.end(), {"--method", "ssdo"});
    return run(flags, name).pixels;
  };
  const auto plain = ssdo({});
  EXPECT_EQ(ssdo({"--seed", "0", "--filter", "geometry", "--radius", "auto", "--set", "samples=16",
                  "--set", "strength=1"}),
            plain)
      << "these are the defaults";
  for (const std::vector<std::string>& flags : {std::vector<std::string>{"--seed", "1"},
                                                {"--seed", "4294967295"},
                                                {"--filter", "none"},
                                                {"--radius", "0.2"},
                                                {"--set", "samples=64"},
                                                {"--set", "singularity=0.2"},
                                                {"--set", "bias=0.3"},
                                                {"--set", "strength=0.5"}}) {
    EXPECT_NE(ssdo(flags), plain) << flags[0] << " " << flags[1];
  }
  const auto bounce = ssdo({}, "bounce.R");
  EXPECT_NE(ssdo({"--set", "bounce-strength=2"}, "bounce.R"), bounce);
  EXPECT_NE(ssdo({"--set", "bounce-singularity=0.1"}, "bounce.R"), bounce);
  EXPECT_EQ(ssdo({"--set", "bounce-strength=2"}), plain) << "occlusion is not its business";
}

TEST_F(Outputs, ARadianceLayerSendsInPlaceOfTheAlbedo) {
  FramePart part = frame_of(small_picture());
  part.add("glow", Plane<glm::vec3>(64, 48, {3, 0, 0}), "RGB");
  write_frame(path("in.exr"), part);
  const double plain = sum(run({}, "bounce.R"));
  const double glowing = sum(run({"--aov", "radiance=glow"}, "bounce.R"));
  EXPECT_GT(glowing, 3 * plain) << "3 is more than 6 times what albedo 1/2 in light 1 sends";
  EXPECT_EQ(sum(channel(path("out.exr"), "bounce.G")), 0);
}

}  // namespace
}  // namespace ssdo::test::outputs_test
