// SPDX-License-Identifier: Apache-2.0
//
// What pictures of back faces are worth, against rays through the scene.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "estimators/bitmask/request.h"
#include "support/frame_file.h"
#include "support/run_tool.h"
#include "support/slab_and_ball.h"

namespace ssdo::test::back_faces_test {
namespace {

using testing::ContainsRegex;
using testing::Not;

/// The ground beside and below a slab sees the sky under it.
TEST(BackFacesOfTheTool, OpenWhatIsBelowASlab) {
  const TempDir folder;
  const Camera camera = camera_of(kFrame);
  const std::string frame = write_view(folder / "frame.exr", scene(), camera, kFrame),
                    back = write_view(folder / "back.exr", backs(), camera, kFrame),
                    out = folder / "out.exr";
  const auto ao = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        frame, "-o",           out,     "--overwrite", "--products",
        "ao",  "--pixel-type", "float", "--quality",   "final"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished run = run_tool(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return channel(out, "ao.Y");
  };
  const auto rmse = [&](const Plane<float>& found) {
    double sum = 0;
    int count = 0;
    for (int y = 12; y < kFrame.height() - 12; y += 6) {
      for (int x = 12; x < kFrame.width() - 12; x += 6) {
        const Point p = point_at(scene(), camera, kFrame, x, y);
        if (p.position.z > 1e-6 || std::abs(p.position.x) > 1.6 || std::abs(p.position.y) > 1.6)
          continue;
        sum += std::pow(double(found(x, y)) - ao_by_rays(scene(), p, kNoLimit, 2048), 2);
        ++count;
      }
    }
    EXPECT_GT(count, 40);
    return std::sqrt(sum / count);
  };
  for (const std::string method : {"bitmask", "trace"}) {
    // By rules: with a learned prior, there is less to gain.
    const double alone = rmse(ao({"--method", method, "--prior", "rules"})),
                 known = rmse(ao({"--method", method, "--prior", "rules", "--also", back})),
                 thick = rmse(ao({"--method", method, "--thickness", "3"})),
                 given = rmse(ao({"--method", method, "--also", back, "--thickness", "3"}));
    fmt::print(
        "{}: RMSE {:.4f} alone, {:.4f} with back faces; {:.4f} and {:.4f} if a thickness is "
        "given too\n",
        method, alone, known, thick, given);
    EXPECT_LT(known, alone) << method;
    EXPECT_LT(known, method == "trace" ? 0.024 : 0.01) << method;
    EXPECT_LT(given, 0.5 * thick) << method << ": what is measured wins";
  }
  EXPECT_EQ(ao({"--also", back, "--threads", "1"}).pixels,
            ao({"--also", back, "--threads", "3"}).pixels);
  // They stay where --no-cast takes things out, here none.
  FramePart matte;
  matte.data = matte.display = kFrame;
  matte.channels["none.A"] = Plane<float>(kFrame.width(), kFrame.height(), 0.0f);
  write_frame(folder / "matte.exr", matte);
  const std::string none = (folder / "matte.exr").string() + ":none";
  EXPECT_EQ(ao({"--also", back, "--no-cast", none}).pixels, ao({"--also", back}).pixels);
  EXPECT_THAT(run_tool({"info", frame, "--also", back}).out,
              ContainsRegex("back.exr: back faces .* in [1-9][0-9]* pixels"));
  EXPECT_THAT(run_tool({"info", frame, "--also", frame}).out, Not(ContainsRegex("back faces")));
}

}  // namespace
}  // namespace ssdo::test::back_faces_test
