// SPDX-License-Identifier: Apache-2.0
//
// --only, --no-receive, --holdout, --no-cast and --shadow-of.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::objects_test {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kBlender = std::string(SSDO_SOURCE_DIR) + "/data/objects.exr";
const std::string kSky = std::string(SSDO_SOURCE_DIR) + "/data/environments/sky.exr";
constexpr Window kWindow{0, 0, 96, 72};

/// A floor, a wall and a ball, with ids and a matte of the ball.
FramePart frame(bool with_ball, const Window& window = kWindow) {
  const Camera by =
      look_at(camera_from_fov(50, window, 1), {0.3, -4, 2.2}, {0, 0.5, 0.4}, {0, 0, 1});
  const Surface floor = plane({0, 0, 0}, {0, 0, 1}), wall = plane({0, 2, 0}, {0, -1, 0}),
                ball = sphere({0.1, 0.6, 0.5}, 0.5);
  const Picture picture =
      take_picture(with_ball ? all_of({floor, wall, ball}) : all_of({floor, wall}), by, window);
  FramePart part = frame_of(picture);
  part.data = part.display = window;
  Plane<float> ids(window.width(), window.height(), 1.0f);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const glm::dvec3 p(picture.position[i]);
    if (with_ball && std::abs(glm::distance(p, {0.1, 0.6, 0.5}) - 0.5) < 1e-4) ids[i] = 2;
  }
  part.channels["IndexOB.X"] = ids;
  Plane<float> matte = ids;
  for (float& m : matte.pixels) m = m == 2 ? 1 : 0;
  part.channels["ball.A"] = matte;
  return part;
}

class Objects : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_ / name; }

  void run(const std::string& in, const std::string& out, const Words& flags) const {
    const Finished done =
        run_tool(Words{in, "-o", path(out), "--overwrite", "--pixel-type", "float", "-q"} + flags);
    EXPECT_EQ(done.code, 0) << done.err;
  }

  Plane<float> at(const std::string& file, const std::string& name) const {
    return channel(path(file), name);
  }

  Finished refused(const Words& flags, const std::string& in = kBlender) const {
    return run_tool(Words{in, "-o", path("none.exr")} + flags);
  }

  const TempDir dir_;
};

double rms(const Plane<float>& a, const Plane<float>& b, const Plane<float>& where, float is) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (where[i] != is) continue;
    sum += double(a[i] - b[i]) * double(a[i] - b[i]), count += 1;
  }
  return std::sqrt(sum / std::max(count, 1.0));
}

TEST_F(Objects, InfoListsTheNamesOfAFrame) {
  const Finished text = run_tool({"info", kBlender});
  EXPECT_THAT(text.out, HasSubstr("objects   ViewLayer.CryptoObject: "));
  EXPECT_THAT(text.out, HasSubstr("objects   ViewLayer.IndexOB: "));
  const nlohmann::json objects = parse_json(run_tool({"info", kBlender, "--json"}).out)["objects"];
  ASSERT_EQ(objects.size(), 4u);
  double sum = 0;
  for (const double share : objects["ViewLayer.CryptoObject"]) sum += share;
  EXPECT_NEAR(sum, 1, 0.2);
  EXPECT_GT(objects["ViewLayer.CryptoObject"]["ball.001"], 0.03);
}

/// Coverage c gives c P + (1 - c) B by --only, and the other way round by --no-receive.
TEST_F(Objects, OnlyAndNoReceiveShareThePixels) {
  for (const Words& more : {Words{}, Words{"--downsample", "3"}, Words{"--compose", "add"}}) {
    run(kBlender, "all.exr", more);
    run(kBlender, "only.exr", more + Words{"--only", "crypto:ball.001"});
    run(kBlender, "not.exr", more + Words{"--no-receive", "crypto:ball.001"});
    run(kBlender, "beauty.exr", more + Words{"--only", "crypto:ball.001-crypto:ball.001"});
    int changed = 0, kept = 0, mixed = 0;
    for (const char* c : {"R", "G", "B"}) {
      const Plane<float> all = at("all.exr", c), only = at("only.exr", c), other = at("not.exr", c),
                         beauty = at("beauty.exr", c);
      for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_NEAR(only[i] + other[i], all[i] + beauty[i], 1e-5f) << i;
        changed += std::abs(only[i] - all[i]) < 1e-6f, kept += only[i] == beauty[i];
        mixed += (only[i] - all[i]) * (only[i] - beauty[i]) < -1e-6f;
      }
    }
    if (more != Words{"--downsample", "3"}) {
      EXPECT_GT(changed, 20);
    }
    EXPECT_GT(kept, 200);
    EXPECT_GT(mixed, 20) << "edges are not antialiased";
    if (!more.empty()) continue;
    const Plane<float> rendered = channel(kBlender, "ViewLayer.Combined.G");
    EXPECT_EQ(at("beauty.exr", "G").pixels, rendered.pixels);
  }
}

TEST_F(Objects, WithoutABeautyPixelsAreOpen) {
  FramePart part = frame(true);
  write_frame(path("in.exr"), part);
  run(path("in.exr"), "all.exr", {"--env", "1,2,3"});
  run(path("in.exr"), "kept.exr", {"--env", "1,2,3", "--no-receive", "id:IndexOB=2"});
  for (const auto& [name, open] : std::vector<std::pair<std::string, float>>{
           {"ao.Y", 1}, {"direct.R", 1}, {"direct.B", 3}, {"bounce.G", 0}, {"G", 1}}) {
    const Plane<float> all = at("all.exr", name), kept = at("kept.exr", name);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (part.channels["ball.A"][i] == 0) {
        ASSERT_EQ(all[i], kept[i]) << name;
      } else {
        ASSERT_NEAR(kept[i], open, 1e-5f) << name;
      }
    }
  }
}

TEST_F(Objects, OccludeLeavesKeptPixelsAsRendered) {
  FramePart part = frame(true);
  part.add("beauty", Plane<glm::vec3>(96, 72, glm::vec3(0.5f, 0.4f, 0.3f)), "RGB");
  part.add("amb", Plane<glm::vec3>(96, 72, glm::vec3(0.4f)), "RGB");
  write_frame(path("in.exr"), part);
  run(path("in.exr"), "out.exr", {"--aov", "ambient=amb", "--only", "ball"});
  const Plane<float> out = at("out.exr", "R");
  int darker = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (part.channels["ball.A"][i] == 0)
      ASSERT_EQ(out[i], 0.5f);
    else
      darker += out[i] < 0.49f;
  }
  EXPECT_GT(darker, 50);
}

TEST_F(Objects, HoldoutTakesAlphaAndNothingElse) {
  for (const Words& more : {Words{}, Words{"--downsample", "3"}}) {
    run(kBlender, "all.exr", more);
    run(kBlender, "held.exr", more + Words{"--holdout", "crypto:ball.001"});
    int out = 0;
    for (const char* c : {"R", "G", "B", "A"}) {
      const Plane<float> all = at("all.exr", c), held = at("held.exr", c);
      for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_LE(held[i], all[i]);
        out += held[i] == 0 && all[i] > 0;
      }
    }
    if (more.empty()) {
      EXPECT_GT(out, 20);
    }
    EXPECT_EQ(at("all.exr", "ao.Y").pixels, at("held.exr", "ao.Y").pixels);
    EXPECT_EQ(at("all.exr", "direct.R").pixels, at("held.exr", "direct.R").pixels);
  }
}

/// What is left out of a frame casts as if it had not been there.
TEST_F(Objects, NoCastIsAsIfItWereNotThere) {
  const FramePart with = frame(true);
  write_frame(path("with.exr"), with), write_frame(path("without.exr"), frame(false));
  const Plane<float>& ball = with.channels.at("ball.A");
  for (const std::string method : {"bitmask", "trace"}) {
    const Words flags = {"--method", method, "--env", "1,1,1"};
    run(path("with.exr"), "with_out.exr", flags);
    run(path("without.exr"), "truth.exr", flags);
    run(path("with.exr"), "no_cast.exr", flags + Words{"--no-cast", "id:IndexOB=2"});
    for (const std::string name : {"ao.Y", "direct.G", "bounce.G"}) {
      const Plane<float> truth = at("truth.exr", name);
      const double before = rms(at("with_out.exr", name), truth, ball, 0),
                   after = rms(at("no_cast.exr", name), truth, ball, 0);
      EXPECT_LT(after, 0.2 * before) << method << " " << name;
      RecordProperty(method + name, fmt::format("{:.4f} of {:.4f}", after, before));
    }
    // The ball receives, but not from itself: it is open to all but floor and wall.
    const Plane<float> own = at("no_cast.exr", "ao.Y");
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < own.size(); ++i)
      if (ball[i] == 1) sum += own[i], count += 1;
    EXPECT_GT(sum / count, 0.4) << method;
    EXPECT_LT(sum / count, 0.98) << method;
  }
}

TEST_F(Objects, NoCastHasTheSameBitsForAnyThreads) {
  write_frame(path("in.exr"), frame(true));
  run(path("in.exr"), "one.exr", {"--no-cast", "ball", "--threads", "1"});
  run(path("in.exr"), "three.exr", {"--no-cast", "ball", "--threads", "3"});
  for (const std::string& name : channel_names(path("one.exr")))
    EXPECT_EQ(at("one.exr", name).pixels, at("three.exr", name).pixels) << name;
}

/// A view that shows the ball does not bring it back, where it has its ids too.
TEST_F(Objects, NoCastHoldsInOtherViews) {
  const FramePart with = frame(true);
  write_frame(path("in.exr"), with), write_frame(path("without.exr"), frame(false));
  write_frame(path("view.exr"), with);
  run(path("without.exr"), "truth.exr", {});
  run(path("in.exr"), "out.exr", {"--no-cast", "id:IndexOB=2", "--also", path("view.exr")});
  EXPECT_LT(rms(at("out.exr", "ao.Y"), at("truth.exr", "ao.Y"), with.channels.at("ball.A"), 0),
            0.02);
}

/// A matte is an input, whoever names it.
TEST_F(Objects, NoOutputReplacesAMatte) {
  write_frame(path("in.exr"), frame(true));
  write_frame(path("matte.exr"), frame(true));
  const std::string ball = path("matte.exr") + ":ball";
  for (const Words& with :
       {Words{"--no-cast", ball}, Words{"--light", "sphere position=0,2,2 receive=" + ball},
        Words{"--light", "sphere position=0,2,2 cast=" + ball}}) {
    const Finished done =
        run_tool(Words{path("in.exr"), "-o", path("matte.exr"), "--overwrite"} + with);
    EXPECT_EQ(done.code, 5);
    EXPECT_THAT(done.error_line(), HasSubstr("is an input"));
  }
}

/// Nor in frames of a shot, whose mattes have files of their own.
TEST_F(Objects, NoCastHoldsInAShot) {
  const FramePart with = frame(true);
  FramePart without = frame(false), matte = with;
  std::erase_if(matte.channels, [](const auto& c) { return c.first != "ball.A"; });
  for (const std::string number : {"1001", "1002"}) {
    write_frame(path("in." + number + ".exr"), with);
    write_frame(path("matte." + number + ".exr"), matte);
  }
  write_frame(path("without.exr"), without);
  run(path("without.exr"), "truth.exr", {});
  const Finished done =
      run_tool({path("in.####.exr"), "-o", path("out.####.exr"), "--frames", "1001", "--shot", "1",
                "--no-cast", path("matte.####.exr") + ":ball", "--pixel-type", "float"});
  EXPECT_EQ(done.code, 0);
  EXPECT_LT(rms(at("out.1001.exr", "ao.Y"), at("truth.exr", "ao.Y"), with.channels.at("ball.A"), 0),
            0.02);
}

/// The shadow of an object in a frame of a shot is that of the frame alone, with its seed.
TEST_F(Objects, ShadowOfInAShotIsThatOfTheFrame) {
  const FramePart with = frame(true);
  for (const std::string number : {"0001", "0002", "0003"})
    write_frame(path("in." + number + ".exr"), with);
  const Words flags = {"--shadow-of",  "ball",       "--env",
                       "2,1,1",        "--products", "direct,bounce,shadow_of",
                       "--pixel-type", "float"};
  const auto made = [&](const std::string& out, const Words& more) {
    const Finished done = run_tool(
        Words{path("in.####.exr"), "-o", path(out + ".####.exr"), "--frames", "2"} + flags + more);
    EXPECT_EQ(done.code, 0) << done.err;
  };
  made("alone", {"--seed", "7"});
  made("shot", {"--seed", "5", "--shot", "1"});
  for (const std::string c : {"R", "G", "B"})
    EXPECT_EQ(at("shot.0002.exr", "shadow_of." + c).pixels,
              at("alone.0002.exr", "shadow_of." + c).pixels);
  EXPECT_NE(at("shot.0002.exr", "bounce.R").pixels, at("alone.0002.exr", "bounce.R").pixels)
      << "the light is that of the shot";
  int dark = 0;
  for (const float shadow : at("shot.0002.exr", "shadow_of.R").pixels) dark += shadow < 0.8f;
  EXPECT_GT(dark, 20);
}

/// What receives where nothing casts has light all the same: the floor of this room is taken out.
TEST_F(Objects, WhatHasNothingBehindItReceives) {
  FramePart part = frame(true);
  for (float& id : part.channels["IndexOB.X"].pixels) id = 3 - id;
  write_frame(path("in.exr"), part);
  for (const Words& env : {Words{}, Words{"--env", kSky}}) {
    run(path("in.exr"), "out.exr", env + Words{"--no-cast", "id:IndexOB=2"});
    for (const std::string& name : channel_names(path("out.exr"))) {
      for (const float value : at("out.exr", name).pixels)
        ASSERT_TRUE(std::isfinite(value)) << name;
    }
    const Plane<float> ao = at("out.exr", "ao.Y");
    for (std::size_t i = 0; i < ao.size(); ++i)
      // The ball, which alone casts, hides less than half.
      if (part.channels["ball.A"][i] == 0 && i % 96 < 20) {
        ASSERT_GT(ao[i], 0.5f);
      }
  }
}

/// With the shadow, the light without the object is the light with it.
TEST_F(Objects, ShadowOfIsTheLightThatAnObjectTakes) {
  const FramePart with = frame(true);
  write_frame(path("in.exr"), with);
  const Plane<float>& ball = with.channels.at("ball.A");
  const Words light = {"--env", "2,1,1"};
  run(path("in.exr"), "all.exr", light + Words{"--shadow-of", "ball"});
  run(path("in.exr"), "with.exr", light);
  run(path("in.exr"), "without.exr", light + Words{"--no-cast", "ball"});
  EXPECT_EQ(at("all.exr", "direct.R").pixels, at("with.exr", "direct.R").pixels);
  const Plane<float> shadow = at("all.exr", "shadow_of.R");
  const Plane<float> a = at("with.exr", "direct.R"), a2 = at("with.exr", "bounce.R"),
                     b = at("without.exr", "direct.R"), b2 = at("without.exr", "bounce.R");
  int dark = 0, clear = 0;
  for (std::size_t i = 0; i < shadow.size(); ++i) {
    EXPECT_GT(shadow[i], 0);
    if (ball[i] == 1) continue;
    // Less of it where there is hardly any light, and no direct light that the ball adds.
    const double open = std::max(a[i], b[i]) + b2[i], noise = 0.03 * 2 / open,
                 expected = 1 + ((a[i] + a2[i]) / open - 1) / (1 + noise * noise);
    EXPECT_NEAR(shadow[i], expected, 1e-4) << open;
    dark += shadow[i] < 0.8f, clear += std::abs(shadow[i] - 1) < 0.02f;
  }
  EXPECT_GT(dark, 20);
  EXPECT_GT(clear, 1000);
}

/// What noise and guesses add to the direct light is none of the object's.
TEST_F(Objects, ShadowOfAddsNoDirectLight) {
  run(kBlender, "out.exr", {"--env", kSky, "--bounces", "0", "--shadow-of", "crypto:crate"});
  int dark = 0;
  for (const float shadow : at("out.exr", "shadow_of.R").pixels) {
    EXPECT_LE(shadow, 1.0001f);
    dark += shadow < 0.7f;
  }
  EXPECT_GT(dark, 10);
}

/// What is around the display window counts for the hole, whether it is written or not.
TEST_F(Objects, NoCastHasTheSameBitsWithCrop) {
  constexpr Window kOverscan{-20, -12, 116, 84};
  FramePart part = frame(true, kOverscan);
  part.display = kWindow;
  write_frame(path("in.exr"), part);
  const Words flags = {"--no-cast", "ball", "--products", "ao,direct,bounce,guessed"};
  run(path("in.exr"), "whole.exr", flags);
  run(path("in.exr"), "crop.exr", flags + Words{"--crop"});
  for (const std::string& name : channel_names(path("whole.exr"))) {
    const Plane<float> whole = at("whole.exr", name), crop = at("crop.exr", name);
    ASSERT_EQ(crop.width, kWindow.width());
    for (int y = 0; y < crop.height; ++y)
      for (int x = 0; x < crop.width; ++x)
        ASSERT_EQ(crop(x, y), whole(x + 20, y + 12)) << name << " " << x << " " << y;
  }
}

/// A sky dome casts nothing, as if the frame showed the sky.
TEST_F(Objects, ADomeHidesNoLight) {
  const Camera by =
      look_at(camera_from_fov(50, kWindow, 1), {0.3, -4, 2.2}, {0, 0.5, 1.2}, {0, 0, 1});
  const Surface stage = cut(plane({0, 0, 0}, {0, 0, 1}),
                            [](const glm::dvec3&p) { return glm::length(p) < 20; }),
                ball = sphere({0.1, 0.6, 0.5}, 0.5);
  const auto write = [&](const std::string& name, const std::vector<Surface>& shown) {
    FramePart part = frame_of(take_picture(all_of(shown), by, kWindow));
    part.data = part.display = kWindow;
    write_frame(path(name), part);
  };
  write("open.exr", {stage, ball}), write("dome.exr", {stage, ball, dome({0, 0, 0}, 500)});
  run(path("open.exr"), "truth.exr", {});
  run(path("dome.exr"), "auto.exr", {});
  run(path("dome.exr"), "cast.exr", {"--backdrop", "cast"});
  run(path("dome.exr"), "off.exr", {"--backdrop", "off"});
  const Picture open = take_picture(all_of({stage, ball}), by, kWindow);
  Plane<float> shown(96, 72);
  for (std::size_t i = 0; i < shown.size(); ++i) shown[i] = open.valid[i];
  const Plane<float> truth = at("truth.exr", "ao.Y");
  EXPECT_LT(rms(at("auto.exr", "ao.Y"), truth, shown, 1), 1e-5);
  EXPECT_GT(rms(at("cast.exr", "ao.Y"), truth, shown, 1), 0.1);
  EXPECT_EQ(at("cast.exr", "ao.Y").pixels, at("off.exr", "ao.Y").pixels);
  // Where it was is background to suns too.
  run(path("open.exr"), "truth.exr", {"--env", kSky, "--env-up", "z"});
  run(path("dome.exr"), "auto.exr", {"--env", kSky, "--env-up", "z"});
  EXPECT_LT(rms(at("auto.exr", "direct.R"), at("truth.exr", "direct.R"), shown, 1), 1e-4);
  const auto warning = [&](const std::string& choice) {
    return run_tool({"info", path("dome.exr"), "--backdrop", choice}).out;
  };
  EXPECT_THAT(warning("auto"),
              HasSubstr("a dome of radius 500 around everything: it casts nothing"));
  EXPECT_THAT(warning("cast"), HasSubstr("it hides the light"));
  EXPECT_THAT(warning("off"), Not(HasSubstr("a dome")));
}

/// Where a dome was is sky to a sun that stands beyond the border: a court is no room.
TEST_F(Objects, ADomeThatIsOutClosesNoCourt) {
  const Camera by =
      look_at(camera_from_fov(60, kWindow, 1), {0.3, -2.4, 1.6}, {0, 2, 2.2}, {0, 0, 1});
  const auto wall = [](const glm::dvec3& at, const glm::dvec3& normal) {
    return cut(plane(at, normal),
               [](const glm::dvec3& p) { return p.z < 3.2 && glm::length(p) < 7; });
  };
  const std::vector<Surface> court = {
      cut(plane({0, 0, 0}, {0, 0, 1}), [](const glm::dvec3& p) { return glm::length(p) < 7; }),
      wall({0, 3, 0}, {0, -1, 0}), wall({-3, 0, 0}, {1, 0, 0}), wall({3, 0, 0}, {-1, 0, 0})};
  const auto write = [&](const std::string& name, std::vector<Surface> shown, double radius) {
    if (radius > 0) shown.push_back(dome({0, 0, 0}, radius));
    FramePart part = frame_of(take_picture(all_of(shown), by, kWindow));
    part.data = part.display = kWindow;
    write_frame(path(name), part);
  };
  write("open.exr", court, 0), write("dome.exr", court, 500);
  const Picture open = take_picture(all_of(court), by, kWindow);
  Plane<float> shown(96, 72);
  for (std::size_t i = 0; i < shown.size(); ++i) shown[i] = open.valid[i];
  for (const std::string turn : {"0", "90", "180", "270"}) {
    const Words sun = {"--env", kSky, "--env-up", "z", "--env-rotate", turn};
    run(path("open.exr"), "truth.exr", sun);
    run(path("dome.exr"), "auto.exr", sun);
    EXPECT_LT(rms(at("auto.exr", "direct.R"), at("truth.exr", "direct.R"), shown, 1), 1e-4) << turn;
  }
}

/// Of a shot all frames have one answer, also the one whose dome is hardly larger than its stage.
TEST_F(Objects, AShotHasOneAnswerAboutItsDome) {
  const Camera by =
      look_at(camera_from_fov(50, kWindow, 1), {0.3, -4, 2.2}, {0, 0.5, 1.2}, {0, 0, 1});
  const Surface stage = cut(plane({0, 0, 0}, {0, 0, 1}),
                            [](const glm::dvec3&p) { return glm::length(p) < 20; }),
                ball = sphere({0.1, 0.6, 0.5}, 0.5);
  const auto write = [&](const std::string& name, double radius) {
    const Surface shown = all_of({stage, ball, dome({0, 0, 0}, radius)});
    FramePart part = frame_of(take_picture(shown, by, kWindow));
    part.data = part.display = kWindow;
    write_frame(path(name), part);
  };
  write("far.0001.exr", 500), write("far.0002.exr", 40), write("far.0003.exr", 500);
  write("near.0001.exr", 40), write("near.0002.exr", 60), write("near.0003.exr", 40);
  const auto says = [&](const Words& files) {
    const std::string out = files.size() > 1 ? "out.#.exr" : "out.exr";
    return run_tool(Words{"--overwrite", "-o", path(out)} + files).err;
  };
  EXPECT_THAT(says({path("far.0002.exr")}), Not(HasSubstr("a dome")));
  EXPECT_THAT(says({path("far.#.exr"), "--frames", "2"}),
              HasSubstr("a dome of radius 40 around everything: it casts nothing"));
  EXPECT_THAT(says({path("near.0002.exr")}), HasSubstr("a dome of radius 60"));
  EXPECT_THAT(says({path("near.#.exr"), "--frames", "2"}), Not(HasSubstr("a dome")));
}

/// A card behind a gap casts nothing either.
TEST_F(Objects, ACardHidesNoLight) {
  const Camera by =
      look_at(camera_from_fov(50, kWindow, 1), {0.3, -4, 2.2}, {0, 0.5, 1.2}, {0, 0, 1});
  const Surface stage = cut(plane({0, 0, 0}, {0, 0, 1}),
                            [](const glm::dvec3&p) { return glm::length(p) < 12; }),
                ball = sphere({0.1, 0.6, 0.5}, 0.5);
  const auto write = [&](const std::string& name, const std::vector<Surface>& shown) {
    FramePart part = frame_of(take_picture(all_of(shown), by, kWindow));
    part.data = part.display = kWindow;
    write_frame(path(name), part);
  };
  write("open.exr", {stage, ball});
  write("card.exr", {stage, ball, plane({0, 400, 0}, {0, -1, 0})});
  run(path("open.exr"), "truth.exr", {});
  run(path("card.exr"), "auto.exr", {});
  run(path("card.exr"), "cast.exr", {"--backdrop", "cast"});
  const Picture open = take_picture(all_of({stage, ball}), by, kWindow);
  Plane<float> shown(96, 72);
  for (std::size_t i = 0; i < shown.size(); ++i) shown[i] = open.valid[i];
  const Plane<float> truth = at("truth.exr", "ao.Y");
  EXPECT_LT(rms(at("auto.exr", "ao.Y"), truth, shown, 1), 1e-4);
  EXPECT_GT(rms(at("cast.exr", "ao.Y"), truth, shown, 1), 0.05);
}

/// One that stands on the ground nearby may be a wall: it casts until it is selected, or until
/// --backdrop any.
TEST_F(Objects, ACardOnTheGroundIsTakenOutByASelection) {
  const Camera by =
      look_at(camera_from_fov(50, kWindow, 1), {0.3, -4, 2.2}, {0, 0.5, 1.2}, {0, 0, 1});
  const Surface ground =
                    cut(plane({0, 0, 0}, {0, 0, 1}), [](const glm::dvec3&p) { return p.y < 40; }),
                ball = sphere({0.1, 0.6, 0.5}, 0.5), card = plane({0, 40, 0}, {0, -1, 0});
  const Picture open = take_picture(all_of({ground, ball}), by, kWindow);
  const auto write = [&](const std::string& name, const std::vector<Surface>& shown) {
    FramePart part = frame_of(take_picture(all_of(shown), by, kWindow));
    part.data = part.display = kWindow;
    part.channels["card.A"] = Plane<float>(96, 72, 0.0f);
    for (std::size_t i = 0; i < open.valid.size(); ++i)
      part.channels["card.A"][i] = open.valid[i] ? 0.0f : 1.0f;
    write_frame(path(name), part);
  };
  write("open.exr", {ground, ball}), write("card.exr", {ground, ball, card});
  run(path("open.exr"), "truth.exr", {});
  run(path("card.exr"), "auto.exr", {});
  run(path("card.exr"), "out.exr", {"--no-cast", "card"});
  EXPECT_THAT(run_tool({"info", path("card.exr")}).out,
              HasSubstr("show a card that stands on the ground, 20 times as far away as the camera "
                        "is high: it casts; where it stands for the sky, --backdrop any"));
  run(path("card.exr"), "any.exr", {"--backdrop", "any"});
  Plane<float> shown(96, 72);
  for (std::size_t i = 0; i < shown.size(); ++i) shown[i] = open.valid[i];
  const Plane<float> truth = at("truth.exr", "ao.Y");
  const double before = rms(at("auto.exr", "ao.Y"), truth, shown, 1),
               after = rms(at("out.exr", "ao.Y"), truth, shown, 1);
  RecordProperty("rms", fmt::format("{:.4f} of {:.4f}", after, before));
  EXPECT_GT(before, 0.05);
  EXPECT_LT(after, 0.1 * before) << before;
  EXPECT_LT(rms(at("any.exr", "ao.Y"), truth, shown, 1), 0.1 * before);
}

/// Nor one that only another view shows.
TEST_F(Objects, ADomeOfAnotherViewHidesNoLight) {
  const Surface stage = cut(plane({0, 0, 0}, {0, 0, 1}),
                            [](const glm::dvec3&p) { return glm::length(p) < 20; }),
                ball = sphere({0.1, 0.6, 0.5}, 0.5);
  const Camera lens = camera_from_fov(50, kWindow, 1),
               down = look_at(lens, {0.3, -2, 5}, {0, 0.5, 0}, {0, 0, 1}),
               level = look_at(camera_from_fov(120, kWindow, 1), {0.3, -4, 2.2}, {0, 0.5, 4},
                               {0, 0, 1});
  const auto write = [&](const std::string& name, const Camera& by, const Surface& shown) {
    FramePart part = frame_of(take_picture(shown, by, kWindow));
    part.data = part.display = kWindow;
    write_frame(path(name), part);
  };
  write("in.exr", down, all_of({stage, ball}));
  write("open.exr", level, all_of({stage, ball}));
  write("dome.exr", level, all_of({stage, ball, dome({0, 0, 0}, 500)}));
  run(path("in.exr"), "truth.exr", {"--also", path("open.exr")});
  run(path("in.exr"), "auto.exr", {"--also", path("dome.exr")});
  run(path("in.exr"), "cast.exr", {"--also", path("dome.exr"), "--backdrop", "cast"});
  const Plane<float> all(96, 72, 1.0f), truth = at("truth.exr", "ao.Y");
  EXPECT_LT(rms(at("auto.exr", "ao.Y"), truth, all, 1), 0.01);
  EXPECT_GT(rms(at("cast.exr", "ao.Y"), truth, all, 1), 0.05);
}

TEST_F(Objects, RefuseInOneLine) {
  const auto expect = [](const Finished& done, int code, const std::string& says) {
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_THAT(done.error_line(), HasSubstr(says));
  };
  expect(refused({"--only", "crypto:bal"}), 4, "did you mean ball");
  expect(refused({"--only", "crypto:"}), 2, "expected crypto:NAME");
  expect(refused({"--holdout", "IndexOB=1"}), 4, "no layer 'IndexOB=1'");
  expect(refused({"--no-cast", "crypto:ball.001", "--method", "gtao"}), 2, "take bitmask or trace");
  expect(refused({"--products", "shadow_of"}), 2, "say which with --shadow-of SEL");
  expect(refused({"--no-cast", path("no.exr") + ":A"}), 4, "no layer");
  expect(refused({"--shadow-of", "crypto:ball.001", "--products", "shadow_of", "--temporal"}), 2,
         "--temporal");
}

/// Masks are read band by band.
TEST_F(Objects, MasksAreTheSameInBands) {
  constexpr Window kTall{0, 0, 320, 1600};
  FramePart part = frame_of(small_picture(kTall, kTall));
  part.data = part.display = kTall;
  Plane<float> matte(320, 1600);
  for (int y = 0; y < 1600; ++y)
    for (int x = 0; x < 320; ++x) matte(x, y) = float((x + y) % 100) / 99;
  part.channels["soft.A"] = matte;
  part.add("beauty", Plane<glm::vec3>(320, 1600, glm::vec3(0.5f, 0.4f, 0.3f)), "RGB");
  write_frame(path("in.exr"), part);
  const nlohmann::json info = parse_json(run_tool({"info", path("in.exr"), "--json"}).out);
  std::ofstream(path("camera.json")) << info["camera"].dump();
  const Words flags = {
      "--camera", path("camera.json"), "--thickness",    "0.3", "--radius", "0.3", "--only",
      "soft",     "--holdout",         "soft - beauty.R"};
  run(path("in.exr"), "whole.exr", flags);
  run(path("in.exr"), "bands.exr", flags + Words{"--mem-limit", "124M"});
  for (const std::string& name : channel_names(path("whole.exr")))
    EXPECT_EQ(at("whole.exr", name).pixels, at("bands.exr", name).pixels) << name;
}

/// Writes a frame of 320 x 1600 pixels: a ball on a floor, and a stone beside it. Gives the matte
/// of the ball, the layer "ball"; that of the other is "stone".
Plane<float> write_tall_frame(const std::string& file, double radius) {
  constexpr Window kTall{0, 0, 320, 1600};
  const Camera by = look_at(camera_from_fov(40, kTall, 1), {0, -4, 3}, {0, 0, 0.3}, {0, 0, 1});
  const Surface floor = plane({}, {0, 0, 1}), ball = sphere({0.2, 0, radius}, radius),
                stone = sphere({0 - radius, 0, 0.2}, 0.2);
  const Picture shown = take_picture(all_of({floor, ball, stone}), by, kTall);
  FramePart part = frame_of(shown);
  part.data = part.display = kTall;
  Plane<float> matte(320, 1600, 0.0f), of_stone = matte;
  for (std::size_t i = 0; i < shown.position.size(); ++i) {
    const glm::vec3& p = shown.position[i];
    const bool in_ball = glm::distance(p, glm::vec3(0.2, 0, radius)) < float(radius) + 1e-3f;
    if (p.z > 1e-4f) (in_ball ? matte : of_stone)[i] = 1;
  }
  part.channels["ball.A"] = matte, part.channels["stone.A"] = of_stone;
  write_frame(file, part);
  return matte;
}

/// What casts nothing is taken out of each band, within what marches in bands are off.
TEST_F(Objects, NoCastInBandsIsNearlyThatOfTheFrame) {
  const Plane<float> matte = write_tall_frame(path("in.exr"), 1.2);
  const Words flags = {"--thickness", "0.3", "--radius", "1", "--products", "ao,bounce"},
              out = flags + Words{"--no-cast", "ball"}, limit = {"--mem-limit", "124M"};
  run(path("in.exr"), "cast.exr", flags);
  run(path("in.exr"), "whole.exr", out);
  run(path("in.exr"), "bands.exr", out + limit);
  EXPECT_THAT(run_tool(Words{"info", path("in.exr")} + out + limit).out, HasSubstr(" bands of "));
  for (const std::string name : {"ao.Y", "bounce.G"}) {
    const Plane<float> whole = at("whole.exr", name), bands = at("bands.exr", name);
    const double off = std::max(rms(whole, bands, matte, 0), rms(whole, bands, matte, 1)),
                 effect = rms(whole, at("cast.exr", name), matte, 0);
    RecordProperty(name, fmt::format("{:.5f} {:.5f}", off, effect));
    EXPECT_LT(off, 0.05 * effect) << name;
  }
}

/// So is what throws the shadow of --shadow-of; and what the lamps name that does not block them.
TEST_F(Objects, ShadowOfInBandsIsNearlyThatOfTheFrame) {
  const Plane<float> matte = write_tall_frame(path("in.exr"), 0.6);
  const std::string lamp = "sphere position=-1.5,-1,3 radius=0.1 normalize=true intensity=60 ";
  const Words limit = {"--mem-limit", "180M"};
  for (const std::string radius : {"0.8", "inf"}) {
    const Words flags = {
        "--shadow-of", "ball", "--thickness", "0.3",       "--radius", radius,
        "--slices",    "1",    "--steps",     "8",         "--env",    "0.3",
        "--bounces",   "0",    "--products",  "shadow_of", "--light",  lamp + "cast=ball",
        "--no-cast",   "stone"};
    run(path("in.exr"), "whole.exr", flags);
    run(path("in.exr"), "bands.exr", flags + limit);
    EXPECT_THAT(run_tool(Words{"info", path("in.exr")} + flags + limit).out,
                HasSubstr(" bands of "));
    const Plane<float> whole = at("whole.exr", "shadow_of.G"),
                       bands = at("bands.exr", "shadow_of.G"), none(320, 1600, 1.0f);
    const double off = rms(whole, bands, matte, 0), effect = rms(whole, none, matte, 0);
    RecordProperty("radius " + radius, fmt::format("{:.5f} {:.5f}", off, effect));
    EXPECT_GT(effect, 0.02) << radius;
    EXPECT_LT(off, 0.05 * effect) << radius;
  }
}

TEST_F(Objects, ADomeHidesNoLightInBands) {
  constexpr Window kTall{0, 0, 320, 1600};
  const Camera by = look_at(camera_from_fov(20, kTall, 1), {0.3, -4, 2.2}, {0, 0.5, 2}, {0, 0, 1});
  const Surface stage = cut(plane({0, 0, 0}, {0, 0, 1}),
                            [](const glm::dvec3&p) { return glm::length(p) < 20; }),
                ball = sphere({0.1, 0.6, 0.5}, 0.5);
  const auto write = [&](const std::string& name, const std::vector<Surface>& shown) {
    FramePart part = frame_of(take_picture(all_of(shown), by, kTall));
    part.data = part.display = kTall;
    write_frame(path(name), part);
  };
  write("open.exr", {stage, ball}), write("dome.exr", {stage, ball, dome({0, 0, 0}, 500)});
  const Words flags = {"--thickness", "0.3", "--products", "ao", "--mem-limit", "124M"};
  run(path("open.exr"), "truth.exr", flags);
  run(path("dome.exr"), "auto.exr", flags);
  run(path("dome.exr"), "cast.exr", flags + Words{"--backdrop", "cast"});
  const Picture open = take_picture(all_of({stage, ball}), by, kTall);
  Plane<float> shown(320, 1600);
  for (std::size_t i = 0; i < shown.size(); ++i) shown[i] = open.valid[i];
  const Plane<float> truth = at("truth.exr", "ao.Y");
  const double effect = rms(at("cast.exr", "ao.Y"), truth, shown, 1);
  EXPECT_GT(effect, 0.05);
  // Other bands fit into the memory where something casts nothing.
  EXPECT_LT(rms(at("auto.exr", "ao.Y"), truth, shown, 1), 0.05 * effect);
}

}  // namespace
}  // namespace ssdo::test::objects_test
