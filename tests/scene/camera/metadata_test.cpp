// SPDX-License-Identifier: Apache-2.0
//
// The camera that a header says, as each renderer writes it: used where it is proved, named where
// it is not, and refused where it is wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "error.h"
#include "scene/build_geometry.h"
#include "scene/camera/metadata/unreal.h"
#include "scene/geometry.h"
#include "support/gbuffer_of.h"
#include "support/header_camera.h"

namespace ssdo::test::metadata_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// A display window, the part of it that is rendered, and how wide pixels are.
struct Windows {
  Window display, data;
  double pixel_aspect = 1;
};
const Windows kPlain{{0, 0, 96, 72}, {0, 0, 96, 72}};
const std::vector<Windows> kAllWindows = {kPlain,
                                          {{0, 0, 96, 72}, {20, 10, 90, 65}},
                                          {{0, 0, 96, 72}, {-9, -7, 105, 80}},
                                          {{16, 8, 112, 80}, {16, 8, 112, 80}},
                                          {{0, 0, 64, 96}, {0, 0, 64, 96}},
                                          {{0, 0, 72, 96}, {0, 0, 72, 96}, 2}};

Surface still_life() {
  return all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6), sphere({-1, 0.5, 0.4}, 0.4)});
}

/// A camera that is turned about all axes.
Camera turned_camera(const Windows& windows) {
  const Camera lens = camera_from_fov(40, windows.display, windows.pixel_aspect);
  return look_at(lens, {1.5, -4, 3}, {0, 0, 0.3}, {0.2, 0.1, 1});
}

Camera shifted(Camera camera) {
  camera.cx += 7.25, camera.cy -= 4.5;
  return camera;
}

GBuffer with_header(GBuffer g, const HeaderNumbers& header, const Windows& windows) {
  g.display = windows.display;
  g.pixel_aspect = float(windows.pixel_aspect);
  g.header = header;
  // As files store them.
  for (auto& [name, values] : g.header)
    for (double& value : values) value = double(float(value));
  return g;
}

GBuffer depth_of(const Picture& picture) {
  GBuffer g = gbuffer_of(picture);
  g.depth = Plane<float>(g.position.width, g.position.height);
  for (std::size_t i = 0; i < g.depth.size(); ++i) {
    if (g.valid[i]) g.depth[i] = float(-picture.camera.to_camera(glm::dvec3(g.position[i])).z);
  }
  g.position = g.normal = {};
  return g;
}

/// P in camera space, with axes of these signs; N stays in the world, or is left out.
GBuffer in_camera_space(const Picture& picture, bool with_normals,
                        const glm::vec3& signs = glm::vec3(1)) {
  GBuffer g = gbuffer_of(picture);
  for (std::size_t i = 0; i < g.position.size(); ++i) {
    if (g.valid[i])
      g.position[i] = signs * glm::vec3(picture.camera.to_camera(glm::dvec3(g.position[i])));
  }
  if (!with_normals) g.normal = {};
  return g;
}

struct Built {
  Geometry geometry;
  GeometryReport report;
};

Built build(const GBuffer& g, const CameraOptions& options = {}) {
  Built built;
  built.geometry = build_geometry(g, options, "f.exr", built.report);
  return built;
}

/// Holds what was built to what the camera of the picture shows, in a world that is known.
void expect_of(const Picture& picture, const Built& built) {
  const Geometry& g = built.geometry;
  EXPECT_TRUE(g.world_known);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(glm::distance(g.camera.rotation[i], picture.camera.rotation[i]), 1e-5);
    EXPECT_LT(glm::distance(g.world_to_camera[i], glm::mat3(picture.camera.rotation)[i]), 1e-5);
  }
  EXPECT_LT(glm::distance(g.camera.origin, picture.camera.origin), 2e-4);
  double worst = 0;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    EXPECT_EQ(g.is_surface(i), picture.valid[i] != 0);
    if (!g.is_surface(i)) continue;
    const glm::dvec3 expected = picture.camera.to_camera(glm::dvec3(picture.position[i]));
    const double off = glm::distance(glm::dvec3(g.surfaces[i].position), expected);
    worst = std::max(worst, off / glm::length(expected));
  }
  EXPECT_LT(worst, 2e-5) << "of the distance";
}

/// The message with which a camera cannot be found.
std::string refusal_of(const GBuffer& g) {
  try {
    build(g);
  } catch (const Error& e) {
    return e.what();
  }
  return "a camera was found";
}

/// What a renderer writes, and what its header proves of itself.
struct Renderer {
  std::string name;
  HeaderNumbers (*header)(const Camera&, const Window&);
  bool has_matrices;  ///< lens and pose in two matrices that agree; else the lens is centred
  std::string reading = {};
};
const std::vector<Renderer> kRenderers = {
    {"Arnold", standard_header, true},
    {"pbrt-v4", pbrt_header, true, "transposed, NDC of the shorter side with y up"},
    {"V-Ray", vray_header, false},
    {"Redshift", redshift_header, false}};

TEST(HeaderCamera, GivesADepthItsLensAndItsWorld) {
  for (const Renderer& renderer : kRenderers) {
    for (const Windows& windows : kAllWindows) {
      SCOPED_TRACE(renderer.name + " " + std::to_string(&windows - kAllWindows.data()));
      if (renderer.name == "pbrt-v4" && windows.pixel_aspect != 1) continue;
      Camera camera = turned_camera(windows);
      if (renderer.has_matrices) camera = shifted(camera);
      const Picture picture = take_picture(still_life(), camera, windows.data);
      const Built built =
          build(with_header(depth_of(picture), renderer.header(camera, windows.display), windows));
      expect_of(picture, built);
      ASSERT_TRUE(built.report.header);
      EXPECT_EQ(built.report.header->reading, renderer.reading);
      if (renderer.has_matrices) {
        const bool overscan = windows.data.x0 < windows.display.x0;
        EXPECT_THAT(built.report.warnings, SizeIs(overscan ? 1 : 0));
        EXPECT_EQ(built.report.header->proof, HeaderProof::consistency);
      } else {
        EXPECT_THAT(built.report.warnings, testing::Contains(HasSubstr("proves the pose")));
      }
    }
  }
}

TEST(HeaderCamera, GivesPInCameraSpaceItsWorld) {
  for (const Renderer& renderer : kRenderers) {
    for (const Windows& windows : kAllWindows) {
      SCOPED_TRACE(renderer.name + " " + std::to_string(&windows - kAllWindows.data()));
      if (renderer.name == "pbrt-v4" && windows.pixel_aspect != 1) continue;
      const Camera camera = shifted(turned_camera(windows));
      const Picture picture = take_picture(still_life(), camera, windows.data);
      const HeaderNumbers header = renderer.header(camera, windows.display);
      const glm::vec3 signs = windows.data == kPlain.data ? glm::vec3(1) : glm::vec3(1, 1, -1);
      const Built built =
          build(with_header(in_camera_space(picture, false, signs), header, windows));
      expect_of(picture, built);
      EXPECT_EQ(built.report.camera_source, "fitted from P");
      ASSERT_TRUE(built.report.header);
      EXPECT_EQ(built.report.header->proof,
                renderer.has_matrices ? HeaderProof::lens : HeaderProof::nothing);
      EXPECT_THAT(built.report.warnings, SizeIs(renderer.has_matrices ? 0 : 1));
      // Normals of the world prove the pose.
      const Built proved =
          build(with_header(in_camera_space(picture, true, signs), header, windows));
      expect_of(picture, proved);
      EXPECT_EQ(proved.report.header->proof, HeaderProof::normals);
      EXPECT_EQ(proved.report.normal_space, "the world of the header");
      EXPECT_THAT(proved.report.warnings, IsEmpty());
    }
  }
}

TEST(HeaderCamera, IsCheckedByPInTheWorld) {
  for (const Renderer& renderer : kRenderers) {
    for (const Windows& windows : kAllWindows) {
      SCOPED_TRACE(renderer.name + " " + std::to_string(&windows - kAllWindows.data()));
      const Camera camera = shifted(turned_camera(windows));
      const Picture picture = take_picture(still_life(), camera, windows.data);
      const HeaderNumbers header = renderer.header(camera, windows.display);
      const Built built = build(with_header(gbuffer_of(picture), header, windows)),
                  without = build(with_header(gbuffer_of(picture), {}, windows));
      EXPECT_EQ(built.report.camera_source, "fitted from P");
      EXPECT_EQ(built.geometry.camera.fx, without.geometry.camera.fx) << "the fit stays, in bits";
      EXPECT_EQ(built.geometry.camera.origin, without.geometry.camera.origin);
      ASSERT_TRUE(built.report.header);
      EXPECT_EQ(built.report.header->proof, HeaderProof::positions);
      EXPECT_LT(*built.report.header->miss_px, 0.01);
      EXPECT_THAT(built.report.warnings, IsEmpty());
    }
  }
}

/// A matrix under another name or for other vectors than the standard has it.
TEST(HeaderCamera, FindsTheReadingOfAMatrixThatPAgreesWith) {
  const Camera camera = turned_camera(kPlain);
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  const std::vector<double> standard = standard_header(camera, kPlain.display).at("worldToCamera"),
                            vray = vray_header(camera, kPlain.display).at("cameraTransform");
  const std::vector<std::pair<HeaderNumbers, std::string>> cases = {
      {{{"worldToCamera", standard}}, ""},
      {{{"worldToCamera", transposed(standard)}}, "transposed"},
      {{{"worldToCamera", inverse(standard)}}, "inverse"},
      {{{"worldToCamera", vray}}, "inverse, looking along -y"},
      {{{"cameraTransform", vray}}, ""},
      {{{"cameraTransform", transposed(vray)}}, "transposed"},
      {{{"cameraTransform", inverse(standard)}}, "looking along z"},
      {{{"worldToCamera", vray}, {"cameraFov", {40}}},
       "V-Ray's cameraTransform, renamed by OpenImageIO"}};
  for (const auto& [header, reading] : cases) {
    SCOPED_TRACE(header.begin()->first + " " + reading);
    const Built in_world = build(with_header(gbuffer_of(picture), header, kPlain));
    ASSERT_TRUE(in_world.report.header);
    EXPECT_EQ(in_world.report.header->reading, reading);
    EXPECT_EQ(in_world.report.header->proof, HeaderProof::positions);
    // Of P in camera space, normals of the world tell.
    const Built built = build(with_header(in_camera_space(picture, true), header, kPlain));
    expect_of(picture, built);
    ASSERT_TRUE(built.report.header);
    EXPECT_EQ(built.report.header->reading, reading);
    EXPECT_EQ(built.report.header->proof, HeaderProof::normals);
    EXPECT_THAT(built.report.warnings, IsEmpty());
  }
}

TEST(HeaderCamera, OfAnotherShotIsRefusedWithAWarning) {
  const Camera camera = turned_camera(kPlain);
  Camera other = camera;
  other.origin += glm::dvec3(0.1, 0, 0);
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  for (const Renderer& renderer : kRenderers) {
    SCOPED_TRACE(renderer.name);
    const HeaderNumbers header = renderer.header(other, kPlain.display);
    const Built built = build(with_header(gbuffer_of(picture), header, kPlain));
    expect_of(picture, built);
    EXPECT_FALSE(built.report.header);
    EXPECT_THAT(built.report.warnings, ElementsAre(HasSubstr("is not used: under no reading")));
  }
}

TEST(HeaderCamera, OfAnotherLensIsRefusedForPInCameraSpace) {
  const Camera camera = turned_camera(kPlain);
  Camera other = camera;
  other.fx *= 1.1, other.fy *= 1.1;
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  const HeaderNumbers header = standard_header(other, kPlain.display);
  const Built built = build(with_header(in_camera_space(picture, false), header, kPlain));
  EXPECT_FALSE(built.geometry.world_known);
  EXPECT_FALSE(built.report.header);
  EXPECT_THAT(built.report.warnings, ElementsAre(HasSubstr("its lens is not that of P")));
}

TEST(HeaderCamera, IsRefusedWhereNormalsAreOfAnotherWorld) {
  const Camera camera = turned_camera(kPlain);
  const Camera other = look_at(camera, {3, -3, 3}, {0, 0, 1}, {-0.3, 0, 1});
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  for (const Renderer& renderer : kRenderers) {
    SCOPED_TRACE(renderer.name);
    const HeaderNumbers header = renderer.header(other, kPlain.display);
    const Built built = build(with_header(in_camera_space(picture, true), header, kPlain));
    EXPECT_FALSE(built.geometry.world_known);
    EXPECT_THAT(built.report.warnings, ElementsAre(HasSubstr("of another world")));
  }
}

/// N of a frame of depth is in the world of another reading, or in no world of the header's.
TEST(HeaderCamera, OfADepthFollowsTheNormals) {
  const Camera camera = turned_camera(kPlain);
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  GBuffer depth = depth_of(picture);
  depth.normal = picture.normal;
  HeaderNumbers header = vray_header(camera, kPlain.display);
  header["cameraTransform"] = inverse(standard_header(camera, kPlain.display).at("worldToCamera"));
  const Built built = build(with_header(depth, header, kPlain));
  expect_of(picture, built);
  EXPECT_EQ(built.report.header->reading, "looking along z");
  EXPECT_EQ(built.report.header->proof, HeaderProof::normals);
  EXPECT_THAT(built.report.warnings, IsEmpty());

  const Camera other = look_at(camera, {3, -3, 3}, {0, 0, 1}, {-0.3, 0, 1});
  const Built refused = build(with_header(depth, vray_header(other, kPlain.display), kPlain));
  EXPECT_FALSE(refused.geometry.world_known);
  EXPECT_EQ(refused.geometry.camera.rotation, glm::dmat3(1));
  EXPECT_EQ(refused.geometry.camera.origin, glm::dvec3(0));
  EXPECT_THAT(refused.report.warnings, ElementsAre(HasSubstr("of another world")));
}

/// As with oiiotool --fullsize: the header is of the larger picture.
TEST(HeaderCamera, OfOverscanThatAToolMadeIsThatOfTheDataWindow) {
  const Windows windows{{0, 0, 96, 72}, {-24, -18, 120, 90}};
  const Camera camera = turned_camera(windows);
  const Picture picture = take_picture(still_life(), camera, windows.data);
  const HeaderNumbers header = standard_header(camera, windows.data);
  const Built in_space = build(with_header(in_camera_space(picture, false), header, windows)),
              in_world = build(with_header(gbuffer_of(picture), header, windows)),
              of_depth = build(with_header(depth_of(picture), header, windows));
  expect_of(picture, in_space);
  EXPECT_EQ(in_space.report.header->reading, "NDC of the data window");
  EXPECT_THAT(in_space.report.warnings, IsEmpty());
  EXPECT_EQ(in_world.report.header->proof, HeaderProof::positions);
  EXPECT_THAT(in_world.report.warnings, IsEmpty());
  EXPECT_THAT(of_depth.report.warnings,
              ElementsAre(HasSubstr("unless the windows were changed after the render")));
}

/// The header of a picture by one matrix, times a factor that changes no projection.
HeaderNumbers header_of_ndc(const Camera& camera, double factor) {
  HeaderNumbers header = standard_header(camera, kPlain.display);
  header.erase("worldToCamera");
  for (double& value : header["worldToNDC"]) value *= factor;
  return header;
}

TEST(HeaderCamera, OfNdcAloneIsWholeThoughNothingConfirmsIt) {
  const Camera camera = shifted(turned_camera(kPlain));
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  const std::string unproved = "nothing proves the pose";
  for (const double factor : {1.0, -1.0}) {
    const HeaderNumbers header = header_of_ndc(camera, factor);
    const Built of_depth = build(with_header(depth_of(picture), header, kPlain)),
                in_space = build(with_header(in_camera_space(picture, false), header, kPlain)),
                by_normals = build(with_header(in_camera_space(picture, true), header, kPlain));
    for (const Built& built : {of_depth, in_space, by_normals}) expect_of(picture, built);
    EXPECT_THAT(of_depth.report.warnings,
                ElementsAre(HasSubstr("nothing proves that the lens"), HasSubstr(unproved)));
    EXPECT_THAT(in_space.report.warnings, ElementsAre(HasSubstr(unproved)));
    EXPECT_EQ(by_normals.report.header->proof, HeaderProof::normals);
    EXPECT_THAT(by_normals.report.warnings, IsEmpty());
  }
}

TEST(HeaderCamera, OfNdcAloneIsRefusedWithALensThatIsNotThatOfP) {
  const Camera camera = turned_camera(kPlain);
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  Camera other = camera;
  other.fx *= 1.2, other.fy *= 1.2;
  const Built built =
      build(with_header(in_camera_space(picture, false), header_of_ndc(other, 1), kPlain));
  EXPECT_FALSE(built.report.header);
  EXPECT_THAT(built.report.warnings, ElementsAre(HasSubstr("its lens is not that of P")));
}

TEST(HeaderCamera, OfAFieldOfViewThatNoLensHasIsNoneAndNamed) {
  const Camera camera = turned_camera(kPlain);
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  HeaderNumbers header = vray_header(camera, kPlain.display);
  for (const double fov : {0.0, 0.009, 179.5, -40.0}) {
    header["cameraFov"] = {fov};
    const Built by_film = build(with_header(depth_of(picture), header, kPlain));
    expect_of(picture, by_film);
    EXPECT_THAT(by_film.report.warnings,
                testing::Contains(HasSubstr("header cameraFov is " + fmt::format("{:g}", fov))));
    HeaderNumbers alone = header;
    alone.erase("cameraAperture");
    EXPECT_THAT(refusal_of(with_header(depth_of(picture), alone, kPlain)),
                HasSubstr("outside 0.01 to 179, and is not used"));
    EXPECT_THAT(build(with_header(gbuffer_of(picture), alone, kPlain)).report.warnings, IsEmpty());
  }
}

TEST(HeaderCamera, OfAMatrixThatIsNoPoseIsNotUsedAndSaysSo) {
  const Camera camera = turned_camera(kPlain);
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  HeaderNumbers header = redshift_header(camera, kPlain.display);
  for (std::size_t i = 0; i < 12; ++i) header["rs/camera/transform"][i] *= 2;
  for (const GBuffer& g :
       {depth_of(picture), gbuffer_of(picture), in_camera_space(picture, false)}) {
    const Built built = build(with_header(g, header, kPlain));
    EXPECT_FALSE(built.report.placement.world_given);
    EXPECT_THAT(built.report.warnings,
                testing::Contains(HasSubstr("header rs/camera/transform is no rotation and "
                                            "translation, and is not used"))
                    .Times(1));
  }
}

TEST(HeaderCamera, IsThatOfPInAPlaneOnlyIfPAgrees) {
  const Camera camera = shifted(turned_camera(kPlain));
  const Picture floor = take_picture(plane({}, {0, 0, 1}), camera, kPlain.data);
  const HeaderNumbers header = standard_header(camera, kPlain.display);
  const Built in_world = build(with_header(gbuffer_of(floor), header, kPlain)),
              in_space = build(with_header(in_camera_space(floor, false), header, kPlain));
  expect_of(floor, in_world);
  expect_of(floor, in_space);
  EXPECT_EQ(in_world.report.header->proof, HeaderProof::positions);
  EXPECT_EQ(in_space.report.header->proof, HeaderProof::lens);
  Camera other = camera;
  other.fx *= 1.2, other.fy *= 1.2;
  const GBuffer wrong =
      with_header(gbuffer_of(floor), standard_header(other, kPlain.display), kPlain);
  EXPECT_THAT(refusal_of(wrong), HasSubstr("worldToNDC does not put P on its own pixels"));
}

TEST(HeaderCamera, OfALensAloneGetsItsPoseFromPInAPlane) {
  const Camera camera = turned_camera(kPlain);
  const Picture floor = take_picture(plane({}, {0, 0, 1}), camera, kPlain.data);
  HeaderNumbers header = vray_header(camera, kPlain.display);
  header.erase("cameraTransform");
  const Built built = build(with_header(gbuffer_of(floor), header, kPlain));
  expect_of(floor, built);
  EXPECT_EQ(built.report.header->proof, HeaderProof::lens);
  EXPECT_LT(built.report.residual->median_px, 0.01);
}

TEST(HeaderCamera, WithMatricesThatContradictEachOtherIsNoneForADepth) {
  const Camera camera = turned_camera(kPlain);
  Camera other = camera;
  other.origin += glm::dvec3(0.1, 0, 0);
  HeaderNumbers header = standard_header(camera, kPlain.display);
  header["worldToNDC"] = standard_header(other, kPlain.display).at("worldToNDC");
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  EXPECT_THAT(refusal_of(with_header(depth_of(picture), header, kPlain)),
              HasSubstr("worldToCamera and worldToNDC are not of one camera"));
}

TEST(HeaderCamera, OfAnUnlikelyLensIsNoneForADepth) {
  const Camera camera = turned_camera(kPlain);
  const GBuffer depth = depth_of(take_picture(still_life(), camera, kPlain.data));
  Camera wide = camera, aside = camera;
  wide.fx *= 1.05;
  aside.cx = 130;
  HeaderNumbers sheared = standard_header(camera, kPlain.display);
  sheared.erase("worldToCamera");
  std::vector<double>& to_ndc = sheared["worldToNDC"];
  for (std::size_t row = 0; row < 4; ++row) to_ndc[4 * row] += 0.02 * to_ndc[4 * row + 1];
  for (const HeaderNumbers& header :
       {standard_header(wide, kPlain.display), standard_header(aside, kPlain.display), sheared}) {
    EXPECT_THAT(refusal_of(with_header(depth, header, kPlain)), HasSubstr("give --fov DEGREES"));
  }
}

TEST(HeaderCamera, OfBlenderIsWrittenByItsScript) {
  GBuffer depth = depth_of(take_picture(still_life(), turned_camera(kPlain), kPlain.data));
  depth.by_blender = true;
  EXPECT_THAT(refusal_of(depth), HasSubstr("data/blender/export.py"));
}

TEST(HeaderCamera, OfALensThatNothingConfirmsIsUsedWithAWarning) {
  const Camera camera = turned_camera(kPlain);
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  HeaderNumbers header = vray_header(camera, kPlain.display);
  header["cameraAperture"] = {25};
  const Built built = build(with_header(depth_of(picture), header, kPlain));
  expect_of(picture, built);
  EXPECT_THAT(
      built.report.warnings,
      testing::Contains(HasSubstr("nothing proves that the lens has 40 degrees (cameraFov")));
  header["cameraProjection"] = {1};
  EXPECT_THROW(build(with_header(depth_of(picture), header, kPlain)), Error);
}

TEST(HeaderCamera, OfAnOrthographicViewNeedsBothMatrices) {
  const Camera lens = shifted(camera_from_ortho_width(5, kPlain.display, 1));
  const Camera camera = look_at(lens, {1.5, -4, 3}, {0, 0, 0.3}, {0.2, 0.1, 1});
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  HeaderNumbers header = standard_header(camera, kPlain.display);
  const Built built = build(with_header(depth_of(picture), header, kPlain));
  expect_of(picture, built);
  EXPECT_TRUE(built.geometry.camera.orthographic);
  header.erase("worldToCamera");
  EXPECT_THROW(build(with_header(depth_of(picture), header, kPlain)), Error);
}

TEST(HeaderCamera, OfUnrealIsARotatorInALeftHandedWorld) {
  for (const UnrealPose& pose :
       {UnrealPose{0, 0, 0, {-4, 0.3, 1.5}}, UnrealPose{-20, 30, 0, {-3, -2, 2.5}},
        UnrealPose{-25, -40, 35, {-3, 3, 3}}}) {
    const Camera camera = unreal_camera(pose, camera_from_fov(50, kPlain.display, 1));
    EXPECT_NEAR(glm::determinant(camera.rotation), -1, 1e-12);
    const glm::dmat3 rotation = rotation_of(UnrealRotation{pose.pitch, pose.yaw, pose.roll});
    for (int i = 0; i < 3; ++i) EXPECT_LT(glm::distance(rotation[i], camera.rotation[i]), 1e-12);
    const Picture picture = take_picture(still_life(), camera, kPlain.data);
    const HeaderNumbers header = unreal_header(pose, camera, kPlain.display);
    expect_of(picture, build(with_header(depth_of(picture), header, kPlain)));
    const Built in_world = build(with_header(gbuffer_of(picture), header, kPlain));
    ASSERT_TRUE(in_world.report.header);
    EXPECT_EQ(in_world.report.header->proof, HeaderProof::positions);
    EXPECT_THAT(in_world.report.warnings, IsEmpty());
  }
}

/// Camera space and the world are then one, which P alone cannot tell.
TEST(HeaderCamera, AtTheOriginMakesTheWorldKnown) {
  const Camera camera =
      look_at(shifted(camera_from_fov(40, kPlain.display, 1)), {0, 0, 0}, {0, 0, -1}, {0, 1, 0});
  const Surface scene = all_of({plane({0, 0, -6}, {0.3, 0, 1}), sphere({0.2, 0, -4}, 0.6)});
  const Picture picture = take_picture(scene, camera, kPlain.data);
  const HeaderNumbers header = standard_header(camera, kPlain.display);
  EXPECT_TRUE(build(with_header(gbuffer_of(picture), header, kPlain)).geometry.world_known);
  EXPECT_FALSE(build(with_header(gbuffer_of(picture), {}, kPlain)).geometry.world_known);
}

TEST(HeaderCamera, GivesWayToTheSpaceThatTheUserSays) {
  const Camera camera = turned_camera(kPlain);
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  const HeaderNumbers header = standard_header(camera, kPlain.display);
  GBuffer in_space = with_header(in_camera_space(picture, false), header, kPlain),
          in_world = with_header(gbuffer_of(picture), header, kPlain);
  in_space.space = Space::camera, in_world.space = Space::world;
  expect_of(picture, build(in_space));
  expect_of(picture, build(in_world));
  in_space.space = Space::world, in_world.space = Space::camera;
  for (const GBuffer& g : {in_space, in_world}) {
    const Built built = build(g);
    EXPECT_FALSE(built.report.header);
    EXPECT_EQ(built.geometry.world_known, g.space == Space::world);
  }
}

/// A camera that is turned by little against the world, and its depth with normals of the world.
struct SlightTurn {
  Camera camera;
  Picture picture;
  GBuffer depth;

  explicit SlightTurn(double yaw, double tilt) {
    const double y = glm::radians(yaw), t = std::tan(glm::radians(tilt));
    const glm::dvec3 eye(5 * std::sin(y), 0.6 + 5 * t, 5 * std::cos(y));
    camera = look_at(shifted(camera_from_fov(40, kPlain.display, 1)), eye, {0, 0.6, 0}, {0, 1, 0});
    picture = take_picture(all_of({plane({}, {0, 1, 0}), sphere({0.2, 0.6, 0}, 0.6)}), camera,
                           kPlain.data);
    depth = with_header(depth_of(picture), standard_header(camera, kPlain.display), kPlain);
    depth.normal = gbuffer_of(picture).normal;
  }

  /// About the axis z of the world.
  void turn_normals(float degrees) {
    const float c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
    for (glm::vec3& n : depth.normal.pixels) n = {c * n.x - s * n.y, s * n.x + c * n.y, n.z};
  }
};

TEST(HeaderCamera, IsProvedByNormalsOfAWorldThatIsTurnedByLittle) {
  for (const glm::dvec2& turn : {glm::dvec2(3, 0), {20, 0}, {0, 4}, {0, 9}, {0, 20}, {24, 7}}) {
    const SlightTurn frame(turn.x, turn.y);
    const Built built = build(frame.depth);
    expect_of(frame.picture, built);
    EXPECT_EQ(built.report.normal_space, "the world of the header") << turn.x << ' ' << turn.y;
    ASSERT_TRUE(built.report.header);
    EXPECT_EQ(built.report.header->proof, HeaderProof::normals);
    EXPECT_THAT(built.report.warnings, IsEmpty());
  }
}

/// Smooth normals may lean to one side by some degrees: no reason to doubt the pose.
TEST(HeaderCamera, StaysWhereNormalsLeanByLittle) {
  SlightTurn frame(40, 20);
  frame.turn_normals(2.5);
  const Built built = build(frame.depth);
  EXPECT_TRUE(built.geometry.world_known);
  EXPECT_THAT(built.report.warnings, IsEmpty());
}

TEST(HeaderCamera, IsNotJudgedByNormalsWhoseSpaceTheUserSays) {
  SlightTurn frame(40, 0);
  frame.turn_normals(30);
  EXPECT_THAT(build(frame.depth).report.warnings, ElementsAre(HasSubstr("of another world")));
  for (const Space space : {Space::world, Space::camera}) {
    frame.depth.space = space;
    const Built built = build(frame.depth);
    EXPECT_TRUE(built.geometry.world_known);
    EXPECT_EQ(built.report.normal_space, space == Space::world
                                             ? "the world of the header, by --space"
                                             : "camera space, by --space");
  }
}

TEST(HeaderCamera, GivesWayToOptions) {
  const Camera camera = turned_camera(kPlain);
  const Picture picture = take_picture(still_life(), camera, kPlain.data);
  const Built built =
      build(with_header(depth_of(picture), standard_header(camera, kPlain.display), kPlain),
            {{}, 60, {}});
  EXPECT_EQ(built.report.camera_source, "--fov 60");
  EXPECT_FALSE(built.report.header);
  EXPECT_NEAR(built.geometry.camera.hfov_degrees(96), 60, 1e-9);
}

}  // namespace
}  // namespace ssdo::test::metadata_test
