// SPDX-License-Identifier: Apache-2.0
//
// An output that keeps the channels of its input is an input again, and shows the same picture.
#include <gmock/gmock.h>

#include "support/frame_file.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::rerun_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

/// Ground and a ball with a beauty in the layer `beauty` and its ambient part in Sky.
FramePart rendered(const std::string& beauty) {
  FramePart part = frame_of(small_picture(), "");
  part.add("Sky", Plane<glm::vec3>(64, 48, {0.5f, 0.25f, 0.125f}), "RGB");
  const std::string layer = beauty.empty() ? "" : beauty + ".";
  for (const auto& [name, value] : {std::pair{"R", 1.0f}, {"G", 0.75f}, {"B", 0.5f}, {"A", 1.0f}})
    part.channels[layer + name] = Plane<float>(64, 48, value);
  return part;
}

class Rerun : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_ / name; }

  Finished run(const std::string& in, const std::string& out, const Words& flags = {}) const {
    const Finished done =
        run_tool(Words{path(in), "-o", path(out), "--aov", "ambient=Sky", "--quality", "draft",
                       "--keep-channels", "--pixel-type", "float", "-v"} +
                 flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return done;
  }

  Plane<float> of(const std::string& file, const std::string& name, int part = 0) const {
    return channel(path(file), name, part);
  }

  void expect_same_channels(const std::string& a, const std::string& b) const {
    const ExrReader file(path(a));
    for (const ExrPart& part : file.parts()) {
      const auto names = channel_names(path(a), part.index);
      ASSERT_EQ(names, channel_names(path(b), part.index));
      for (const std::string& name : names)
        EXPECT_TRUE(of(a, name, part.index).pixels == of(b, name, part.index).pixels)
            << name << " of part " << part.index;
    }
  }

  /// Runs three times, each time on the last output.
  void expect_same_thrice(const Words& flags = {}) const {
    run("in.exr", "once.exr", flags);
    run("once.exr", "twice.exr", flags);
    run("twice.exr", "thrice.exr", flags);
    expect_same_channels("once.exr", "twice.exr");
    expect_same_channels("twice.exr", "thrice.exr");
  }

  TempDir dir_;
};

TEST_F(Rerun, OccludesTheRenderAndNotTheCompositeOfBefore) {
  write_frame(path("in.exr"), rendered(""));
  for (const char* compose : {"occlude", "add"}) {
    const Words flags = {"--compose", compose, "--overwrite"};
    expect_same_thrice(flags);
    EXPECT_TRUE(of("thrice.exr", "input.R").pixels == of("in.exr", "R").pixels);
    EXPECT_FALSE(of("thrice.exr", "R").pixels == of("in.exr", "R").pixels);
  }
  EXPECT_THAT(run("once.exr", "twice.exr", {"--overwrite"}).err,
              HasSubstr("an earlier run of ssdo made A, B, G, R"));
  EXPECT_THAT(run("in.exr", "once.exr", {"--overwrite"}).err, Not(HasSubstr("earlier run")));
}

/// The composite stands beside the beauty, under the name that a beauty has in other files.
TEST_F(Rerun, OccludesABeautyOfAnotherName) {
  write_frame(path("in.exr"), rendered("Combined"));
  expect_same_thrice();
  EXPECT_THAT(channel_names(path("thrice.exr")), Not(Contains("input.R")))
      << "the composite of before is no layer of the render";
}

TEST_F(Rerun, OccludesABeautyInAnotherPart) {
  FramePart all = rendered(""), beauty = all, data = all;
  beauty.name = "rgba", data.name = "P";
  for (const auto& [name, pixels] : all.channels)
    (name.size() == 1 && name != "Z" ? data : beauty).channels.erase(name);
  write_frame(path("in.exr"), {beauty, data});
  expect_same_thrice();
}

TEST_F(Rerun, OccludesAnAmbientLayerAlone) {
  FramePart part = rendered("");
  for (const char* name : {"R", "G", "B", "A"}) part.channels.erase(name);
  write_frame(path("in.exr"), part);
  expect_same_thrice();
}

TEST_F(Rerun, LosesNoLayerThatIsCalledInput) {
  FramePart part = rendered("");
  part.add("input", Plane<glm::vec3>(64, 48, glm::vec3(0.0625f)), "RGB");
  write_frame(path("in.exr"), part);
  expect_same_thrice();
  for (const char* name : {"R", "G", "B"}) {
    const std::string own = std::string("input.") + name;
    EXPECT_TRUE(of("thrice.exr", own).pixels == of("in.exr", own).pixels);
    EXPECT_TRUE(of("thrice.exr", "input." + own).pixels == of("in.exr", name).pixels);
  }
  EXPECT_TRUE(of("thrice.exr", "input.A").pixels == of("in.exr", "A").pixels);
}

TEST_F(Rerun, KeepsTheRenderWhereTheFirstRunMadeNoComposite) {
  write_frame(path("in.exr"), rendered(""));
  run("in.exr", "once.exr", {"--products", "ao"});
  run("once.exr", "twice.exr");
  run("in.exr", "at_once.exr");
  EXPECT_TRUE(of("twice.exr", "R").pixels == of("at_once.exr", "R").pixels);
  EXPECT_TRUE(of("twice.exr", "input.R").pixels == of("in.exr", "R").pixels);
  run("twice.exr", "thrice.exr", {"--products", "ao"});
  EXPECT_TRUE(of("thrice.exr", "input.R").pixels == of("in.exr", "R").pixels);
  run("thrice.exr", "last.exr");
  EXPECT_TRUE(of("last.exr", "R").pixels == of("at_once.exr", "R").pixels)
      << "R is still known as a product of the second run";
}

/// A request names the layer of the render, or else the product.
TEST_F(Rerun, TakesRequestsForTheLayersOfTheRender) {
  FramePart part = rendered("");
  part.add("direct", Plane<glm::vec3>(64, 48, glm::vec3(0.25f)), "RGB");
  write_frame(path("in.exr"), part);
  run("in.exr", "once.exr");
  const auto layer = [&](const std::string& request, const std::string& role) {
    const Finished done = run_tool({"info", path("once.exr"), "--aov", role + "=" + request});
    EXPECT_EQ(done.code, 0) << done.err;
    return done.out;
  };
  EXPECT_THAT(layer("direct", "radiance"), HasSubstr("input.direct.R"));
  EXPECT_THAT(layer("input.direct", "radiance"), HasSubstr("input.direct.R"));
  EXPECT_THAT(layer("rgba", "beauty"), HasSubstr("input.R, input.G"));
  EXPECT_THAT(layer("input", "beauty"), HasSubstr("input.R, input.G"));
  EXPECT_THAT(layer("ao.Y", "roughness"), HasSubstr("ao.Y"));
  EXPECT_THAT(layer("A", "alpha"), HasSubstr("input.A"));
}

}  // namespace
}  // namespace ssdo::test::rerun_test
