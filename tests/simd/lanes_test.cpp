// SPDX-License-Identifier: Apache-2.0
//
// Every function of the lanes' vocabulary against the same in double, on every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <random>
#include <vector>

#include "math/light_range.h"
#include "math/luminance.h"
#include "math/octahedral_map.h"
#include "math/spherical_harmonics.h"
#include "support/chosen_isa.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/lanes_test.cpp"
#include <hwy/foreach_target.h>

#include "math/spherical_harmonics-inl.h"
#include "scene/same_surface-inl.h"
#include "simd/lanes-inl.h"
#include "simd/octahedral_map-inl.h"

#ifndef SSDO_LANES_TEST_VALUES_
#define SSDO_LANES_TEST_VALUES_
namespace ssdo::test {

constexpr int kCount = 4 * kMostLanes;

struct Operands {
  glm::vec3 a[kCount], b[kCount];  ///< b is unit
  float s[kCount];                 ///< -2..2
  int index[kCount];               ///< of one of them
};

struct Results {
  float dot[kCount], dot2[kCount], saturate[kCount], smoothstep[kCount], reciprocal_sqrt[kCount],
      luminance[kCount], gathered[kCount], iota[kCount], plane_weight[kCount],
      normal_weight[kCount];
  glm::vec3 sum[kCount], difference[kCount], negative[kCount], product[kCount], quotient[kCount],
      mul_add[kCount], cross[kCount], unit[kCount], across[kCount], chosen[kCount], kept[kCount],
      in_range[kCount], color[kCount], swapped[kCount];
  bool any_above_1[kCount], all_above_1[kCount], within_sine[kCount];
  float harmonics[kShCount][kCount];
  int lanes;
};

}  // namespace ssdo::test
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

using test::kCount;

void evaluate_vectors(const test::Operands& in, test::Results& out) {
  for (int i = 0; i < kCount; i += kLanes) {
    const V3 a = load(in.a + i), b = load(in.b + i);
    const V s = load(in.s + i);
    store(a + b, out.sum + i);
    store(a - b, out.difference + i);
    store(-a, out.negative + i);
    store(a * b, out.product + i);
    store(a / s, out.quotient + i);
    store(mul_add(a, s, b), out.mul_add + i);
    store(cross(a, b), out.cross + i);
    store(normalise(a), out.unit + i);
    store(unit_across(a, b), out.across + i);
    store(if_then_else(s > set(0), a, b), out.chosen + i);
    store(if_then_else_zero(s > set(0), a), out.kept + i);
    store(within_range(a * (s / set(0))), out.in_range + i);  // infinities and not-a-number
    float rows[3 * kMostLanes];
    store_apart(a, kMostLanes, rows);
    const V3 apart = load_apart(rows, kMostLanes);
    store(V3{apart.z, apart.y, apart.x}, out.swapped + i);
    store(dot(a, b), out.dot + i);
    store(dot(V2{a.x, a.y}, V2{b.x, b.y}), out.dot2 + i);
    store(luminance(a), out.luminance + i);
  }
}

void evaluate_numbers(const test::Operands& in, test::Results& out) {
  out.lanes = kLanes;
  for (int i = 0; i < kCount; i += kLanes) {
    const V s = load(in.s + i);
    store(saturate(s), out.saturate + i);
    store(smoothstep(set(-1), set(1.5f), s), out.smoothstep + i);
    store(reciprocal_sqrt(hn::Abs(s)), out.reciprocal_sqrt + i);
    store(gather(in.s, hn::LoadU(DI(), in.index + i)), out.gathered + i);
    store(iota(float(i)), out.iota + i);
    store(plane_weight(hn::Abs(s) * set(0.25f)), out.plane_weight + i);
    store(normal_weight(s), out.normal_weight + i);
    out.any_above_1[i] = any(s > set(1)), out.all_above_1[i] = all(s > set(1));
    out.within_sine[i] = all(within_sine(s, set(1), 0.7f));
  }
}

void evaluate_maps(const test::Operands& in, const OctahedralMap& map, test::Results& out) {
  for (int i = 0; i < kCount; i += kLanes) {
    const V3 d = load(in.b + i);
    store(look_up(map, d), out.color + i);
    for_each_sh_polynomial<0, kShOrder>(
        d.x, d.y, d.z, [](float value) HWY_ATTR { return set(value); },
        [&](int k, V value)
            HWY_ATTR { store(value * set(kShConstants[std::size_t(k)]), out.harmonics[k] + i); });
  }
}

/// Reads `count` numbers and vectors and writes them, as far as a vector goes.
void copy_first(int count, const test::Operands& in, float* numbers, glm::vec3* vectors) {
  for (int i = 0; i < count; i += kLanes) {
    store_first(count - i, load_first(count - i, in.s + i), numbers + i);
    store_first(count - i, load_first(count - i, in.a + i), vectors + i);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(evaluate_vectors);
HWY_EXPORT(evaluate_numbers);
HWY_EXPORT(evaluate_maps);
HWY_EXPORT(copy_first);

namespace test {
namespace {

Operands random_operands() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> number(-2, 2);
  Operands in;
  for (int i = 0; i < kCount; ++i) {
    in.a[i] = {number(random), number(random), number(random)};
    in.b[i] = glm::normalize(glm::vec3(number(random), number(random), number(random)));
    in.s[i] = number(random);
    in.index[i] = int(random() % kCount);
  }
  in.a[5] = glm::vec3(0), in.s[6] = 0;
  return in;
}

void expect_near(const glm::vec3& found, const glm::dvec3& expected, const char* what, int i) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(found[c], expected[c], 1e-6 * (1 + std::abs(expected[c]))) << what << " " << i;
}

glm::dvec3 unit(const glm::dvec3& v) { return v == glm::dvec3(0) ? v : glm::normalize(v); }

/// Runs `test` on every instruction set that this processor has.
template <class Test>
void on_every_isa(const Test& test) {
  for (const char* name : kIsas) {
    if (!has_isa(name)) continue;
    const ChosenIsa isa(name);
    SCOPED_TRACE(name);
    test();
  }
}

TEST(Lanes, VectorsOfThreeAreThoseOfMathematics) {
  const Operands in = random_operands();
  on_every_isa([&] {
    Results out;
    HWY_DYNAMIC_DISPATCH(evaluate_vectors)(in, out);
    for (int i = 0; i < kCount; ++i) {
      const glm::dvec3 a(in.a[i]), b(in.b[i]);
      const double s = in.s[i];
      expect_near(out.sum[i], a + b, "sum", i);
      expect_near(out.difference[i], a - b, "difference", i);
      expect_near(out.negative[i], -a, "negative", i);
      expect_near(out.product[i], a * b, "product", i);
      if (s != 0) expect_near(out.quotient[i], a / s, "quotient", i);
      expect_near(out.mul_add[i], a * s + b, "mul_add", i);
      expect_near(out.cross[i], glm::cross(a, b), "cross", i);
      expect_near(out.unit[i], unit(a), "normalise", i);
      expect_near(out.across[i], unit(a - glm::dot(a, b) * b), "unit_across", i);
      expect_near(out.chosen[i], s > 0 ? a : b, "if_then_else", i);
      expect_near(out.kept[i], s > 0 ? a : glm::dvec3(0), "if_then_else_zero", i);
      expect_near(out.swapped[i], {a.z, a.y, a.x}, "load_apart", i);
      for (int c = 0; c < 3; ++c) {
        const double light = double(in.a[i][c]) * (s / 0.0);
        const float held = std::isnan(light) ? 0 : std::copysign(kBrightest, float(light));
        EXPECT_EQ(out.in_range[i][c], held) << i;
      }
      EXPECT_NEAR(out.dot[i], glm::dot(a, b), 1e-6) << i;
      EXPECT_NEAR(out.dot2[i], a.x * b.x + a.y * b.y, 1e-6) << i;
      EXPECT_NEAR(out.luminance[i], luminance(in.a[i]), 1e-6) << i;
    }
  });
}

/// ramp() of scene/same_surface.h
double ramp(double x) { return std::clamp(2 - 2 * x, 0.0, 1.0); }

TEST(Lanes, FunctionsOfOneNumberAreThoseOfShadingLanguages) {
  const Operands in = random_operands();
  on_every_isa([&] {
    Results out;
    HWY_DYNAMIC_DISPATCH(evaluate_numbers)(in, out);
    for (int i = 0; i < kCount; ++i) {
      const double s = in.s[i], t = std::clamp((s + 1) / 2.5, 0.0, 1.0);
      EXPECT_EQ(out.saturate[i], float(std::clamp(s, 0.0, 1.0))) << i;
      EXPECT_NEAR(out.smoothstep[i], t * t * (3 - 2 * t), 1e-6) << i;
      if (s != 0) {
        const double expected = 1 / std::sqrt(std::abs(s));
        EXPECT_NEAR(out.reciprocal_sqrt[i] / expected, 1, 2e-7) << i;
      }
      EXPECT_EQ(out.gathered[i], in.s[in.index[i]]) << i;
      EXPECT_EQ(out.iota[i], float(i));
      EXPECT_NEAR(out.plane_weight[i], ramp(std::abs(s) / 4 / 0.3), 2e-6) << i;
      EXPECT_NEAR(out.normal_weight[i], ramp((1 - s) / 0.2), 2e-5) << i;
    }
    for (int i = 0; i < kCount; i += out.lanes) {
      bool any = false, all = true, within = true;
      for (int k = i; k < i + out.lanes; ++k) {
        any = any || in.s[k] > 1, all = all && in.s[k] > 1;
        within = within && std::abs(in.s[k]) <= 0.7f;
      }
      EXPECT_EQ(out.any_above_1[i], any) << i;
      EXPECT_EQ(out.all_above_1[i], all) << i;
      EXPECT_EQ(out.within_sine[i], within) << i;
    }
  });
}

TEST(Lanes, MapsAndHarmonicsAreThoseOfOneDirection) {
  const Operands in = random_operands();
  OctahedralMap map(17);
  for (int y = 0; y < map.size(); ++y) {
    for (int x = 0; x < map.size(); ++x) map(x, y) = map.direction_of(x, y) + glm::vec3(1, 2, 3);
  }
  on_every_isa([&] {
    Results out;
    HWY_DYNAMIC_DISPATCH(evaluate_maps)(in, map, out);
    for (int i = 0; i < kCount; ++i) {
      expect_near(out.color[i], map(in.b[i]), "look_up", i);
      const auto basis = sh_basis(in.b[i]);
      for (int k = 0; k < kShCount; ++k) EXPECT_NEAR(out.harmonics[k][i], basis[k], 2e-6) << k;
    }
  });
}

TEST(Lanes, TheFirstFewAreReadAndWrittenAlone) {
  const Operands in = random_operands();
  on_every_isa([&] {
    for (int count = 0; count <= 2 * kMostLanes; ++count) {
      std::vector<float> numbers(std::size_t(kCount), 9);
      std::vector<glm::vec3> vectors(std::size_t(kCount), glm::vec3(9));
      HWY_DYNAMIC_DISPATCH(copy_first)(count, in, numbers.data(), vectors.data());
      for (int i = 0; i < kCount; ++i) {
        EXPECT_EQ(numbers[std::size_t(i)], i < count ? in.s[i] : 9) << count << " " << i;
        EXPECT_EQ(vectors[std::size_t(i)], i < count ? in.a[i] : glm::vec3(9)) << count << " " << i;
      }
    }
  });
}

}  // namespace
}  // namespace test
}  // namespace ssdo
#endif
