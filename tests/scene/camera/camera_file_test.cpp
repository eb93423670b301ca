// SPDX-License-Identifier: Apache-2.0
//
// What describes no camera is refused (issue 18). What `ssdo info` writes is read back in
// tests/cli/camera_file_test.cpp.
#include <gmock/gmock.h>

#include <fstream>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "scene/camera/camera.h"
#include "support/error_matchers.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::camera_file_test {
namespace {

using nlohmann::json;

class CameraFile : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_ / name; }
  Camera read(const std::string& text) const {
    std::ofstream(path("c.json")) << text;
    return read_camera(path("c.json"), {0, 0, 64, 48}, 1);
  }
  void expect_refused(const std::string& text, const std::string& says) const {
    EXPECT_THAT(error_of([&] { read(text); }), IsError(ExitCode::input, says)) << text;
  }
  static std::string with_matrix(const std::string& rows, const std::string& more = "") {
    return R"({"fx": 50, )" + more + R"("world_to_camera": )" + rows + "}";
  }
  TempDir dir_;
};

TEST_F(CameraFile, FieldsOfViewAndSizesAreThoseOfACamera) {
  for (const char* degrees : {"0", "-40", "180", "400", "1e308", "1e-307"})
    expect_refused(std::string(R"({"hfov_deg": )") + degrees + "}", "hfov_deg is ");
  for (const char* text : {R"({"hfov_deg": "40"})", R"({"hfov_deg": null})", R"({"fx": 1e999})",
                           R"({"fx": NaN})", "[]", "7", "", "{}", R"({"type": 3, "fx": 1})"})
    expect_refused(text, "");
  for (const char* width : {"0", "-3", "1e-307"})
    expect_refused(std::string(R"({"type": "ortho", "ortho_width": )") + width + "}",
                   "ortho_width is ");
  expect_refused(R"({"fx": 0})", "fx is 0");
  expect_refused(R"({"fx": 50, "fy": -50})", "fy is -50");
  expect_refused(R"({"fx": 50, "cx": 1e300})", "cx is ");
  EXPECT_NEAR(read(R"({"hfov_deg": 90})").fx, 32, 1e-9);
}

TEST_F(CameraFile, IsNoFolder) {
  EXPECT_THAT(error_of([&] {
                read_camera(dir_.path(), {0, 0, 64, 48}, 1);
              }),
              IsError(ExitCode::input, "camera file cannot be read"));
}

TEST_F(CameraFile, APoseIsARigidMatrixForColumnVectors) {
  expect_refused(with_matrix("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[1,2,3,1]]"),
                 "the last row of world_to_camera is 1 2 3 1, not 0 0 0 1");
  expect_refused(with_matrix("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]"), "the last row");
  expect_refused(with_matrix("[[1,0,0],[0,1,0],[0,0,1]]"), "four rows of four");
  expect_refused(with_matrix("[[1,0,0,0],[0,1,0,0]]"), "four rows of four");
  expect_refused(with_matrix("[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"), "four rows of four");
  expect_refused(with_matrix("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1],[0,0,0,1]]"),
                 "four rows of four");
  expect_refused(with_matrix("[[1,0,0,0],[0,1,0,0],[0,0,null,0],[0,0,0,1]]"), "");
  expect_refused(with_matrix("[[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]"), "scales or shears");
  EXPECT_NEAR(read(with_matrix("[[1,0,0,0],[0,1,0,0],[0,0,1,-5]]")).origin.z, 5, 1e-12)
      << "the last row may be missing";
}

TEST_F(CameraFile, AMirrorIsRefusedUnlessTheFileDeclaresIt) {
  const std::string mirror = "[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]";
  expect_refused(with_matrix(mirror), "mirrors (its determinant is -1)");
  expect_refused(with_matrix(mirror, R"("world_handedness": "right", )"), "mirrors");
  expect_refused(with_matrix(mirror, R"("world_handedness": "LEFT", )"), "use 'right' or 'left'");
  expect_refused(
      with_matrix("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]", R"("world_handedness": "left", )"),
      "does not mirror");
  EXPECT_NEAR(
      glm::determinant(read(with_matrix(mirror, R"("world_handedness": "left", )")).rotation), -1,
      1e-12);
}

}  // namespace
}  // namespace ssdo::test::camera_file_test
