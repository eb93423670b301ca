// SPDX-License-Identifier: Apache-2.0
//
// ssdo bench of a sequence through the real binary: its figures are those of the commands that it
// prints, as ssdo compare measures them, and its forms say the same.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "support/browser.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::bench_shot_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

class BenchShot : public testing::Test {
 protected:
  /// Three frames of a camera that goes around a ball; the truth of the last two is 3/4 everywhere.
  BenchShot() {
    const Window window{0, 0, 48, 36};
    const Surface scene = all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6)});
    for (int n = 1; n <= 3; ++n) {
      const double angle = 2 * n * std::numbers::pi / 180;
      const Camera camera =
          look_at(camera_from_fov(40, window, 1), {4 * std::sin(angle), -4 * std::cos(angle), 3},
                  {0, 0, 0.3}, {0, 0, 1});
      write_frame(path("in." + std::to_string(n) + ".exr"),
                  frame_of(take_picture(scene, camera, window)));
      const std::map<std::string, Plane<float>> truth = {{"AO.Y", Plane<float>(48, 36, 0.75f)}};
      if (n > 1)
        write_frame(path("truth." + std::to_string(n) + ".exr"),
                    FramePart{"", window, window, truth, Imf::FLOAT, {}});
    }
  }

  std::string path(const std::string& name) const { return dir_ / name; }

  Finished bench(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {
        "bench", path("in.@.exr"), "--quality", "draft",     "--radius",
        "1",     "--products",     "ao",        "--threads", "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tool(arguments);
  }

  json report(std::vector<std::string> more) const {
    more.insert(more.end(), {"--report", path("r.json"), "--overwrite"});
    const Finished done = bench(more);
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(read_file(path("r.json")));
  }

  TempDir dir_;
};

/// Runs the command of each row, as a person would who pastes it, and measures what it writes.
TEST_F(BenchShot, ItsFiguresAreThoseOfItsCommands) {
  const json all = report({"--truth", path("truth.@.exr") + ":AO"});
  EXPECT_EQ(all.at("frames"), json({1, 2, 3}));
  EXPECT_EQ(all.at("truths").at("ao").at("frames"), json({2, 3}));
  ASSERT_EQ(all.at("rows").size(), 4u) << "alone, causal, 1 and 2 of 3 frames";
  std::vector<double> flickers;
  for (const json& row : all.at("rows")) {
    const std::string command = row.at("command");
    const std::string line = "cd '" + dir_.path().string() + "' && " + tool_path().string() +
                             command.substr(4) + " --pixel-type float --overwrite -q";
    ASSERT_EQ(std::system(line.c_str()), 0) << line;
    const auto compared = [&](std::vector<std::string> arguments) {
      arguments.insert(arguments.begin(), {"compare", path("relit.####.exr") + ":ao"});
      arguments.insert(arguments.end(), {"--points", path("in.@.exr"), "--json"});
      const Finished done = run_tool(arguments);
      EXPECT_EQ(done.code, 0) << done.out << done.err;
      return parse_json(done.out).at("layers").at(0);
    };
    const json figures = row.at("products").at("ao"), flicker = compared({}).at("flicker");
    EXPECT_NEAR(figures.at("flicker"), flicker.at("rms"), 1e-9) << line;
    EXPECT_NEAR(figures.at("flicker_border"), flicker.at("border_rms"), 1e-9);
    EXPECT_EQ(figures.at("points"), flicker.at("points"));
    const json error = compared(
        {path("truth.@.exr") + ":AO", "--frames", "2-3", "--mask", path("in.@.exr") + ":Normal"});
    EXPECT_NEAR(figures.at("error"), error.at("rmse"), 1e-9);
    EXPECT_TRUE(figures.at("error_near_moving").is_null()) << "the ball is still";
    EXPECT_NEAR(figures.at("flicker_of_error"), error.at("flicker").at("a_minus_b").at("rms"),
                1e-9);
    EXPECT_GT(row.at("cpu_s_per_frame"), 0);
    EXPECT_GT(row.at("wall_s_per_frame"), 0);
    flickers.push_back(figures.at("flicker"));
  }
  EXPECT_GT(flickers[0], 0.003) << "frames alone";
  EXPECT_LT(flickers[1], 0.9 * flickers[0]) << "the causal filter";
}

/// A ball jumps, at the left of a wide picture. The truth is wrong by much at the right.
TEST_F(BenchShot, TellsTheErrorNearWhatMoves) {
  const Window window{0, 0, 192, 36};
  const Camera camera = look_at(camera_from_fov(70, window, 1), {0, -4, 3}, {0, 0, 0.3}, {0, 0, 1});
  std::map<int, Plane<unsigned char>> shows_ball;
  for (int n = 1; n <= 3; ++n) {
    const Picture picture = take_picture(
        all_of({plane({}, {0, 0, 1}), sphere({-2.2 + 0.7 * n, 0, 0.3}, 0.25)}), camera, window);
    write_frame(path("in." + std::to_string(n) + ".exr"), frame_of(picture));
    shows_ball[n] = Plane<unsigned char>(window.width(), window.height(), 0);
    for (std::size_t i = 0; i < picture.position.size(); ++i)
      shows_ball[n][i] = picture.position[i].z > 1e-4f;
    std::map<std::string, Plane<float>> truth = {{"AO.Y", Plane<float>(192, 36, 0.9f)}};
    for (int y = 0; y < 36; ++y)
      for (int x = 150; x < 192; ++x) truth["AO.Y"](x, y) = 0.2f;
    if (n > 1)
      write_frame(path("truth." + std::to_string(n) + ".exr"),
                  FramePart{"", window, window, truth, Imf::FLOAT, {}});
  }
  const json all = report({"--truth", path("truth.@.exr") + ":AO"});
  const json& row = all.at("rows").at(0);
  const std::string command = row.at("command");
  ASSERT_EQ(std::system(("cd '" + dir_.path().string() + "' && " + tool_path().string() +
                         command.substr(4) + " --pixel-type float --overwrite -q")
                            .c_str()),
            0);
  double squares = 0, count = 0;
  for (int n = 2; n <= 3; ++n) {
    const Plane<float> ao = channel(path("relit.000" + std::to_string(n) + ".exr"), "ao.Y");
    for (int y = 0; y < 36; ++y) {
      for (int x = 0; x < 192; ++x) {
        bool is_near = false;
        for (int v = std::max(y - 24, 0); v <= std::min(y + 24, 35); ++v)
          for (int u = std::max(x - 24, 0); u <= std::min(x + 24, 191); ++u)
            is_near = is_near || shows_ball[n](u, v) || shows_ball[n - 1](u, v);
        if (!is_near) continue;
        squares += std::pow(double(ao(x, y)) - (x < 150 ? 0.9 : 0.2), 2), ++count;
      }
    }
  }
  const json& figures = row.at("products").at("ao");
  EXPECT_NEAR(figures.at("error_near_moving"), std::sqrt(squares / count),
              0.02 * std::sqrt(squares / count));
  EXPECT_GT(figures.at("error"), 2 * double(figures.at("error_near_moving")));
}

TEST_F(BenchShot, TableCsvAndJsonSayTheSame) {
  const Finished done =
      bench({"--report", path("r.csv"), "--report", path("r.json"), "--frames", "2-3", "-q"});
  ASSERT_EQ(done.code, 0) << done.err;
  const json all = parse_json(read_file(path("r.json")));
  ASSERT_EQ(all.at("rows").size(), 4u) << "frames on disk that are not measured take part";
  std::istringstream lines(read_file(path("r.csv")));
  std::string line;
  std::getline(lines, line);
  EXPECT_THAT(line, testing::StartsWith("setting,cpu_s_per_frame"));
  for (const json& row : all.at("rows")) {
    const double flicker = row.at("products").at("ao").at("flicker");
    EXPECT_TRUE(row.at("products").at("ao").at("error").is_null()) << "no truth was given";
    std::getline(lines, line);
    EXPECT_THAT(line, HasSubstr(",ao,"));
    EXPECT_THAT(line, HasSubstr("," + json(flicker).dump() + ","));
    char shown[16];
    std::snprintf(shown, sizeof shown, "%.4f", flicker);
    EXPECT_THAT(done.out, HasSubstr(shown));
    EXPECT_THAT(done.out, HasSubstr(std::string(row.at("setting"))));
    EXPECT_THAT(std::string(row.at("command")), HasSubstr("--frames 2-3"));
  }
  EXPECT_EQ(done.err, "");
}

TEST_F(BenchShot, LeavesNothingInTheFolderForTemporaryFiles) {
  std::filesystem::create_directory(path("tmp"));
  const Finished done = run_tool(
      {"bench", path("in.@.exr"), "--quality", "draft", "--products", "ao", "--frames", "1", "-q"},
      {.variables = {{"TMPDIR", path("tmp")}}});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(listing(path("tmp")), IsEmpty());
}

TEST_F(BenchShot, RefusesWhatIsOfAFrameAndBrokenShots) {
  const auto fails = [&](const std::vector<std::string>& more, int code, const std::string& text) {
    const Finished done = bench(more);
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_THAT(done.err, HasSubstr(text));
    EXPECT_EQ(done.out, "");
  };
  fails({"--methods", "ssao"}, 2, "name one method with --method");
  fails({"--want", "0.1"}, 2, "--want chooses");
  fails({"--truth", path("truth.2.exr") + ":AO"}, 2, "give the truth a frame pattern");
  fails({"--truth", path("nothing.@.exr") + ":AO"}, 3, "none of the 3 frames exists");
  fails({"--frames", "1,7"}, 3, "in.7.exr");
  fails({"--report", path("in.1.exr")}, 2, "unknown kind");
  EXPECT_EQ(run_tool({"bench", path("in.1.exr"), "--quality", "draft"}).code, 2);
}

TEST_F(BenchShot, ThePageDrawsFlickerAgainstTime) {
  const json all = report({"--truth", path("truth.@.exr") + ":AO", "--report", path("page.html")});
  Browser browser(dir_ / "profile", 1500, 1200);
  browser.open_page("file://" + path("page.html"));
  for (const std::string what : {"flicker", "error"}) {
    const std::string points = "Chart.getChart('" + what + "').data.datasets.flatMap(s => s.data)";
    double times = 0, values = 0;
    for (const json& row : all.at("rows")) {
      times += double(row.at("cpu_s_per_frame"));
      values += double(row.at("products").at("ao").at(what));
    }
    EXPECT_EQ(browser.evaluate(points + ".length"), all.at("rows").size());
    EXPECT_NEAR(browser.evaluate(points + ".reduce((sum, p) => sum + p.x, 0)"), times, 1e-9);
    EXPECT_NEAR(browser.evaluate(points + ".reduce((sum, p) => sum + p.y, 0)"), values, 1e-9);
  }
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('#table tbody tr').length"),
            all.at("rows").size());
  EXPECT_EQ(browser.evaluate("document.getElementById('command').textContent"),
            all.at("rows").back().at("command"));
  EXPECT_THAT(browser.complaints, IsEmpty());
  for (std::size_t i = 1; i < browser.requests.size(); ++i)
    EXPECT_THAT(browser.requests[i], testing::StartsWith("data:"));
}

}  // namespace
}  // namespace ssdo::test::bench_shot_test
