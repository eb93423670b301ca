// SPDX-License-Identifier: Apache-2.0
//
// A beauty whose ambient layer was rendered without occlusion, and the composite that occludes it,
// against the path-traced picture: the sky's light with its shadows, and the lamp of the beauty.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::shaded_beauty_test {
namespace {

using Channels = std::array<Plane<float>, 3>;

Channels channels(const std::filesystem::path& path, const std::string& layer) {
  return {channel(path, layer + "R"), channel(path, layer + "G"), channel(path, layer + "B")};
}

/// The picture with the light that the path tracer found.
Channels path_traced() {
  const std::string beauty_file = data("still_life_beauty.exr");
  Channels picture = channels(beauty_file, "Combined.");
  const Channels ambient = channels(beauty_file, "Ambient."),
                 albedo = channels(data("still_life.exr"), "ViewLayer.DiffCol."),
                 direct = channels(data("truth/still_life/env_direct.exr"), "ViewLayer.DiffDir.");
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < picture[c].size(); ++i)
      picture[c][i] += albedo[c][i] * direct[c][i] - ambient[c][i];
  }
  return picture;
}

/// How far the composite is from `expected`, over surfaces, relative to the mean there.
double error_of_composite(const Channels& expected, const std::vector<std::string>& light) {
  const TempDir dir;
  const std::string beauty_file = data("still_life_beauty.exr");
  std::vector<std::string> flags = {data("still_life.exr"),
                                    "-o",
                                    dir / "out.exr",
                                    "--products",
                                    "composite",
                                    "--aov",
                                    "beauty=" + beauty_file + ":Combined",
                                    "--aov",
                                    "ambient=" + beauty_file + ":Ambient"};
  flags.insert(flags.end(), light.begin(), light.end());
  const Finished done = run_tool(flags);
  EXPECT_EQ(done.code, 0) << done.err;
  const Channels found = channels(dir / "out.exr", "");
  const Plane<float> depth = channel(data("still_life.exr"), "ViewLayer.Depth.Z");
  double square = 0, sum = 0, count = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < depth.size(); ++i) {
      if (depth[i] > 1e9f) continue;
      square += std::pow(double(found[c][i]) - double(expected[c][i]), 2);
      sum += double(expected[c][i]), count += 1;
    }
  }
  return std::sqrt(square / count) / (sum / count);
}

TEST(ShadedBeauty, SharesByChannelAreNearerToThePathTracerThanAo) {
  const Channels expected = path_traced();
  const double by_channel = error_of_composite(expected, {"--env", data("environments/sky.exr")}),
               by_ao = error_of_composite(expected, {});
  fmt::print("relative RMSE {:.3f} by channel, {:.3f} by ao\n", by_channel, by_ao);
  EXPECT_LT(by_channel, 0.13);
  EXPECT_GT(by_ao, 2 * by_channel);
}

}  // namespace
}  // namespace ssdo::test::shaded_beauty_test
