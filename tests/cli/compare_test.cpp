// SPDX-License-Identifier: Apache-2.0
//
// ssdo compare through the real binary, and against the comparer of OpenImageIO.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>

#include "math/sequence_numbers.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::compare_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const float kNan = std::numeric_limits<float>::quiet_NaN();

Plane<float> plane_of(const Window& w, const std::function<float(int x, int y)>& value) {
  Plane<float> plane(w.width(), w.height());
  for (int y = 0; y < w.height(); ++y) {
    for (int x = 0; x < w.width(); ++x) plane(x, y) = value(x + w.x0, y + w.y0);
  }
  return plane;
}

class Compare : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_ / name; }

  /// An EXR with these channels over a window of a display of 20 x 10.
  void write(const std::string& name, std::map<std::string, Plane<float>> channels,
             const Window& window = {0, 0, 20, 10}) const {
    write_frame(path(name),
                FramePart{"", window, {0, 0, 20, 10}, std::move(channels), Imf::FLOAT, {}});
  }

  /// What `--json` says of the only layer.
  json layer(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "compare");
    arguments.push_back("--json");
    const Finished done = run_tool(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    const json all = parse_json(done.out).at("layers");
    EXPECT_EQ(all.size(), 1u);
    return all.at(0);
  }

  const Window all_{0, 0, 20, 10};
  TempDir dir_;
};

TEST_F(Compare, FiguresInClosedForm) {
  // Differences 0, 1, ... 199 hundredths over a mean of 2.
  write("a.exr",
        {{"ao.Y", plane_of(all_, [](int x, int y) { return 2 + (20 * y + x) / 100.0f; })}});
  write("b.exr", {{"ao.Y", plane_of(all_, [](int, int) { return 2; })}});
  const json l = layer({path("a.exr"), path("b.exr")});
  EXPECT_EQ(l["a"], "ao");
  EXPECT_EQ(l["pixels"], 200);
  const double rmse = std::sqrt(199 * 200 * 399 / 6.0 / 200) / 100;
  EXPECT_NEAR(l["rmse"], rmse, 1e-6);
  EXPECT_NEAR(l["relative_rmse"], rmse / 2, 1e-6);
  EXPECT_NEAR(l["bias"], 0.995, 1e-6);
  EXPECT_NEAR(l["max"], 1.99, 1e-6);
  EXPECT_NEAR(l["p99"], 1.97, 1e-6) << "198 of 200 are at most that";
  EXPECT_NEAR(l["psnr"], 20 * std::log10(3.99 / rmse), 1e-4);
  EXPECT_NEAR(layer({path("b.exr"), path("a.exr")})["bias"], -0.995, 1e-6);
}

TEST_F(Compare, EqualImagesHaveNoError) {
  write("a.exr", {{"R", plane_of(all_, [](int x, int) { return float(x); })},
                  {"G", plane_of(all_, [](int, int y) { return float(y); })}});
  const json l = layer({path("a.exr"), path("a.exr")});
  EXPECT_EQ(l["rmse"], 0);
  EXPECT_EQ(l["channels"], 2);
  EXPECT_TRUE(l["psnr"].is_null());
  const Finished done = run_tool({"compare", path("a.exr"), path("a.exr"), "--fail-above", "0"});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.out, HasSubstr("R,G"));
  EXPECT_EQ(done.err, "");
}

TEST_F(Compare, LayersPairByName) {
  const auto one = plane_of(all_, [](int, int) { return 1; });
  const auto two = plane_of(all_, [](int, int) { return 2; });
  write("a.exr", {{"direct.R", one}, {"direct.G", one}, {"direct.B", two}, {"ao.Y", one}});
  write("b.exr", {{"ViewLayer.DiffDir.R", one},
                  {"ViewLayer.DiffDir.G", two},
                  {"ViewLayer.DiffDir.B", two},
                  {"ao.Y", two}});
  EXPECT_EQ(layer({path("a.exr"), path("b.exr")})["a"], "ao") << "the only one of both";
  const json l = layer({path("a.exr") + ":direct", path("b.exr") + ":DiffDir"});
  EXPECT_EQ(l["b"], "ViewLayer.DiffDir");
  EXPECT_NEAR(l["rmse"], std::sqrt(1 / 3.0), 1e-6);
  EXPECT_NEAR(l["bias"], -1 / 3.0, 1e-6);
  EXPECT_EQ(layer({path("a.exr") + ":direct.B", path("b.exr") + ":DiffDir.G"})["rmse"], 0);
  EXPECT_NEAR(layer({path("a.exr") + ":ao", path("b.exr") + ":DiffDir"})["bias"], -2 / 3.0, 1e-6)
      << "one channel against each of three";
}

TEST_F(Compare, OnlyValidPixelsCount) {
  write("a.exr", {{"ao.Y", plane_of(all_, [](int x, int) { return x == 3 ? kNan : 1.0f; })}});
  write("b.exr", {{"ao.Y", plane_of({5, 0, 25, 10}, [](int x, int) { return float(x) / 10; })}},
        {5, 0, 25, 10});
  write("mask.exr", {{"A", plane_of(all_, [](int x, int) { return x < 10 ? 1.0f : 0.0f; })}});
  EXPECT_EQ(layer({path("a.exr"), path("a.exr")})["pixels"], 190);
  EXPECT_EQ(layer({path("a.exr"), path("b.exr")})["pixels"], 150) << "columns 5 to 19";
  const json l = layer({path("a.exr"), path("b.exr"), "--mask", path("mask.exr")});
  EXPECT_EQ(l["pixels"], 50) << "columns 5 to 9";
  EXPECT_NEAR(l["bias"], 0.3, 1e-6);
}

TEST_F(Compare, WritesTheDifference) {
  write("a.exr", {{"n.X", plane_of(all_, [](int x, int) { return float(x); })},
                  {"n.Y", plane_of(all_, [](int, int y) { return y == 2 ? kNan : 1; })}});
  write("b.exr", {{"n.X", plane_of(all_, [](int, int y) { return float(y); })},
                  {"n.Y", plane_of(all_, [](int, int) { return 4; })}});
  const std::vector<std::string> arguments = {"compare", path("a.exr"), path("b.exr"), "--diff",
                                              path("d.exr")};
  EXPECT_EQ(run_tool(arguments).code, 0);
  EXPECT_THAT(channel_names(path("d.exr")), testing::ElementsAre("n.X", "n.Y"));
  EXPECT_EQ(channel(path("d.exr"), "n.X")(7, 4), 3);
  EXPECT_EQ(channel(path("d.exr"), "n.Y")(7, 4), -3);
  EXPECT_EQ(channel(path("d.exr"), "n.X")(7, 2), 0) << "not valid in A";
  EXPECT_EQ(run_tool(arguments).code, 5) << "it exists";
  auto onto_input = arguments;
  onto_input.back() = path("a.exr");
  onto_input.push_back("--overwrite");
  EXPECT_EQ(run_tool(onto_input).code, 5);
}

TEST_F(Compare, FailsAboveABound) {
  write("a.exr", {{"ao.Y", plane_of(all_, [](int, int) { return 0.5f; })}});
  write("b.exr", {{"ao.Y", plane_of(all_, [](int, int) { return 0.75f; })}});
  const auto code = [&](const std::string& bound) {
    const Finished done =
        run_tool({"compare", path("a.exr"), path("b.exr"), "--fail-above", bound});
    EXPECT_THAT(done.out, HasSubstr("0.25"));
    return done.code;
  };
  EXPECT_EQ(code("0.25"), 0);
  EXPECT_EQ(code("0.2499"), 1);
}

TEST_F(Compare, ErrorsInOneLine) {
  const auto one = plane_of(all_, [](int, int) { return 1; });
  write("a.exr", {{"direct.R", one}, {"direct.G", one}, {"x.direct.Y", one}, {"q.Y", one}});
  write("nan.exr",
        {{"direct.R", plane_of(all_, [](int, int) { return kNan; })}, {"direct.G", one}});
  const auto fails = [&](std::vector<std::string> arguments, int code, const std::string& text) {
    arguments.insert(arguments.begin(), "compare");
    const Finished done = run_tool(arguments);
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_THAT(done.error_line(), HasSubstr(text));
    EXPECT_EQ(done.out, "");
  };
  const std::string a = path("a.exr");
  fails({a}, 2, "B");
  fails({a, a, a}, 2, "");
  fails({a, a, "--fail-above", "nan"}, 2, "--fail-above");
  fails({a, path("none.exr")}, 3, "none.exr");
  fails({a + ":nothing", a}, 4, "has no layer 'nothing'; there is direct, q, x.direct");
  fails({a + ":Y", a}, 4, "2 layers are called 'Y'");
  fails({a, path("nan.exr")}, 1, "no pixel is valid");
  fails({a, a, "--mask", a}, 4, "name one");
  fails({a, a, "--diff", path("no/d.exr")}, 5, "no");
}

/// What a command prints.
std::string output_of(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  char buffer[256];
  while (pipe && std::fgets(buffer, sizeof buffer, pipe)) text += buffer;
  if (pipe) pclose(pipe);
  return text;
}

/// OpenImageIO's idiff measures RMSE, the largest difference and the PSNR over all channels.
TEST_F(Compare, AgreesWithIdiff) {
  const auto noise = [](int x, int y, int k) {
    return float(fraction(0.5 + x * 0.7548776662 + y * 0.5698402910 + k * 0.381966));
  };
  std::map<std::string, Plane<float>> a, b;
  for (int c = 0; c < 3; ++c) {
    const std::string name = std::string(1, "RGB"[c]);
    a[name] = plane_of(all_, [&](int x, int y) { return noise(x, y, c); });
    b[name] = plane_of(all_, [&](int x, int y) { return 1.5f * noise(x, y, c + 5); });
  }
  write("a.exr", a);
  write("b.exr", b);
  const std::string text = output_of("idiff -fail 0 " + path("a.exr") + " " + path("b.exr"));
  const auto figure = [&](const std::string& name) {
    std::smatch found;
    const bool said = std::regex_search(text, found, std::regex(name + " *= *([0-9.e+-]+)"));
    EXPECT_TRUE(said) << name << " in: " << text;
    return said ? std::stod(found[1]) : 0.0;
  };
  const json l = layer({path("a.exr"), path("b.exr")});
  EXPECT_NEAR(l["rmse"], figure("RMS error"), 1e-5);
  EXPECT_NEAR(l["max"], figure("Max error"), 1e-5);
  EXPECT_NEAR(l["psnr"], figure("Peak SNR"), 1e-3);
}

}  // namespace
}  // namespace ssdo::test::compare_test
