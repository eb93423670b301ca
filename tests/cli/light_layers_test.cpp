// SPDX-License-Identifier: Apache-2.0
//
// Lamps and --per-light, from the command line to the channels of the output: the layers of each
// light, whatever else is asked for, and composites of a beauty with lamps.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/analytic_scene.h"
#include "support/exr_fixture.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::light_layers_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ContainsRegex;
using testing::Each;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

/// A floor with a ball, seen from above at a slant, in the light of two lamps and a sky.
class LayersOfLights : public testing::Test {
 protected:
  static constexpr Window kWindow{0, 0, 96, 64};
  inline static const Words kLamps = {
      "--light", "sphere name=key position=-1.5,-1,2 radius=0.1 intensity=40 color=1,0.8,0.6",
      "--light", "sphere name=fill position=1,-2,1 radius=0.2 intensity=5 color=0.4,0.6,1"};
  inline static const Words kColors = {"--env", "0.3,0.4,0.5"};

  static Picture picture(const Window& window) {
    const Camera camera =
        look_at(camera_from_fov(45, window, 1), {0.5, -5, 3}, {0, 0, 0.3}, {0, 0, 1});
    const Surface surface = all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.5}, 0.5)});
    return take_picture(surface, camera, window);
  }

  std::string path(const std::string& name) const { return dir_ / name; }

  void write(const std::string& name, const Window& window) const {
    FramePart part = frame_of(picture(window));
    part.data = part.display = window;
    write_frame(path(name), part);
  }

  Finished run(const std::string& in, const std::string& out, const Words& flags) const {
    return run_tool(Words{path(in), "-o", path(out), "--overwrite"} + flags);
  }
  void made(const std::string& in, const std::string& out, const Words& flags) const {
    const Finished finished = run(in, out, flags + Words{"--pixel-type", "float"});
    ASSERT_EQ(finished.code, 0) << finished.err;
  }

  Plane<float> at(const std::string& file, const std::string& name) const {
    return channel(path(file), name);
  }

  /// Largest difference between a channel and the sum of others, over its mean.
  double off(const std::string& file, const std::string& all, const Words& parts) const {
    const Plane<float> whole = at(file, all);
    Plane<float> sum(whole.width, whole.height, 0.0f);
    for (const std::string& part : parts) {
      const Plane<float> one = at(file, part);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += one[i];
    }
    double worst = 0, mean = 0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      worst = std::max(worst, double(std::abs(sum[i] - whole[i])));
      mean += double(whole[i]) / double(sum.size());
    }
    return worst / mean;
  }

  void expect_same_bits(const std::string& a, const std::string& b) const {
    const Words names = channel_names(path(a));
    EXPECT_EQ(channel_names(path(b)), names);
    for (const std::string& name : names)
      EXPECT_TRUE(at(a, name).pixels == at(b, name).pixels) << name;
  }

  TempDir dir_;
};

TEST_F(LayersOfLights, StandBesideTheLightOfAll) {
  write("in.exr", kWindow);
  const Words flags = kLamps + kColors + Words{"--products", "direct,bounce,unshadowed,shadow"};
  made("in.exr", "all.exr", flags);
  made("in.exr", "each.exr", flags + Words{"--per-light"});
  const Words names = channel_names(path("each.exr"));
  EXPECT_EQ(names.size(), channel_names(path("all.exr")).size() + 3 * 4 * 3);
  EXPECT_THAT(names,
              IsSupersetOf({"direct.env.R", "bounce.key.G", "shadow.fill.B", "unshadowed.env.R"}));
  for (const std::string& name : channel_names(path("all.exr")))
    EXPECT_TRUE(at("each.exr", name).pixels == at("all.exr", name).pixels) << name;
  for (const std::string c : {".R", ".G", ".B"}) {
    const auto parts = [&](const std::string& product) {
      return Words{product + ".env" + c, product + ".key" + c, product + ".fill" + c};
    };
    EXPECT_LT(off("each.exr", "direct" + c, parts("direct")), 1e-5);
    EXPECT_LT(off("each.exr", "unshadowed" + c, parts("unshadowed")), 1e-5);
    EXPECT_LT(off("each.exr", "bounce" + c, parts("bounce")), 5e-3);
    for (const std::string light : {"", ".env", ".key", ".fill"}) {
      const Plane<float> direct = at("each.exr", "direct" + light + c),
                         unshadowed = at("each.exr", "unshadowed" + light + c),
                         shadow = at("each.exr", "shadow" + light + c);
      float darkest = 1;
      for (std::size_t i = 0; i < direct.size(); ++i) {
        EXPECT_NEAR(shadow[i] * unshadowed[i], direct[i], 3e-7f * direct[i]);
        darkest = std::min(darkest, shadow[i]);
      }
      EXPECT_LT(darkest, 0.6f) << light << " casts a shadow";
    }
  }
}

/// What a learned prior finds to be hidden sends the light of each lamp in its part.
TEST_F(LayersOfLights, AddUpWithAPrior) {
  write("in.exr", kWindow);
  for (const std::string filter : {"geometry", "none"}) {
    made("in.exr", "each.exr",
         kLamps + kColors +
             Words{"--products", "direct,bounce", "--prior", "learned", "--per-light", "--bounces",
                   "2", "--filter", filter});
    for (const std::string c : {".R", ".G", ".B"}) {
      const auto parts = [&](const std::string& product) {
        return Words{product + ".env" + c, product + ".key" + c, product + ".fill" + c};
      };
      EXPECT_LT(off("each.exr", "direct" + c, parts("direct")), 1e-5) << filter;
      EXPECT_LT(off("each.exr", "bounce" + c, parts("bounce")), 5e-3) << filter;
    }
  }
}

TEST_F(LayersOfLights, OfALampAreThoseOfARunWithItAlone) {
  write("in.exr", kWindow);
  const Words flags = {"--products", "direct,bounce", "--method", "trace", "--set", "samples=16"};
  made("in.exr", "each.exr", kLamps + kColors + flags + Words{"--per-light"});
  made("in.exr", "key.exr", Words{kLamps[0], kLamps[1], "--env", "0,0,0"} + flags);
  for (const std::string c : {".R", ".G", ".B"}) {
    EXPECT_LT(off("key.exr", "direct" + c, {}), 100) << "is there";
    const Plane<float> direct = at("key.exr", "direct" + c),
                       of_key = at("each.exr", "direct.key" + c),
                       bounce = at("key.exr", "bounce" + c),
                       key_bounce = at("each.exr", "bounce.key" + c);
    for (std::size_t i = 0; i < direct.size(); ++i) {
      EXPECT_NEAR(of_key[i], direct[i], 1e-5f);
      EXPECT_NEAR(key_bounce[i], bounce[i], 1e-5f);
    }
  }
}

/// Bits depend on neither threads nor bands.
TEST_F(LayersOfLights, AreTheSameInPartsAndByAnyThreads) {
  const Window tall{0, 0, 320, 1600};
  FramePart part = frame_of(small_picture(tall, tall));
  part.data = part.display = tall;
  write_frame(path("tall.exr"), part);
  const nlohmann::json info = parse_json(run_tool({"info", path("tall.exr"), "--json"}).out);
  std::ofstream(path("camera.json")) << info["camera"].dump();
  const Words flags =
      kLamps + kColors + Words{"--per-light", "--radius",         "0.05", "--thickness", "0.3",
                               "--camera",    path("camera.json")};
  made("tall.exr", "one.exr", flags + Words{"--threads", "1"});
  made("tall.exr", "two.exr", flags + Words{"--threads", "2"});
  expect_same_bits("one.exr", "two.exr");
  const Finished bands = run("tall.exr", "bands.exr",
                             flags + Words{"--pixel-type", "float", "-v", "--mem-limit", "200M"});
  ASSERT_EQ(bands.code, 0) << bands.err;
  EXPECT_THAT(bands.err, AllOf(ContainsRegex("[2-9] bands of"), Not(HasSubstr("marches go on"))));
  expect_same_bits("one.exr", "bands.exr");
}

TEST_F(LayersOfLights, AreOfTheEnvironmentAloneWithoutLamps) {
  write("in.exr", kWindow);
  made("in.exr", "env.exr", Words{"--per-light", "--products", "direct,shadow"});
  EXPECT_THAT(
      channel_names(path("env.exr")),
      testing::UnorderedElementsAre("direct.R", "direct.G", "direct.B", "direct.env.R",
                                    "direct.env.G", "direct.env.B", "shadow.R", "shadow.G",
                                    "shadow.B", "shadow.env.R", "shadow.env.G", "shadow.env.B"));
  EXPECT_LT(off("env.exr", "direct.G", {"direct.env.G"}), 1e-6);
  made("in.exr", "lamps.exr",
       kLamps + Words{"--env", "0,0,0", "--per-light", "--products", "direct"});
  EXPECT_THAT(channel_names(path("lamps.exr")), Not(Contains("direct.env.R")));
}

TEST_F(LayersOfLights, GoWithOtherOptionsOrAreRefusedInALine) {
  write("in.exr", kWindow);
  const Words flags = kLamps + kColors + Words{"--per-light"};
  made("in.exr", "error.exr", flags + Words{"--products", "direct,bounce,error"});
  EXPECT_LT(off("error.exr", "direct.R", {"direct.env.R", "direct.key.R", "direct.fill.R"}), 1e-5);
  made("in.exr", "small.exr", flags + Words{"--downsample", "2", "--products", "all"});
  EXPECT_LT(off("small.exr", "direct.R", {"direct.env.R", "direct.key.R", "direct.fill.R"}), 1e-5);
  made("in.exr", "again.exr", flags + Words{"--keep-channels"});
  const Finished radiance =
      run("in.exr", "out.exr", flags + Words{"--aov", "radiance=ViewLayer.DiffCol"});
  EXPECT_EQ(radiance.code, 2);
  EXPECT_THAT(radiance.err, HasSubstr("the layer of radiance says what surfaces send"));
  const Finished env =
      run("in.exr", "out.exr",
          Words{"--light", "sphere name=env position=0,0,3 radius=1"} + Words{"--per-light"});
  EXPECT_EQ(env.code, 2);
  const Finished picture = run("in.exr", "out.png", flags);
  EXPECT_THAT(picture.err, HasSubstr("--per-light has no effect: no output is an EXR"));
  const Finished ao = run("in.exr", "ao.exr", flags + Words{"--products", "ao"});
  EXPECT_THAT(ao.err, HasSubstr("--per-light has no effect: no output has direct"));
}

TEST_F(LayersOfLights, ShadowTheBeautysLayersOfLamps) {
  // What each light gives without shadow is what the tool itself says; the frame has albedo 1.
  write("in.exr", kWindow);
  const Words light = kLamps + kColors;
  made("in.exr", "open.exr",
       light + Words{"--per-light", "--products", "unshadowed,shadow", "--bounces", "0"});
  const auto layer = [&](const std::string& role, const std::string& name) {
    return Words{"--aov", role + "=" + path("open.exr") + ":" + name};
  };
  const Words flags = light + Words{"--products", "composite"} + layer("beauty", "unshadowed");
  made("in.exr", "key.exr", flags + layer("light:key", "unshadowed.key"));
  made("in.exr", "both.exr",
       flags + layer("light:key", "unshadowed.key") + layer("light:fill", "unshadowed.fill") +
           layer("ambient", "unshadowed.env"));
  const Plane<float> beauty = at("open.exr", "unshadowed.G"),
                     key = at("open.exr", "unshadowed.key.G"),
                     of_key = at("open.exr", "shadow.key.G"), found = at("key.exr", "G"),
                     fill = at("open.exr", "unshadowed.fill.G"),
                     of_fill = at("open.exr", "shadow.fill.G"),
                     env = at("open.exr", "unshadowed.env.G"),
                     of_env = at("open.exr", "shadow.env.G"), all = at("both.exr", "G");
  for (std::size_t i = 0; i < beauty.size(); ++i) {
    const float without_key = key[i] * (1 - std::min(of_key[i], 1.0f)),
                without_fill = fill[i] * (1 - std::min(of_fill[i], 1.0f)),
                without_env = env[i] * (1 - of_env[i]);
    EXPECT_NEAR(found[i], beauty[i] - without_key, 1e-4f * beauty[i]);
    EXPECT_NEAR(all[i], beauty[i] - without_key - without_fill - without_env, 1e-4f * beauty[i]);
  }
  const Finished unknown = run("in.exr", "out.exr", flags + layer("light:sun", "unshadowed.key"));
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err,
              HasSubstr("--aov light:sun: there is no lamp 'sun'; there are key, fill"));
  const Finished nameless = run("in.exr", "out.exr", flags + layer("light", "unshadowed.key"));
  EXPECT_EQ(nameless.code, 2);
  EXPECT_THAT(nameless.err, HasSubstr("expected light:NAME=LAYER"));
  const Finished idle =
      run("in.exr", "out.exr",
          light + layer("light:key", "unshadowed.key") + Words{"--products", "direct"});
  EXPECT_THAT(idle.err, HasSubstr("--aov light has no effect: no output has the composite"));
}

}  // namespace
}  // namespace ssdo::test::light_layers_test
