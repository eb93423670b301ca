// SPDX-License-Identifier: Apache-2.0
// Which colour space the input has. Gains: see config_of_gains.
#include <gtest/gtest.h>

#include "support/color_fixture.h"

namespace ssdo::test::color_space_test {
namespace {

using ColorSpace = ColorFixture;

constexpr Chromaticities kAp1 = {.713f, .293f, .165f, .830f, .128f, .044f, .32168f, .33767f};
constexpr Chromaticities kAp0 = {.7347f, .2653f, 0, 1, .0001f, -.0770f, .32168f, .33767f};
constexpr Chromaticities kP3D65 = {.680f, .320f, .265f, .690f, .150f, .060f, .3127f, .3290f};
constexpr Chromaticities kRec2020 = {.708f, .292f, .170f, .797f, .131f, .046f, .3127f, .3290f};

TEST_F(ColorSpace, EachRuleYieldsToTheOneBeforeIt) {
  ColorOptions options{.ocio = gains()};
  ColorTags tags{"/shots/a_plate.exr", "lin_rec709_scene", true, kAp1};
  EXPECT_THAT(description(options, tags),
              testing::HasSubstr("lin_rec709 (colorInteropID lin_rec709_scene)"));
  EXPECT_FLOAT_EQ(shown_grey(options, 1, tags), 3);
  options.colorspace = "Reference";
  EXPECT_THAT(description(options, tags), testing::HasSubstr("Reference (--colorspace)"));
  EXPECT_FLOAT_EQ(shown_grey(options, 1, tags), 1);
  options.colorspace.clear();
  tags.interop_id.clear();
  EXPECT_THAT(description(options, tags),
              testing::HasSubstr("ACES2065-1 (acesImageContainerFlag)"));
  EXPECT_FLOAT_EQ(shown_grey(options, 1, tags), 7);
  tags.aces_container = false;
  EXPECT_THAT(description(options, tags),
              testing::HasSubstr("ACES - ACEScg (chromaticities of AP1"));
  EXPECT_FLOAT_EQ(shown_grey(options, 1, tags), 5);
  tags.chromaticities.reset();
  EXPECT_THAT(description(options, tags), testing::HasSubstr("Plate (file rule plates)"));
  EXPECT_FLOAT_EQ(shown_grey(options, 1, tags), 11);
  tags.path = "/shots/a.exr";
  EXPECT_THAT(description(options, tags), testing::HasSubstr("Linear (role scene_linear)"));
  EXPECT_FLOAT_EQ(shown_grey(options, 1, tags), 13);
}

TEST_F(ColorSpace, InteropIdsFindSpacesOfOtherNames) {
  const ColorOptions options{.ocio = gains()};
  EXPECT_FLOAT_EQ(shown_grey(options, 1, {.interop_id = "lin_ap1_scene"}), 5);
  EXPECT_FLOAT_EQ(shown_grey(options, 1, {.interop_id = "Plate"}), 11);
}

TEST_F(ColorSpace, TagsOfDataArePassedOver) {
  const ColorOptions options{.ocio = gains()};
  const ColorTags tagged{.path = "a_mask.exr", .interop_id = "data"};
  EXPECT_FLOAT_EQ(shown_grey(options, 1, tagged), 13);
  EXPECT_THAT(description(options, tagged),
              testing::EndsWith("; passed over: colorInteropID data (data, no colours), "
                                "file rule masks (data, no colours)"));
}

TEST_F(ColorSpace, TagsThatTheConfigDoesNotKnowArePassedOverWithAWarning) {
  const ColorTags tags{.interop_id = "lin_nobody\nknows"};
  EXPECT_THAT(description({}, tags), testing::HasSubstr("lin_rec709 (role scene_linear)"));
  EXPECT_THAT(description({}, tags),
              testing::EndsWith("; passed over: colorInteropID lin_nobody knows (not in the "
                                "config)"));
  EXPECT_THAT(DisplayTransform({}, tags).warning(),
              testing::StartsWith("colorInteropID lin_nobody knows (not in the config): its "
                                  "colours are taken as lin_rec709"));
  EXPECT_EQ(DisplayTransform({}, {}).warning(), "");
  EXPECT_EQ(DisplayTransform({}, {.interop_id = "data"}).warning(), "");
  EXPECT_EQ(DisplayTransform({.colorspace = "ACEScg"}, tags).warning(), "");
}

/// Issue 12, number 20: colours of primaries that the config lacks were taken as Rec.709 in
/// silence. What is shown is what a config that has them shows: their red in Rec.709 is ITU-R
/// BT.2087's for Rec.2020, and SMPTE's for P3 with the white of Rec.709.
TEST_F(ColorSpace, PrimariesThatTheConfigLacksAreConverted) {
  const ColorOptions linear{.ocio = write("plain.ocio",
                                          "ocio_profile_version: 2\n"
                                          "roles: {default: lin_rec709, scene_linear: lin_rec709}\n"
                                          "displays:\n"
                                          "  Monitor:\n"
                                          "    - !<View> {name: Plain, colorspace: lin_rec709}\n"
                                          "    - !<View> {name: Raw, colorspace: Raw}\n"
                                          "colorspaces:\n"
                                          "  - !<ColorSpace> {name: lin_rec709}\n"
                                          "  - !<ColorSpace> {name: Raw, isdata: true}\n")};
  const auto red = [&](const ColorTags& tags) {
    return shown(DisplayTransform(linear, tags), {1, 0, 0});
  };
  for (const ColorTags& tags :
       {ColorTags{.chromaticities = kRec2020}, ColorTags{.interop_id = "lin_rec2020_scene"}}) {
    EXPECT_NEAR(red(tags).x, 1.6605, 1e-3);
    EXPECT_NEAR(red(tags).y, -0.1246, 1e-3);
    EXPECT_NEAR(red(tags).z, -0.0182, 1e-3);
    EXPECT_THAT(description(linear, tags), testing::HasSubstr(", converted) to display"));
    EXPECT_EQ(DisplayTransform(linear, tags).warning(), "");
  }
  EXPECT_NEAR(red({.chromaticities = kP3D65}).x, 1.2249, 1e-3);
  EXPECT_NEAR(red({.chromaticities = kP3D65}).y, -0.0420, 1e-3);
  for (const Chromaticities& c : {kRec2020, kP3D65, kAp1, kAp0}) {
    const glm::vec3 white = shown(DisplayTransform(linear, {.chromaticities = c}), glm::vec3(1));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(white[i], 1, 1e-4) << "white stays white";
  }
  ColorOptions raw = linear;
  raw.view = "Raw";
  EXPECT_EQ(shown(DisplayTransform(raw, {.chromaticities = kRec2020}), {1, 0, 0}).y, 0);
  const ColorTags flat{.chromaticities = Chromaticities{.3f, .3f, .3f, .3f, .3f, .3f, .3f, .3f}};
  EXPECT_EQ(red(flat), glm::vec3(1, 0, 0));
  EXPECT_THAT(DisplayTransform(linear, flat).warning(), testing::HasSubstr("--colorspace"));
}

TEST_F(ColorSpace, EachKnownSetOfChromaticitiesFindsItsSpace) {
  const ColorOptions options{.ocio = gains()};
  EXPECT_FLOAT_EQ(shown_grey(options, 1, {.chromaticities = kRec709}), 3);
  EXPECT_FLOAT_EQ(shown_grey(options, 1, {.chromaticities = kAp1}), 5);
  EXPECT_FLOAT_EQ(shown_grey(options, 1, {.chromaticities = kAp0}), 7);
  EXPECT_FLOAT_EQ(shown_grey(options, 1, {.chromaticities = kP3D65}), 19);
  EXPECT_FLOAT_EQ(shown_grey(options, 1, {.chromaticities = kRec2020}), 23);
}

TEST_F(ColorSpace, ChromaticitiesMayBeRounded) {
  EXPECT_THAT(description({}, {.chromaticities = kRec709}),
              testing::HasSubstr("lin_rec709 (chromaticities"));
  EXPECT_THAT(description({}, {.chromaticities = kAp0}),
              testing::HasSubstr("ACES2065-1 (chromaticities"));
  Chromaticities off = kAp1;
  off[6] = 0.3220f;
  EXPECT_THAT(description({}, {.chromaticities = off}),
              testing::HasSubstr("ACEScg (chromaticities"));
  off[6] = 0.3127f;
  EXPECT_THAT(description({}, {.chromaticities = off}),
              testing::HasSubstr("chromaticities of no known space (0.713 0.293"));
}

TEST_F(ColorSpace, ColorspaceMayBeAnAliasOrARole) {
  EXPECT_THAT(description({.colorspace = "lin_ap1_scene"}),
              testing::HasSubstr("ACEScg (--colorspace)"));
  EXPECT_THAT(description({.colorspace = "compositing_log"}),
              testing::HasSubstr("ACEScct (--colorspace)"));
}

TEST_F(ColorSpace, NamesInThePathDoNotDecideUnderVersion1) {
  const std::string file =
      write("v1.ocio",
            "ocio_profile_version: 1\n"
            "roles: {default: log, scene_linear: linear}\n"
            "displays:\n  Monitor:\n    - !<View> {name: Plain, colorspace: linear}\n"
            "colorspaces:\n  - !<ColorSpace> {name: linear}\n" +
                space("log", 2));
  EXPECT_FLOAT_EQ(shown_grey({.ocio = file}, 1, {.path = "/catalog/a.exr"}), 1);
}

}  // namespace
}  // namespace ssdo::test::color_space_test
