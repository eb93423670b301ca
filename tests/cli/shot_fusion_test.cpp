// SPDX-License-Identifier: Apache-2.0
//
// Frames that share what they find, by the tool on made shots: that they are nearer to rays through
// the very scene and steadier, that the same bits come however the shot is cut, and that nothing of
// other times is left.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "estimators/bitmask/request.h"
#include "support/boxes.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::shot_fusion_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const Window kFrame{0, 0, 96, 72};
constexpr int kFrames = 9;

/// Boxes in a row on a floor before a wall.
Surface boxes() {
  std::vector<Surface> things = {plane({}, {0, 0, 1}), plane({0, 1.2, 0}, {0, -1, 0})};
  for (const double x : {-1.1, 0.0, 1.1})
    things.push_back(Box{{x - 0.3, -0.4, 0}, {x + 0.3, 0, 0.9}}.surface());
  return all_of(things);
}

Camera passing(int frame) {
  const double x = 0.12 * (frame - 5);
  return look_at(camera_from_fov(45, kFrame, 1), {x, -4, 1.3}, {0.2 * x, 0, 0.3}, {0, 0, 1});
}

class AShot : public testing::Test {
 protected:
  fs::path file(int frame, const std::string& name = "in") const {
    return folder / fmt::format("{}.{:04}.exr", name, frame);
  }
  void write(int frame, const FramePart& part) const { write_frame(file(frame), part); }
  void write(int frame, const Surface& scene, const Camera& camera) const {
    write(frame, frame_of(take_picture(scene, camera, kFrame)));
  }
  void write_shot() const {
    for (int frame = 1; frame <= kFrames; ++frame) write(frame, boxes(), passing(frame));
  }
  Finished run(const Words& more, const std::string& name = "out") const {
    return run_tool(Words{folder / "in.####.exr", "-o", folder / (name + ".####.exr"),
                          "--overwrite", "--pixel-type", "float"} +
                    more);
  }
  Plane<float> found(int frame, const std::string& layer = "ao.Y",
                     const std::string& name = "out") const {
    return channel(file(frame, name), layer);
  }

  TempDir folder;
};

TEST_F(AShot, HasTheSameBitsHoweverItIsCut) {
  write_shot();
  const Words all = {"--shot",     "2",
                     "--products", "ao,bent,direct,bounce,shadow,guessed",
                     "--light",    "distant direction=0.3,0.4,-1 angle=2"};
  ASSERT_EQ(run(all, "whole").code, 0);
  const std::vector<Words> cuts = {{"--frames", "4"},
                                   {"--frames", "3-5", "--threads", "1"},
                                   {"--frames", "9,8,7,6,5,4,3,2,1"},
                                   {"--frames", "2-8x2", "--threads", "3"}};
  for (const Words& cut : cuts) {
    ASSERT_EQ(run(all + cut, "cut").code, 0);
    for (const std::string& layer : channel_names(file(4, "whole")))
      EXPECT_EQ(found(4, layer, "cut").pixels, found(4, layer, "whole").pixels)
          << layer << " " << cut[1];
    for (int frame = 1; frame <= kFrames; ++frame) fs::remove(file(frame, "cut"));
  }
}

/// Frames whose outputs exist are not made again, and tell the others the same.
TEST_F(AShot, GoesOnWhereItStopped) {
  write_shot();
  const Words shot = {"--shot", "2", "--products", "ao", "--frames", "2-8"};
  ASSERT_EQ(run(shot).code, 0);
  const Plane<float> whole = found(5);
  fs::remove(file(5, "out"));
  const Finished again = run(shot + Words{"--skip-existing", "-v"});
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.err, AllOf(HasSubstr("in.0004.exr: skipped"), HasSubstr("in.0002.exr: skipped"),
                               Not(HasSubstr("in.0005.exr: skipped"))));
  EXPECT_EQ(found(5).pixels, whole.pixels);
  EXPECT_FALSE(fs::exists(file(1, "out")));
}

/// What does not fit into memory waits in the folder for temporary files.
TEST_F(AShot, HasTheSameBitsFromDisk) {
  write_shot();
  const Words all = {"--shot",     "2",
                     "--quality",  "draft",
                     "--env",      "0.5,0.6,0.8",
                     "--light",    "distant direction=0.3,0.4,-1 angle=2",
                     "--products", "ao,bent,direct,bounce,shadow,guessed,reflection"};
  const std::string nowhere = folder / "nowhere";
  const auto with = [&](const Words& more, const std::string& name, const std::string& temporary) {
    return run_tool(Words{folder / "in.####.exr", "-o", folder / (name + ".####.exr"),
                          "--overwrite", "--pixel-type", "float"} +
                        all + more,
                    {.variables = {{"TMPDIR", temporary}}});
  };
  EXPECT_EQ(with({}, "whole", nowhere).code, 0) << "all fits into memory";
  const Words little = {"--mem-limit", "175.7M", "--threads", "2"};
  ASSERT_EQ(with(little, "little", folder.path()).code, 0);
  for (int frame = 1; frame <= kFrames; ++frame)
    for (const std::string& layer : channel_names(file(frame, "whole")))
      EXPECT_EQ(found(frame, layer, "little").pixels, found(frame, layer, "whole").pixels)
          << layer << " " << frame;
  const Finished full = with(little, "none", nowhere);
  EXPECT_EQ(full.code, 1);
  EXPECT_THAT(full.error_line(), AllOf(HasSubstr(nowhere + ": cannot keep"),
                                       HasSubstr("set TMPDIR"), HasSubstr("--mem-limit")));
  EXPECT_EQ(listing(folder.path()).size(), 3u * kFrames) << "nothing is left behind";
  const Words info = {"info", folder / "in.####.exr", "--shot", "2", "--json"};
  EXPECT_EQ(run_tool(info + Words{"--mem-limit", "175.7M"}).out, run_tool(info).out);
}

/// A frame that does not fit by itself is refused, as it is in bands.
TEST_F(AShot, IsRefusedForFramesLargerThanMemory) {
  write_shot();
  const Finished done = run({"--shot", "2", "--mem-limit", "150M", "--threads", "2"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.error_line(), AllOf(HasSubstr("in.0001.exr: 96 x 72 pixels take"),
                                       HasSubstr("--shot needs all of the frame at once"),
                                       HasSubstr("raise --mem-limit")));
}

/// 17 frames of a camera at rest, one of which is made.
TEST_F(AShot, TakesNoMoreMemoryThanItMay) {
  const Window window{0, 0, 384, 216};
  const Camera camera =
      look_at(camera_from_fov(45, window, 1), {0.5, -4, 1.3}, {0, 0, 0.3}, {0, 0, 1});
  write_frame(file(1),
              frame_of(take_picture(all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.4}, 0.4)}),
                                    camera, window)));
  for (int frame = 2; frame <= 17; ++frame) fs::create_hard_link(file(1), file(frame));
  const Words one = {"--shot",     "8",
                     "--frames",   "9",
                     "--quality",  "draft",
                     "--products", "ao,bent,direct",
                     "--light",    "distant direction=0.3,0.4,-1",
                     "--light",    "distant direction=-0.3,0.1,-1",
                     "--threads",  "2"};
  const auto peak = [&](const Words& more, const std::string& name) {
    const Finished done = run(one + more, name);
    EXPECT_EQ(done.code, 0) << done.err;
    return double(done.used.ru_maxrss) * 1024;
  };
  const double much = peak({"--mem-limit", "4G"}, "much"),
               little = peak({"--mem-limit", "227M"}, "little");
  fmt::print("at most {:.0f} MB, {:.0f} MB with --mem-limit 227M\n", much / 1e6, little / 1e6);
  EXPECT_LT(little, 227 << 20);
  EXPECT_GT(much, little + 0.5 * 17 * 48 * double(window.area())) << "kept surfaces and values";
  EXPECT_EQ(found(9, "ao.Y", "little").pixels, found(9, "ao.Y", "much").pixels);
  EXPECT_EQ(found(9, "direct.R", "little").pixels, found(9, "direct.R", "much").pixels);
  const std::string refusal = run(one + Words{"--mem-limit", "215M"}, "less").error_line();
  double takes = 0, may_take = 0;
  ASSERT_NE(refusal.find(" take "), std::string::npos) << refusal;
  std::sscanf(refusal.c_str() + refusal.find(" take "), " take %lf GB of memory, and may take %lf",
              &takes, &may_take);
  EXPECT_GT(takes, may_take) << refusal;
}

/// The same point of the same surface has the same light from frame to frame.
TEST_F(AShot, IsSteadierAndNearerToRays) {
  write_shot();
  const auto measure = [&](const Words& more) {
    EXPECT_EQ(run(Words{"--products", "ao", "--radius", "inf"} + more).code, 0);
    double change = 0, error = 0;
    int changes = 0, errors = 0;
    for (int frame = 3; frame <= 7; ++frame) {
      const Plane<float> here = found(frame), next = found(frame + 1);
      for (int y = 1; y < kFrame.height(); y += 3) {
        for (int x = 1; x < kFrame.width(); x += 3) {
          const Point p = point_at(boxes(), passing(frame), kFrame, x, y);
          if (frame == 5) {
            const double rays = ao_by_rays(boxes(), p, kNoLimit, 128);
            error += std::pow(double(here(x, y)) - rays, 2), ++errors;
          }
          const Camera camera = passing(frame + 1);
          const glm::dvec2 at = camera.project(camera.to_camera(p.position));
          const int u = int(std::floor(at.x)), v = int(std::floor(at.y));
          if (u < 0 || v < 0 || u >= kFrame.width() || v >= kFrame.height()) continue;
          const Point q = point_at(boxes(), camera, kFrame, u, v);
          if (glm::distance(p.position, q.position) > 0.05 || glm::dot(p.normal, q.normal) < 0.99)
            continue;
          change += std::pow(double(next(u, v)) - double(here(x, y)), 2), ++changes;
        }
      }
    }
    return std::pair(std::sqrt(change / changes), std::sqrt(error / errors));
  };
  const auto [flicker_alone, error_alone] = measure({});
  const auto [flicker, error] = measure({"--shot", "4"});
  fmt::print("change per frame {:.4f} alone, {:.4f} in the shot; RMSE {:.4f}, {:.4f}\n",
             flicker_alone, flicker, error_alone, error);
  EXPECT_LT(flicker, 0.5 * flicker_alone);
  EXPECT_LT(error, error_alone);
}

/// Under a ball that flies over a floor, its shadow is where it is now: what it has left is lit.
TEST_F(AShot, AMovingBallDragsNoShadow) {
  for (const double step : {0.22, 0.07}) {
    const auto with_ball = [=](int frame) {
      return all_of({plane({}, {0, 0, 1}), Box{{1, 0.4, 0}, {1.3, 0.8, 0.5}}.surface(),
                     sphere({step * (frame - 5), 0, 0.5}, 0.22)});
    };
    for (int frame = 1; frame <= kFrames; ++frame) write(frame, with_ball(frame), passing(5));
    const Words light = {"--products", "shadow", "--light",
                         "distant direction=0.35,0.2,-1 angle=1"};
    ASSERT_EQ(run(light + Words{"--shot", "4"}).code, 0);
    ASSERT_EQ(run(light, "alone").code, 0);
    const glm::dvec3 to = glm::normalize(glm::dvec3(-0.35, -0.2, 1));
    const auto is_lit = [&](const Point& p, int frame) {
      return !with_ball(frame)({p.position + 1e-6 * p.normal, to});
    };
    const Picture picture = take_picture(with_ball(5), passing(5), kFrame);
    double trail = 0, trail_alone = 0, front = 0, front_alone = 0, error = 0, alone = 0;
    int trails = 0, fronts = 0, all = 0;
    const Plane<float> shadow = found(5, "shadow.R"), single = found(5, "shadow.R", "alone");
    for (int y = 0; y < kFrame.height(); ++y) {
      for (int x = 0; x < kFrame.width(); ++x) {
        if (!picture.valid(x, y)) continue;
        const Point p = point_at(with_ball(5), passing(5), kFrame, x, y);
        if (p.position.z > 1e-6) continue;
        const bool lit = is_lit(p, 5), was = is_lit(p, 4);
        error += std::abs(shadow(x, y) - float(lit)), alone += std::abs(single(x, y) - float(lit));
        ++all;
        if (lit && !was) trail += shadow(x, y), trail_alone += single(x, y), ++trails;
        if (lit || !was) continue;
        front += shadow(x, y), front_alone += single(x, y);
        ++fronts;
      }
    }
    ASSERT_GT(trails, 3);
    ASSERT_GT(fronts, 3);
    fmt::print(
        "lit where the shadow was {:.3f} (alone {:.3f}), in the shadow {:.3f} (alone {:.3f}); mean "
        "error {:.4f}, "
        "alone {:.4f}\n",
        trail / trails, trail_alone / trails, front / fronts, front_alone / fronts, error / all,
        alone / all);
    EXPECT_GT(trail / trails, trail_alone / trails - 0.03);
    EXPECT_LT(front / fronts, front_alone / fronts + 0.03);
    EXPECT_LT(error, 1.05 * alone);
  }
}

/// A lamp in the picture is switched on: before, its light is nowhere.
TEST_F(AShot, ALampThatIsSwitchedOnIsNotDraggedAlong) {
  const Surface room = all_of({plane({}, {0, 0, 1}), plane({0, 1.2, 0}, {0, -1, 0}),
                               Box{{-0.3, -0.2, 0}, {0.3, 0.2, 0.5}}.surface()});
  const Picture picture = take_picture(room, passing(5), kFrame);
  for (int frame = 1; frame <= kFrames; ++frame) {
    FramePart part = frame_of(picture);
    Plane<float> glow(kFrame.width(), kFrame.height(), 0.0f);
    for (std::size_t i = 0; i < glow.size(); ++i) {
      const glm::vec3 p = picture.position[i];
      if (frame >= 6 && std::abs(p.x) < 0.301f && std::abs(p.y) < 0.201f && p.z > 0.01f)
        glow[i] = 5;
    }
    for (const char* c : {"R", "G", "B"}) {
      part.channels[std::string("glow.") + c] = glow;
      part.channels[std::string("albedo.") + c] = Plane<float>(96, 72, 0.5f);
    }
    write(frame, part);
  }
  ASSERT_EQ(
      run({"--aov", "radiance=glow", "--products", "bounce", "--env", "0", "--shot", "3"}).code, 0);
  const auto brightest = [&](int frame) {
    const Plane<float> found_there = found(frame, "bounce.R");
    return *std::ranges::max_element(found_there.pixels);
  };
  EXPECT_EQ(brightest(5), 0);
  EXPECT_GT(brightest(6), 0.3f);
  EXPECT_NEAR(brightest(6), brightest(9), 0.02f * brightest(9));
}

/// Light has any unit: half numbers, in which frames tell each other, have a range.
TEST_F(AShot, ScalesWithTheLight) {
  for (int frame = 1; frame <= 3; ++frame) {
    FramePart part = frame_of(take_picture(boxes(), passing(frame), kFrame));
    for (const char* c : {"R", "G", "B"})
      part.channels[std::string("albedo.") + c] = Plane<float>(96, 72, 0.5f);
    write(frame, part);
  }
  const Words bounce = {"--products", "bounce", "--frames", "2", "--shot", "1", "--env"};
  ASSERT_EQ(run(bounce + Words{"1"}).code, 0);
  const Plane<float> one = found(2, "bounce.R");
  for (const double scale : {0x1p-27, 0x1p27}) {
    ASSERT_EQ(run(bounce + Words{fmt::format("{}", scale)}).code, 0);
    const Plane<float> scaled = found(2, "bounce.R");
    for (std::size_t i = 0; i < one.size(); ++i)
      ASSERT_NEAR(double(scaled[i]) / scale, double(one[i]), 1e-3) << scale;
  }
}

/// Frames with a step between them come in their order, with their own lines.
TEST_F(AShot, WithAStepKeepsTheOrderOfFrames) {
  write_shot();
  const Words stepped = {"--shot", "1x3", "--products", "ao"};
  ASSERT_EQ(run(stepped + Words{"--stats", folder / "stats.json"}).code, 0);
  const nlohmann::json stats = parse_json(read_file(folder / "stats.json"));
  ASSERT_EQ(stats.size(), std::size_t(kFrames));
  for (int frame = 1; frame <= kFrames; ++frame)
    EXPECT_EQ(stats[std::size_t(frame - 1)]["frame"], frame);
  const Plane<float> whole = found(5);
  ASSERT_EQ(run(stepped + Words{"--frames", "5"}).code, 0);
  EXPECT_EQ(found(5).pixels, whole.pixels);
  ASSERT_EQ(run({"--shot", "1", "--products", "ao", "--frames", "5"}).code, 0);
  EXPECT_NE(found(5).pixels, whole.pixels);
}

TEST_F(AShot, DoesWithoutFramesThatCannotBeUsed) {
  write_shot();
  const Words middle = {"--frames", "5", "--shot", "2", "--products", "ao"};
  fs::remove(file(3));
  fs::remove(file(6));
  ASSERT_EQ(run(middle).code, 0);
  const Plane<float> with_two = found(5);
  // One that is cut short, one that holds no P.
  write(3, boxes(), passing(3));
  fs::resize_file(file(3), fs::file_size(file(3)) / 2);
  FramePart part = frame_of(take_picture(boxes(), passing(6), kFrame));
  for (const char* c : {"X", "Y", "Z"}) part.channels.erase(std::string("ViewLayer.Position.") + c);
  part.channels.erase("ViewLayer.Depth.Z");
  write(6, part);
  const Finished done = run(middle);
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, AllOf(HasSubstr("do without it: " + std::string(file(3)) + ": is damaged"),
                              HasSubstr("do without it: " + std::string(file(6)))));
  EXPECT_EQ(found(5).pixels, with_two.pixels);
  // A frame of another size after a cut shows none of the points.
  write_frame(file(6), frame_of(take_picture(all_of({plane({0, 0, 9}, {0, 0, 1})}),
                                             look_at(camera_from_fov(45, {0, 0, 64, 64}, 1),
                                                     {0, 0, 12}, {0, 0.1, 0}, {0, 0, 1}),
                                             {0, 0, 64, 64})));
  EXPECT_EQ(run(middle).code, 0);
  EXPECT_EQ(found(5).pixels, with_two.pixels);
}

TEST_F(AShot, WhatAFrameLacksIsTakenFromTheOthers) {
  write_shot();
  const Words middle = {"--frames", "5", "--shot", "2", "--products", "all"};
  ASSERT_EQ(run(middle).code, 0);
  ASSERT_EQ(run({"--frames", "5", "--shot", "1", "--products", "all"}, "near").code, 0);
  for (const int frame : {3, 7}) {  // no albedo: they make no bounce
    FramePart part = frame_of(take_picture(boxes(), passing(frame), kFrame));
    for (const char* c : {"R", "G", "B"})
      part.channels.erase(std::string("ViewLayer.DiffCol.") + c);
    write(frame, part);
  }
  ASSERT_EQ(run(middle, "lacks").code, 0);
  EXPECT_EQ(found(5, "ao.Y", "lacks").pixels, found(5, "ao.Y").pixels);
  EXPECT_EQ(found(5, "bent.X", "lacks").pixels, found(5, "bent.X").pixels);
  EXPECT_EQ(found(5, "direct.G", "lacks").pixels, found(5, "direct.G").pixels);
  EXPECT_EQ(found(5, "bounce.G", "lacks").pixels, found(5, "bounce.G", "near").pixels);
  EXPECT_NE(found(5, "bounce.G").pixels, found(5, "bounce.G", "near").pixels);
}

TEST_F(AShot, IsDescribedByInfo) {
  // A camera at rest, and a ball that comes from outside in the last of three frames.
  for (int frame = 1; frame <= 3; ++frame) {
    std::vector<Surface> things = {boxes()};
    if (frame == 3) things.push_back(sphere({0.5, -1.5, 0.4}, 0.4));
    write(frame, all_of(things), passing(5));
  }
  const auto shot_of = [&](const char* frames) {
    return parse_json(run_tool({"info", folder / "in.####.exr", "--json", "--shot", "1", "--frames",
                                frames})
                          .out)
        .at("shot");
  };
  const nlohmann::json still = shot_of("1"), before = shot_of("2"), ball = shot_of("3");
  EXPECT_EQ(still.at("frames"), 1);
  EXPECT_GE(still.at("shown"), 0.99);
  EXPECT_EQ(still.at("through"), 0);
  EXPECT_EQ(before.at("frames"), 2);
  EXPECT_GT(before.at("times"), 1.5);
  EXPECT_EQ(before.at("through"), 0);  // what the ball hides has not moved
  EXPECT_EQ(ball.at("frames"), 1);
  EXPECT_GT(ball.at("through"), 0.02);
  EXPECT_NEAR(double(ball.at("shown")) + double(ball.at("through")), 1, 0.05);
  EXPECT_THAT(run_tool({"info", folder / "in.####.exr", "--shot", "1"}).out,
              HasSubstr("in.0002.exr: 2 frames around it show "));
}

TEST_F(AShot, IsRefusedWithoutAWorldOrASequence) {
  Picture own = take_picture(boxes(), passing(3), kFrame);
  for (std::size_t i = 0; i < own.position.size(); ++i)
    if (own.valid[i])
      own.position[i] = glm::vec3(own.camera.to_camera(glm::dvec3(own.position[i])));
  own.camera = camera_from_fov(45, kFrame, 1);
  for (int frame = 1; frame <= 2; ++frame) write(frame, frame_of(own));
  const Finished no_world = run({"--frames", "1", "--shot", "1"});
  EXPECT_EQ(no_world.code, 4);
  EXPECT_THAT(no_world.error_line(), AllOf(HasSubstr("world space"), HasSubstr("--camera")));

  const Finished single = run_tool({file(1), "-o", folder / "out.exr", "--shot", "1"});
  EXPECT_EQ(single.code, 2);
  EXPECT_THAT(single.error_line(), HasSubstr("--shot needs a sequence"));
  EXPECT_EQ(run_tool({"bench", file(1), "--shot", "1"}).code, 2);
  EXPECT_EQ(run({"--shot", "1", "--temporal"}).code, 2);

  const Finished old = run({"--neighbours", "2"});
  EXPECT_EQ(old.code, 2);
  EXPECT_THAT(old.error_line(), HasSubstr("is now --shot"));

  const Finished onto_lent = run_tool(
      {folder / "in.####.exr", "-o", file(2), "--frames", "1", "--overwrite", "--shot", "1"});
  EXPECT_EQ(onto_lent.code, 5);
  EXPECT_THAT(onto_lent.error_line(), HasSubstr("is an input"));
}

}  // namespace
}  // namespace ssdo::test::shot_fusion_test
