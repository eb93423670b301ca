// SPDX-License-Identifier: Apache-2.0
//
// The product specular through the binary: where F0 comes from, what the plan says, and what the
// composites do with it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <map>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::specular_test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

using Values = decltype(Plane<float>::pixels);

class SpecularProduct : public testing::Test {
 protected:
  void write_with(const std::map<std::string, float>& layers) {
    const Picture picture = small_picture();
    FramePart part = frame_of(picture);
    for (const auto& [name, value] : layers)
      part.channels[name] = Plane<float>(picture.window.width(), picture.window.height(), value);
    write_frame(dir_ / "in.exr", part);
  }

  Finished made(std::vector<std::string> flags) {
    flags.insert(flags.begin(),
                 {dir_ / "in.exr", "-o", dir_ / "out.exr", "--overwrite", "--pixel-type", "float"});
    const Finished done = run_tool(flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return done;
  }

  Values of(const std::string& name) { return channel(dir_ / "out.exr", name).pixels; }

  Values red(std::vector<std::string> flags) {
    // A filter looks at all channels of a share.
    flags.insert(flags.end(), {"--products", "specular", "--filter", "none"});
    made(flags);
    EXPECT_THAT(channel_names(dir_ / "out.exr"),
                testing::ElementsAre("specular.B", "specular.G", "specular.R"));
    return of("specular.R");
  }

  TempDir dir_;
};

TEST_F(SpecularProduct, TheColourComesFromALayerOrAnIndexOfRefraction) {
  write_with({{"tint.R", 1}, {"tint.G", 0.04f}, {"tint.B", 0}, {"grey.Y", 1}});
  const Values glass = red({}), metal = red({"--set", "ior=1e6"});
  EXPECT_NE(glass, metal);
  const Values tinted = red({"--aov", "specular-color=tint"});
  const Values green = of("specular.G"), blue = of("specular.B");
  ASSERT_EQ(tinted.size(), metal.size());
  for (std::size_t i = 0; i < tinted.size(); ++i) {
    ASSERT_NEAR(tinted[i], metal[i], 1e-4f);
    ASSERT_NEAR(green[i], glass[i], 1e-4f);
    ASSERT_LE(blue[i], green[i]);
  }
  EXPECT_THAT(red({"--aov", "specular-color=grey"}),
              testing::Pointwise(testing::FloatNear(1e-4f), metal));
  EXPECT_NE(red({"--set", "roughness=0.9"}), glass);
}

TEST_F(SpecularProduct, IsAmongAllProductsOnlyWhereRoughnessIsKnown) {
  const auto products = [&] {
    const Finished done = run_tool({"info", dir_ / "in.exr", "--products", "all", "--json"});
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(done.out)["plan"]["products"].get<std::vector<std::string>>();
  };
  write_with({});
  EXPECT_THAT(products(), Not(Contains("specular")));
  write_with({{"roughness", 0.4f}});
  EXPECT_THAT(products(), Contains("specular"));
}

TEST_F(SpecularProduct, IsPartOfTheCompositeIfProductsNamesIt) {
  write_with({{"roughness", 0.3f}, {"beauty.R", 0.2f}, {"beauty.G", 0.2f}, {"beauty.B", 0.2f}});
  for (const char* compose : {"relight", "add"}) {
    made({"--products", "composite,direct,bounce,specular", "--compose", compose});
    const Values with = of("R"), specular = of("specular.R");
    const Finished without = made({"--products", "all", "--compose", compose});
    const Values diffuse = of("R");
    double most = 0;
    for (std::size_t i = 0; i < with.size(); ++i) {
      ASSERT_NEAR(with[i], diffuse[i] + specular[i], 1e-5f) << compose;
      most = std::max(most, double(specular[i]));
    }
    EXPECT_GT(most, 0.01);
  }
  const Finished done = run_tool({"info", dir_ / "in.exr", "--products", "composite,specular"});
  EXPECT_THAT(done.out, HasSubstr("albedo (direct + bounce) + specular, which --products names"));
}

TEST_F(SpecularProduct, ThePlanSaysWhatMirrors) {
  write_with({});
  const Finished done =
      run_tool({"info", dir_ / "in.exr", "--products", "specular", "--set", "roughness=0.3"});
  EXPECT_THAT(done.out, HasSubstr("specular: roughness 0.3 everywhere"));
  EXPECT_THAT(done.out, HasSubstr("specular: index of refraction 1.5 everywhere"));
  const Finished other =
      run_tool({"info", dir_ / "in.exr", "--method", "gtao", "--products", "specular"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.error_line(),
              HasSubstr("method gtao makes no specular; these do: bitmask, trace"));
}

}  // namespace
}  // namespace ssdo::test::specular_test
