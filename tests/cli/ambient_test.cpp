// SPDX-License-Identifier: Apache-2.0
//
// A composite that darkens only the ambient part of a render.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A frame whose surfaces have a lamp's light of 2 and an ambient part of 0.5, 0.25 and 0.125.
FramePart rendered(const Picture& picture, float alpha) {
  FramePart part = frame_of(picture);
  const int w = picture.window.width(), h = picture.window.height();
  Plane<glm::vec3> ambient(w, h), beauty(w, h);
  Plane<float> coverage(w, h);
  for (std::size_t i = 0; i < ambient.size(); ++i) {
    if (!picture.valid[i]) continue;
    ambient[i] = alpha * glm::vec3(0.5f, 0.25f, 0.125f);
    beauty[i] = alpha * glm::vec3(2) + ambient[i];
    coverage[i] = alpha;
  }
  part.add("ViewLayer.Combined", beauty, "RGB");
  part.channels["ViewLayer.Combined.A"] = coverage;
  part.add("ViewLayer.Sky", ambient, "RGB");
  return part;
}

Finished relight(const TempDir& dir, const FramePart& part, std::vector<std::string> flags = {}) {
  write_frame(dir / "in.exr", part);
  flags.insert(flags.begin(), {dir / "in.exr", "-o", dir / "out.exr", "--overwrite", "--pixel-type",
                               "float", "--aov", "ambient=ViewLayer.Sky"});
  return run_tool(flags);
}

/// What each surface of the composite is expected to be, premultiplied.
void expect_composite(const TempDir& dir, const Picture& picture, float lamp, float alpha) {
  const Plane<float> ao = channel(dir / "out.exr", "ao.Y");
  const glm::vec3 ambient(0.5f, 0.25f, 0.125f);
  float darkest = 1;
  for (int c = 0; c < 3; ++c) {
    const Plane<float> composite = channel(dir / "out.exr", std::string(1, "RGB"[c]));
    for (std::size_t i = 0; i < ao.size(); ++i) {
      const float expected = picture.valid[i] ? alpha * (lamp + ao[i] * ambient[c]) : 0.0f;
      EXPECT_NEAR(composite[i], expected, 1e-6f);
      darkest = std::min(darkest, ao[i]);
    }
  }
  EXPECT_LT(darkest, 0.8f) << "nothing is occluded";
}

TEST(Ambient, OnlyTheAmbientPartOfABeautyIsOccluded) {
  const TempDir dir;
  const Picture picture = small_picture();
  for (const float alpha : {1.0f, 0.5f}) {
    const Finished done = relight(dir, rendered(picture, alpha));
    ASSERT_EQ(done.code, 0) << done.err;
    expect_composite(dir, picture, 2, alpha);
  }
}

TEST(Ambient, IsTheWholeCompositeWithoutABeautyAndNeedsNoAlbedo) {
  const TempDir dir;
  const Picture picture = small_picture();
  FramePart part = rendered(picture, 1);
  std::erase_if(part.channels, [](const auto& item) {
    return item.first.starts_with("ViewLayer.Combined.") ||
           item.first.starts_with("ViewLayer.DiffCol.");
  });
  const Finished done = relight(dir, part);
  ASSERT_EQ(done.code, 0) << done.err;
  expect_composite(dir, picture, 0, 1);
}

TEST(Ambient, CostsOcclusionAloneAndThePlanSaysSo) {
  const TempDir dir;
  write_frame(dir / "in.exr", rendered(small_picture(), 1));
  const auto plan = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"info", dir / "in.exr", "--json", "--products", "composite"});
    const Finished done = run_tool(flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(done.out)["plan"];
  };
  const json ambient = plan({"--aov", "ambient=ViewLayer.Sky"});
  EXPECT_EQ(ambient["bounces"], 0);
  EXPECT_THAT(ambient["reasons"].dump(), HasSubstr("ambient part times ao"));
  EXPECT_EQ(plan({})["bounces"], 1) << "a layer becomes ambient on request only";
}

TEST(Ambient, BrokenPixelsOfRenderedLayersStayOutOfTheComposite) {
  const TempDir dir;
  const Picture picture = small_picture();
  FramePart part = rendered(picture, 1);
  part.channels["ViewLayer.Sky.G"](32, 24) = NAN;
  part.channels["ViewLayer.Combined.R"](33, 24) = INFINITY;
  const Finished done = relight(dir, part);
  ASSERT_EQ(done.code, 0) << done.err;
  for (const char* name : {"R", "G", "B"}) {
    for (const float value : channel(dir / "out.exr", name).pixels)
      EXPECT_TRUE(std::isfinite(value));
  }
}

TEST(Ambient, ALayerThatIsMissingIsNamed) {
  const TempDir dir;
  write_frame(dir / "in.exr", rendered(small_picture(), 1));
  const Finished refused = run_tool({"info", dir / "in.exr", "--aov", "ambient=Fill"});
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.error_line(), HasSubstr("'Fill' with channels for ambient"));
}

}  // namespace
}  // namespace ssdo::test
