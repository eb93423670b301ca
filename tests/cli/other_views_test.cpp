// SPDX-License-Identifier: Apache-2.0
//
// Other views of a scene, by the tool on real files: what they add, against rays through the very
// scene, and what they must not change.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "estimators/bitmask/request.h"
#include "support/boxes.h"
#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::other_views_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const Window kFrame{0, 0, 160, 120}, kView{0, 0, 96, 72}, kPanorama{0, 0, 192, 96};

Camera pinhole(const Window& window, double fov, const glm::dvec3& eye, const glm::dvec3& target) {
  return look_at(camera_from_fov(fov, window, 1), eye, target, {0, 0, 1});
}

Camera panorama(const glm::dvec3& eye, const glm::dvec3& target) {
  return look_at(lat_long(kPanorama), eye, target, {0, 0, 1});
}

/// P, N and albedo, and the planar depth of pinholes, by which they have a background.
FramePart part_of(const Surface& scene, const Camera& camera, const Window& window) {
  FramePart part = frame_of(take_picture(scene, camera, window));
  if (camera.panorama) part.channels.erase("ViewLayer.Depth.Z");
  return part;
}

/// Six walls without thickness: seen from both sides.
Surface closed_room() {
  const auto wall = [](const glm::dvec3& at, const glm::dvec3& normal) {
    return cut(plane(at, normal), [](const glm::dvec3& p) {
      return std::abs(p.x) < 3.001 && std::abs(p.y) < 3.001 && p.z > -0.001 && p.z < 3.001;
    });
  };
  return all_of({wall({0, 0, 0}, {0, 0, 1}), wall({0, 0, 3}, {0, 0, -1}),
                 wall({-3, 0, 0}, {1, 0, 0}), wall({3, 0, 0}, {-1, 0, 0}),
                 wall({0, -3, 0}, {0, 1, 0}), wall({0, 3, 0}, {0, -1, 0})});
}

class OtherViews : public testing::Test {
 protected:
  std::string write(const std::string& name, const Surface& scene, const Camera& camera,
                    const Window& window) {
    const auto path = folder.path() / name;
    write_frame(path, part_of(scene, camera, window));
    return path;
  }

  /// The ao of a run with these further files.
  Plane<float> ao(const std::string& frame, const std::vector<std::string>& also,
                  const std::vector<std::string>& more = {}) {
    const std::string out = folder.path() / "out.exr";
    std::vector<std::string> arguments = {
        frame, "-o",           out,     "--overwrite", "--products",
        "ao",  "--pixel-type", "float", "--quality",   "final"};
    for (const std::string& file : also) arguments.insert(arguments.end(), {"--also", file});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished run = run_tool(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return run.code == 0 ? channel(out, "ao.Y") : Plane<float>();
  }

  Finished fails(const std::string& frame, const std::string& also) {
    return run_tool({frame, "-o", folder.path() / "out.exr", "--overwrite", "--also", also});
  }

  TempDir folder;
};

/// RMSE of ao over every eighth pixel that `counts`, against rays.
template <class Counts>
double rmse(const Plane<float>& ao, const Surface& scene, const Camera& camera,
            const Counts& counts) {
  double sum = 0;
  int count = 0;
  for (int y = 12; y < kFrame.height() - 12; y += 8) {
    for (int x = 12; x < kFrame.width() - 12; x += 8) {
      const Point p = point_at(scene, camera, kFrame, x, y);
      if (!counts(p.position)) continue;
      sum += std::pow(double(ao(x, y)) - ao_by_rays(scene, p, kNoLimit, 2048), 2);
      ++count;
    }
  }
  EXPECT_GT(count, 20);
  return std::sqrt(sum / count);
}

TEST_F(OtherViews, ClosedRoomIsDarkWithAPanorama) {
  const glm::dvec3 eye(-0.5, -2, 1.4), target(0.3, 3, 1.2);
  const std::string frame =
                        write("frame.exr", closed_room(), pinhole(kFrame, 50, eye, target), kFrame),
                    around = write("around.exr", closed_room(), panorama(eye, target), kPanorama);
  const auto mean = [](const Plane<float>& ao) {
    double sum = 0;
    for (const float a : ao.pixels) sum += a;
    return sum / double(ao.size());
  };
  for (const char* method : {"bitmask", "trace"}) {
    EXPECT_GT(mean(ao(frame, {}, {"--method", method, "--offscreen", "open"})), 0.3) << method;
    EXPECT_LT(mean(ao(frame, {around}, {"--method", method})), 0.02) << method;
  }
}

/// A sky with a sun that stands high: it would light the floor of the room if nothing asked what is
/// behind the camera.
TEST_F(OtherViews, NoSunShinesIntoAClosedRoom) {
  const glm::dvec3 eye(-0.5, -2, 1.4), target(0.3, 3, 0.6);
  const std::string frame =
                        write("frame.exr", closed_room(), pinhole(kFrame, 50, eye, target), kFrame),
                    around = write("around.exr", closed_room(), panorama(eye, target), kPanorama),
                    out = folder.path() / "out.exr";
  for (const std::string method : {"bitmask", "trace"}) {
    const auto mean_direct = [&](const std::vector<std::string>& more) {
      std::vector<std::string> arguments = {
          frame,      "-o",       out,    "--overwrite", "--products",
          "direct",   "--method", method, "--env",       data("environments/sky.exr"),
          "--env-up", "z"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      EXPECT_EQ(run_tool(arguments).code, 0);
      double sum = 0;
      const Plane<float> direct = channel(out, "direct.R");
      for (const float d : direct.pixels) sum += double(d);
      return sum / double(direct.size());
    };
    EXPECT_GT(mean_direct({"--offscreen", "open"}), 0.2) << method;
    EXPECT_LT(mean_direct({"--also", around}), 0.02) << method;
  }
}

/// Views from outside show the other side of walls that stand behind the camera: they are lit
/// there, and dark inside.
TEST_F(OtherViews, WallsSeenFromOutsideSendNoLightInside) {
  const glm::dvec3 eye(-0.5, -2, 1.4), target(0.3, 3, 1.2);
  const Camera above = pinhole(kView, 50, {8, 9, 8}, {0, 0, 1.5}),
               below = pinhole(kView, 50, {-8, -9, -5}, {0, 0, 1.5});
  const std::string frame =
                        write("frame.exr", closed_room(), pinhole(kFrame, 50, eye, target), kFrame),
                    a = write("a.exr", closed_room(), above, kView),
                    b = write("b.exr", closed_room(), below, kView),
                    out = folder.path() / "out.exr";
  for (const std::string method : {"bitmask", "trace"}) {
    EXPECT_EQ(run_tool({frame, "-o", out, "--overwrite", "--products", "ao,bounce", "--method",
                        method, "--also", a, "--also", b})
                  .code,
              0);
    double ao = 0, bounce = 0;
    const Plane<float> all_ao = channel(out, "ao.Y"), all_bounce = channel(out, "bounce.R");
    for (std::size_t i = 0; i < all_ao.size(); ++i)
      ao += double(all_ao[i]), bounce += double(all_bounce[i]);
    fmt::print("{}: ao {:.4f}, bounce {:.4f}\n", method, ao / double(all_ao.size()),
               bounce / double(all_ao.size()));
    EXPECT_LT(ao / double(all_ao.size()), 0.03) << method;
    EXPECT_LT(bounce / double(all_ao.size()), 0.03) << method;
  }
}

TEST_F(OtherViews, AreKnownAndNotGuessed) {
  const glm::dvec3 eye(-0.5, -2, 1.4), target(0.3, 3, 1.2);
  const std::string frame =
                        write("frame.exr", closed_room(), pinhole(kFrame, 50, eye, target), kFrame),
                    around = write("around.exr", closed_room(), panorama(eye, target), kPanorama),
                    out = folder.path() / "out.exr";
  const auto mean_guessed = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {frame, "-o", out, "--overwrite", "--products", "guessed"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished run = run_tool(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    double sum = 0;
    const Plane<float> guessed = channel(out, "guessed.Y");
    for (const float g : guessed.pixels) sum += double(g);
    return sum / double(guessed.size());
  };
  for (const std::string method : {"bitmask", "trace"}) {
    EXPECT_GT(mean_guessed({"--method", method, "--prior", "rules"}), 0.5);
    EXPECT_LT(mean_guessed({"--method", method, "--prior", "rules", "--also", around}), 0.03);
  }
  EXPECT_LT(mean_guessed({"--also", around}), mean_guessed({}) / 10) << "the expected error";
  const Finished alone = run_tool({"info", frame}),
                 known = run_tool({"info", frame, "--also", around});
  EXPECT_THAT(alone.out, AllOf(HasSubstr("behind the camera"), HasSubstr("render a panorama")));
  EXPECT_THAT(alone.out, HasSubstr("are guessed; render"));
  EXPECT_THAT(known.out, AllOf(HasSubstr("guessed: 0.0"), Not(HasSubstr("are guessed"))));
  EXPECT_THAT(run_tool({"info", frame, "--products", "guessed", "--method", "gtao"}).error_line(),
              HasSubstr("these do: bitmask, trace"));
}

TEST_F(OtherViews, BoxBehindABoxHidesWhatItHides) {
  const Box before{{-0.5, -0.6, 0}, {0.5, -0.4, 1.1}}, behind{{-0.4, 0.1, 0}, {0.4, 0.5, 0.8}};
  const Surface scene = all_of({plane({}, {0, 0, 1}), before.surface(), behind.surface()});
  const Camera camera = pinhole(kFrame, 40, {0, -4, 1.3}, {0, 0, 0.3});
  const std::string frame = write("frame.exr", scene, camera, kFrame),
                    left = write("left.exr", scene,
                                 pinhole(kView, 50, {-3.5, 1.2, 1.4}, {0, 0, 0.3}), kView),
                    right = write("right.exr", scene,
                                  pinhole(kView, 50, {3.5, 1.2, 1.4}, {0, 0, 0.3}), kView);
  const auto floor = [](const glm::dvec3& p) { return p.z < 1e-6 && glm::length(p) < 2; };
  for (const std::string method : {"bitmask", "trace"}) {
    std::vector<std::string> by = {"--method", method};
    if (method == "trace") by.insert(by.end(), {"--set", "samples=256"});
    const double alone = rmse(ao(frame, {}, by), scene, camera, floor),
                 known = rmse(ao(frame, {left, right}, by), scene, camera, floor);
    fmt::print("{}: RMSE {:.4f} alone, {:.4f} with two views\n", method, alone, known);
    EXPECT_LT(known, 0.025) << method;
    EXPECT_LT(known, 0.6 * alone) << method;
  }
}

TEST_F(OtherViews, CoarseViewOfAnOpenTerrainChangesNothing) {
  // Gentle hills within the frame, all of which both cameras see.
  const Surface hills =
      all_of({plane({}, {0, 0, 1}), sphere({-1, 0, -9.9}, 10), sphere({0.5, 0.4, -7.85}, 8)});
  const Camera camera = pinhole(kFrame, 45, {0, -5, 4}, {0, 0, 0});
  const std::string frame = write("frame.exr", hills, camera, kFrame),
                    above = write("above.exr", hills, pinhole(kView, 45, {0.5, -1, 6}, {0, 0.1, 0}),
                                  kView);
  // Of solids of one thickness a view has nothing to carve: what changes would be its triangles.
  const std::vector<std::string> solid = {"--thickness", "0.5"};
  const Plane<float> alone = ao(frame, {}, solid), known = ao(frame, {above}, solid);
  double largest = 0;
  for (int y = 8; y < kFrame.height() - 8; ++y)
    for (int x = 8; x < kFrame.width() - 8; ++x)
      largest = std::max(largest, std::abs(double(alone(x, y)) - double(known(x, y))));
  fmt::print("changes by {:.5f} at most\n", largest);
  EXPECT_LT(largest, 1e-3);
  const auto everywhere = [](const glm::dvec3&) { return true; };
  EXPECT_LT(rmse(ao(frame, {above}), hills, camera, everywhere),
            rmse(ao(frame, {}), hills, camera, everywhere) + 1e-4);
}

TEST_F(OtherViews, WhatHasMovedIsLeftOut) {
  const Surface ground = plane({}, {0, 0, 1}), stays = sphere({1.2, 0.4, 0.4}, 0.4);
  const Surface now = all_of({ground, stays}),
                before = all_of({ground, stays, sphere({-0.6, 0, 0.5}, 0.5)});
  const Camera camera = pinhole(kFrame, 45, {0, -5, 3}, {0, 0, 0});
  const std::string frame = write("frame.exr", now, camera, kFrame),
                    earlier = write("earlier.exr", before,
                                    pinhole(kView, 45, {0.4, -5, 3}, {0, 0, 0}), kView);
  const Plane<float> alone = ao(frame, {}), known = ao(frame, {earlier});
  // Where the sphere would hide half of the sky.
  const glm::dvec2 beside = camera.project(camera.to_camera({-0.6, -0.6, 0}));
  EXPECT_NEAR(known(int(beside.x), int(beside.y)), alone(int(beside.x), int(beside.y)), 0.02);
  const Finished info = run_tool({"info", frame, "--also", earlier});
  EXPECT_THAT(info.out, testing::ContainsRegex("[1-9][0-9]* contradict it"));
  EXPECT_THAT(info.out, Not(HasSubstr("the same scene")));
  const std::string larger = write("larger.exr", all_of({before, sphere({-0.6, 0, 1}, 1)}),
                                   pinhole(kView, 45, {0.4, -5, 3}, {0, 0, 0}), kView);
  EXPECT_THAT(run_tool({"info", frame, "--also", larger}).out, HasSubstr("larger.exr: left out"));
}

TEST_F(OtherViews, GiveTheSameBitsInAnyOrderAndForAnyThreads) {
  const Box box{{-0.5, -0.6, 0}, {0.5, 0.4, 0.9}};
  const Surface scene = all_of({plane({}, {0, 0, 1}), box.surface()});
  const std::string frame = write("frame.exr", scene,
                                  pinhole(kFrame, 40, {0, -4, 1.3}, {0, 0, 0.3}), kFrame),
                    a = write("a.exr", scene, pinhole(kView, 50, {-3.5, 1.2, 1.4}, {0, 0, 0.3}),
                              kView),
                    b = write("b.exr", scene, panorama({0, 3, 1}, {0, 0, 1}), kPanorama);
  const Plane<float> once = ao(frame, {a, b}, {"--threads", "1"});
  EXPECT_EQ(once.pixels, ao(frame, {b, a}, {"--threads", "1"}).pixels);
  EXPECT_EQ(once.pixels, ao(frame, {a, b}, {"--threads", "3"}).pixels);
}

TEST_F(OtherViews, SendTheLightThatTheyReceive) {
  // A wall behind the camera lights the floor: its bounce is missing in the frame alone.
  const Surface scene = all_of({plane({}, {0, 0, 1}), plane({0, -3, 0}, {0, 1, 0})});
  const glm::dvec3 eye(0, -2, 1.5), target(0, 1, 0);
  const std::string frame = write("frame.exr", scene, pinhole(kFrame, 50, eye, target), kFrame),
                    around = write("around.exr", scene, panorama(eye, target), kPanorama),
                    out = folder.path() / "out.exr";
  const auto bounce_at_bottom = [&](const std::vector<std::string>& also) {
    std::vector<std::string> arguments = {
        frame,    "-o",           out,     "--overwrite", "--products",
        "bounce", "--pixel-type", "float", "--fov",       "50"};
    arguments.insert(arguments.end(), also.begin(), also.end());
    EXPECT_EQ(run_tool(arguments).code, 0);
    return channel(out, "bounce.R")(80, 110);
  };
  EXPECT_LT(bounce_at_bottom({"--offscreen", "open"}), 0.01);
  // Light of 1: the wall gets half of it at every height but near the floor, as the floor does,
  // and sends half of that; the floor sees it under its own height.
  const Point p = point_at(scene, pinhole(kFrame, 50, eye, target), kFrame, 80, 110);
  const double hidden = 1 - ao_by_rays(scene, p, kNoLimit, 4096);
  EXPECT_NEAR(bounce_at_bottom({"--also", around}), hidden * 0.5 * 0.5, 0.2 * hidden * 0.25);
}

TEST_F(OtherViews, AreRefusedWhereTheyCannotBePlaced) {
  const Surface scene = all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.5}, 0.5)}),
                other = all_of({plane({0, 0, 0.4}, {0, 0, 1}), sphere({1, 1, 0.9}, 0.5)});
  const Camera camera = pinhole(kFrame, 45, {0, -5, 3}, {0, 0, 0}),
               beside = pinhole(kView, 45, {2, -5, 3}, {0, 0, 0});
  const std::string frame = write("frame.exr", scene, camera, kFrame),
                    of_other = write("other.exr", other, beside, kView),
                    around = write("around.exr", scene, panorama({0, -2, 2}, {0, 0, 1}), kPanorama);
  const Finished another = fails(frame, of_other);
  EXPECT_EQ(another.code, 0);
  EXPECT_THAT(another.err, AllOf(HasSubstr("other.exr: left out"), HasSubstr("the same scene")));

  FramePart no_position = part_of(scene, beside, kView);
  for (const char* c : {"X", "Y", "Z"})
    no_position.channels.erase(std::string("ViewLayer.Position.") + c);
  write_frame(folder.path() / "depth.exr", no_position);
  const Finished depth = fails(frame, folder.path() / "depth.exr");
  EXPECT_EQ(depth.code, 4);
  EXPECT_THAT(depth.error_line(), HasSubstr("depth.exr"));

  Picture own = take_picture(scene, beside, kView);
  for (std::size_t i = 0; i < own.position.size(); ++i)
    if (own.valid[i]) own.position[i] = glm::vec3(beside.to_camera(glm::dvec3(own.position[i])));
  own.camera = camera_from_fov(45, kView, 1);
  write_frame(folder.path() / "own.exr", frame_of(own));
  const Finished in_own_space = fails(frame, folder.path() / "own.exr");
  EXPECT_EQ(in_own_space.code, 4);
  EXPECT_THAT(in_own_space.error_line(), AllOf(HasSubstr("own.exr"), HasSubstr("camera space")));
  const Finished into_own_space = fails(folder.path() / "own.exr", around);
  EXPECT_EQ(into_own_space.code, 4);
  EXPECT_THAT(into_own_space.error_line(), AllOf(HasSubstr("own.exr"), HasSubstr("--camera")));

  const Finished as_frame = run_tool({around, "-o", folder.path() / "as_frame.exr"});
  EXPECT_EQ(as_frame.code, 4);
  EXPECT_THAT(as_frame.error_line(), AllOf(HasSubstr("around.exr"), HasSubstr("--also")));
}

TEST_F(OtherViews, WithoutAlbedoHideAndSendNothing) {
  const Box box{{-0.5, -0.6, 0}, {0.5, 0.4, 0.9}};
  const Surface scene = all_of({plane({}, {0, 0, 1}), box.surface()});
  const Camera beside = pinhole(kView, 50, {-3.5, 1.2, 1.4}, {0, 0, 0.3});
  const std::string frame =
      write("frame.exr", scene, pinhole(kFrame, 40, {0, -4, 1.3}, {0, 0, 0.3}), kFrame);
  FramePart part = part_of(scene, beside, kView);
  for (const char* c : {"R", "G", "B"}) part.channels.erase(std::string("ViewLayer.DiffCol.") + c);
  write_frame(folder.path() / "no_albedo.exr", part);
  const Finished run = run_tool({frame, "-o", folder.path() / "out.exr", "--dry-run", "-v",
                                 "--also", folder.path() / "no_albedo.exr"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out + run.err, HasSubstr("has no albedo, so that it sends no light"));
}

}  // namespace
}  // namespace ssdo::test::other_views_test
