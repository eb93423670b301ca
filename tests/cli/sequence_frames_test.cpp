// SPDX-License-Identifier: Apache-2.0
//
// What frames of a shot take from the others: where they tell too little, the camera, the axis that
// is up and the space of N; and the radius.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "support/analytic_scene.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::sequence_frames_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

const Window kWindow{0, 0, 64, 48};

/// A ground, a wall and two balls, z being up.
Surface court() {
  return all_of({plane({}, {0, 0, 1}), plane({0, 6, 0}, {0, -1, 0}), sphere({0.2, 0, 1}, 1),
                 sphere({-2, 1, 0.6}, 0.6)});
}

/// A level camera that goes by and turns a little.
Camera camera_at(const Camera& lens, double along) {
  return look_at(lens, {along - 0.5, -6, 2.5}, {0.5 * along, 0, 0.6}, {0, 0, 1});
}

/// Only these pixels show a surface.
Picture only(Picture picture, const std::vector<glm::ivec2>& pixels) {
  Plane<unsigned char> valid(kWindow.width(), kWindow.height(), 0);
  for (const glm::ivec2& at : pixels) valid(at.x, at.y) = picture.valid(at.x, at.y);
  for (std::size_t i = 0; i < valid.size(); ++i)
    if (!valid[i]) picture.position[i] = picture.normal[i] = glm::vec3(0);
  picture.valid = valid;
  return picture;
}

void write_camera(const std::filesystem::path& path, const Camera& camera) {
  const glm::dvec3 t = -(camera.rotation * camera.origin);
  json rows = json::array();
  for (int row = 0; row < 3; ++row)
    rows.push_back(
        {camera.rotation[0][row], camera.rotation[1][row], camera.rotation[2][row], t[row]});
  std::ofstream(path) << json{{"type", camera.orthographic ? "ortho" : "persp"},
                              {"fx", camera.fx},
                              {"fy", camera.fy},
                              {"cx", camera.cx},
                              {"cy", camera.cy},
                              {"world_to_camera", rows}};
}

/// A light from above, brighter to one side.
void write_sky(const std::filesystem::path& path) {
  const Window window{0, 0, 32, 16};
  Plane<glm::vec3> sky(32, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x)
      sky(x, y) =
          y < 8 ? glm::vec3(0.5f + 0.1f * float(8 - y), 1, 1.0f + float(x < 16)) : glm::vec3(0.05f);
  FramePart part{"", window, window, {}, Imf::FLOAT, {}};
  for (int c = 0; c < 3; ++c) {
    Plane<float> channel(32, 16);
    for (std::size_t i = 0; i < sky.size(); ++i) channel[i] = sky[i][c];
    part.channels[std::string(1, "RGB"[c])] = channel;
  }
  write_frame(path, part);
}

class SequenceFrames : public testing::Test {
 protected:
  SequenceFrames() { write_sky(sky_); }

  std::string file(const std::string& name, int frame) const {
    return dir_ / (name + ".000" + std::to_string(frame) + ".exr");
  }
  void write(int frame, const Picture& picture) const {
    write_frame(file("in", frame), frame_of(picture));
  }
  Finished run(std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {dir_ / "in.####.exr", "-o", dir_ / "out.####.exr", "--env", sky_,
                                 "--overwrite", "--pixel-type", "float"});
    return run_tool(flags);
  }
  json info(int frame) const {
    return parse_json(run_tool({"info", dir_ / "in.####.exr", "--frames", std::to_string(frame),
                                "--env", sky_, "--json"})
                          .out);
  }
  TempDir dir_;
  std::string sky_ = dir_ / "sky.exr";
};

/// The largest difference of the products of two outputs.
double largest_difference(const std::string& a, const std::string& b) {
  double largest = 0;
  for (const char* name : {"direct.R", "direct.B", "bounce.G", "ao.Y"}) {
    const Plane<float> one = channel(a, name), other = channel(b, name);
    for (std::size_t i = 0; i < one.size(); ++i)
      largest = std::max(largest, double(std::abs(one[i] - other[i])));
  }
  return largest;
}

struct OpenCamera {
  const char* name;
  Camera lens;
  Surface scene;
  std::vector<glm::ivec2> pixels;  ///< that show a surface; none: all
};

std::vector<OpenCamera> open_cameras() {
  const Camera lens = camera_from_fov(40, kWindow, 1);
  Camera shifted = lens;
  shifted.cx += 12, shifted.cy -= 7;
  const Camera ortho = camera_from_ortho_width(7, kWindow, 1);
  std::vector<glm::ivec2> row;
  for (int x = 8; x < 56; ++x) row.emplace_back(x, 33);  // the balls and the ground before them
  const std::vector<glm::ivec2> block = {{30, 20}, {31, 20}, {32, 20},
                                         {30, 21}, {31, 21}, {32, 21}};
  const Surface ground = plane({}, {0, 0, 1});
  return {{"one pixel", lens, court(), {{30, 20}}},
          {"two pixels", lens, court(), {{30, 20}, {38, 24}}},
          {"three pixels", lens, court(), {{30, 20}, {38, 24}, {12, 40}}},
          {"a line", lens, court(), row},
          {"six pixels of a ball", lens, court(), block},
          {"a shifted lens", shifted, ground, {}},
          {"a shifted lens and two pixels", shifted, court(), {{30, 20}, {38, 24}}},
          {"an orthographic camera", ortho, ground, {}},
          {"an orthographic camera and a line", ortho, court(), row}};
}

/// Such a frame stopped the sequence with status 4, or was given a camera of its own that is wrong.
TEST_F(SequenceFrames, TakeTheCameraOfTheFramesBeside) {
  for (const OpenCamera& c : open_cameras()) {
    for (const double step : {0.0, 0.15}) {
      SCOPED_TRACE(testing::Message() << c.name << ", step " << step);
      for (const int frame : {1, 3})
        write(frame, take_picture(court(), camera_at(c.lens, step * frame), kWindow));
      const Camera camera = camera_at(c.lens, step * 2);
      const Picture picture = take_picture(c.scene, camera, kWindow);
      write(2, c.pixels.empty() ? picture : only(picture, c.pixels));
      const Finished done = run({});
      ASSERT_EQ(done.code, 0) << done.err;
      EXPECT_THAT(done.err, HasSubstr("in.0002.exr: warning: P does not tell the camera, which has "
                                      "the lens of " +
                                      file("in", 1)));
      write_camera(dir_ / "true.json", camera);
      const std::string right = dir_ / "right.exr";
      ASSERT_EQ(run_tool({file("in", 2), "-o", right, "--env", sky_, "--env-up", "z", "--camera",
                          dir_ / "true.json", "--overwrite", "--pixel-type", "float"})
                    .code,
                0);
      EXPECT_LT(largest_difference(file("out", 2), right), 1e-3);
      const json found = info(2)["camera"];
      EXPECT_NEAR(double(found["fx"]) / camera.fx, 1, 1e-3);
      EXPECT_LT(double(found["residual_px"]["max"]), 0.02);
      EXPECT_EQ(found["type"], camera.orthographic ? "ortho" : "persp");
      if (!camera.orthographic) {
        EXPECT_NEAR(double(found["cx"]), camera.cx, 0.02);
      }
      const std::string whole = read_file(file("out", 2));
      ASSERT_EQ(run({"--frames", "2"}).code, 0);
      EXPECT_TRUE(read_file(file("out", 2)) == whole) << "however the shot is cut";
    }
  }
}

/// With --fov, the lens is given and the pose is not.
TEST_F(SequenceFrames, TakeThePoseUnderAGivenLens) {
  const Camera camera = camera_at(camera_from_fov(40, kWindow, 1), 0);
  const Picture picture = take_picture(court(), camera, kWindow);
  for (const int frame : {1, 3}) write(frame, picture);
  write(2, only(picture, {{30, 20}, {38, 24}}));
  const Finished done = run({"--fov", "40"});
  EXPECT_EQ(done.code, 0) << done.err;
}

/// A tilted frame was lit from the side in the middle of a shot.
TEST_F(SequenceFrames, HaveOneAxisThatIsUp) {
  const Camera lens = camera_from_fov(40, kWindow, 1);
  for (int frame = 1; frame <= 5; ++frame)
    write(frame, take_picture(court(), camera_at(lens, 0.1 * frame), kWindow));
  const Camera tilted = look_at(lens, {0, -2.5, 7}, {0, 0, 0}, {0.5, 1, 0});
  write(2, take_picture(court(), tilted, kWindow));
  const std::string alone =
      parse_json(run_tool({"info", file("in", 2), "--env", sky_, "--json"}).out)["light"];
  ASSERT_THAT(alone, testing::Not(HasSubstr("up by the camera")));
  for (int frame = 1; frame <= 5; ++frame)
    EXPECT_THAT(std::string(info(frame)["light"]), HasSubstr("up by the camera of the shot"));
  ASSERT_EQ(run({}).code, 0);
  const std::string found = read_file(file("out", 2)), first = read_file(file("out", 1));
  ASSERT_EQ(run({"--frames", "2"}).code, 0);
  EXPECT_TRUE(read_file(file("out", 2)) == found) << "however the shot is cut";
  std::filesystem::copy_file(file("out", 2), dir_ / "found.exr");
  ASSERT_EQ(run({"--env-up", "z"}).code, 0);
  EXPECT_EQ(largest_difference(dir_ / "found.exr", file("out", 2)), 0);
}

/// N in camera space beside P of the world was taken as of the world where P is nowhere smooth.
TEST_F(SequenceFrames, HaveOneSpaceOfNormals) {
  const Camera lens = camera_from_fov(40, kWindow, 1);
  std::vector<glm::ivec2> apart;
  std::mt19937 random(1);
  for (int i = 0; i < 250; ++i) apart.emplace_back(random() % 64, random() % 48);
  for (int frame = 1; frame <= 3; ++frame) {
    Picture picture = take_picture(court(), camera_at(lens, 0.1 * frame), kWindow);
    for (glm::vec3& n : picture.normal.pixels) n = glm::mat3(picture.camera.rotation) * n;
    write(frame, frame == 2 ? only(picture, apart) : picture);
  }
  const json alone = parse_json(run_tool({"info", file("in", 2), "--json"}).out);
  EXPECT_THAT(std::string(alone["normals"]["space"]), StartsWith("the space of P, unchecked"));
  EXPECT_THAT(std::string(info(2)["normals"]["space"]), StartsWith("camera space, unchecked"));
  const Finished whole = run({});
  ASSERT_EQ(whole.code, 0);
  EXPECT_THAT(whole.err, testing::Not(HasSubstr("another space")));
  const std::string second = read_file(file("out", 2));
  ASSERT_EQ(run({"--frames", "2"}).code, 0);
  EXPECT_TRUE(read_file(file("out", 2)) == second) << "however the shot is cut";
}

/// That N points the other way is of the shot too.
TEST_F(SequenceFrames, TurnNormalsRoundAlike) {
  const Camera lens = camera_from_fov(40, kWindow, 1);
  std::vector<glm::ivec2> apart;
  std::mt19937 random(1);
  for (int i = 0; i < 250; ++i) apart.emplace_back(random() % 64, random() % 48);
  std::string plain;
  for (const bool turned : {false, true}) {
    for (int frame = 1; frame <= 3; ++frame) {
      Picture picture = take_picture(court(), camera_at(lens, 0.1 * frame), kWindow);
      if (turned)
        for (glm::vec3& n : picture.normal.pixels) n = -n;
      write(frame, frame == 2 ? only(picture, apart) : picture);
    }
    ASSERT_EQ(run({"--products", "direct,bounce,ao"}).code, 0);
    if (!turned) std::filesystem::copy_file(file("out", 2), plain = dir_ / "plain.exr");
  }
  EXPECT_LT(largest_difference(file("out", 2), plain), 1e-5);
}

/// Frames 1 to 9 of a still camera; a ball covers most of the picture of frames 4, 5
/// and 9: of the first, the middle and the last, but not of most.
void write_passing_ball(const std::function<void(int, const Picture&)>& write) {
  const Camera camera = camera_at(camera_from_fov(40, kWindow, 1), 0);
  const Surface near = all_of({court(), sphere({-0.4, -4.6, 2.2}, 0.6)});
  for (int frame = 1; frame <= 9; ++frame)
    write(frame,
          take_picture(frame == 4 || frame == 5 || frame == 9 ? near : court(), camera, kWindow));
}

/// A thing that came close to the camera made the radius of methods that need one several times
/// smaller.
TEST_F(SequenceFrames, HaveOneRadius) {
  write_passing_ball([&](int frame, const Picture& picture) { write(frame, picture); });
  const auto radius = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all = {"info", "--json", "--method", "gtao"};
    all.insert(all.end(), words.begin(), words.end());
    return double(parse_json(run_tool(all).out)["plan"]["radius"]);
  };
  const double far = radius({file("in", 1)}), near = radius({file("in", 4)});
  ASSERT_GT(far, 2 * near);
  for (const char* frame : {"1", "4", "9"})
    EXPECT_EQ(radius({dir_ / "in.####.exr", "--frames", frame}), far);
  EXPECT_NEAR(radius({dir_ / "in.####.exr", "--frames", "4", "--radius", "0.7"}), 0.7, 1e-6);

  const std::vector<std::string> by = {"--method", "gtao", "--products", "ao"};
  const auto bits = [&](const std::string& frames) {
    std::vector<std::string> flags = by;
    flags.insert(flags.end(), {"--frames", frames});
    EXPECT_EQ(run(flags).code, 0);
    std::vector<std::string> files;
    for (int frame = 3; frame <= 6; ++frame) files.push_back(read_file(file("out", frame)));
    return files;
  };
  const std::vector<std::string> whole = bits("1-9"), chunk = bits("3-6");
  EXPECT_TRUE(whole == chunk) << "however the shot is cut";
  for (const char* frame : {"6", "5", "4", "3"}) bits(frame);
  EXPECT_TRUE(bits("9") == whole);

  std::vector<std::string> flags = by;
  const std::string told = run(flags).err;
  EXPECT_THAT(told,
              HasSubstr(fmt::format("in.####.exr: warning: radius {:.4g} is that of the shot: "
                                    "for frames 4 to 5, 9 alone it would be {:.4g}; give --radius",
                                    far, near)));
  flags.insert(flags.end(), {"--radius", "0.7"});
  EXPECT_EQ(run(flags).err, "");
}

/// Where frames differ all the same, it is said.
TEST_F(SequenceFrames, ThatDifferSaySo) {
  const Camera lens = camera_from_fov(40, kWindow, 1);
  for (int frame = 1; frame <= 3; ++frame) {
    Picture picture = take_picture(court(), camera_at(lens, 0.1 * frame), kWindow);
    if (frame == 3)
      for (glm::vec3& n : picture.normal.pixels) n = glm::mat3(picture.camera.rotation) * n;
    write(frame, picture);
  }
  EXPECT_THAT(run({}).err,
              HasSubstr("in.0003.exr: warning: normals are of another space: the space "
                        "of P in frame 2, camera space in frame 3"));
}

TEST_F(SequenceFrames, SayWhereAViewFitsSomeOfThemOnly) {
  const Camera lens = camera_from_fov(40, kWindow, 1);
  const Picture picture = take_picture(court(), camera_at(lens, 0), kWindow);
  const Surface other = all_of({plane({0, 0, -1}, {0.3, 0.2, 1}), plane({0, 4, 0}, {0.4, -1, 0}),
                                sphere({0.2, -2, 0}, 0.8)});
  write(1, picture), write(2, take_picture(other, camera_at(lens, 0), kWindow));
  const std::string also = dir_ / "also.exr";
  write_frame(also, frame_of(take_picture(court(), camera_at(lens, 2), kWindow)));
  const Finished done = run({"--also", also});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("in.0002.exr: warning: --also " + also +
                                  " is used in frame 1 and left out of frame 2"));
}

}  // namespace
}  // namespace ssdo::test::sequence_frames_test
