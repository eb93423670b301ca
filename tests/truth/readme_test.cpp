// SPDX-License-Identifier: Apache-2.0
//
// The tables of README.md state the errors that truth_test and degradation_test hold the methods
// to, so that a change of one shows in the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "estimators/registry.h"
#include "hard/recorded_degradation.h"
#include "truth/recorded_errors.h"

namespace ssdo::test::readme_test {
namespace {

using Row = std::vector<std::string>;

/// The rows of the table of README.md whose first line starts with `heading`; none without it.
std::vector<Row> table_of(const std::string& heading) {
  std::ifstream in(std::string(SSDO_SOURCE_DIR) + "/README.md");
  std::string line;
  while (std::getline(in, line) && !line.starts_with(heading)) continue;
  std::getline(in, line);  // the rule under the heading
  static const std::regex cell(R"(\|\s*([^|]*[^|\s])?\s*(?=\|))");
  std::vector<Row> rows;
  while (std::getline(in, line) && line.starts_with("|")) {
    Row& row = rows.emplace_back();
    for (std::sregex_iterator i(line.begin(), line.end(), cell), end; i != end; ++i)
      row.push_back((*i)[1]);
  }
  return rows;
}

/// `stated` starts with a figure that is `recorded` to the places it has.
void expect_states(const std::string& stated, double recorded, const std::string& where) {
  static const std::regex figure(R"(^\d+\.(\d+))");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(stated, match, figure)) << where << ": '" << stated << "'";
  const double half_a_place = 0.5 * std::pow(10.0, -double(match.length(1)));
  EXPECT_NEAR(std::stod(match.str()), recorded, half_a_place + 1e-9) << where;
}

std::string unquoted(const std::string& name) {
  return name.size() < 2 ? "" : name.substr(1, name.size() - 2);
}

const RecordedErrors& errors_of(const std::string& method) {
  const auto found = std::find_if(kRecordedErrors.begin(), kRecordedErrors.end(),
                                  [&](const RecordedErrors& e) { return e.method == method; });
  if (found == kRecordedErrors.end()) throw std::runtime_error("nothing recorded of " + method);
  return *found;
}

void expect_states(const Row& row, std::size_t first, const std::vector<double>& recorded) {
  ASSERT_EQ(row.size(), first + recorded.size());
  for (std::size_t i = 0; i < recorded.size(); ++i)
    expect_states(row[first + i], recorded[i], row[0] + ", column " + std::to_string(first + i));
}

TEST(Readme, StatesWhatKnownGeometryBrings) {
  const std::vector<Row> rows = table_of("| what is known | ao, small radius |");
  ASSERT_EQ(rows.size(), kRecordedKnownGeometry.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RecordedKnownGeometry& r = kRecordedKnownGeometry[i];
    EXPECT_EQ(rows[i][0], r.known);
    expect_states(rows[i], 1, {r.ao_small, r.ao_large, r.white, r.direct, r.bounce});
  }
}

TEST(Readme, StatesTheRecordedErrorsOfTheMainExample) {
  const std::vector<Row> rows = table_of("| room corner in a studio | ao at 0.25 |");
  ASSERT_EQ(rows.size(), 2u);
  const TruthErrors &alone = errors_of("bitmask").room_corner, &with = kRecordedRoomCornerOverscan;
  expect_states(rows[0], 1, {alone.ao_small, alone.ao_large, alone.direct, alone.bounce});
  expect_states(rows[1], 1, {with.ao_small, with.ao_large, with.direct, with.bounce});
}

TEST(Readme, StatesTheRecordedErrorsOfLamps) {
  const std::vector<Row> rows = table_of("| a lamp | direct |");
  ASSERT_EQ(2 * rows.size(), kRecordedLamps.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RecordedLamp &alone = kRecordedLamps[i], &with = kRecordedLamps[rows.size() + i];
    EXPECT_EQ(rows[i][0], alone.lamp);
    EXPECT_EQ(with.lamp, alone.lamp);
    expect_states(rows[i], 1, {alone.direct, alone.bounce, with.direct, with.bounce});
  }
}

TEST(Readme, StatesTheRecordedErrorsOfTheDefaultMethod) {
  const std::vector<Row> rows = table_of("| frame | method | ao, small radius |");
  ASSERT_EQ(rows.size(), 4u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), 6u);
    const std::string method = unquoted(rows[i][1]);
    const std::string frame = rows[i - i % 2][0], where = frame + ", " + method;
    const bool indoors = frame.starts_with("room corner");
    ASSERT_TRUE(indoors || frame.starts_with("still life")) << frame;
    const RecordedErrors& both = errors_of(method);
    const TruthErrors& errors = indoors ? both.room_corner : both.still_life;
    expect_states(rows[i][2], errors.ao_small, where + ", ao small");
    expect_states(rows[i][3], errors.ao_large, where + ", ao large");
    expect_states(rows[i][4], errors.direct, where + ", direct");
    expect_states(rows[i][5], errors.bounce, where + ", bounce");
  }
}

TEST(Readme, StatesTheRecordedErrorsOfTheOtherMethods) {
  std::set<std::string> stated = {"bitmask", "ssdo", "trace"};
  for (const Row& row : table_of("| method | still life |")) {
    ASSERT_EQ(row.size(), 8u);
    const std::string method = unquoted(row[0]);
    const RecordedErrors& errors = errors_of(method);
    stated.insert(method);
    std::size_t column = 1;
    for (const TruthErrors& e : {errors.still_life, errors.room_corner}) {
      for (const double recorded : {e.ao_small, e.ao_large, e.direct}) {
        expect_states(row[column], recorded, method + ", column " + std::to_string(column));
        ++column;
      }
    }
  }
  for (const Method& method : methods())
    EXPECT_TRUE(stated.contains(std::string(method.name))) << method.name;
}

/// What is recorded of a method under a heading of the README: the largest of several columns.
double degradation(std::string_view method, const std::set<std::string_view>& columns) {
  double most = 0;
  for (std::size_t i = 0; i < kDegradationColumns.size(); ++i) {
    if (columns.contains(kDegradationColumns[i]))
      most = std::max(most, kRecordedDegradation.at(method)[i]);
  }
  return most;
}

TEST(Readme, StatesTheRecordedErrorsOfHardCases) {
  const std::vector<Row> rows = table_of("| | `bitmask` | worst of the other methods |");
  const std::vector<std::set<std::string_view>> columns = {
      {"half P"},
      {"half P, origin 90 away"},
      {"origin 1.7e6 away"},
      {"beside them"},
      {"plane at 85", "plane at 89", "plane at 89.9"}};
  ASSERT_EQ(rows.size(), columns.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), 3u);
    expect_states(rows[i][1], degradation("bitmask", columns[i]), rows[i][0] + ", bitmask");
    double most = 0;
    for (const auto& [method, recorded] : kRecordedDegradation)
      if (method != "bitmask") most = std::max(most, degradation(method, columns[i]));
    const std::string worst = rows[i][2], name = worst.substr(worst.find(' ') + 1);
    expect_states(worst, most, rows[i][0] + ", worst");
    EXPECT_EQ(degradation(unquoted(name), columns[i]), most) << rows[i][0] << ": " << name;
  }
}

}  // namespace
}  // namespace ssdo::test::readme_test
