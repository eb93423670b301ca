// SPDX-License-Identifier: Apache-2.0
//
// The scalar build of the march is the reference of the vector builds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/chosen_isa.h"
#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::isa_test {
namespace {

const std::vector<std::string> kChannels = {"ao.Y",     "direct.R", "direct.G", "direct.B",
                                            "bounce.R", "bounce.G", "bounce.B"};

/// Runs the tool on an instruction set; gives its output, empty where the machine lacks it.
std::string relight(const TempDir& dir, const std::string& isa) {
  const std::string out = dir / (isa + ".exr");
  const Finished done = run_tool(
      {data("room_corner.exr"), "-o", out, "--method", "bitmask", "--filter", "none", "--env",
       data("environments/studio.exr"), "--products", "ao,direct,bounce", "--pixel-type", "float"},
      {.variables = {{"SSDO_ISA", isa}}});
  if (done.err.find("lacks") != std::string::npos) return "";
  EXPECT_EQ(done.code, 0) << done.err;
  return out;
}

class BitmaskIsa : public testing::TestWithParam<std::string> {};

TEST_P(BitmaskIsa, GivesWhatTheScalarBuildGives) {
  if (!has_isa("scalar")) GTEST_SKIP() << "a build for one instruction set";
  const TempDir dir;
  const std::string vector = relight(dir, GetParam());
  if (vector.empty()) return fmt::print("this machine lacks {}\n", GetParam());
  const std::string scalar = relight(dir, "scalar");
  for (const std::string& name : kChannels) {
    const Plane<float> a = channel(scalar, name), b = channel(vector, name);
    double sum2 = 0, worst = 0, mean = 0;
    std::size_t off = 0;
    for (std::size_t i = 0; i < a.size(); ++i) mean += a[i] / double(a.size());
    // Light in units of its mean.
    const double unit = name == "ao.Y" ? 1 : mean;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double error = std::abs(a[i] - b[i]) / unit;
      sum2 += error * error;
      off += error > 0.02;
      worst = std::max(worst, error);
    }
    const double rmse = std::sqrt(sum2 / double(a.size())),
                 within = 1 - double(off) / double(a.size());
    fmt::print("{} against scalar, {:<8} RMSE {:.1e}, {:.3f} % within 0.02, at most {:.2e}\n",
               GetParam(), name, rmse, 100 * within, worst);
    // A sector that rounds differently has another first sender, which may be much brighter.
    const bool bounce = name.starts_with("bounce");
    EXPECT_LT(rmse, bounce ? 4e-3 : 2.5e-3) << name;
    EXPECT_GE(within, bounce ? 0.995 : 0.998) << name;
    EXPECT_GT(mean, 0) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Vectors, BitmaskIsa,
                         testing::ValuesIn(std::vector<std::string>(std::begin(kVectorIsas),
                                                                    std::end(kVectorIsas))),
                         [](const auto& isa) { return isa.param; });

TEST(BitmaskIsaNames, OthersAreRefused) {
  const TempDir dir;
  const Finished done = run_tool({data("room_corner.exr"), "-o", dir / "out.exr"},
                                 {.variables = {{"SSDO_ISA", "sse9"}}});
  EXPECT_EQ(done.code, 2) << done.err;
  EXPECT_NE(done.err.find("SSDO_ISA"), std::string::npos) << done.err;
}

}  // namespace
}  // namespace ssdo::test::isa_test
