// SPDX-License-Identifier: Apache-2.0
//
// The range of light and its primaries. Issue 12, number 11: light beyond the range of numbers made
// pictures of NaN, black ones, and a crash.
#include "relight/lighting.h"

#include <ImfChromaticitiesAttribute.h>
#include <gtest/gtest.h>

#include "math/light_range.h"
#include "support/error_matchers.h"
#include "support/frame_file.h"
#include "support/temp_dir.h"

namespace ssdo::test::lighting_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Window kWindow{0, 0, 16, 8};
constexpr Chromaticities kP3D65 = {.680f, .320f, .265f, .690f, .150f, .060f, .3127f, .3290f};

class LightRange : public testing::Test {
 protected:
  /// A grey map.
  std::string map(float value, const std::optional<Chromaticities>& primaries = {}) const {
    FramePart part{"", kWindow, kWindow, {}, Imf::FLOAT, {}};
    for (const char* c : {"R", "G", "B"}) part.channels[c] = Plane<float>(16, 8, value);
    if (primaries) {
      const Chromaticities& p = *primaries;
      part.extra.insert("chromaticities",
                        Imf::ChromaticitiesAttribute(Imf::Chromaticities(
                            {p[0], p[1]}, {p[2], p[3]}, {p[4], p[5]}, {p[6], p[7]})));
      part.channels["G"] = part.channels["B"] = Plane<float>(16, 8, 0);
    }
    write_frame(dir_ / "map.exr", part);
    return dir_ / "map.exr";
  }

  static Lighting light(const std::string& env, double stops = 0) {
    LightOptions options;
    options.env = env;
    options.exposure_stops = stops;
    return Lighting(options);
  }

  static std::vector<std::string> warnings(const Lighting& of) {
    return of.around(UpAxis::y, std::nullopt).warnings;
  }

  TempDir dir_;
};

TEST_F(LightRange, ColoursAreFiniteAndNotNegative) {
  for (const char* env : {"-1", "1,-0.1,1", "1,1,1e16", "1e39"}) {
    EXPECT_THAT(error_of([&] { light(env); }), IsError(ExitCode::usage, "--env")) << env;
  }
  const Environment brightest = light("1e15,0,1").around(UpAxis::y, {}).environment;
  EXPECT_EQ(brightest.constant_radiance(), glm::vec3(kBrightest, 0, 1));
}

/// They were looked for as files.
TEST_F(LightRange, ColoursMayHaveBlanksAndWrongOnesAreNamed) {
  for (const char* env : {"1, 2, 3", " 1,2,3 ", "1 ,2\t,3"}) {
    EXPECT_EQ(light(env).around(UpAxis::y, {}).environment.constant_radiance(), glm::vec3(1, 2, 3))
        << env;
  }
  EXPECT_THAT(error_of([&] { light("0.5,0.5"); }), IsError(ExitCode::usage, "these are 2 numbers"));
  for (const char* env : {"nan", "inf", "1,nan,1", "1 2 3", "1,,2", "1;2;3", "1e"})
    EXPECT_THAT(error_of([&] { light(env); }), IsError(ExitCode::usage, "is R,G,B or one")) << env;
  for (const char* env : {"info.exr", "nan.hdr", "1x.exr"})
    EXPECT_THAT(error_of([&] { light(env); }), IsError(ExitCode::input, "does not exist")) << env;
}

TEST_F(LightRange, ExposureEndsWhereLightDoes) {
  EXPECT_THAT(error_of([&] { light("1", 80); }),
              IsError(ExitCode::usage,
                      "--env-exposure 80: makes the brightest light of --env 1 1.2e+24, and 1e+15 "
                      "is the most; give 49 stops or less"));
  const float exposed = light("1", 49).around(UpAxis::y, {}).environment.constant_radiance().x;
  EXPECT_EQ(exposed, std::exp2(49.0f));
  EXPECT_THAT(error_of([&] { light(map(1000), 49); }),
              IsError(ExitCode::usage, "give 39 stops or less"));
  EXPECT_EQ(light(map(1000), 39).around(UpAxis::y, {}).environment.gain(), std::exp2(39.0f));
  EXPECT_THAT(warnings(light("1", -80)), ElementsAre(HasSubstr("more --env-exposure")));
  EXPECT_THAT(warnings(light(map(1), -80)), ElementsAre(HasSubstr("more --env-exposure")));
  EXPECT_THAT(warnings(light("1", -20)), IsEmpty());
}

TEST_F(LightRange, DimIsTheLightAndNotTheBrightestTexel) {
  FramePart part{"", kWindow, kWindow, {}, Imf::FLOAT, {}};
  Plane<float> star(16, 8, 0.0f);
  star(3, 3) = 1e-6f;  // holds in half, and gives surfaces 3e-8 at most
  for (const char* c : {"R", "G", "B"}) part.channels[c] = star;
  write_frame(dir_ / "star.exr", part);
  EXPECT_THAT(warnings(light(dir_ / "star.exr")), ElementsAre(HasSubstr("more --env-exposure")));
  EXPECT_THAT(warnings(light(dir_ / "star.exr", 3)), IsEmpty());
}

/// What surfaces beyond the border hide of lamps depends on it, in a constant light as well.
TEST(Lighting, TakesTheAxisThatIsUpWithLamps) {
  LightOptions options;
  EXPECT_FALSE(Lighting(options).needs_up());
  options.lamps = {"distant direction=0,0,-1"};
  EXPECT_TRUE(Lighting(options).needs_up());
  EXPECT_EQ(Lighting(options).around(UpAxis::z, {}).environment.frame().up, UpAxis::z);
  options.up = UpAxis::y;
  EXPECT_FALSE(Lighting(options).needs_up());
  EXPECT_EQ(Lighting(options).around(UpAxis::z, {}).environment.frame().up, UpAxis::y);
}

TEST_F(LightRange, ABlackMapIsMentioned) {
  EXPECT_THAT(warnings(light(map(0))), ElementsAre(HasSubstr("map.exr: is black")));
  EXPECT_THAT(warnings(light(map(0.1f))), IsEmpty());
  EXPECT_THAT(warnings(light("0")), IsEmpty()) << "as asked";
}

/// P3's red in Rec.709, as in SMPTE EG 432-1.
TEST_F(LightRange, AMapIsConvertedToTheFramesPrimaries) {
  const Lighting tagged = light(map(1, kP3D65));
  const FrameEnvironment in_rec709 = tagged.around(UpAxis::y, kRec709);
  const glm::vec3 red = in_rec709.environment.radiance({0, 0, 1});
  EXPECT_NEAR(red.x, 1.2249, 1e-3);
  EXPECT_NEAR(red.y, -0.0420, 1e-3);
  EXPECT_THAT(in_rec709.warnings, IsEmpty());
  EXPECT_THAT(in_rec709.description, HasSubstr("converted from P3-D65"));
  EXPECT_EQ(tagged.around(UpAxis::y, kP3D65).environment.radiance({0, 0, 1}), glm::vec3(1, 0, 0));
  const FrameEnvironment unknown = tagged.around(UpAxis::y, std::nullopt);
  EXPECT_EQ(unknown.environment.radiance({0, 0, 1}), glm::vec3(1, 0, 0));
  EXPECT_THAT(unknown.warnings, ElementsAre(HasSubstr("has the primaries of P3-D65")));
  EXPECT_THAT(light(map(1)).around(UpAxis::y, kP3D65).warnings, IsEmpty())
      << "a map that says nothing has those of the frame";
}

}  // namespace
}  // namespace ssdo::test::lighting_test
