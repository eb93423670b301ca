// SPDX-License-Identifier: Apache-2.0
//
// The product reflection through the binary: where roughness comes from, and who makes it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "estimators/bitmask/request.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::reflection_test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// The frame with layers of one value for every pixel.
void write_with(const TempDir& dir, const std::map<std::string, float>& layers) {
  const Picture picture = small_picture();
  FramePart part = frame_of(picture);
  for (const auto& [name, value] : layers)
    part.channels[name] = Plane<float>(picture.window.width(), picture.window.height(), value);
  write_frame(dir / "in.exr", part);
}

Plane<float> reflection_of(const TempDir& dir, std::vector<std::string> flags) {
  flags.insert(flags.begin(), {dir / "in.exr", "-o", dir / "out.exr", "--overwrite", "--pixel-type",
                               "float", "--method", "gtao", "--products", "reflection"});
  const Finished done = run_tool(flags);
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(channel_names(dir / "out.exr"), testing::ElementsAre("reflection.Y"));
  return channel(dir / "out.exr", "reflection.Y");
}

TEST(ReflectionProduct, RoughnessComesFromALayerOrFromTheParameter) {
  const TempDir dir;
  write_with(dir, {{"gloss.Y", 0.9f}});
  const Plane<float> smooth = reflection_of(dir, {"--set", "roughness=0.2"}),
                     rough = reflection_of(dir, {"--set", "roughness=0.9"});
  EXPECT_NE(smooth.pixels, rough.pixels);
  EXPECT_EQ(reflection_of(dir, {"--aov", "roughness=gloss"}).pixels, rough.pixels);
  write_with(dir, {{"specular_roughness.Y", 0.2f}});
  EXPECT_EQ(reflection_of(dir, {}).pixels, smooth.pixels) << "found by its name";
}

TEST(ReflectionProduct, IsAmongAllProductsOnlyWhereRoughnessIsKnown) {
  const TempDir dir;
  const auto products = [&] {
    const Finished done =
        run_tool({"info", dir / "in.exr", "--method", "gtao", "--products", "all", "--json"});
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(done.out)["plan"]["products"].get<std::vector<std::string>>();
  };
  write_with(dir, {});
  EXPECT_THAT(products(), Not(Contains("reflection")));
  write_with(dir, {{"roughness", 0.4f}});
  EXPECT_THAT(products(), Contains("reflection"));
}

TEST(ReflectionProduct, ThePlanSaysWhichRoughness) {
  const TempDir dir;
  write_with(dir, {});
  const Finished done = run_tool({"info", dir / "in.exr", "--method", "gtao", "--products",
                                  "reflection", "--set", "roughness=0.3"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("roughness 0.3 everywhere"));
}

TEST(ReflectionProduct, OtherMethodsSayWhoMakesItAndDoNotCareAboutRoughness) {
  const TempDir dir;
  write_with(dir, {{"base.roughness", 0.2f}, {"coat.roughness", 0.4f}});
  const Finished refused =
      run_tool({"info", dir / "in.exr", "--method", "ssao", "--products", "ao,reflection"});
  EXPECT_EQ(refused.code, 4);
  write_with(dir, {{"base.roughness", 0.2f}});
  const Finished not_made =
      run_tool({"info", dir / "in.exr", "--method", "ssao", "--products", "reflection"});
  EXPECT_EQ(not_made.code, 2);
  EXPECT_THAT(not_made.error_line(), HasSubstr("these do: bitmask, trace, gtao"));
  write_with(dir, {{"base.roughness", 0.2f}, {"coat.roughness", 0.4f}});
  EXPECT_EQ(run_tool({"info", dir / "in.exr"}).code, 0) << "two layers are no matter here";
  const Finished unclear = run_tool({"info", dir / "in.exr", "--products", "reflection"});
  EXPECT_EQ(unclear.code, 4);
  EXPECT_THAT(unclear.error_line(), HasSubstr("--aov roughness=LAYER"));
}

/// A floor at the foot of a wall: of what a mirror at the foot shows of the wall nothing is open.
TEST(ReflectionProduct, BitmaskIsTrace) {
  const TempDir dir;
  const Window window{0, 0, 96, 72};
  const Picture picture =
      take_picture(floor_and_wall(), tilted(camera_from_fov(50, window, 1), 50), window);
  write_frame(dir / "in.exr", frame_of(picture));
  const auto reflection = [&](const std::string& method, const std::string& roughness) {
    std::vector<std::string> flags = {dir / "in.exr", "-o",         dir / "out.exr",
                                      "--overwrite",  "--products", "reflection",
                                      "--radius",     "1",          "--method",
                                      method,         "--set",      "roughness=" + roughness};
    if (method == "trace") flags.insert(flags.end(), {"--set", "samples=256", "--filter", "none"});
    const Finished done = run_tool(flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return channel(dir / "out.exr", "reflection.Y");
  };
  for (const std::string roughness : {"0.2", "0.7"}) {
    const Plane<float> fast = reflection("bitmask", roughness),
                       exact = reflection("trace", roughness);
    double square = 0, bias = 0, mean = 0;
    for (std::size_t i = 0; i < fast.size(); ++i) {
      const double difference = double(fast[i]) - double(exact[i]);
      square += difference * difference / double(fast.size());
      bias += difference / double(fast.size()), mean += double(exact[i]) / double(fast.size());
    }
    fmt::print("roughness {}: RMSE {:.4f}, bias {:+.4f}, mean {:.3f}\n", roughness,
               std::sqrt(square), bias, mean);
    EXPECT_LT(std::abs(bias), 0.02) << roughness;
    // The filter blurs the edges of what is mirrored.
    EXPECT_LT(std::sqrt(square), 0.1) << roughness;
    EXPECT_LT(mean, 0.95) << roughness;
  }
}

}  // namespace
}  // namespace ssdo::test::reflection_test
