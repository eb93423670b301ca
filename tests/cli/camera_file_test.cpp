// SPDX-License-Identifier: Apache-2.0
//
// A camera that `ssdo info --json` writes is read back by --camera.
#include <gtest/gtest.h>

#include <fstream>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "scene/camera/camera.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::camera_file_test {
namespace {

using nlohmann::json;

/// P in a left-handed space fits a camera that mirrors, and so does its file.
TEST(CameraOfInfo, ComesBack) {
  const TempDir dir;
  for (const bool left : {false, true}) {
    Picture picture = small_picture();
    for (std::size_t i = 0; left && i < picture.position.size(); ++i) {
      picture.position[i].z *= -1;
      picture.normal[i].z *= -1;
    }
    write_frame(dir / "in.exr", frame_of(picture));
    const Finished told = run_tool({"info", dir / "in.exr", "--json"});
    ASSERT_EQ(told.code, 0) << told.err;
    const json camera = parse_json(told.out)["camera"];
    EXPECT_EQ(camera["world_handedness"], left ? "left" : "right");
    std::ofstream(dir / "c.json") << camera.dump();
    const Camera back = read_camera(dir / "c.json", {0, 0, 64, 48}, 1);
    EXPECT_NEAR(back.fx, camera["fx"].get<double>(), 1e-9);
    EXPECT_NEAR(glm::determinant(back.rotation), left ? -1 : 1, 1e-3);
    EXPECT_EQ(
        run_tool({dir / "in.exr", "-o", dir / "out.exr", "--overwrite", "--camera", dir / "c.json"})
            .code,
        0);
  }
}

}  // namespace
}  // namespace ssdo::test::camera_file_test
