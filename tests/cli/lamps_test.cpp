// SPDX-License-Identifier: Apache-2.0
//
// Lamps by the tool in every kind of frame and with every option that makes light in another way:
// stereo, orthographic cameras, other views, sequences, errors, mirrors, other primaries. What a
// lamp gives to the open floor is known: I cos / d^2 of a small one.
#include <ImfStandardAttributes.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/pictures/primaries.h"
#include "scene/light/lamps/blackbody.h"
#include "support/analytic_scene.h"
#include "support/frame_file.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::lamps_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const Window kWindow{0, 0, 96, 64};

/// A point that gives 3 / d^2 to a surface which faces it.
const glm::dvec3 kLamp(-1.5, -0.5, 2);
const Words kKey = {"--light",
                    "sphere name=key position=-1.5,-0.5,2 radius=0 normalize=true intensity=12",
                    "--env", "0,0,0"};

Surface floor_and_ball() { return all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.5}, 0.5)}); }

Camera camera_at(double x, bool orthographic = false) {
  const Camera lens =
      orthographic ? camera_from_ortho_width(4, kWindow, 1) : camera_from_fov(45, kWindow, 1);
  Camera camera = look_at(lens, {0.5, -5, 3}, {0, 0, 0.3}, {0, 0, 1});
  camera.origin.x += x;
  return camera;
}

class LampsByTheTool : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_ / name; }

  /// Writes the frame of a camera, and keeps where it sees what.
  void write(const std::string& name, const Camera& camera) {
    picture_ = take_picture(floor_and_ball(), camera, kWindow);
    write_frame(path(name), frame_of(picture_));
  }

  Finished run(const std::string& in, const std::string& out, const Words& flags) const {
    return run_tool(Words{path(in), "-o", path(out), "--overwrite", "--pixel-type", "float"} +
                    flags);
  }
  Plane<float> made(const std::string& in, const Words& flags, const std::string& name) const {
    const Finished done = run(in, "out.exr", flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return channel(path("out.exr"), name);
  }

  bool is_floor(std::size_t i) const { return picture_.valid[i] && picture_.normal[i].z > 0.999f; }
  double unshadowed(std::size_t i) const {
    const glm::dvec3 way = kLamp - glm::dvec3(picture_.position[i]);
    return 3 / std::numbers::pi * way.z / std::pow(glm::length(way), 3);
  }
  /// Whether the ball is between the lamp and a place on the floor, which rays pass by a margin.
  int in_shadow(std::size_t i) const {
    const glm::dvec3 at(picture_.position[i]), way = glm::normalize(kLamp - at), middle(0, 0, 0.5);
    const double along = glm::dot(middle - at, way),
                 aside = glm::distance(middle, at + along * way);
    return aside < 0.4 ? 1 : aside > 0.6 ? 0 : -1;
  }
  /// Expects the light of the lamp on the open floor and none in the shadow of the ball.
  void expect_light(const Plane<float>& direct, double within) const {
    int open = 0, dark = 0, wrong = 0;
    for (std::size_t i = 0; i < direct.size(); ++i) {
      if (!is_floor(i) || in_shadow(i) < 0) continue;
      const bool shadowed = in_shadow(i) == 1;
      (shadowed ? dark : open) += 1;
      const double should = shadowed ? 0 : unshadowed(i);
      wrong += std::abs(double(direct[i]) - should) > within * unshadowed(i);
    }
    EXPECT_GT(open, 1000);
    EXPECT_GT(dark, 40);
    EXPECT_LT(wrong, 0.02 * (open + dark));
  }

  TempDir dir_;
  Picture picture_;
};

TEST_F(LampsByTheTool, LightFloorsUnderPerspectiveAndOrthographicCameras) {
  for (const bool orthographic : {false, true}) {
    SCOPED_TRACE(orthographic);
    write("in.exr", camera_at(0, orthographic));
    expect_light(made("in.exr", kKey + Words{"--products", "direct"}, "direct.G"), 0.03);
  }
}

TEST_F(LampsByTheTool, LightBothEyesOfAStereoFile) {
  FramePart both;
  for (const std::string view : {"left", "right"}) {
    write(view + ".exr", camera_at(view == "left" ? -0.1 : 0.1));
    const FramePart frame = frame_of(picture_, "");
    if (both.channels.empty()) both = frame, both.channels.clear();
    for (const auto& [name, plane] : frame.channels) both.channels[view + "." + name] = plane;
  }
  write_frame(path("both.exr"), both);
  const Words flags = kKey + Words{"--products", "direct", "--per-light"};
  const Plane<float> right =
                         made("both.exr", flags + Words{"--stereo", "all"}, "right.direct.key.G"),
                     left = channel(path("out.exr"), "left.direct.key.G");
  expect_light(right, 0.03);
  write("left.exr", camera_at(-0.1));
  expect_light(left, 0.03);
}

TEST_F(LampsByTheTool, AreHiddenByWhatOnlyOtherViewsShow) {
  // The picture ends to the right of the ball, whose shadow falls into it.
  const Surface things = all_of({floor_and_ball(), sphere({1.4, 0.7, 0}, 0.1)});
  const Picture near = take_picture(
      things, look_at(camera_from_fov(8, kWindow, 1), {3, -5, 3}, {1, 0.3, 0}, {0, 0, 1}), kWindow);
  write_frame(path("in.exr"), frame_of(near));
  const Words flags = kKey + Words{"--products", "direct", "--offscreen", "open"};
  const Plane<float> alone = made("in.exr", flags, "direct.G");
  write_frame(path("also.exr"), frame_of(take_picture(things, camera_at(0), kWindow)));
  const Plane<float> known = made("in.exr", flags + Words{"--also", path("also.exr")}, "direct.G");
  picture_ = near;
  int dark = 0, lit_alone = 0, dark_with = 0;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!is_floor(i) || in_shadow(i) != 1) continue;
    ++dark, lit_alone += double(alone[i]) > 0.9 * unshadowed(i);
    dark_with += double(known[i]) < 0.1 * unshadowed(i);
  }
  EXPECT_GT(dark, 500);
  EXPECT_GT(lit_alone, 0.9 * dark) << "the picture does not show the ball";
  EXPECT_GT(dark_with, 0.6 * dark) << "the pixels of the other view are as large as ten of these";
}

TEST_F(LampsByTheTool, KeepTheirLightInASequence) {
  for (int frame = 1; frame <= 3; ++frame)
    write(fmt::format("in.{}.exr", frame), camera_at(0.02 * frame));
  const Finished done = run_tool(Words{path("in.@.exr"), "-o", path("out.@.exr"), "--frames", "1-3",
                                       "--temporal", "--per-light", "--products", "direct",
                                       "--pixel-type", "float", kKey[0], kKey[1], "--env", "0.2"});
  ASSERT_EQ(done.code, 0) << done.err;
  expect_light(channel(path("out.3.exr"), "direct.key.G"), 0.05);
  const Plane<float> all = channel(path("out.3.exr"), "direct.G"),
                     key = channel(path("out.3.exr"), "direct.key.G"),
                     env = channel(path("out.3.exr"), "direct.env.G");
  for (std::size_t i = 0; i < all.size(); ++i)
    ASSERT_NEAR(key[i] + env[i], all[i], 1e-3f * all[i] + 1e-6f);
}

TEST_F(LampsByTheTool, CountInTheError) {
  write("in.exr", camera_at(0));
  const Words lamp = {"--light",   "sphere name=key position=-1.5,-0.5,2 radius=0.4 intensity=10",
                      "--env",     "0,0,0",
                      "--bounces", "0"};
  const Plane<float> error = made("in.exr", lamp + Words{"--products", "direct,error"}, "error.Y");
  const Plane<float> direct = channel(path("out.exr"), "direct.G"),
                     exact = made("in.exr", lamp + Words{"--products", "direct", "--slices", "32"},
                                  "direct.G");
  double said = 0, is = 0, open = 0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    if (!picture_.valid[i]) continue;
    said += std::pow(double(error[i]), 2);
    is += std::pow(double(direct[i]) - double(exact[i]), 2);
    open = std::max(open, double(exact[i]));
  }
  EXPECT_GT(is, 0);
  EXPECT_LT(std::sqrt(is), 3 * std::sqrt(said)) << "more than it says";
  EXPECT_GT(std::sqrt(is), std::sqrt(said) / 6) << "less than it says";
}

TEST_F(LampsByTheTool, ShowInMirrorsUnlessSomethingIsInBetween) {
  // The lamp is in the picture, above the floor that mirrors it.
  const glm::dvec3 lamp(0.8, 1, 0.8);
  write("in.exr", camera_at(0));
  const Words flags = {"--light",    "sphere name=key position=0.8,1,0.8 radius=0.1 intensity=10",
                       "--env",      "0,0,0",
                       "--products", "specular",
                       "--set",      "roughness=0.1",
                       "--set",      "ior=1e6"};
  const Plane<float> found = made("in.exr", flags, "specular.G");
  const auto brightest = std::size_t(std::ranges::max_element(found.pixels) - found.pixels.begin());
  ASSERT_TRUE(is_floor(brightest));
  const glm::dvec3 at(picture_.position[brightest]),
      viewer = glm::normalize(picture_.camera.origin - at), to = glm::normalize(lamp - at);
  EXPECT_GT(glm::dot(glm::normalize(viewer + to), glm::dvec3(0, 0, 1)), std::cos(0.04));
  EXPECT_GT(found[brightest], 5);

  // Behind the ball, whose shadow the place where the floor would mirror it lies in.
  Words hidden = flags;
  hidden[1] = "sphere name=key position=-0.1,1.3,1 radius=0.1 intensity=10";
  const Plane<float> shadowed = made("in.exr", hidden, "specular.G");
  const glm::dvec3 image(-0.1, 1.3, -1);  // mirrored by the floor
  double most = 0;
  for (std::size_t i = 0; i < shadowed.size(); ++i) {
    if (!is_floor(i)) continue;
    const glm::dvec3 place(picture_.position[i]);
    const glm::dvec3 way = glm::normalize(image - picture_.camera.origin);
    if (glm::distance(glm::normalize(place - picture_.camera.origin), way) < 0.1)
      most = std::max(most, double(shadowed[i]));
  }
  EXPECT_LT(most, 0.1);
}

TEST_F(LampsByTheTool, AreWarnedOfWhereSurfacesBlockAllTheirLight) {
  write("in.exr", camera_at(0));
  const auto warning = [&](const std::string& place) {
    const Finished done = run("in.exr", "out.exr",
                              {"--light", "sphere name=lost radius=0.05 position=" + place,
                               "--products", "direct", "--env", "0.1"});
    EXPECT_EQ(done.code, 0) << done.err;
    return done.err;
  };
  for (const std::string place : {"0,0,-5", "0.3,0.2,-0.3", "-2,1,-1", "0,0,0.5", "0,0.1,0.4"})
    EXPECT_THAT(warning(place), AllOf(HasSubstr("--light lost: position: "),
                                      testing::AnyOf(HasSubstr("block"), HasSubstr("lights no"))))
        << place;
  for (const std::string place : {"0,0,2", "0.8,0.8,0.3", "0,0.8,0.2", "0,-9,3"})
    EXPECT_THAT(warning(place), Not(HasSubstr("--light lost"))) << place;
  // A thing that fills little of the frame is lit all the same; trace knows no weights.
  write_frame(path("small.exr"),
              frame_of(take_picture(sphere({0, 0, 0.5}, 0.2), camera_at(0), kWindow)));
  const Finished done = run("small.exr", "out.exr",
                            {"--light", "sphere name=lost radius=0.05 position=0.5,-5,3",
                             "--products", "direct", "--method", "trace"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, Not(HasSubstr("--light lost")));
}

TEST_F(LampsByTheTool, OfARealFrameUnderTheGroundAreWarnedOf) {
  // A box with a floor, with things in it: their undersides face a lamp under the floor.
  const std::string frame = std::string(SSDO_SOURCE_DIR) + "/data/truth/corner/gbuffer.exr";
  const auto run_with = [&](const std::string& place) {
    return run_tool({frame, "-o", path("out.exr"), "--overwrite", "--products", "direct", "--light",
                     "sphere name=lost radius=0.1 intensity=100 position=" + place});
  };
  EXPECT_THAT(run_with("0,0,-5").err, HasSubstr("--light lost: position: "));
  EXPECT_THAT(run_with("0,-0.5,2").err, Not(HasSubstr("--light lost")));
}

TEST_F(LampsByTheTool, HaveTheColourOfTheirTemperatureInThePrimariesOfTheFrame) {
  const Imf::Chromaticities ap1{
      {0.713f, 0.293f}, {0.165f, 0.830f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}};
  write("in.exr", camera_at(0));
  FramePart part = frame_of(picture_);
  Imf::addChromaticities(part.extra, ap1);
  write_frame(path("ap1.exr"), part);
  const Words flags = {"--light",    "sphere position=0,-1,3 color_temperature=2500",
                       "--env",      "0,0,0",
                       "--products", "direct"};
  const glm::vec3 rec709(blackbody_color(2500));
  const auto matrix = conversion_of_primaries(
      kRec709, {0.713f, 0.293f, 0.165f, 0.830f, 0.128f, 0.044f, 0.32168f, 0.33767f});
  ASSERT_TRUE(matrix);
  for (const auto& [file, should] :
       {std::pair("in.exr", rec709), std::pair("ap1.exr", *matrix * rec709)}) {
    const Plane<float> red = made(file, flags, "direct.R"),
                       green = channel(path("out.exr"), "direct.G"),
                       blue = channel(path("out.exr"), "direct.B");
    for (std::size_t i = 0; i < red.size(); i += 91) {
      if (!is_floor(i) || green[i] < 0.01f) continue;
      EXPECT_NEAR(red[i] / green[i], should.x / should.y, 1e-3) << file;
      EXPECT_NEAR(blue[i] / green[i], should.z / should.y, 1e-3) << file;
    }
  }
  // A colour that the user gives is in the primaries of the frame as it is.
  const Plane<float> red = made("ap1.exr",
                                {"--light", "sphere position=0,-1,3 color=1,0.5,0.25", "--env",
                                 "0,0,0", "--products", "direct"},
                                "direct.R"),
                     blue = channel(path("out.exr"), "direct.B");
  for (std::size_t i = 0; i < red.size(); i += 91) ASSERT_NEAR(blue[i], red[i] / 4, 1e-4f);
}

}  // namespace
}  // namespace ssdo::test::lamps_test
