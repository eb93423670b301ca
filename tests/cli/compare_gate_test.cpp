// SPDX-License-Identifier: Apache-2.0
//
// ssdo compare as a gate of scripts. Issue 12, number 15: it passed pictures of which only a part
// could be compared, and did not look at the alpha of PNG.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "io/images/image_file.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::compare_gate_test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const float kNan = std::numeric_limits<float>::quiet_NaN();
const Window kAll{0, 0, 20, 10};

class CompareGate : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_ / name; }

  static Plane<float> plane_of(const std::function<float(int x, int y)>& value,
                               const Window& w = kAll) {
    Plane<float> plane(w.width(), w.height());
    for (int y = 0; y < w.height(); ++y) {
      for (int x = 0; x < w.width(); ++x) plane(x, y) = value(x + w.x0, y + w.y0);
    }
    return plane;
  }

  void write(const std::string& name, std::map<std::string, Plane<float>> channels,
             const Window& window = kAll) const {
    write_frame(path(name), FramePart{"", window, kAll, std::move(channels), Imf::FLOAT, {}});
  }

  void write_png(const std::string& name, int channels, float color, float alpha) const {
    std::vector<float> values;
    for (int i = 0; i < 20 * 10 * channels; ++i)
      values.push_back(channels % 2 == 0 && i % channels == channels - 1 ? alpha : color);
    SafeFile file(path(name), {});
    write_image(file, {20, 10, channels, 8, 1}, values);
    file.commit();
  }

  Finished gate(const std::string& a, const std::string& b,
                const std::vector<std::string>& flags = {}) const {
    std::vector<std::string> arguments = {"compare", path(a), path(b), "--fail-above", "0.001"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return run_tool(arguments);
  }

  json layers(const std::string& a, const std::string& b) const {
    const Finished done = run_tool({"compare", path(a), path(b), "--json"});
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(done.out).at("layers");
  }

  json layer(const std::string& a, const std::string& b) const { return layers(a, b).at(0); }

  TempDir dir_;
};

TEST_F(CompareGate, AlphaOfPngIsCompared) {
  write_png("opaque.png", 4, 0.4f, 1);
  write_png("thin.png", 4, 0.4f, 0.2f);
  write_png("rgb.png", 3, 0.4f, 1);
  EXPECT_EQ(gate("opaque.png", "thin.png").code, 1);
  const json kinds = layers("opaque.png", "thin.png");
  ASSERT_EQ(kinds.size(), 2u);
  EXPECT_EQ(kinds[0]["channels"], 3);
  EXPECT_EQ(kinds[0]["rmse"], 0);
  EXPECT_EQ(kinds[1]["a"], "A");
  EXPECT_NEAR(kinds[1]["rmse"], 0.8, 1e-6);
  EXPECT_EQ(gate("opaque.png", "opaque.png").code, 0);
  const Finished without = gate("opaque.png", "rgb.png");
  EXPECT_EQ(without.code, 0) << "what both have is equal";
  EXPECT_THAT(without.out, HasSubstr("only in A: A\n"));
  EXPECT_EQ(layer("opaque.png", "rgb.png")["channels"], 3);
}

TEST_F(CompareGate, AlphaOfAPngIsNoMask) {
  write_png("black.png", 4, 0, 1);
  write_png("white.png", 4, 1, 0);
  write("a.exr", {{"ao.Y", plane_of([](int, int) { return 1; })}});
  EXPECT_EQ(gate("a.exr", "a.exr", {"--mask", path("white.png")}).code, 0);
  const Finished nothing = gate("a.exr", "a.exr", {"--mask", path("black.png")});
  EXPECT_EQ(nothing.code, 1);
  EXPECT_THAT(nothing.error_line(), HasSubstr("no pixel is valid"));
}

TEST_F(CompareGate, PixelsThatAreFiniteInOneOnlyFail) {
  const auto one = plane_of([](int, int) { return 1; });
  const auto half_broken = plane_of([](int x, int) { return x < 10 ? 1 : kNan; });
  write("a.exr", {{"ao.Y", one}});
  write("b.exr", {{"ao.Y", half_broken}});
  const json l = layer("a.exr", "b.exr");
  EXPECT_EQ(l["pixels"], 100);
  EXPECT_EQ(l["left_out"], 100);
  EXPECT_EQ(l["not_finite_in_one"], 100);
  EXPECT_EQ(l["not_finite_in_both"], 0);
  const Finished failed = gate("a.exr", "b.exr");
  EXPECT_EQ(failed.code, 1);
  EXPECT_THAT(failed.out, HasSubstr("ao: 100 pixels have no counterpart"));
  EXPECT_EQ(gate("a.exr", "b.exr", {"--max-invalid", "0.5"}).code, 0);
  EXPECT_EQ(gate("a.exr", "b.exr", {"--max-invalid", "0.49"}).code, 1);
  EXPECT_EQ(run_tool({"compare", path("a.exr"), path("b.exr")}).code, 0) << "no gate";
  EXPECT_EQ(gate("a.exr", "b.exr", {"--max-invalid", "2"}).code, 2);
}

/// A depth is not finite where there is no surface.
TEST_F(CompareGate, BackgroundThatBothHaveIsLeftOut) {
  const auto depth =
      plane_of([](int x, int) { return x < 10 ? 3 : std::numeric_limits<float>::infinity(); });
  write("a.exr", {{"Z", depth}});
  const json l = layer("a.exr", "a.exr");
  EXPECT_EQ(l["not_finite_in_both"], 100);
  EXPECT_EQ(l["not_finite_in_one"], 0);
  const Finished passed = gate("a.exr", "a.exr");
  EXPECT_EQ(passed.code, 0);
  EXPECT_THAT(passed.out, Not(HasSubstr("counterpart")));
}

TEST_F(CompareGate, PixelsOutsideOneWindowFail) {
  const Window right{15, 0, 25, 10};
  write("a.exr", {{"ao.Y", plane_of([](int, int) { return 1; })}});
  write("b.exr", {{"ao.Y", plane_of([](int, int) { return 1; }, right)}}, right);
  const json l = layer("a.exr", "b.exr");
  EXPECT_EQ(l["pixels"], 50);
  EXPECT_EQ(l["outside_one"], 200) << "150 of A and 50 of B";
  EXPECT_EQ(gate("a.exr", "b.exr").code, 1);
  EXPECT_EQ(gate("a.exr", "b.exr", {"--max-invalid", "0.8"}).code, 0);
  write("mask.exr", {{"A", plane_of([](int, int) { return 1; }, {15, 0, 20, 10})}},
        {15, 0, 20, 10});
  EXPECT_EQ(gate("a.exr", "b.exr", {"--mask", path("mask.exr")}).code, 0);
}

TEST_F(CompareGate, OutputsOfTheToolPassAgainstThemselves) {
  write_frame(path("in.exr"), frame_of(small_picture()));
  ASSERT_EQ(run_tool({path("in.exr"), "-o", path("out.exr"), "-o", path("out.png")}).code, 0);
  EXPECT_EQ(gate("out.exr", "out.exr").code, 0);
  EXPECT_EQ(gate("out.png", "out.png").code, 0);
}

/// Colours, a depth and an alpha were one figure, which the depth ruled.
TEST_F(CompareGate, WhatDiffersInKindHasFiguresOfItsOwn) {
  const auto value = [&](float v) { return plane_of([=](int, int) { return v; }); };
  const std::map<std::string, Plane<float>> a = {
      {"R", value(1)},   {"G", value(1)},   {"B", value(1)},     {"A", value(1)},
      {"Z", value(500)}, {"P.X", value(1)}, {"P.Y", value(1)},   {"P.Z", value(1)},
      {"c.R", value(1)}, {"c.A", value(1)}, {"N.red", value(1)}, {"N.green", value(1)}};
  std::map<std::string, Plane<float>> b = a;
  b["R"] = b["P.Z"] = value(1.5), b["Z"] = value(400), b["c.A"] = value(0.5);
  write("a.exr", a);
  write("b.exr", b);
  std::map<std::string, double> rmse;
  for (const json& l : layers("a.exr", "b.exr")) rmse[l["a"]] = l["rmse"];
  EXPECT_EQ(rmse.size(), 7u);
  EXPECT_NEAR(rmse.at("R,G,B"), 0.5 / std::sqrt(3), 1e-6);
  EXPECT_EQ(rmse.at("A"), 0);
  EXPECT_EQ(rmse.at("Z"), 100);
  EXPECT_NEAR(rmse.at("P"), 0.5 / std::sqrt(3), 1e-6);
  EXPECT_EQ(rmse.at("c.A"), 0.5);
  EXPECT_EQ(rmse.at("N"), 0);
}

/// A gate passed a picture without the layer that it was to guard.
TEST_F(CompareGate, ALayerThatOneSideLacksFails) {
  const auto one = plane_of([](int, int) { return 1; });
  write("both.exr", {{"ao.Y", one}, {"direct.R", one}, {"direct.G", one}, {"direct.B", one}});
  write("ao.exr", {{"ao.Y", one}});
  for (const auto& [a, b] : {std::pair("both.exr", "ao.exr"), {"ao.exr", "both.exr"}}) {
    const Finished done = gate(a, b);
    EXPECT_EQ(done.code, 1) << a;
    EXPECT_THAT(done.out, HasSubstr("direct.R")) << a;
    EXPECT_EQ(run_tool({"compare", path(a), path(b)}).code, 0) << "no gate";
  }
  EXPECT_EQ(gate("both.exr:ao", "ao.exr:ao").code, 0) << "named";
  EXPECT_EQ(gate("both.exr:direct", "ao.exr").code, 4);
}

TEST_F(CompareGate, ABareChannelCanBeNamedBesideALayerWithItsName) {
  const auto value = [&](float v) { return plane_of([=](int, int) { return v; }); };
  write(
      "a.exr",
      {{"P.X", value(1)}, {"P.Y", value(2)}, {"P.Z", value(3)}, {"R", value(9)}, {"Z", value(4)}});
  const json l = layer("a.exr:Z", "a.exr:P.Z");
  EXPECT_NEAR(l["bias"], 1, 1e-6);
}

TEST_F(CompareGate, ADifferenceIsAnExr) {
  write("a.exr", {{"ao.Y", plane_of([](int, int) { return 1; })}});
  for (const char* name : {"d.png", "d", "d.hdr"}) {
    const Finished done = gate("a.exr", "a.exr", {"--diff", path(name)});
    EXPECT_EQ(done.code, 2) << name;
    EXPECT_THAT(done.error_line(), HasSubstr(".exr")) << name;
    EXPECT_FALSE(std::filesystem::exists(path(name))) << name;
  }
}

TEST_F(CompareGate, ADifferenceDoesNotReplaceTheMask) {
  write("a.exr", {{"ao.Y", plane_of([](int, int) { return 1; })}});
  write("mask.exr", {{"A", plane_of([](int, int) { return 1; })}});
  const Finished done =
      gate("a.exr", "a.exr",
           {"--mask", path("mask.exr") + ":A", "--diff", path("mask.exr"), "--overwrite"});
  EXPECT_EQ(done.code, 5);
  EXPECT_THAT(done.error_line(), HasSubstr("is an input"));
}

TEST_F(CompareGate, ChannelsWithoutACounterpartAreListed) {
  const auto one = plane_of([](int, int) { return 1; });
  write("a.exr", {{"ao.Y", one}, {"bounce.R", one}});
  write("b.exr", {{"ao.Y", one}, {"error.Y", one}});
  const Finished done = gate("a.exr", "b.exr");
  EXPECT_EQ(done.code, 1);
  EXPECT_THAT(done.out, HasSubstr("only in A: bounce.R\nonly in B: error.Y\n"));
  const json all = parse_json(run_tool({"compare", path("a.exr"), path("b.exr"), "--json"}).out);
  EXPECT_THAT(all["only_in_a"], ElementsAre("bounce.R"));
  EXPECT_THAT(all["only_in_b"], ElementsAre("error.Y"));
}

}  // namespace
}  // namespace ssdo::test::compare_gate_test
