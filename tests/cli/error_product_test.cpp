// SPDX-License-Identifier: Apache-2.0
//
// The product `error` against what it estimates, on real frames (issue 12, 19): the distance of
// direct + bounce from what very many slices and steps give through the same filter. Frames are
// every fourth pixel of those in data/, in a row and in a column, in light from everywhere alike
// and in that of a sky with a sun, 3.5 degrees wide.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "math/luminance.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::error_product_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr int kEvery = 4;

/// Factor by which the product may be off, both ways.
constexpr double kMost = 2;

void write_smaller(const std::string& from, const std::string& to) {
  FramePart part;
  for (const char* name : {"Position.X", "Position.Y", "Position.Z", "Normal.X", "Normal.Y",
                           "Normal.Z", "DiffCol.R", "DiffCol.G", "DiffCol.B", "Depth.Z"}) {
    const std::string full = std::string("ViewLayer.") + name;
    const Plane<float> all = channel(from, full);
    Plane<float> some(all.width / kEvery, all.height / kEvery);
    for (int y = 0; y < some.height; ++y)
      for (int x = 0; x < some.width; ++x)
        some(x, y) = all(kEvery * x + kEvery / 2, kEvery * y + kEvery / 2);
    part.data = part.display = {0, 0, some.width, some.height};
    part.channels[full] = some;
  }
  write_frame(to, part);
}

/// What a run has written.
struct Lit {
  Plane<float> brightness, error;  ///< error may be empty
  json statistics;
  std::string messages;
};

const std::vector<std::string> kConstant = {"--env", "1,0.8,0.6"};
const std::vector<std::string> kSky = {"--env", data("environments/sky.exr"), "--env-up", "z"};

/// A frame and the flags of its light.
struct Shown {
  std::string frame, light;
  const std::vector<std::string>& flags;
};

class ErrorProduct : public testing::TestWithParam<Shown> {
 protected:
  ErrorProduct() {
    write_smaller(data(GetParam().frame + ".exr"), path("in.exr"));
    surfaces_ = channel(path("in.exr"), "ViewLayer.Depth.Z");
    for (float& depth : surfaces_.pixels) depth = depth < 1e9f;
  }

  std::string path(const std::string& name) const { return dir_ / name; }

  Lit run(std::vector<std::string> flags, bool with_error = true) const {
    flags.insert(flags.begin(), GetParam().flags.begin(), GetParam().flags.end());
    flags.insert(
        flags.begin(),
        {path("in.exr"), "-o", path("out.exr"), "--overwrite", "--pixel-type", "float", "--stats",
         path("stats.json"), "--products", with_error ? "direct,bounce,error" : "direct,bounce"});
    const Finished done = run_tool(flags);
    EXPECT_EQ(done.code, 0) << done.err;
    Lit lit;
    lit.brightness = Plane<float>(surfaces_.width, surfaces_.height, 0.0f);
    for (const std::string product : {"direct", "bounce"}) {
      const Plane<float> r = channel(path("out.exr"), product + ".R"),
                         g = channel(path("out.exr"), product + ".G"),
                         b = channel(path("out.exr"), product + ".B");
      for (std::size_t i = 0; i < r.size(); ++i)
        lit.brightness[i] += luminance(glm::vec3(r[i], g[i], b[i]));
    }
    if (with_error) lit.error = channel(path("out.exr"), "error.Y");
    lit.statistics = parse_json(read_file(path("stats.json")))[0];
    lit.messages = done.err;
    return lit;
  }

  Lit limit(const std::string& filter) const {
    return run({"--slices", "16", "--steps", "128", "--seed", "5", "--filter", filter}, false);
  }

  double rms(const Plane<float>& plane) const {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < plane.size(); ++i) {
      if (surfaces_[i] == 0) continue;
      sum += double(plane[i]) * double(plane[i]);
      count += 1;
    }
    return std::sqrt(sum / count);
  }

  double rms_difference(const Lit& a, const Lit& b) const {
    Plane<float> difference = a.brightness;
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= b.brightness[i];
    return rms(difference);
  }

 private:
  TempDir dir_;
  Plane<float> surfaces_;  ///< 1 there, else 0
};

TEST_P(ErrorProduct, IsTheDistanceFromTheLimit) {
  const Lit converged = limit("geometry");
  for (const std::string quality : {"draft", "standard", "final"}) {
    const Lit lit = run({"--quality", quality});
    const double said = rms(lit.error), found = rms_difference(lit, converged);
    fmt::print("{:<9} error {:.4f}, limit is off by {:.4f}: {:.2f}\n", quality, said, found,
               said / found);
    EXPECT_NEAR(lit.statistics["error"]["rms"], said, 1e-4 * said);
    EXPECT_GT(said / found, 1 / kMost) << quality;
    EXPECT_LT(said / found, kMost) << quality;
  }
}

/// The part of it that is noise is what other seeds change.
TEST_P(ErrorProduct, HasTheNoiseThatOtherSeedsHave) {
  const std::vector<std::pair<std::string, std::string>> settings = {
      {"geometry", "2"}, {"geometry", "12"}, {"none", "6"}};
  for (const auto& [filter, slices] : settings) {
    const auto with_seed = [&, filter = filter, slices = slices](const char* seed,
                                                                 bool with_error) {
      return run({"--slices", slices, "--filter", filter, "--seed", seed}, with_error);
    };
    const Lit one = with_seed("1", true), other = with_seed("70", false);
    const double said = one.statistics["error"]["noise"],
                 found = rms_difference(one, other) / std::sqrt(2.0);
    fmt::print("{} {:>2} slices: noise {:.4f}, seeds differ by {:.4f}: {:.2f}\n", filter, slices,
               said, found, said / found);
    EXPECT_GT(said / found, 1 / kMost) << filter << " " << slices;
    EXPECT_LT(said / found, kMost) << filter << " " << slices;
  }
}

/// --error E stops where the true error is within a factor of 2 of E.
TEST_P(ErrorProduct, IsReachedWhereItIsAskedFor) {
  const Lit usual = run({}), converged = limit("geometry");
  const double wanted = 0.5 * rms(usual.error);
  const Lit lit = run({"--error", std::to_string(wanted)});
  const double found = rms_difference(lit, converged);
  fmt::print("--error {:.4f}: {} slices x {} steps, off by {:.4f}\n", wanted,
             lit.statistics["plan"]["slices"].get<int>(),
             lit.statistics["plan"]["steps"].get<int>(), found);
  EXPECT_LE(rms(lit.error), wanted);
  EXPECT_LT(found, 2 * wanted);
  EXPECT_GT(found, wanted / kMost);
  EXPECT_EQ(lit.messages, "");
}

INSTANTIATE_TEST_SUITE_P(, ErrorProduct,
                         testing::Values(Shown{"still_life", "constant", kConstant},
                                         Shown{"still_life", "sky", kSky},
                                         Shown{"room_corner", "sky", kSky}),
                         [](const auto& shown) {
                           return shown.param.frame + "_" + shown.param.light;
                         });

/// What cannot be reached ends at the most slices and steps, with a warning.
TEST(ErrorThatCannotBeReached, EndsWithAWarning) {
  const TempDir dir;
  const Window window{0, 0, 24, 16};
  write_frame(dir / "in.exr", frame_of(small_picture(window, window)));
  const std::string stats = dir / "stats.json";
  const Finished done = run_tool({dir / "in.exr", "-o", dir / "out.exr", "--products", "direct",
                                  "--bounces", "0", "--error", "1e-9", "--stats", stats});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.error_line(), testing::StartsWith("ssdo: ")) << "it is said once";
  EXPECT_THAT(done.error_line(), HasSubstr("warning: --error 1e-09 is not reached"));
  const json plan = parse_json(read_file(stats))[0]["plan"];
  EXPECT_EQ(plan["slices"], 64);
  EXPECT_EQ(plan["steps"], 128);
}

}  // namespace
}  // namespace ssdo::test::error_product_test
