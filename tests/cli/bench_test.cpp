// SPDX-License-Identifier: Apache-2.0
//
// ssdo bench through the real binary: its figures are those of the commands that it prints, and
// its three forms say the same.
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/bench_frame.h"
#include "support/parse_json.h"

namespace ssdo::test::bench_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Bench : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return frame_.folder / name; }

  /// With the made-up truth of all products.
  std::vector<std::string> with_truth(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all =
        frame_.arguments({"--truth", frame_.truth + ":AO", "--truth", frame_.truth + ":DiffDir",
                          "--truth", "bounce=" + frame_.truth + ":strange"});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  json report_of(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--report", path("r.json"), "--overwrite"});
    const Finished done = run_tool(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(read_file(path("r.json")));
  }

  void fails(const std::vector<std::string>& more, int code, const std::string& text) const {
    const Finished done = run_tool(frame_.arguments(more));
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_THAT(done.error_line(), HasSubstr(text));
    EXPECT_EQ(done.out, "");
  }

  BenchFrame frame_;
};

/// Runs the command of a row in the test's folder, as a person would who pastes it, and compares
/// what it writes with the truth.
TEST_F(Bench, TheErrorOfARowIsThatOfItsCommand) {
  const json report = report_of(with_truth());
  ASSERT_EQ(report.at("rows").size(), 14u);
  for (const std::size_t i : {0u, 3u, 8u, 12u}) {
    const json row = report["rows"][i];
    const std::string command = row.at("command");
    ASSERT_TRUE(command.starts_with("ssdo "));
    const std::string line = "cd '" + frame_.folder.path().string() + "' && " +
                             tool_path().string() + command.substr(4) +
                             " --pixel-type float --overwrite -q";
    ASSERT_EQ(std::system(line.c_str()), 0) << line;
    const std::string relit = path("it's <!--<script>_relit.exr");
    for (const auto& [product, layer] :
         {std::pair{"ao", "AO"}, {"direct", "DiffDir"}, {"bounce", "strange"}}) {
      if (!row["errors"].contains(product)) {
        EXPECT_EQ(row["method"], "ssao");
        continue;
      }
      const Finished compared =
          run_tool({"compare", relit + ":" + product, frame_.truth + ":" + layer, "--mask",
                    frame_.frame + ":Normal", "--json"});
      ASSERT_EQ(compared.code, 0) << compared.err;
      const json layer_figures = parse_json(compared.out)["layers"][0];
      const double expected =
          layer_figures[std::string(product) == "ao" ? "rmse" : "relative_rmse"];
      EXPECT_NEAR(row["errors"][product]["model"], expected, 1e-9) << line << ", " << product;
      EXPECT_GT(expected, 0.01) << "the truth is made up";
    }
  }
}

TEST_F(Bench, NoiseGoesDownAndTraceIsTheYardstick) {
  const json report = report_of(frame_.arguments());
  EXPECT_EQ(report["products"], json({"ao", "direct", "bounce"}));
  const auto rows_of = [&](const std::string& method) {
    std::vector<json> rows;
    for (const json& row : report["rows"]) {
      if (row["method"] == method) rows.push_back(row);
    }
    return rows;
  };
  const auto trace = rows_of("trace");
  ASSERT_EQ(trace.size(), 3u);
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const json errors = trace[i]["errors"]["ao"];
    EXPECT_EQ(errors["noise"], errors["approximation"]) << "its own limit is the yardstick";
    EXPECT_TRUE(errors["model"].is_null()) << "no truth was given";
    if (i == 0) continue;
    EXPECT_LT(errors["noise"], 0.7 * double(trace[i - 1]["errors"]["ao"]["noise"]));
  }
  // Its limit is told to be nearer to itself than any row.
  for (const json& limit : report["limits"]) {
    if (limit["method"] != "trace") continue;
    EXPECT_EQ(limit["errors"]["ao"]["approximation"], 0);
    EXPECT_GT(limit["errors"]["ao"]["noise"], 0);
    EXPECT_LT(limit["errors"]["ao"]["noise"], trace[2]["errors"]["ao"]["noise"]);
  }
  const auto bitmask = rows_of("bitmask");
  EXPECT_LT(bitmask.back()["errors"]["ao"]["noise"],
            0.7 * double(bitmask.front()["errors"]["ao"]["noise"]));
  for (const json& row : report["rows"]) {
    EXPECT_GT(row["cpu_ms_per_megapixel"], 0);
    const double estimate = row["estimate"]["cpu_ms"], filter = row["filter"]["cpu_ms"];
    EXPECT_NEAR(row["cpu_ms_per_megapixel"], (estimate + filter) / (32 * 24 * 1e-6),
                1e-6 * double(row["cpu_ms_per_megapixel"]));
  }
  EXPECT_GT(report["stages_ms"]["write"], 0);
  EXPECT_EQ(report["surface_pixels"], 32 * (24 - BenchFrame::kSky));
}

/// Limits have no filter, whichever is asked for.
TEST_F(Bench, MeasuresEveryMethodWithTheFilterOfItsSource) {
  const auto with = [&](const std::string& filter) {
    return report_of({"bench", frame_.frame, "--methods", "ssao-fade,sao", "--products", "ao",
                      "--filter", filter, "-q"});
  };
  const json source = with("source"), none = with("none");
  EXPECT_EQ(source["filter"], "source");
  EXPECT_EQ(source["limits"], none["limits"]);
  ASSERT_EQ(source["rows"].size(), none["rows"].size());
  for (std::size_t i = 0; i < source["rows"].size(); ++i) {
    const json& row = source["rows"][i];
    EXPECT_THAT(std::string(row["command"]), HasSubstr(" --filter source "));
    EXPECT_NE(row["errors"]["ao"]["noise"], none["rows"][i]["errors"]["ao"]["noise"])
        << row["method"] << " " << row["setting"];
  }
}

/// Their light of lamps would be wrong: they find no shadows.
TEST_F(Bench, MeasuresNoLightOfLampsWithMethodsThatRefuseThem) {
  const json report = report_of({"bench", frame_.frame, "--methods", "sao,gtao", "--products",
                                 "ao,direct", "--light", "sphere position=0,0,1", "-q"});
  ASSERT_GT(report["rows"].size(), 1u);
  for (const json& row : report["rows"]) {
    EXPECT_TRUE(row["errors"].contains("ao")) << row;
    EXPECT_FALSE(row["errors"].contains("direct")) << row;
  }
}

TEST_F(Bench, CsvAndTableSayWhatJsonSays) {
  const Finished done = run_tool(with_truth(
      {"--report", path("r.csv"), "--report", path("r.json"), "--products", "ao,direct"}));
  ASSERT_EQ(done.code, 0) << done.err;
  const json report = parse_json(read_file(path("r.json")));
  std::istringstream csv(read_file(path("r.csv")));
  std::string line;
  std::getline(csv, line);
  EXPECT_THAT(line, testing::StartsWith("method,setting,"));
  for (const std::string product : {"ao", "direct", "bounce"}) {
    const auto& front = report["fronts"][product];
    for (std::size_t i = 0; i < report["rows"].size(); ++i) {
      const json& row = report["rows"][i];
      if (!row["errors"].contains(product)) continue;
      ASSERT_TRUE(std::getline(csv, line));
      const bool on_front = std::find(front.begin(), front.end(), i) != front.end();
      const json& errors = row["errors"][product];
      EXPECT_THAT(line, testing::StartsWith(std::string(row["method"]) + "," +
                                            std::string(row["setting"])));
      std::ostringstream figures;
      figures << "," << product << "," << errors["noise"].dump() << ","
              << errors["approximation"].dump() << "," << errors["model"].dump() << "," << on_front
              << ",";
      EXPECT_THAT(line, HasSubstr(figures.str()));
      EXPECT_THAT(done.out,
                  HasSubstr(std::string(row["method"]) + " " + std::string(row["setting"])));
    }
  }
  EXPECT_FALSE(std::getline(csv, line));
}

TEST_F(Bench, RecommendsTheCheapestOrNamesTheBest) {
  const json report = report_of(with_truth({"--want", "10"}));
  const json found = report["recommendation"];
  EXPECT_EQ(found["reached"], true);
  for (const json& row : report["rows"]) {
    EXPECT_GE(row["cpu_ms_per_megapixel"],
              report["rows"][std::size_t(found["row"])]["cpu_ms_per_megapixel"]);
  }
  // Only two methods make a bounce; nothing is that near to truth that is made up.
  const Finished all = run_tool(with_truth({"--want", "ao=10", "--want", "bounce=10"}));
  EXPECT_EQ(all.code, 0);
  EXPECT_THAT(all.out, HasSubstr("with an error of ao 10, bounce 10 at most: bitmask"));
  const Finished none = run_tool(with_truth({"--want", "1e-6", "--report", path("none.json")}));
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.out, HasSubstr("No setting has an error of ao 1e-06. The best is "));
  const json best = parse_json(read_file(path("none.json")))["recommendation"];
  EXPECT_EQ(best["reached"], false);
  EXPECT_THAT(none.out, HasSubstr(std::string(best["command"])));
}

TEST_F(Bench, RefusesWhatItCannotMeasure) {
  fails({"--method", "ssao"}, 2, "bench takes no --method: name methods with --methods");
  fails({"-o", path("x.exr")}, 2, "bench takes no --output");
  fails({"--slices", "3"}, 2, "bench takes no --slices");
  fails({"--methods", "nothing"}, 2, "no such method");
  fails({"--products", "bent"}, 2, "product 'bent': bench measures ao, direct, bounce");
  fails({"--want", "none"}, 2, "--want none");
  fails({"--want", "ao=-1"}, 2, "--want ao=-1");
  fails({"--want", "sheen=1"}, 2, "sheen is not measured; there is ao, direct, bounce");
  fails({"--report", path("r.txt")}, 2, "r.txt: unknown kind; use .html, .csv or .json");
  fails({"--report", path("r.csv"), "--report", path("r.csv")}, 2, "named twice");
  fails({"--report", path("no/r.csv")}, 5, "no");
  fails({"--report", frame_.folder.path() / "truth.csv", "--truth", path("none.exr") + ":AO"}, 3,
        "none.exr");
  fails({"--truth", frame_.truth}, 4, "has 3 layers; name one");
  fails({"--truth", frame_.truth + ":nothing"}, 4, "has no layer 'nothing'");
  fails({"--truth", frame_.truth + ":strange"}, 2, "does not tell what it is the truth of");
  fails({"--truth", frame_.truth + ":AO", "--truth", "ao=" + frame_.truth + ":strange"}, 2,
        "another truth of ao");
  fails({"--truth", "ao=" + data("truth/still_life/white.exr") + ":DiffDir"}, 4,
        "it has to show the same frame");
  fails({"--radius", "0"}, 2, "--radius");
  const Finished sequence = run_tool({"bench", path("shot.####.exr")});
  EXPECT_EQ(sequence.code, 3);
  EXPECT_THAT(sequence.error_line(), HasSubstr("no frame of this sequence exists"));
  const Finished missing = run_tool({"bench", path("none.exr")});
  EXPECT_EQ(missing.code, 3);
  EXPECT_THAT(missing.error_line(), HasSubstr("none.exr"));
}

/// It measures no composite, so that none of the layers of one are needed.
TEST_F(Bench, NeedsNoLayersOfComposites) {
  for (const char* compose : {"occlude", "add"}) {
    const Finished done = run_tool(
        {"bench", frame_.frame, "--methods", "msvo", "--products", "ao", "--compose", compose});
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.err, HasSubstr("--compose has no effect: bench measures no composite"));
  }
}

TEST_F(Bench, KeepsReportsThatExist) {
  std::ofstream(path("r.csv")) << "precious";
  fails({"--report", path("r.csv")}, 5, "r.csv");
  EXPECT_EQ(read_file(path("r.csv")), "precious");
  const std::string copy = path("frame.json");
  std::filesystem::copy(frame_.frame, copy);
  const Finished onto_input = run_tool({"bench", copy, "--report", copy, "--overwrite"});
  EXPECT_EQ(onto_input.code, 5) << onto_input.err;
  EXPECT_THAT(onto_input.error_line(), HasSubstr("is an input"));
}

}  // namespace
}  // namespace ssdo::test::bench_test
