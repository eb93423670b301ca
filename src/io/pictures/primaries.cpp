// SPDX-License-Identifier: Apache-2.0
#include "io/pictures/primaries.h"

#include <ImathMatrix.h>
#include <ImfChromaticities.h>
#include <ImfChromaticitiesAttribute.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ssdo {
namespace {

/// Matrix from XYZ to cone responses, for row vectors: K. M. Lam, "Metamerism and Colour
/// Constancy", 1985, as in ICC.1:2022, annex E.
const Imath::M44f kBradford(0.8951f, -0.7502f, 0.0389f, 0,  //
                            0.2664f, 1.7135f, -0.0685f, 0,  //
                            -0.1614f, 0.0367f, 1.0296f, 0,  //
                            0, 0, 0, 1);

/// XYZ of white at a luminance of 1.
Imath::V3f white_of(const Imf::Chromaticities& c) {
  return Imath::V3f(c.white.x, c.white.y, 1 - c.white.x - c.white.y) / c.white.y;
}

Imath::M44f adaptation(const Imath::V3f& from, const Imath::V3f& to) {
  const Imath::V3f scale = (to * kBradford) / (from * kBradford);
  Imath::M44f scaling;
  scaling.setScale(scale);
  return kBradford * scaling * kBradford.inverse();
}

/// Least area of the triangle of a set's colours: those of Rec. 709 span 0.11.
constexpr float kLeastArea = 1e-4f;

float area(const Imf::Chromaticities& c) {
  return 0.5f * std::abs((c.green - c.red) % (c.blue - c.red));
}

Imf::Chromaticities unpack(const Chromaticities& c) {
  return {{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}};
}

}  // namespace

std::optional<Chromaticities> chromaticities_of(const Imf::Header& header) {
  const auto* found = header.findTypedAttribute<Imf::ChromaticitiesAttribute>("chromaticities");
  if (!found) return std::nullopt;
  const Imf::Chromaticities& c = found->value();
  return Chromaticities{c.red.x,  c.red.y,  c.green.x, c.green.y,
                        c.blue.x, c.blue.y, c.white.x, c.white.y};
}

bool same_chromaticities(const Chromaticities& a, const Chromaticities& b) {
  return std::equal(a.begin(), a.end(), b.begin(),
                    [](float x, float y) { return std::abs(x - y) < 1e-3f; });
}

std::optional<glm::mat3> conversion_of_primaries(const Chromaticities& from,
                                                 const Chromaticities& to) try {
  const Imf::Chromaticities a = unpack(from), b = unpack(to);
  if (area(a) < kLeastArea || area(b) < kLeastArea) return std::nullopt;
  const Imath::M44f m =
      Imf::RGBtoXYZ(a, 1) * adaptation(white_of(a), white_of(b)) * Imf::XYZtoRGB(b, 1);
  glm::mat3 matrix;  // a row of Imath, as a column of glm, is what one channel becomes
  bool finite = true;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      matrix[i][k] = m[i][k];
      // Sets in use differ by factors below 10.
      finite = finite && std::abs(m[i][k]) < 100;
    }
  }
  return finite ? std::optional(matrix) : std::nullopt;
} catch (const std::invalid_argument&) {
  return std::nullopt;  // the white of a set has no luminance
}

}  // namespace ssdo
