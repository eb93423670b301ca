// SPDX-License-Identifier: Apache-2.0
//
// Files whose header says their camera, by the tool: they are lit as the same frame with P in the
// world is, or with --camera.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/header_camera.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::metadata_test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const Window kDisplay{0, 0, 96, 72}, kData{8, 4, 92, 72};
const std::vector<std::string> kSky = {"--env", data("environments/sky.exr"), "--env-up", "z"};

Surface still_life() {
  return all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6), sphere({-1, 0.5, 0.4}, 0.4)});
}

Camera shot_camera() {
  Camera lens = camera_from_fov(40, kDisplay, 1);
  lens.cx += 5.5, lens.cy -= 3.25;
  return look_at(lens, {1.5, -4, 3}, {0, 0, 0.3}, {0.2, 0.1, 1});
}

class HeaderCameraFiles : public testing::Test {
 protected:
  /// P, N and albedo of a crop, with the camera in the header.
  FramePart in_world() const {
    FramePart part = frame_of(picture_);
    part.display = kDisplay;
    part.channels.erase("ViewLayer.Depth.Z");
    return part;
  }

  /// The same with P and N in camera space.
  FramePart in_camera_space() const {
    Picture turned = picture_;
    for (std::size_t i = 0; i < turned.position.size(); ++i) {
      if (!turned.valid[i]) continue;
      turned.position[i] = glm::vec3(camera_.to_camera(glm::dvec3(turned.position[i])));
      turned.normal[i] = glm::vec3(camera_.rotation * glm::dvec3(turned.normal[i]));
    }
    FramePart part = in_world();
    part.add("ViewLayer.Position", turned.position);
    part.add("ViewLayer.Normal", turned.normal);
    return part;
  }

  FramePart depth_alone() const {
    FramePart part = frame_of(picture_);
    part.display = kDisplay;
    for (const char* c : {"X", "Y", "Z"}) {
      part.channels.erase(std::string("ViewLayer.Position.") + c);
      part.channels.erase(std::string("ViewLayer.Normal.") + c);
    }
    return part;
  }

  std::string write(const std::string& name, FramePart part, const HeaderNumbers& header,
                    const std::string& prefix = "", bool as_text = false) {
    add_attributes(part.extra, header, prefix, as_text);
    write_frame(folder_ / name, part);
    return folder_ / name;
  }

  HeaderNumbers standard() const { return standard_header(camera_, kDisplay); }

  Plane<float> product(const std::string& frame, const std::string& name,
                       const std::vector<std::string>& more = {}) {
    const std::string out = folder_ / "out.exr", layer = name.substr(0, name.find('.'));
    std::vector<std::string> words = {frame, "-o",           out,    "--overwrite", "--products",
                                      layer, "--pixel-type", "float"};
    words.insert(words.end(), more.begin(), more.end());
    const Finished run = run_tool(words);
    EXPECT_EQ(run.code, 0) << run.err;
    said_ = run.err;
    return run.code == 0 ? channel(out, name) : Plane<float>();
  }

  TempDir folder_;
  Camera camera_ = shot_camera();
  Picture picture_ = take_picture(still_life(), camera_, kData);
  std::string said_;
};

/// The share of the pixels that differ by more than `by`: rounding of P moves a few rays past
/// edges.
double share_off(const Plane<float>& a, const Plane<float>& b, double by) {
  EXPECT_EQ(a.size(), b.size());
  if (a.empty() || a.size() != b.size()) return 1;
  std::size_t off = 0;
  for (std::size_t i = 0; i < a.size(); ++i) off += !(std::abs(a[i] - b[i]) <= by);
  return double(off) / double(a.size());
}

TEST_F(HeaderCameraFiles, PlacesAnEnvironmentAroundPInCameraSpace) {
  const std::string world = write("world.exr", in_world(), {}),
                    lost = write("lost.exr", in_camera_space(), {}),
                    posed = write("posed.exr", in_camera_space(), standard());
  const Plane<float> expected = product(world, "direct.G", kSky),
                     found = product(posed, "direct.G", kSky);
  EXPECT_THAT(said_, IsEmpty());
  EXPECT_LT(share_off(found, expected, 2e-3), 0.01);
  const Plane<float> without = product(lost, "direct.G", kSky);
  EXPECT_THAT(said_, HasSubstr("knows no world space"));
  EXPECT_GT(share_off(without, expected, 2e-3), 0.3) << "the header decides";
}

TEST_F(HeaderCameraFiles, GivesADepthTheAoThatACameraFileGivesIt) {
  const std::string posed = write("posed.exr", depth_alone(), standard()),
                    bare = write("bare.exr", depth_alone(), {});
  std::ofstream(folder_ / "camera.json")
      << json{{"fx", camera_.fx}, {"cx", camera_.cx}, {"cy", camera_.cy}};
  // A learned prior asks for a way up, which only the header tells.
  const auto ao = [&](const std::string& file, std::vector<std::string> flags) {
    flags.insert(flags.end(), {"--prior", "rules"});
    return product(file, "ao.Y", flags);
  };
  const Plane<float> found = ao(posed, {});
  EXPECT_THAT(said_, IsEmpty());
  EXPECT_LT(share_off(found, ao(bare, {"--camera", folder_ / "camera.json"}), 2e-3), 0.01);
  EXPECT_GT(share_off(found, ao(bare, {"--fov", "20"}), 2e-3), 0.2);
  const Finished refused = run_tool({bare, "-o", folder_ / "no.exr"});
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.error_line(), HasSubstr("give --fov DEGREES"));
}

TEST_F(HeaderCameraFiles, PlacesOtherPicturesBesidePInCameraSpace) {
  const Camera side =
      look_at(camera_from_fov(50, kDisplay, 1), {-4, -2, 2}, {0, 0, 0.3}, {0, 0, 1});
  write_frame(folder_ / "side.exr", frame_of(take_picture(still_life(), side, kDisplay)));
  const std::vector<std::string> also = {"--also", folder_ / "side.exr"};
  const Plane<float> expected = product(write("world.exr", in_world(), {}), "ao.Y", also),
                     found =
                         product(write("posed.exr", in_camera_space(), standard()), "ao.Y", also);
  EXPECT_LT(share_off(found, expected, 5e-3), 0.02);
  EXPECT_GT(share_off(product(folder_ / "world.exr", "ao.Y"), expected, 5e-3), 0.02);
  const Finished lost = run_tool(
      {write("lost.exr", in_camera_space(), {}), "-o", folder_ / "no.exr", also[0], also[1]});
  EXPECT_EQ(lost.code, 4) << lost.err;
}

TEST_F(HeaderCameraFiles, GivePInCameraSpaceAHistoryAndAShot) {
  const auto run = [&](const HeaderNumbers& header, const std::vector<std::string>& options) {
    for (const char* name : {"f.0001.exr", "f.0002.exr"}) write(name, in_camera_space(), header);
    std::vector<std::string> words = {folder_ / "f.####.exr",
                                      "-o",
                                      folder_ / "out.####.exr",
                                      "--frames",
                                      "1-2",
                                      "--products",
                                      "ao",
                                      "--overwrite",
                                      "-v"};
    words.insert(words.end(), options.begin(), options.end());
    return run_tool(words);
  };
  EXPECT_THAT(run(standard(), {"--temporal"}).err, Not(HasSubstr("knows no world space")));
  EXPECT_THAT(run({}, {"--temporal"}).err, HasSubstr("knows no world space"));
  const Finished beside = run(standard(), {"--shot", "1"});
  EXPECT_EQ(beside.code, 0) << beside.err;
  EXPECT_THAT(beside.err, Not(HasSubstr("do without it")));
  EXPECT_EQ(run({}, {"--shot", "1"}).code, 4);
}

TEST_F(HeaderCameraFiles, AreThoseOfNukeAndOfAnotherPartToo) {
  const std::string read = write("read.exr", depth_alone(), standard(), "exr/"),
                    written = write("written.exr", depth_alone(), standard(), "nuke/exr/");
  FramePart depth = depth_alone(), other = depth_alone();
  depth.name = "depth", other.name = "camera";
  other.channels = {{"extra.V", depth.channels.begin()->second}};
  add_attributes(other.extra, standard());
  write_frame(folder_ / "parts.exr", {depth, other});
  for (const std::string& file : {read, written, std::string(folder_ / "parts.exr")}) {
    const Finished info = run_tool({"info", file});
    EXPECT_EQ(info.code, 0) << info.err;
    EXPECT_THAT(info.out, HasSubstr("header    worldToCamera + worldToNDC; it agrees with itself"));
  }
}

TEST_F(HeaderCameraFiles, OfTextsIsUnreals) {
  const UnrealPose pose{-25, -40, 35, {-3, 3, 3}};
  camera_ = unreal_camera(pose, camera_from_fov(50, kDisplay, 1));
  picture_ = take_picture(still_life(), camera_, kData);
  const std::string file =
      write("unreal.exr", depth_alone(), unreal_header(pose, camera_, kDisplay), "", true);
  const Finished info = run_tool({"info", file, "--json"});
  ASSERT_EQ(info.code, 0) << info.err;
  const json camera = parse_json(info.out)["camera"];
  EXPECT_EQ(camera["header"]["source"], "unreal/camera/curPos + curRot + fov");
  EXPECT_EQ(camera["header"]["proved_by"], "consistency");
  EXPECT_EQ(camera["world_handedness"], "left");
  EXPECT_NEAR(camera["hfov_deg"].get<double>(), 50, 1e-4);
  // The sky lies around z, as Unreal has it up.
  const std::vector<std::string> sky = {kSky[0], kSky[1]};
  EXPECT_EQ(product(file, "direct.G", sky).pixels, product(file, "direct.G", kSky).pixels);
  EXPECT_THAT(said_, HasSubstr("nothing proves the pose"));
}

TEST_F(HeaderCameraFiles, AreNamedByInfoWithWhatProvesThem) {
  HeaderNumbers turned;
  for (const auto& [name, matrix] : standard()) turned[name] = transposed(matrix);
  const std::string proved = write("proved.exr", in_world(), turned);
  EXPECT_THAT(run_tool({"info", proved}).out,
              HasSubstr("header    worldToCamera + worldToNDC (transposed); proved by P, which "
                        "lands "));
  const json camera = parse_json(run_tool({"info", proved, "--json"}).out)["camera"];
  EXPECT_EQ(camera["source"], "fitted from P");
  EXPECT_EQ(camera["header"]["reading"], "transposed");
  EXPECT_EQ(camera["header"]["proved_by"], "positions");
  EXPECT_LT(camera["header"]["miss_px"].get<double>(), 0.01);

  Camera other = camera_;
  other.origin.x += 0.1;
  const std::string wrong = write("wrong.exr", in_world(), standard_header(other, kDisplay));
  const Finished info = run_tool({"info", wrong});
  EXPECT_THAT(info.out, AllOf(HasSubstr("header worldToCamera + worldToNDC is not used"),
                              Not(HasSubstr("\n  header"))));
  EXPECT_EQ(product(wrong, "ao.Y").pixels,
            product(write("none.exr", in_world(), {}), "ao.Y").pixels);
}

/// OpenImageIO writes V-Ray's cameraTransform, which leads to the world, as worldToCamera.
TEST_F(HeaderCameraFiles, RenamedByOpenImageIOIsVRays) {
  camera_ = look_at(camera_from_fov(40, kDisplay, 1), {1.5, -4, 3}, {0, 0, 0.3}, {0.2, 0.1, 1});
  picture_ = take_picture(still_life(), camera_, kData);
  const HeaderNumbers vray = vray_header(camera_, kDisplay);
  HeaderNumbers renamed = vray;
  renamed["worldToCamera"] = renamed["cameraTransform"];
  renamed.erase("cameraTransform");
  const Plane<float> expected = product(write("vray.exr", depth_alone(), vray), "direct.G", kSky);
  EXPECT_EQ(product(write("oiio.exr", depth_alone(), renamed), "direct.G", kSky).pixels,
            expected.pixels);
  EXPECT_THAT(said_, HasSubstr("renamed by OpenImageIO"));
}

}  // namespace
}  // namespace ssdo::test::metadata_test
