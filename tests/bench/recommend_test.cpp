// SPDX-License-Identifier: Apache-2.0
#include "bench/recommend.h"

#include <gtest/gtest.h>

namespace ssdo::test::recommend_test {
namespace {

/// Rows of one megapixel: cost, and the errors of ao and bounce from rays; negative: not made.
BenchReport report_of(const std::vector<std::array<double, 3>>& rows) {
  BenchReport report;
  report.pixels = 1'000'000;
  report.products = {"ao", "bounce"};
  for (const auto& [cost, ao, bounce] : rows) {
    BenchRow row;
    row.estimate.cpu_ms = cost - 1;
    row.filter.cpu_ms = 1;
    row.errors["ao"].approximation = ao;
    if (bounce >= 0) row.errors["bounce"].approximation = bounce;
    report.rows.push_back(row);
  }
  return report;
}

TEST(Recommend, AllThatIsWantedHasToHold) {
  const std::vector<std::array<double, 3>> rows = {
      {2, 0.1, -1}, {5, 0.2, 0.5}, {4, 0.1, 0.9}, {9, 0.1, 0.4}};
  const auto chosen = [&](const std::vector<WantedError>& wants) {
    BenchReport report = report_of(rows);
    recommend(report, wants);
    return report.recommended;
  };
  EXPECT_EQ(chosen({}), std::nullopt);
  EXPECT_EQ(chosen({{"", 0.1}}), 0u) << "without a name, the first product";
  EXPECT_EQ(chosen({{"bounce", 1}}), 2u) << "what makes no bounce is not chosen";
  EXPECT_EQ(chosen({{"bounce", 0.5}}), 1u);
  EXPECT_EQ(chosen({{"ao", 0.15}, {"bounce", 0.5}}), 3u);
  EXPECT_EQ(chosen({{"ao", 0.05}}), std::nullopt);
}

TEST(Recommend, TruthCountsWhereThereIsOne) {
  BenchReport report = report_of({{1, 0.1, 0.1}, {2, 0.3, 0.1}});
  report.rows[0].errors["ao"].model = 0.4;
  report.rows[1].errors["ao"].model = 0.2;
  recommend(report, {{"ao", 0.25}});
  EXPECT_EQ(report.recommended, 1u);
  EXPECT_EQ(report.wanted, "ao 0.25");
}

TEST(Recommend, NamesTheNearestWhereNoneHolds) {
  BenchReport report = report_of({{1, 0.2, 0.1}, {2, 0.1, 0.3}, {3, 0.12, 0.12}});
  recommend(report, {{"ao", 0.01}, {"bounce", 0.01}});
  EXPECT_EQ(report.recommended, std::nullopt);
  EXPECT_EQ(report.best, 2u);
  BenchReport none = report_of({{1, 0.2, -1}});
  recommend(none, {{"bounce", 0.5}});
  EXPECT_EQ(none.best, std::nullopt);
}

}  // namespace
}  // namespace ssdo::test::recommend_test
