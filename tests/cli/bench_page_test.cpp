// SPDX-License-Identifier: Apache-2.0
//
// The page of ssdo bench in headless Chromium, opened from its file.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/bench_frame.h"
#include "support/browser.h"
#include "support/parse_json.h"

namespace ssdo::test::bench_page_test {
namespace {

using nlohmann::json;
using testing::IsEmpty;
using testing::StartsWith;

/// The points of the chart that stand for settings.
const std::string kPoints =
    "Chart.getChart('chart').data.datasets.filter(s => s.method).flatMap(s => s.data)";

class BenchPage : public testing::Test {
 protected:
  BenchPage() : browser_(frame_.folder / "profile", 1500, 1200) {
    const std::string page = frame_.folder / "page.html", figures = frame_.folder / "r.json";
    const Finished done = run_tool(
        frame_.arguments({"--truth", frame_.truth + ":AO", "--report", page, "--report", figures}));
    EXPECT_EQ(done.code, 0) << done.err;
    report_ = parse_json(read_file(figures));
    browser_.open_page("file://" + page);
  }

  ~BenchPage() override { EXPECT_THAT(browser_.complaints, IsEmpty()); }

  double number(const std::string& expression) { return browser_.evaluate(expression); }
  std::string text(const std::string& expression) { return browser_.evaluate(expression); }

  BenchFrame frame_;
  Browser browser_;
  json report_;
};

TEST_F(BenchPage, AsksForNoOtherFile) {
  ASSERT_FALSE(browser_.requests.empty());
  EXPECT_THAT(browser_.requests[0], StartsWith("file://"));
  for (std::size_t i = 1; i < browser_.requests.size(); ++i)
    EXPECT_THAT(browser_.requests[i], StartsWith("data:"));
}

TEST_F(BenchPage, TheChartHasAPointForEachRow) {
  for (const std::string product : {"ao", "direct", "bounce"}) {
    browser_.evaluate("document.querySelector('#products [value=" + product + "]').click()");
    const std::string part = product == "ao" ? "model" : "approximation";
    double count = 0, errors = 0, times = 0;
    for (const json& row : report_["rows"]) {
      if (!row["errors"].contains(product)) continue;
      count += 1;
      errors += double(row["errors"][product][part]);
      times += double(row["cpu_ms_per_megapixel"]);
    }
    EXPECT_EQ(number(kPoints + ".length"), count) << product;
    EXPECT_NEAR(number(kPoints + ".reduce((sum, p) => sum + p.y, 0)"), errors, 1e-9) << product;
    EXPECT_NEAR(number(kPoints + ".reduce((sum, p) => sum + p.x, 0)"), times, 1e-6 * times);
    const std::string line =
        "Chart.getChart('chart').data.datasets.find(s => !s.method).data"
        ".map(p => bench.rows.indexOf(p.row))";
    EXPECT_EQ(browser_.evaluate(line), report_["fronts"][product]) << "the Pareto front";
  }
  EXPECT_EQ(text("Chart.getChart('chart').options.scales.x.type"), "logarithmic");
  EXPECT_EQ(text("Chart.getChart('chart').options.scales.y.type"), "logarithmic");
}

TEST_F(BenchPage, HoverShowsTheSetting) {
  const json at = browser_.evaluate(
      "(() => { const c = Chart.getChart('chart'), p = c.getDatasetMeta(0).data[0],"
      " b = c.canvas.getBoundingClientRect(); return [b.left + p.x, b.top + p.y]; })()");
  browser_.mouse("mouseMoved", at[0], at[1]);
  EXPECT_EQ(text("new Promise(done => setTimeout(() =>"
                 " done(Chart.getChart('chart').tooltip.title.join()), 200))"),
            "bitmask 1 x 6");
}

TEST_F(BenchPage, TheSliderMovesTheWipe) {
  // Maps are painted once their pictures are decoded.
  const auto shown = [&] { return number("document.getElementById('left-picture').width"); };
  for (int i = 0; i < 100 && shown() != 32; ++i)
    browser_.evaluate("new Promise(done => setTimeout(done, 50))");
  EXPECT_EQ(shown(), 32) << "the map has the pixels of the frame";
  const std::string clip = "document.getElementById('left-picture').style.clipPath";
  EXPECT_EQ(text(clip), "inset(0px 50% 0px 0px)");
  browser_.evaluate("document.getElementById('wipe').scrollIntoView({block: 'center'})");
  const json box = browser_.evaluate(
      "(() => { const b = document.getElementById('wipe').getBoundingClientRect();"
      " return [b.left, b.top + b.height / 2, b.width]; })()");
  const double left = box[0], y = box[1], width = box[2];
  browser_.mouse("mousePressed", left + width / 2, y);
  browser_.mouse("mouseMoved", left + width / 4, y);
  browser_.mouse("mouseReleased", left + width / 4, y);
  EXPECT_NEAR(number("Number(document.getElementById('wipe').value)"), 25, 2);
  EXPECT_NEAR(number("100 - parseFloat(" + clip + ".split(' ')[1])"), 25, 2);
  EXPECT_NEAR(number("parseFloat(document.getElementById('divider').style.left)"), 25, 2);
  // Dragging on the map itself does the same.
  const json map = browser_.evaluate(
      "(() => { const b = document.getElementById('viewer').getBoundingClientRect();"
      " return [b.left, b.top + b.height / 2, b.width]; })()");
  browser_.mouse("mousePressed", double(map[0]) + 0.5 * double(map[2]), map[1]);
  browser_.mouse("mouseMoved", double(map[0]) + 0.75 * double(map[2]), map[1]);
  browser_.mouse("mouseReleased", double(map[0]) + 0.75 * double(map[2]), map[1]);
  EXPECT_NEAR(number("Number(document.getElementById('wipe').value)"), 75, 2);
}

TEST_F(BenchPage, TruthAndCommandsAreThere) {
  browser_.evaluate("document.getElementById('view-picture').click()");
  EXPECT_EQ(text("document.getElementById('right').value"), "truth");
  EXPECT_EQ(text("document.getElementById('want').value = '10',"
                 "document.getElementById('want').dispatchEvent(new Event('input')),"
                 "document.getElementById('command').textContent"),
            std::string(report_["rows"][std::size_t(report_["fronts"]["ao"][0])]["command"]));
}

}  // namespace
}  // namespace ssdo::test::bench_page_test
