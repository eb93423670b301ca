// SPDX-License-Identifier: Apache-2.0
//
// Planck's law, seen with the colour matching functions of the CIE 1931 observer as fitted by
// Wyman, Sloan and Shirley 2013, Simple Analytic Approximations to the CIE XYZ Color Matching
// Functions.
#include "scene/light/lamps/blackbody.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

namespace ssdo {
namespace {

/// A Gaussian with another width on each side, in nanometres.
double lobe(double at, double middle, double below, double above) {
  const double t = (at - middle) * (at < middle ? below : above);
  return std::exp(-0.5 * t * t);
}

glm::dvec3 observer(double nm) {
  return {1.056 * lobe(nm, 599.8, 0.0264, 0.0323) + 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) -
              0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
          0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
          1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

/// In linear Rec. 709, in no unit; colours outside of it are cut off.
glm::dvec3 raw_color(double kelvin) {
  constexpr double kSecondConstant = 1.438776877e7;  // h c / k in nanometres times kelvin
  glm::dvec3 xyz(0);
  for (int nm = 380; nm <= 780; nm += 5) {
    const double x = 560.0 / nm;
    xyz += observer(nm) * std::pow(x, 5) / std::expm1(kSecondConstant / (nm * kelvin));
  }
  const glm::dmat3 to_rec709(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259,
                             -0.4985314, 0.0415560, 1.0572252);
  return glm::max(to_rec709 * xyz, glm::dvec3(0));
}

}  // namespace

glm::dvec3 blackbody_color(double kelvin) {
  const glm::dvec3 color = raw_color(kelvin) / raw_color(kWhiteKelvin);
  return color / glm::dot(color, glm::dvec3(0.2126, 0.7152, 0.0722));
}

}  // namespace ssdo
