// SPDX-License-Identifier: Apache-2.0
//
// Lamps that are linked to objects: `receive` and `cast`.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "support/analytic_scene.h"
#include "support/frame_file.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::lamp_links_test {
namespace {

using testing::HasSubstr;

constexpr Window kWindow{0, 0, 96, 72};
const std::string kLit = "ao,direct,bounce", kMade = kLit + ",specular,unshadowed,shadow";
const std::string kBlender = std::string(SSDO_SOURCE_DIR) + "/data/objects.exr";

/// A floor, a wall and a ball, with their ids, a matte of the ball and one of a part of all.
class LampLinks : public testing::Test {
 protected:
  LampLinks() {
    const Camera by =
        look_at(camera_from_fov(50, kWindow, 1), {0.3, -4, 2.2}, {0, 0.5, 0.4}, {0, 0, 1});
    const Surface floor = plane({0, 0, 0}, {0, 0, 1}), wall = plane({0, 2, 0}, {0, -1, 0}),
                  ball = sphere({0.1, 0.6, 0.5}, 0.5);
    const Picture picture = take_picture(all_of({floor, wall, ball}), by, kWindow);
    FramePart part = frame_of(picture);
    part.data = part.display = kWindow;
    ball_ = part_ = Plane<float>(96, 72, 0.0f);
    Plane<float> ids(96, 72, 1.0f);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const glm::dvec3 p(picture.position[i]);
      if (std::abs(glm::distance(p, {0.1, 0.6, 0.5}) - 0.5) < 1e-4) ids[i] = 2, ball_[i] = 1;
      part_[i] = float(i % 5) / 4;
    }
    part.channels["IndexOB.X"] = ids;
    part.channels["ball.A"] = ball_;
    part.channels["part.A"] = part_;
    write_frame(dir_ / "in.exr", part);
  }

  std::string path(const std::string& name) const { return dir_ / name; }

  /// The frame lit by a lamp with these links: a file, whose channels are read by name.
  std::string lit(const std::string& links, const Words& flags = {},
                  const std::string& products = kMade) const {
    return lit_at("-1,-1,2.5", links, flags, products, path("in.exr"));
  }
  std::string lit_at(const std::string& position, const std::string& links, const Words& flags,
                     const std::string& products, const std::string& input) const {
    const std::string lamp = fmt::format(
                          "sphere name=key position={} radius=0.1 normalize=true intensity=90 {}",
                          position, links),
                      out = path(fmt::format("out{}.exr", ++files_));
    const Finished done = run_tool(Words{input, "-o", out, "--pixel-type", "float", "-q", "--env",
                                         "0,0,0", "--light", lamp, "--products", products} +
                                   flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return out;
  }
  Plane<float> made(const std::string& links, const std::string& name, const Words& flags = {},
                    const std::string& products = kMade) const {
    return channel(lit(links, flags, products), name);
  }

  mutable int files_ = 0;
  const TempDir dir_;
  Plane<float> ball_, part_;
};

double rms(const Plane<float>& a, const Plane<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(double(a[i]) - double(b[i]), 2);
  return std::sqrt(sum / double(a.size()));
}

Plane<float> sum_of(Plane<float> a, const Plane<float>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

/// Methods that know the shadows of lamps.
const std::vector<Words> kMethods = {{"--method", "bitmask"},
                                     {"--method", "trace", "--set", "samples=16"}};

/// A lamp lights what it is linked to, by its coverage, and nothing else, in all products.
TEST_F(LampLinks, ReceiveIsWhatALampLights) {
  for (const Words& by : kMethods) {
    const std::string all = lit("", by), of_ball = lit("receive=ball", by),
                      of_part = lit("receive=part", by);
    for (const std::string name : {"direct.G", "unshadowed.G"}) {
      const Plane<float> whole = channel(all, name), ball = channel(of_ball, name),
                         part = channel(of_part, name);
      for (std::size_t i = 0; i < whole.size(); ++i) {
        ASSERT_NEAR(ball[i], ball_[i] * whole[i], 1e-5f) << by[1] << " " << name << " " << i;
        ASSERT_NEAR(part[i], part_[i] * whole[i], 1e-5f) << by[1] << " " << name << " " << i;
      }
    }
    const Plane<float> shadow = channel(of_ball, "shadow.G");
    for (std::size_t i = 0; i < shadow.size(); ++i)
      if (ball_[i] == 0) {
        ASSERT_EQ(shadow[i], 1);
      }
  }
}

/// What it does not light sends none of its light: parts of a bounce add up.
TEST_F(LampLinks, WhatALampDoesNotLightSendsNothingOfIt) {
  for (const Words& by : kMethods) {
    const std::string all_of = lit("", by), one_of = lit("receive=ball", by),
                      rest_of = lit("receive=id:IndexOB=1", by);
    for (const std::string name : {"bounce.G", "specular.G"}) {
      const Plane<float> all = channel(all_of, name), one = channel(one_of, name),
                         rest = channel(rest_of, name), none(all.width, all.height, 0.0f);
      EXPECT_GT(rms(one, none), 0.04 * rms(all, none)) << by[1] << " " << name;
      EXPECT_GT(rms(rest, none), 0.2 * rms(all, none)) << by[1] << " " << name;
      EXPECT_LT(rms(sum_of(one, rest), all), 0.04 * rms(all, none)) << by[1] << " " << name;
    }
  }
}

/// All but the ball block the light of a lamp as if --no-cast had taken it out.
TEST_F(LampLinks, CastIsWhatBlocksALamp) {
  for (const Words& by : kMethods) {
    const std::string plain = lit("", by);
    const Plane<float> all = channel(plain, "direct.G"), open = channel(plain, "unshadowed.G"),
                       rest = made("cast=id:IndexOB=1", "direct.G", by),
                       out = made("", "direct.G", by + Words{"--no-cast", "ball"}),
                       ball = made("cast=ball", "direct.G", by), none(all.width, all.height, 0.0f);
    EXPECT_GT(rms(all, out), 0.05 * rms(all, none)) << "the ball throws a shadow";
    EXPECT_LT(rms(rest, out), 0.01 * rms(all, none)) << by[1];
    // Floor and wall shadow nothing here.
    EXPECT_LT(rms(ball, all), 0.05 * rms(all, none)) << by[1];
    int dark = 0, open_above = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      dark += ball_[i] == 0 && open[i] > 0.1f && ball[i] < 0.1f * open[i];
      open_above += i / 96 < 8 && ball[i] > 0.98f * open[i];
    }
    EXPECT_GT(dark, 50) << by[1];
    EXPECT_GT(open_above, 500) << by[1];
  }
}

/// A selection of all that the frame shows is no link, also for the sides of things that the camera
/// does not see and for edges before the sky.
TEST_F(LampLinks, CastOfEverythingIsNoLink) {
  for (const Words& by : kMethods) {
    for (const char* position : {"0.5,2.5,0.6", "-1,-1.5,1.2"}) {
      const std::string plain = lit_at(position, "", by, kLit, kBlender);
      for (const char* cast : {"cast=id:ViewLayer.IndexOB=0-100000", "cast=crypto:*"}) {
        const std::string linked = lit_at(position, cast, by, kLit, kBlender);
        for (const std::string name : {"direct.G", "bounce.G"})
          EXPECT_EQ(channel(linked, name).pixels, channel(plain, name).pixels)
              << by[1] << " " << position << " " << cast << " " << name;
      }
    }
  }
}

/// Antialiased mattes select the same pixels, of thin things too, and of edges before the sky,
/// which no alpha tells.
TEST_F(LampLinks, CastOfSoftMattesIsWhole) {
  const Camera by =
      look_at(camera_from_fov(50, kWindow, 1), {0.3, -4, 1.2}, {0, 0.5, 1.2}, {0, 0, 1});
  const Surface stage = cut(plane({0, 0, 0}, {0, 0, 1}),
                            [](const glm::dvec3&p) { return glm::length(p) < 5; }),
                post = cut(plane({-0.5, 0.3, 0}, {0, -1, 0}), [](const glm::dvec3&p) {
                  return std::abs(p.x + 0.5) < 0.03 && p.z < 2;
                });
  FramePart part =
      frame_of(take_picture(all_of({stage, sphere({0.4, 0.6, 1.6}, 0.6), post}), by, kWindow));
  part.data = part.display = kWindow;
  const Picture alone = take_picture(stage, by, kWindow),
                all =
                    take_picture(all_of({stage, sphere({0.4, 0.6, 1.6}, 0.6), post}), by, kWindow);
  Plane<float> hard(96, 72, 0.0f);
  for (std::size_t i = 0; i < hard.size(); ++i)
    hard[i] = all.valid[i] && (!alone.valid[i] || all.position[i] != alone.position[i]);
  Plane<float> soft = hard;
  for (int y = 1; y < 71; ++y) {
    for (int x = 1; x < 95; ++x) {
      float most = 0, least = 1;
      for (int d = -1; d <= 1; ++d) {
        most = std::max({most, hard(x + d, y), hard(x, y + d)});
        least = std::min({least, hard(x + d, y), hard(x, y + d)});
      }
      if (least < most) soft(x, y) = hard(x, y) > 0 ? 0.3f : 0.4f;
    }
  }
  part.channels["hard.A"] = hard, part.channels["soft.A"] = soft;
  write_frame(path("soft.exr"), part);
  for (const Words& by_method : kMethods) {
    const auto direct = [&](const std::string& links) {
      return channel(lit_at("-1,-1,2.5", links, by_method, "direct", path("soft.exr")), "direct.G");
    };
    const Plane<float> of_hard = direct("cast=hard"), of_soft = direct("cast=soft"),
                       of_none = direct("cast=id:hard=7");
    EXPECT_GT(rms(of_hard, of_none), 0.02) << by_method[1];
    EXPECT_EQ(of_soft.pixels, of_hard.pixels) << by_method[1];
  }
}

/// Sides that the camera does not see are those of the things that are there, whatever blocks the
/// light: a lamp between ball and wall lights the ball from behind.
TEST_F(LampLinks, ThingsThatDoNotBlockALampAreLitByIt) {
  for (const Words& by : kMethods) {
    const auto bounce = [&](const std::string& links) {
      return channel(lit_at("0.1,1.5,0.6", links, by, kLit, path("in.exr")), "bounce.G");
    };
    const Plane<float> plain = bounce("receive=ball"),
                       linked = bounce("receive=ball cast=id:IndexOB=1"), none(96, 72, 0.0f);
    EXPECT_LT(rms(plain, linked), 0.05 * rms(plain, none)) << by[1];
  }
}

/// The other lamps, and the sky, do not notice.
TEST_F(LampLinks, LinksAreOfOneLampAlone) {
  const Words flags = {"--light", "sphere name=fill position=2,-1,1.5 radius=0.1 intensity=40",
                       "--per-light"};
  const std::string linked = lit("receive=ball cast=ball", flags, kLit),
                    plain = lit("", flags, kLit), receives = lit("receive=ball", flags, kLit);
  for (const std::string name : {"direct.fill.G", "bounce.fill.G", "ao.Y"}) {
    const Plane<float> a = channel(linked, name), b = channel(plain, name);
    // Which senders have rays of their own is decided by the light of all.
    EXPECT_LT(rms(a, b), 0.02 * rms(b, Plane<float>(96, 72, 0.0f))) << name;
  }
  const Plane<float> key = channel(receives, "direct.key.G"), all = channel(plain, "direct.key.G");
  for (std::size_t i = 0; i < key.size(); ++i) ASSERT_NEAR(key[i], ball_[i] * all[i], 1e-5f);
}

/// An object that does not block the lamps at all has no shadow of theirs.
TEST_F(LampLinks, ShadowOfKnowsThem) {
  const Words flags = {"--shadow-of", "ball", "--bounces", "0"};
  const auto dark = [&](const std::string& links) {
    int count = 0;
    for (const float value : made(links, "shadow_of.G", flags, "direct,shadow_of").pixels)
      count += value < 0.8f;
    return count;
  };
  EXPECT_GT(dark(""), 50);
  EXPECT_EQ(dark("cast=id:IndexOB=1"), 0);
}

/// A board over the scene that only another view shows blocks the lamps that name it.
TEST_F(LampLinks, CastReachesWhatOtherViewsShow) {
  const Camera by = look_at(camera_from_fov(60, kWindow, 1), {0, -3, 4}, {0, 0.8, 1.6}, {0, 0, 1});
  const Surface board = cut(plane({0, 0.2, 2.4}, {0, 0, 1}), [](const glm::dvec3& p) {
    return std::abs(p.x) < 0.6 && std::abs(p.y - 0.2) < 0.6;
  });
  const Picture picture =
      take_picture(all_of({plane({0, 0, 0}, {0, 0, 1}), plane({0, 2, 0}, {0, -1, 0}),
                           sphere({0.1, 0.6, 0.5}, 0.5), board}),
                   by, kWindow);
  FramePart part = frame_of(picture);
  part.data = part.display = kWindow;
  write_frame(path("silent.exr"), part);
  Plane<float> ids(96, 72, 1.0f);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const glm::dvec3 p(picture.position[i]);
    if (std::abs(p.z - 2.4) < 1e-4) ids[i] = 3;
    if (std::abs(glm::distance(p, {0.1, 0.6, 0.5}) - 0.5) < 1e-4) ids[i] = 2;
  }
  part.channels["IndexOB.X"] = ids;
  write_frame(path("view.exr"), part);
  for (const Words& by_method : kMethods) {
    const auto direct = [&](const std::string& cast, const Words& more) {
      return channel(lit_at("1.6,-0.8,4", cast, by_method + more, "direct", path("in.exr")),
                     "direct.G");
    };
    const Words also = {"--also", path("view.exr")};
    const Plane<float> open = direct("", {}), dark = direct("", also),
                       rest = direct("cast=id:IndexOB=1-2", also),
                       named = direct("cast=id:IndexOB=3", also), none(96, 72, 0.0f);
    const double taken = rms(dark, open);
    ASSERT_GT(taken, 0.1 * rms(open, none)) << by_method[1];
    EXPECT_LT(rms(rest, open), 0.1 * taken) << by_method[1];
    // The board's shadow is there, and that of the ball is not.
    int in_shadow = 0, still_dark = 0;
    int lit = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const bool is_shaded = dark[i] < 0.1f * open[i];
      in_shadow += is_shaded, still_dark += is_shaded && named[i] < 0.1f * open[i];
      lit += open[i] == 0 && dark[i] == 0 && named[i] > 0.1f;
    }
    EXPECT_GT(in_shadow, 200) << by_method[1];
    EXPECT_GT(still_dark, 0.95 * in_shadow) << by_method[1];
    EXPECT_GT(lit, 50) << "where the ball stands before the lamp";
  }
  const Finished silent = run_tool(
      {path("in.exr"), "-o", path("silent_out.exr"), "--also", path("silent.exr"), "--light",
       "sphere name=key position=0,0,4 radius=0.1 normalize=true intensity=90 cast=ball", "--light",
       "sphere name=rim position=1,0,4 radius=0.1 normalize=true cast=ball"});
  EXPECT_EQ(silent.code, 0);
  const std::string says = "blocks no light of this lamp: --light key: cast ball: no layer 'ball'";
  EXPECT_THAT(silent.err, HasSubstr(path("silent.exr") + ": " + says));
  EXPECT_EQ(silent.err.find(says), silent.err.rfind(says));
}

/// A wall that only another view shows is lit by a lamp that names it, and by no other: what it
/// sends adds up to what it sends of a lamp without a link.
TEST_F(LampLinks, ReceiveReachesWhatOtherViewsShow) {
  const Camera down = look_at(camera_from_fov(40, kWindow, 1), {0, -2, 3}, {0, 0, 0}, {0, 0, 1}),
               level =
                   look_at(camera_from_fov(70, kWindow, 1), {0, -3, 1.5}, {0, 2, 0.8}, {0, 0, 1});
  const auto write = [&](const std::string& name, const Camera& by) {
    const Picture picture =
        take_picture(all_of({plane({0, 0, 0}, {0, 0, 1}), plane({0, 1.9, 0}, {0, -1, 0}),
                             sphere({0.4, -0.2, 0.2}, 0.2)}),
                     by, kWindow);
    FramePart part = frame_of(picture);
    part.data = part.display = kWindow;
    write_frame(path("silent_" + name), part);
    Plane<float>& ids = part.channels["IndexOB.X"] = Plane<float>(96, 72, 1.0f);
    int walls = 0;
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (picture.position[i].y > 1.89f) ids[i] = 2, ++walls;
    write_frame(path(name), part);
    return walls;
  };
  ASSERT_EQ(write("in.exr", down), 0);
  ASSERT_GT(write("view.exr", level), 500);
  for (const Words& by_method : kMethods) {
    const Words also = by_method + Words{"--also", path("view.exr"), "--bounces", "2"};
    const auto bounce = [&](const std::string& links, const Words& flags) {
      return channel(lit_at("0,1,1.2", links, flags, kLit, path("in.exr")), "bounce.G");
    };
    const Plane<float> all = bounce("", also), wall = bounce("receive=id:IndexOB=2", also),
                       floor = bounce("receive=id:IndexOB=1", also), none(96, 72, 0.0f);
    EXPECT_GT(rms(wall, none), 0.3 * rms(all, none)) << by_method[1];
    EXPECT_GT(rms(floor, none), 0.05 * rms(all, none)) << by_method[1];
    EXPECT_LT(rms(sum_of(wall, floor), all), 0.02 * rms(all, none)) << by_method[1];
  }
  for (const Words& by_method : kMethods) {
    const Words also = by_method + Words{"--also", path("silent_view.exr"), "--bounces", "2"};
    const Plane<float> unknown =
        channel(lit_at("0,1,1.2", "receive=id:IndexOB=2", also, kLit, path("in.exr")), "bounce.G");
    EXPECT_EQ(rms(unknown, Plane<float>(96, 72, 0.0f)), 0) << by_method[1];
  }
  const Finished silent =
      run_tool({path("in.exr"), "-o", path("silent_out.exr"), "--also", path("silent_view.exr"),
                "--light", "sphere name=key position=0,1,1.2 receive=id:IndexOB=1"});
  EXPECT_EQ(silent.code, 0);
  EXPECT_THAT(silent.err, HasSubstr("silent_view.exr: takes no light of this lamp: --light key: "
                                    "receive id:IndexOB=1: no layer 'IndexOB'"));
}

/// Links are those of the frame when it comes in bands.
TEST_F(LampLinks, InBandsAreNearlyThoseOfTheFrame) {
  constexpr Window kTall{0, 0, 320, 1600};
  const Camera by = look_at(camera_from_fov(40, kTall, 1), {0, -4, 3}, {0, 0, 0.3}, {0, 0, 1});
  const Picture shown = take_picture(
      all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6), sphere({-0.7, 0.2, 0.3}, 0.3)}), by,
      kTall);
  FramePart part = frame_of(shown);
  part.data = part.display = kTall;
  Plane<float>& ids = part.channels["IndexOB.X"] = Plane<float>(320, 1600, 1.0f);
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (shown.position[i].z > 1e-4f) ids[i] = shown.position[i].x > -0.4f ? 2 : 3;
  write_frame(path("tall.exr"), part);
  // Without a bounce bands reach less far, and rays go on in the overview.
  const Words flags = {"--thickness", "0.3", "--slices", "1", "--steps", "8"},
              limit = {"--mem-limit", "135M"};
  const auto light = [&](const char* lamp, const std::string& links, const Words& more) {
    return channel(lit_at(lamp, links, flags + more, "direct", path("tall.exr")), "direct.G");
  };
  const std::string links = "cast=id:IndexOB=2 receive=id:IndexOB=1-2";
  EXPECT_THAT(run_tool(Words{"info", path("tall.exr"), "--products", "direct", "--light",
                             "sphere position=-1.5,-1,3 " + links} +
                       flags + limit)
                  .out,
              HasSubstr(" bands of "));
  const char *high = "-1.5,-1,3", *low = "0.3,2.5,1.5";
  const Plane<float> plain = light(high, "", {}), whole = light(high, links, {}),
                     bands = light(high, links, limit);
  const double off = rms(whole, bands), effect = rms(whole, plain);
  RecordProperty("rms", fmt::format("{:.5f} {:.5f}", off, effect));
  EXPECT_GT(effect, 0.05 * rms(plain, Plane<float>(320, 1600, 0.0f)));
  EXPECT_LT(off, 0.05 * effect);
  EXPECT_GT(rms(bands, plain), 0.9 * effect);

  // The low lamp throws a shadow that is longer than what a band has around it. Rays go on in the
  // overview, to what is named there, as they do for a lamp without links, which needs less memory.
  const std::string everything = "cast=id:IndexOB=2-3", ball = "cast=id:IndexOB=2";
  const Plane<float> all = light(low, "", {});
  const double off_of_all = rms(light(low, "", {"--mem-limit", "100M"}), all);
  EXPECT_GT(off_of_all, 0);
  EXPECT_LT(std::abs(rms(light(low, everything, limit), all) - off_of_all), 1e-6);
  EXPECT_LT(rms(light(low, ball, limit), light(low, ball, {})), 1.6 * off_of_all);
}

TEST_F(LampLinks, RefusesInOneLine) {
  const auto expect = [&](const std::string& key, int code, const std::string& says) {
    std::ofstream(path("lights.json"))
        << R"({"lights": [{"type": "sphere", "name": "key", )" << key << "}]}";
    const Finished done =
        run_tool({kBlender, "-o", path("no.exr"), "--lights", path("lights.json")});
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_THAT(done.error_line(), HasSubstr(says));
    EXPECT_THAT(done.error_line(), HasSubstr("light key: "));
  };
  expect(R"("receive": "crypto:bal")", 4, "receive crypto:bal: no Cryptomatte");
  expect(R"("cast": "crypto:bal")", 4, "did you mean ball");
  expect(R"("cast": "nothing")", 4, "no layer 'nothing'");
  expect(R"("receive": ["ball"])", 3, "receive is [\"ball\"]; it is a selection");
  expect(R"("receive": "")", 3, "receive : expected crypto:NAME");
  expect(R"("recieve": "ball")", 3, "did you mean receive");
}

}  // namespace
}  // namespace ssdo::test::lamp_links_test
