// SPDX-License-Identifier: Apache-2.0
#include "io/pictures/transfer_curve.h"

#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <cmath>

namespace ssdo::test::transfer_curve_test {
namespace {

float decoded(const std::string& space, float value) {
  const auto curve = curve_of(space);
  return curve ? curve->to_linear(value) : -1;
}

/// IEC 61966-2-1, ITU-R BT.709, and powers.
TEST(TransferCurve, IsTheOneOfTheStandard) {
  EXPECT_NEAR(decoded("sRGB", 0.5f), 0.21404, 1e-5);
  EXPECT_NEAR(decoded("sRGB", 0.04f), 0.04 / 12.92, 1e-6);
  EXPECT_NEAR(decoded("sRGB", -0.5f), -0.21404, 1e-5);
  EXPECT_NEAR(decoded("Rec709", 0.5f), 0.25964, 1e-4);
  EXPECT_NEAR(decoded("Gamma2.2", 0.5f), std::pow(0.5, 2.2), 1e-6);
  EXPECT_NEAR(decoded("g18_rec709_scene", 0.5f), std::pow(0.5, 1.8), 1e-6);
  for (const char* space : {"sRGB", "Rec709", "g24_rec709_display", "AdobeRGB"})
    EXPECT_NEAR(decoded(space, 1), 1, 1e-6) << space;
}

TEST(TransferCurve, IsFoundByName) {
  using Kind = TransferCurve::Kind;
  for (const char* space : {"sRGB", "srgb_rec709_scene", "srgb_texture", "srgb_ap1_scene",
                            "Utility - sRGB - Texture", "sRGB Encoded Rec.709 (sRGB)"}) {
    ASSERT_TRUE(curve_of(space)) << space;
    EXPECT_EQ(curve_of(space)->kind, Kind::srgb) << space;
  }
  EXPECT_EQ(curve_of("Rec.1886 Rec.709 - Display")->kind, Kind::power);
  for (const char* space : {"ACEScct", "KodakLog", "pq_rec2020_display", "ARRI LogC4"})
    EXPECT_EQ(curve_of(space)->kind, Kind::unknown) << space;
  for (const char* space : {"linear", "Linear Rec.709 (sRGB)", "lin_srgb", "lin_rec709_scene",
                            "Utility - Linear - sRGB", "ACEScg", "ACES2065-1", "data", "raw", ""})
    EXPECT_FALSE(curve_of(space)) << space;
}

TEST(TransferCurve, TheInteropIdOfAHeaderComesFirst) {
  Imf::Header header;
  EXPECT_FALSE(curve_of(header));
  header.insert("oiio:ColorSpace", Imf::StringAttribute("sRGB"));
  EXPECT_TRUE(curve_of(header));
  header.insert("colorInteropID", Imf::StringAttribute("lin_rec709_scene"));
  EXPECT_FALSE(curve_of(header));
}

}  // namespace
}  // namespace ssdo::test::transfer_curve_test
