// SPDX-License-Identifier: Apache-2.0
//
// What holds for every filter: the same result from every instruction set, any number of threads
// and any crop, and a background that does not spread.
#include <gmock/gmock.h>

#include <limits>

#include "filters/filter_products.h"
#include "filters/registry.h"
#include "parallel/tiles.h"
#include "support/chosen_isa.h"
#include "support/crop.h"
#include "support/error_matchers.h"
#include "support/random_frame.h"

namespace ssdo::test::filters_test {
namespace {

Products filtered(std::string_view name, const Products& in, const Geometry& g) {
  return filter_products(find_filter(name), in, g.surfaces, 4);
}

/// All that change anything.
std::vector<std::string> filter_names() {
  std::vector<std::string> names;
  for (const Filter& filter : filters()) {
    if (filter.apply) names.emplace_back(filter.name);
  }
  return names;
}

class EveryFilter : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, EveryFilter, testing::ValuesIn(filter_names()),
                         [](const auto& which) { return which.param; });

TEST_P(EveryFilter, AgreesAmongInstructionSets) {
  if (!has_isa("scalar")) GTEST_SKIP() << "a build for one instruction set";
  const Geometry g = random_geometry(131, 65, 3);
  const Products in = random_products(g, 4);
  const auto run = [&](const char* isa) {
    const ChosenIsa chosen(isa);
    return filtered(GetParam(), in, g);
  };
  const Products scalar = run("scalar");
  for (const char* isa : kVectorIsas) {
    if (!has_isa(isa)) continue;
    SCOPED_TRACE(isa);
    const Products vector = run(isa);
    for (std::size_t i = 0; i < in.ao.size(); ++i) {
      EXPECT_NEAR(vector.ao[i], scalar.ao[i], 1e-5);
      EXPECT_NEAR(vector.error[i], scalar.error[i], 1e-5);
      EXPECT_LT(difference(vector.direct[i], scalar.direct[i]), 1e-5);
      EXPECT_LT(difference(vector.bounce[i], scalar.bounce[i]), 1e-5);
      EXPECT_LT(difference(vector.bent[i], scalar.bent[i]), 1e-5);
    }
  }
}

/// Planes have nothing to do with each other, but for ao and bounce.
TEST_P(EveryFilter, GivesAPlaneAloneWhatItGivesAmongOthers) {
  const Geometry g = random_geometry(60, 40, 7);
  const Products in = random_products(g, 8), all = filtered(GetParam(), in, g);
  const auto alone = [&](const Plane<float>& plane, const char* product) {
    return apply_filter(find_filter(GetParam()), plane, find_product(product).filtering, g.surfaces,
                        4);
  };
  EXPECT_EQ(alone(in.ao, "ao").pixels, all.ao.pixels);
  EXPECT_EQ(alone(in.error, "error").pixels, all.error.pixels);
  EXPECT_EQ(alone(in.reflection, "reflection").pixels, all.reflection.pixels);
}

TEST_P(EveryFilter, GivesTheSameBitsInACropAndOnAnyNumberOfThreads) {
  const Geometry g = random_geometry(150, 140, 5);
  const Products in = random_products(g, 6);
  const Products whole = [&] {
    const ThreadLimit one(1);
    return filtered(GetParam(), in, g);
  }();
  const ThreadLimit several(4);
  const Products again = filtered(GetParam(), in, g);
  EXPECT_EQ(again.ao.pixels, whole.ao.pixels);
  EXPECT_EQ(again.bent.pixels, whole.bent.pixels);

  const Window window{13, 7, 124, 130};
  Geometry part;
  part.surfaces = crop(g.surfaces, window);
  Products part_in;
  part_in.ao = crop(in.ao, window);
  part_in.bent = crop(in.bent, window);
  const Products out = filtered(GetParam(), part_in, part);
  constexpr int kReach = 15;  // three passes of five
  for (int y = kReach; y < window.height() - kReach; ++y) {
    for (int x = kReach; x < window.width() - kReach; ++x) {
      EXPECT_EQ(out.ao(x, y), whole.ao(window.x0 + x, window.y0 + y));
      EXPECT_EQ(out.bent(x, y), whole.bent(window.x0 + x, window.y0 + y));
    }
  }
}

TEST_P(EveryFilter, TakesNothingFromTheBackgroundBeItBroken) {
  const Geometry g = random_geometry(70, 30, 11);
  const Products clean = random_products(g, 12);
  Products broken = clean;
  Geometry holes = g;
  for (std::size_t i = 0; i < broken.ao.size(); ++i) {
    if (g.is_surface(i)) continue;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    broken.ao[i] = nan;
    broken.direct[i] = glm::vec3(nan);
    holes.surfaces.set(i, {glm::vec3(nan), glm::vec3(nan), nan});
  }
  const Products expected = filtered(GetParam(), clean, g),
                 out = filtered(GetParam(), broken, holes);
  for (std::size_t i = 0; i < broken.ao.size(); ++i) {
    if (!g.is_surface(i)) continue;
    EXPECT_EQ(out.ao[i], expected.ao[i]);
    EXPECT_EQ(out.direct[i], expected.direct[i]);
  }
}

TEST(Filters, AreFoundByNameAndNoneChangesNothing) {
  const Geometry g = random_geometry(20, 20, 13);
  const Products in = random_products(g, 14);
  EXPECT_EQ(filtered("none", in, g).ao.pixels, in.ao.pixels);
  EXPECT_NE(filtered("geometry", in, g).ao.pixels, in.ao.pixels);
  EXPECT_THAT(error_of([] { find_filter("blur"); }),
              IsError(ExitCode::usage,
                      "--filter blur: no such filter; there is none, box, "
                      "gaussian, normal, depth, geometry, source"));
}

}  // namespace
}  // namespace ssdo::test::filters_test
