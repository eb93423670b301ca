// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfHeader.h>

#include <array>
#include <glm/mat3x3.hpp>
#include <optional>

namespace ssdo {

/// CIE x and y of red, green, blue and white, one after the other.
using Chromaticities = std::array<float, 8>;

/// ITU-R BT.709, which an EXR has unless it says otherwise.
inline constexpr Chromaticities kRec709 = {.64f, .33f, .30f, .60f, .15f, .06f, .3127f, .3290f};

/// What the header of a part says about its colours.
std::optional<Chromaticities> chromaticities_of(const Imf::Header& header);

/// Whether two sets are equal but for the rounding to three or four decimals that writers do.
bool same_chromaticities(const Chromaticities& a, const Chromaticities& b);

/// Turns linear colours of the primaries `from` into those of `to`, white into white by the
/// Bradford adaptation. Nothing where one of them spans no colours.
std::optional<glm::mat3> conversion_of_primaries(const Chromaticities& from,
                                                 const Chromaticities& to);

}  // namespace ssdo
