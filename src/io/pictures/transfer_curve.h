// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfHeader.h>

#include <optional>
#include <string>

namespace ssdo {

/// How a colour space that is not linear encodes light.
struct TransferCurve {
  enum class Kind { srgb, rec709, power, unknown };

  std::string space;  ///< as the file calls it
  Kind kind = Kind::unknown;
  float exponent = 1;  ///< of `power`

  /// Linear light from a code value, 1 from 1; negative values are mirrored. The value itself where
  /// the curve is unknown.
  float to_linear(float value) const;
};

/// The curve of a colour space by what OpenImageIO, the Color Interop Forum and the ACES configs
/// call it ("sRGB", "srgb_rec709_scene", "Utility - sRGB - Texture", "g22_ap1_scene", "Gamma2.2").
/// Nothing for linear spaces and for names that say nothing of a curve.
std::optional<TransferCurve> curve_of(const std::string& space);

/// The curve of the space that a header names: colorInteropID, else oiio:ColorSpace.
std::optional<TransferCurve> curve_of(const Imf::Header& header);

}  // namespace ssdo
