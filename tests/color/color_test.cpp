// SPDX-License-Identifier: Apache-2.0
#include "color/color.h"

#include <OpenColorIO/OpenColorIO.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <thread>
#include <vector>

#include "support/color_fixture.h"

namespace ssdo::test::color_test {
namespace {

using Color = ColorFixture;

// ---- The built-in config.

TEST_F(Color, AcesViewHasKnownValues) {
  const ColorOptions options{.colorspace = "ACEScg"};
  EXPECT_NEAR(shown_grey(options, 0.18f), 0.3560f, 5e-4f);
  EXPECT_NEAR(shown_grey(options, 1.0f), 0.8120f, 5e-4f);
  EXPECT_NEAR(shown_grey(options, 16.0f), 0.9997f, 5e-4f);
}

TEST_F(Color, LinearSpacesShareTheirWhite) {
  for (const char* name : {"lin_rec709", "ACEScg", "ACES2065-1"}) {
    const ColorOptions options{.colorspace = name, .view = "Un-tone-mapped"};
    const glm::vec3 white = shown(DisplayTransform(options, {}), glm::vec3(1));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(white[i], 1.0f, 5e-4f) << name;
  }
}

/// AP1's red holds 1.70505 of Rec.709's: the first entry of the matrix with Bradford adaptation.
TEST_F(Color, PrimariesDiffer) {
  const glm::vec3 red(1, 0, 0);
  const glm::vec3 rec709 = shown(DisplayTransform({.view = "Un-tone-mapped"}, {}), red);
  EXPECT_NEAR(rec709.x, 1.0f, 5e-4f);
  EXPECT_NEAR(rec709.y, 0.0f, 2e-3f);
  const ColorOptions ap1{
      .colorspace = "ACEScg", .display = "Rec.1886 Rec.709", .view = "Un-tone-mapped"};
  EXPECT_NEAR(shown(DisplayTransform(ap1, {}), red).x, std::pow(1.70505f, 1 / 2.4f), 1e-3f);
}

float srgb(float v) {
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}

TEST_F(Color, UnToneMappedIsTheDisplaysEncoding) {
  for (const float v : {0.0f, 0.001f, 0.0031f, 0.01f, 0.18f, 0.5f, 1.0f, 2.0f}) {
    EXPECT_NEAR(shown_grey({.view = "Un-tone-mapped"}, v), srgb(v), 5e-4f) << v;
    EXPECT_NEAR(shown_grey({.display = "Rec.1886 Rec.709", .view = "Un-tone-mapped"}, v),
                std::pow(v, 1 / 2.4f), 5e-4f)
        << v;
  }
  EXPECT_NEAR(srgb(0.18f), 0.4614f, 5e-5f);
}

TEST_F(Color, EncodedSpacesAreDecoded) {
  EXPECT_NEAR(shown_grey({.colorspace = "sRGB texture", .view = "Un-tone-mapped"}, 0.5f), 0.5f,
              5e-4f);
  // ACEScct of mid-grey, ACES S-2016-001.
  EXPECT_NEAR(shown_grey({.colorspace = "ACEScct", .view = "Un-tone-mapped"}, 0.4135884f),
              srgb(0.18f), 5e-4f);
}

TEST_F(Color, RawViewAndRawInputAreLeftAlone) {
  EXPECT_EQ(shown_grey({.view = "Raw"}, 0.18f), 0.18f);
  EXPECT_EQ(shown_grey({.colorspace = "Raw"}, 0.18f), 0.18f);
}

TEST_F(Color, GamutCompressionActsOnColoursOutsideAp1Only) {
  const ColorOptions plain{.colorspace = "ACEScg", .view = "Un-tone-mapped"};
  ColorOptions compressed = plain;
  compressed.look = "ACES Gamut Compression";
  const DisplayTransform without(plain, {}), with(compressed, {});
  const glm::vec3 inside(0.5f, 0.4f, 0.3f), outside(0.1f, -0.2f, 1.0f);
  EXPECT_NEAR(shown(with, inside).z, shown(without, inside).z, 1e-4f);
  EXPECT_GT(shown(with, outside).y, shown(without, outside).y + 0.1f);
}

TEST_F(Color, BuiltInConfigIsTheInstalledOne) {
  const std::string file = SSDO_SOURCE_DIR "/data/color/config.ocio";
  for (const char* view : {"ACES SDR Video", "Un-tone-mapped"}) {
    const DisplayTransform built_in({.view = view}, {}),
        installed({.ocio = file, .view = view}, {});
    const glm::vec3 color(0.7f, 0.2f, 0.05f);
    EXPECT_EQ(shown(built_in, color), shown(installed, color)) << view;
  }
}

TEST_F(Color, DefaultsAreRec709ToSrgbByAces) {
  EXPECT_EQ(description({}),
            "colour by the built-in config: lin_rec709 (role scene_linear) to display sRGB, "
            "view ACES SDR Video");
}

// ---- Which config, display, view and look.

TEST_F(Color, OptionOverVariableOverBuiltIn) {
  setenv("OCIO", gains().c_str(), 1);
  EXPECT_FLOAT_EQ(shown_grey({}, 1), 13);
  EXPECT_THAT(description({}), testing::HasSubstr("$OCIO " + gains()));
  const std::string other = write("other.ocio", config_of_gains("  scene_linear: Plate\n"));
  EXPECT_FLOAT_EQ(shown_grey({.ocio = other}, 1), 11);
  EXPECT_THAT(description({.ocio = other}), testing::HasSubstr("--ocio " + other));
}

TEST_F(Color, EmptyVariableCountsAsUnset) {
  setenv("OCIO", "", 1);
  EXPECT_THAT(description({}), testing::HasSubstr("the built-in config"));
}

TEST_F(Color, DisplayAndViewAreAsAskedWhateverTheCase) {
  const std::string file = gains();
  EXPECT_FLOAT_EQ(shown_grey({.ocio = file, .view = "tripled"}, 1), 13 * 3);
  EXPECT_FLOAT_EQ(shown_grey({.ocio = file, .display = "PROJECTOR"}, 1), 13 * 3);
  EXPECT_THAT(description({.ocio = file, .display = "PROJECTOR"}),
              testing::EndsWith("to display Projector, view Bright"));
}

TEST_F(Color, LookTakesThePlaceOfTheViewsOwn) {
  const std::string file = gains();
  EXPECT_FLOAT_EQ(shown_grey({.ocio = file, .look = "double"}, 1), 13 * 2);
  EXPECT_FLOAT_EQ(shown_grey({.ocio = file, .view = "Tripled", .look = "double"}, 1), 13 * 2);
  EXPECT_THAT(description({.ocio = file, .look = "double"}),
              testing::EndsWith("view Plain, look double"));
}

// ---- What cannot be.

TEST_F(Color, NamesThatDoNotExistAreAnsweredByThoseThatDo) {
  EXPECT_THAT(refusal({.colorspace = "ACEScc"}),
              IsError(ExitCode::usage,
                      "--colorspace ACEScc: the built-in config has no such colour space; did you "
                      "mean ACEScg? it has: "));
  EXPECT_THAT(refusal({.colorspace = "ACEScc"}),
              IsError(ExitCode::usage, "lin_rec709, ACEScg, ACEScct"));
  EXPECT_THAT(refusal({.display = "P3"}), IsError(ExitCode::usage, "--display P3: "));
  EXPECT_THAT(refusal({.display = "P3"}), IsError(ExitCode::usage, "has: sRGB, Rec.1886 Rec.709"));
  EXPECT_THAT(refusal({.view = "Filmic"}), IsError(ExitCode::usage, "--view Filmic: "));
  EXPECT_THAT(refusal({.view = "Filmic"}),
              IsError(ExitCode::usage, "has: ACES SDR Video, Un-tone-mapped, Raw"));
  EXPECT_THAT(
      refusal({.ocio = gains(), .display = "Projector", .view = "Plain"}),
      IsError(ExitCode::usage, "display Projector of --ocio " + gains() + "; it has: Bright"));
  EXPECT_THAT(refusal({.look = "Punchy"}), IsError(ExitCode::usage, "--look Punchy: "));
  EXPECT_THAT(refusal({.look = "Punchy"}), IsError(ExitCode::usage, "has: ACES Gamut Compression"));
}

TEST_F(Color, ConfigWithoutSceneLinearNeedsColorspace) {
  const std::string file = write("no_role.ocio", config_of_gains(""));
  EXPECT_THAT(refusal({.ocio = file}), IsError(ExitCode::usage, "has no role scene_linear"));
  EXPECT_THAT(refusal({.ocio = file}),
              IsError(ExitCode::usage, "--colorspace, one of: Reference, Raw"));
  EXPECT_FLOAT_EQ(shown_grey({.ocio = file, .colorspace = "Plate"}, 1), 11);
}

TEST_F(Color, ConfigsThatCannotBeReadAreInputErrors) {
  const std::string missing = (dir_ / "missing.ocio").string();
  EXPECT_THAT(refusal({.ocio = missing}), IsError(ExitCode::input, "--ocio " + missing));
  EXPECT_THAT(refusal({.ocio = dir_.path().string()}), IsError(ExitCode::input, "is a folder"));
  EXPECT_THAT(refusal({.ocio = write("text.ocio", "no config\n")}),
              IsError(ExitCode::input, "text.ocio"));
  EXPECT_THAT(refusal({.ocio = write("new.ocio", "ocio_profile_version: 99\n")}),
              IsError(ExitCode::input, "99"));
  setenv("OCIO", missing.c_str(), 1);
  EXPECT_THAT(refusal({}), IsError(ExitCode::input, "$OCIO " + missing));
}

TEST_F(Color, FilesThatTheConfigLacksAreNamed) {
  EXPECT_THAT(refusal({.ocio = gains(), .view = "Broken"}), IsError(ExitCode::input, "gone.cube"));
  EXPECT_THAT(refusal({.ocio = gains(), .view = "Broken"}), IsError(ExitCode::input, "--view"));
}

#if OCIO_VERSION_HEX < 0x02020000
TEST_F(Color, ConfigUrisNeedALaterOpenColorIO) {
  setenv("OCIO", "ocio://default", 1);
  EXPECT_THAT(refusal({}), IsError(ExitCode::input, "$OCIO ocio://default: "));
  EXPECT_THAT(refusal({}), IsError(ExitCode::input, "pass --ocio FILE, or unset OCIO"));
}
#else
TEST_F(Color, ConfigUrisAreThoseOfTheLibrary) {
  // The values of ACES, as of the built-in config.
  const ColorOptions aces{.ocio = "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1",
                          .colorspace = "ACEScg"};
  EXPECT_NEAR(shown_grey(aces, 0.18f), 0.3560f, 5e-4f);
  EXPECT_NEAR(shown_grey(aces, 1.0f), 0.8120f, 5e-4f);
  setenv("OCIO", "ocio://default", 1);
  EXPECT_THAT(description({}), testing::HasSubstr("$OCIO ocio://default"));
  EXPECT_THAT(refusal({.ocio = "ocio://none"}), IsError(ExitCode::input, "--ocio ocio://none"));
}
#endif

// ---- Applying it.

std::vector<glm::vec3> ramp(std::size_t count) {
  std::vector<glm::vec3> colors(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float t = float(i) / float(count);
    colors[i] = {4 * t * t, t, 0.5f - t};
  }
  return colors;
}

bool same_bits(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(), [](const glm::vec3& p, const glm::vec3& q) {
        for (int i = 0; i < 3; ++i) {
          if (std::bit_cast<std::uint32_t>(p[i]) != std::bit_cast<std::uint32_t>(q[i]))
            return false;
        }
        return true;
      });
}

TEST_F(Color, ThreadsAndSplitsDoNotMatter) {
  const DisplayTransform display({}, {});
  std::vector<glm::vec3> whole = ramp(4001), split = whole;
  display.apply(whole);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t i = t; i < split.size(); i += 4)
        display.apply(std::span(split).subspan(i, 1));
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(same_bits(whole, split));
  EXPECT_FALSE(same_bits(whole, ramp(4001)));
}

TEST_F(Color, NothingIsFine) { DisplayTransform({}, {}).apply({}); }

TEST_F(Color, ExtremesStayBright) {
  const float brightest = shown_grey({}, 65504.0f);
  for (const float v : {1e10f, 1e30f, 3e38f, std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(shown_grey({}, v), brightest) << v;
    EXPECT_EQ(shown_grey({}, -v), shown_grey({}, -65504.0f)) << v;
  }
}

TEST_F(Color, OpenColorIOWritesNothingItself) {
  const std::string warns = config_of_gains() + "inactive_colorspaces: [Nobody]\n";
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  description({.ocio = write("warns.ocio", warns)});
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Color, TransformsMayMove) {
  DisplayTransform first({.view = "Un-tone-mapped"}, {});
  const DisplayTransform second = std::move(first);
  EXPECT_NEAR(shown(second, glm::vec3(0.18f)).x, srgb(0.18f), 5e-4f);
}

}  // namespace
}  // namespace ssdo::test::color_test
