// SPDX-License-Identifier: Apache-2.0
//
// Real orthonormal spherical harmonics up to order 4, after Ramamoorthi and Hanrahan 2001, An
// Efficient Representation for Irradiance Environment Maps, and Sloan 2008, Stupid Spherical
// Harmonics Tricks (without the sign (-1)^m of Condon and Shortley). Function l, m is at
// l * l + l + m; negative m are the sines of the azimuth.
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace ssdo {

constexpr int kShOrder = 4;
constexpr int kShCount = (kShOrder + 1) * (kShOrder + 1);

/// How many functions the orders 0..order have.
constexpr int sh_count(int order) { return (order + 1) * (order + 1); }

/// The factor by which the clamped cosine over pi scales each band: A_l / pi in the paper. Odd
/// bands above 1 have the factor 0, and band 6 has 1/64.
constexpr std::array<float, kShOrder + 1> kCosineFactors = {1, 2.0f / 3, 0.25f, 0, -1.0f / 24};

/// The factor by which the lobe max(0, cos - edge), scaled to an integral of 1, scales each band;
/// edge in [-1, 1). Edge 0 gives kCosineFactors.
std::array<double, kShOrder + 1> sh_lobe_factors(double edge);

/// The factors that make the polynomials of spherical_harmonics-inl.h orthonormal on the sphere.
constexpr std::array<float, kShCount> kShConstants = {
    0.2820947918f, 0.4886025119f, 0.4886025119f, 0.4886025119f, 1.0925484306f,
    1.0925484306f, 0.3153915653f, 1.0925484306f, 0.5462742153f, 0.5900435899f,
    2.8906114426f, 0.4570457995f, 0.3731763326f, 0.4570457995f, 1.4453057213f,
    0.5900435899f, 2.5033429418f, 1.7701307698f, 0.9461746958f, 0.6690465436f,
    0.1057855469f, 0.6690465436f, 0.4730873479f, 1.7701307698f, 0.6258357354f};

/// All functions in the unit direction `d`.
std::array<float, kShCount> sh_basis(const glm::vec3& d);

}  // namespace ssdo
