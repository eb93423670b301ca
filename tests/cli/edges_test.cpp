// SPDX-License-Identifier: Apache-2.0
//
// Pixels that a surface covers in part, through the binary: what it sends there is its albedo in
// the light, times alpha once, however the layer of albedo holds alpha.
#include <gmock/gmock.h>

#include <algorithm>

#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::edges_test {
namespace {

using testing::HasSubstr;

const Window kWindow{0, 0, 64, 48};
constexpr float kAlbedo = 0.5f, kBeauty = 0.25f;

/// A ball before nothing.
Picture ball() {
  return take_picture(sphere({0, 0, 0}, 1),
                      look_at(camera_from_fov(40, kWindow, 1), {0, -4, 0}, {0, 0, 0}, {0, 0, 1}),
                      kWindow);
}

bool is_edge(const Picture& picture, int x, int y) {
  for (const auto& [u, v] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}})
    if (kWindow.contains(u, v) && !picture.valid(u, v)) return true;
  return false;
}

/// The ball with an alpha of 0.55 to 0.9 along its edge, and an albedo that has alpha in it or not.
FramePart frame(bool premultiplied) {
  const Picture picture = ball();
  FramePart part = frame_of(picture);
  Plane<float> alpha(64, 48);
  Plane<glm::vec3> albedo(64, 48), beauty(64, 48);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (!picture.valid(x, y)) continue;
      const float a = is_edge(picture, x, y) ? 0.55f + 0.05f * float((x + 3 * y) % 8) : 1;
      alpha(x, y) = a;
      albedo(x, y) = glm::vec3(kAlbedo * (premultiplied ? a : 1));
      beauty(x, y) = glm::vec3(kBeauty * a);
    }
  }
  part.add("ViewLayer.DiffCol", albedo, "RGB");
  part.add("ViewLayer.Combined", beauty, "RGB");
  part.channels["ViewLayer.Combined.A"] = alpha;
  return part;
}

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A pixel of the ball: its alpha, and what it sends over the light that it gets, alpha divided
/// out.
struct Shown {
  float alpha, albedo;
};

/// By --aov, or as the data tell.
std::vector<Shown> show(bool premultiplied, const std::vector<std::string>& flags,
                        const std::string& said) {
  const TempDir dir;
  write_frame(dir / "in.exr", frame(premultiplied));
  const Finished done =
      run_tool(std::vector<std::string>{dir / "in.exr", "-o", dir / "out.exr", "--pixel-type",
                                        "float", "-v", "--quality", "draft"} +
               flags);
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr(said));
  const auto out = [&](const char* name) { return channel(dir / "out.exr", name); };
  const Plane<float> color = out("R"), alpha = out("A"), direct = out("direct.R"),
                     bounce = out("bounce.R");
  const float beauty = done.err.find("composite add") == std::string::npos ? 0 : kBeauty;
  std::vector<Shown> shown;
  for (std::size_t i = 0; i < color.size(); ++i) {
    if (alpha[i] > 0)
      shown.push_back({alpha[i], (color[i] / alpha[i] - beauty) / (direct[i] + bounce[i])});
  }
  EXPECT_GT(std::ranges::count_if(shown, [](const Shown& s) { return s.alpha < 1; }), 60);
  return shown;
}

const std::string kIs = "albedo is premultiplied by alpha", kIsNot = "albedo is not premultiplied";

TEST(Edges, HaveTheAlbedoOfTheInside) {
  for (const bool premultiplied : {false, true}) {
    for (const char* compose : {"relight", "add"}) {
      for (const auto& [alpha, albedo] :
           show(premultiplied, {"--compose", compose}, premultiplied ? kIs : kIsNot))
        ASSERT_NEAR(albedo, kAlbedo, 1e-3f) << compose << ", alpha " << alpha;
    }
  }
}

TEST(Edges, HaveTheAlbedoThatIsStated) {
  const auto stated = [](const std::string& how) {
    return std::vector<std::string>{"--aov", "albedo:" + how + "=ViewLayer.DiffCol"};
  };
  for (const auto& [alpha, albedo] : show(true, stated("straight"), kIsNot))
    ASSERT_NEAR(albedo, kAlbedo * alpha, 1e-3f);
  for (const auto& [alpha, albedo] : show(false, stated("premultiplied"), kIs))
    ASSERT_NEAR(albedo, kAlbedo / alpha, 1e-3f);
}

}  // namespace
}  // namespace ssdo::test::edges_test
