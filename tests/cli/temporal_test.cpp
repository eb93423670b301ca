// SPDX-License-Identifier: Apache-2.0
//
// Sequences with --temporal through the real binary.
#include <ImfStringAttribute.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::temporal_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Frames 5 to 8 of a camera that stands still or moves.
void write_sequence(const TempDir& dir, double step) {
  const Window window{0, 0, 64, 48};
  const Surface scene = all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6)});
  for (int n = 0; n < 4; ++n) {
    const Camera camera =
        look_at(camera_from_fov(40, window, 1), {step * n, -4, 3}, {0, 0, 0.3}, {0, 0, 1});
    write_frame(dir / ("in." + std::to_string(5 + n) + ".exr"),
                frame_of(take_picture(scene, camera, window)));
  }
}

Finished relight(const TempDir& dir, const std::string& out, std::vector<std::string> flags) {
  flags.insert(flags.begin(), {dir / "in.@.exr", "-o", dir / (out + ".@.exr"), "--pixel-type",
                               "float", "--quality", "draft", "--radius", "1"});
  return run_tool(flags);
}

Plane<float> ao(const TempDir& dir, const std::string& name) {
  return channel(dir / (name + ".exr"), "ao.Y");
}

json plan_of(const TempDir& dir, const std::string& name) {
  const ExrReader file(dir / (name + ".exr"));
  const auto* text = file.parts()[0].header.findTypedAttribute<Imf::StringAttribute>("ssdo/plan");
  return parse_json(text->value());
}

TEST(TemporalRuns, AverageFramesWhosePatternsComeFromTheirNumbers) {
  const TempDir dir;
  write_sequence(dir, 0);
  ASSERT_EQ(relight(dir, "mean", {"--temporal"}).code, 0);
  for (const std::string frame : {"5", "6", "7", "8"})
    ASSERT_EQ(relight(dir, "alone", {"--frames", frame, "--seed", frame}).code, 0);
  EXPECT_EQ(ao(dir, "mean.5").pixels, ao(dir, "alone.5").pixels);
  const Plane<float> mean = ao(dir, "mean.8");
  double largest = 0;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    double sum = 0;
    for (const char* frame : {"5", "6", "7", "8"}) sum += ao(dir, "alone." + std::string(frame))[i];
    EXPECT_NEAR(mean[i], sum / 4, 1e-5);
    largest = std::max(largest, std::abs(ao(dir, "alone.8")[i] - sum / 4));
  }
  EXPECT_GT(largest, 0.01) << "every frame has the same pattern";
}

TEST(TemporalRuns, GiveTheSameBitsOnAnyNumberOfThreads) {
  const TempDir dir;
  write_sequence(dir, 0.1);
  ASSERT_EQ(relight(dir, "one", {"--temporal", "--threads", "1"}).code, 0);
  ASSERT_EQ(relight(dir, "four", {"--temporal", "--threads", "4"}).code, 0);
  for (const std::string frame : {"5", "6", "7", "8"})
    EXPECT_EQ(ao(dir, "one." + frame).pixels, ao(dir, "four." + frame).pixels) << frame;
}

TEST(TemporalRuns, SayWhereTheirHistoryBegins) {
  const TempDir dir;
  write_sequence(dir, 0.1);
  ASSERT_EQ(relight(dir, "out", {"--temporal", "--frames", "7-8"}).code, 0);
  EXPECT_EQ(plan_of(dir, "out.7")["temporal"], true);
  EXPECT_THAT(plan_of(dir, "out.7")["reasons"].dump(), HasSubstr("no history"));
  EXPECT_THAT(plan_of(dir, "out.8")["reasons"].dump(), HasSubstr("history of the frame before"));

  // A frame that is skipped leaves none, and one that fails neither.
  std::filesystem::remove(dir / "out.8.exr");
  ASSERT_EQ(relight(dir, "out", {"--temporal", "--frames", "7-8", "--skip-existing"}).code, 0);
  EXPECT_THAT(plan_of(dir, "out.8")["reasons"].dump(), HasSubstr("no history"));
  std::filesystem::remove(dir / "in.6.exr");
  EXPECT_EQ(relight(dir, "gap", {"--temporal", "--frames", "5-7", "--on-error", "continue"}).code,
            3);
  EXPECT_THAT(plan_of(dir, "gap.7")["reasons"].dump(), HasSubstr("no history"));
}

/// Issue 12, 7: the frames after a cut share the floor with those before, but none of their light.
TEST(TemporalRuns, BeginAnewAfterACut) {
  const TempDir dir;
  write_sequence(dir, 0.1);
  const Window window{0, 0, 64, 48};
  const Surface pit = all_of({plane({}, {0, 0, 1}), plane({0, 0.6, 0}, {0, -1, 0}),
                              plane({-0.8, 0, 0}, {1, 0, 0}), sphere({0.4, 0, 0.3}, 0.3)});
  for (const int n : {7, 8}) {
    const Camera camera =
        look_at(camera_from_fov(40, window, 1), {0.3 + 0.05 * n, -3, 3}, {0.2, 0, 0.3}, {0, 0, 1});
    FramePart part = frame_of(take_picture(pit, camera, window));
    part.add("ViewLayer.DiffCol", Plane<glm::vec3>(64, 48, glm::vec3(0.3f, 0.2f, 0.1f)), "RGB");
    write_frame(dir / ("in." + std::to_string(n) + ".exr"), part);
  }
  ASSERT_EQ(relight(dir, "shot", {"--temporal"}).err, "");
  ASSERT_EQ(relight(dir, "alone", {"--temporal", "--frames", "7-8"}).err, "");
  EXPECT_EQ(ao(dir, "shot.7").pixels, ao(dir, "alone.7").pixels);
  EXPECT_EQ(ao(dir, "shot.8").pixels, ao(dir, "alone.8").pixels);
  EXPECT_THAT(plan_of(dir, "shot.6")["reasons"].dump(), HasSubstr("history of the frame before"));
  EXPECT_THAT(plan_of(dir, "shot.7")["reasons"].dump(), HasSubstr("no history: a cut"));
  EXPECT_THAT(plan_of(dir, "shot.8")["reasons"].dump(), HasSubstr("history of the frame before"));
}

TEST(TemporalRuns, NeedASequence) {
  const TempDir dir;
  write_sequence(dir, 0);
  const Finished refused = run_tool({dir / "in.5.exr", "-o", dir / "out.exr", "--temporal"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.error_line(), HasSubstr("--temporal needs a sequence"));
}

/// A camera that moves sideways, and motion in the four channels that Blender writes: to the frame
/// before, and from the frame after, y up.
void write_moving_sequence(const TempDir& dir, const glm::vec2& scale) {
  const Window window{0, 0, 64, 48};
  const Surface scene = all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6)});
  const auto camera = [&](int n) {
    return look_at(camera_from_fov(40, window, 1), {0.1 * n, -4 + 0.1 * n, 3}, {0, 0, 0.3},
                   {0, 0, 1});
  };
  for (int n = 0; n < 4; ++n) {
    const Picture picture = take_picture(scene, camera(n), window);
    FramePart part = frame_of(picture);
    Plane<float> x(64, 48), y(64, 48);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const glm::dvec3 p(picture.position[i]);
      const glm::dvec2 now = camera(n).project(camera(n).to_camera(p)),
                       before = camera(n - 1).project(camera(n - 1).to_camera(p));
      x[i] = scale.x * float(before.x - now.x);
      y[i] = scale.y * float(now.y - before.y);
    }
    const std::string layer = "ViewLayer.Vector.";
    part.channels[layer + "X"] = x, part.channels[layer + "Y"] = y;
    part.channels[layer + "Z"] = part.channels[layer + "W"] = Plane<float>(64, 48, 99.0f);
    write_frame(dir / ("in." + std::to_string(5 + n) + ".exr"), part);
  }
}

TEST(TemporalRuns, TakeMotionInPixelsToTheFrameBeforeWithYUp) {
  const TempDir dir;
  write_moving_sequence(dir, {1, 1});
  // It says what the cameras say: the wrong axis or sign would begin anew everywhere.
  ASSERT_EQ(relight(dir, "motion", {"--temporal"}).err, "");
  EXPECT_THAT(plan_of(dir, "motion.8")["reasons"].dump(), HasSubstr("motion ViewLayer.Vector"));
  write_moving_sequence(dir, {-0.5f, -2});
  ASSERT_EQ(relight(dir, "scaled", {"--temporal", "--motion-scale", "-2,-0.5"}).err, "");
  const Plane<float> motion = ao(dir, "motion.8"), scaled = ao(dir, "scaled.8");
  for (std::size_t i = 0; i < motion.size(); ++i) EXPECT_NEAR(scaled[i], motion[i], 1e-3);

  const Finished wrong = relight(dir, "wrong", {"--temporal", "--frames", "5-6"});
  EXPECT_EQ(wrong.code, 0);
  EXPECT_THAT(wrong.err, HasSubstr("give --motion-scale"));
  EXPECT_EQ(relight(dir, "bad", {"--temporal", "--motion-scale", "1"}).code, 2);
}

TEST(TemporalRuns, DoNotTakeMotionToAFrameThatIsNotTheLast) {
  const TempDir dir;
  write_moving_sequence(dir, {1, 1});
  for (const std::string frames : {"5,7", "8,7"}) {
    ASSERT_EQ(relight(dir, "gap" + frames, {"--temporal", "--frames", frames}).err, "");
    EXPECT_THAT(plan_of(dir, "gap" + frames + ".7")["reasons"].dump(),
                HasSubstr("motion is not used"));
  }
}

TEST(Filters, AreNamedInThePlan) {
  const TempDir dir;
  write_sequence(dir, 0);
  for (const std::string name : {"none", "box", "gaussian", "normal", "depth", "geometry"}) {
    const Finished done = run_tool({"info", dir / "in.5.exr", "--json", "--filter", name});
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(parse_json(done.out)["plan"]["filter"], name);
  }
}

TEST(Filters, OfTheSourceAreNamedInThePlanAndTheListing) {
  const TempDir dir;
  write_sequence(dir, 0);
  for (const auto& [method, filter] : {std::pair{"ssao-fade", "gaussian"}, {"sao", "depth"}}) {
    const std::vector<std::string> words = {"info",   dir / "in.5.exr", "--filter",
                                            "source", "--method",       method};
    const Finished done = run_tool(words);
    EXPECT_THAT(done.out, HasSubstr("filter " + std::string(filter) + ")"));
    EXPECT_THAT(done.out, HasSubstr("filter " + std::string(filter) + ": that of the method's"));
    std::vector<std::string> json_words = words;
    json_words.push_back("--json");
    EXPECT_EQ(parse_json(run_tool(json_words).out)["plan"]["filter"], filter);
  }
  EXPECT_THAT(run_tool({"--list-methods"}).out,
              HasSubstr("\n  source filter: gaussian, on the map"));
}

/// The filter at half resolution is part of each frame, before the mean over frames.
TEST(Filters, OfTheSourceGoWithTemporal) {
  const TempDir dir;
  write_sequence(dir, 0);
  const std::vector<std::string> source = {"--method", "ssao-fade", "--filter", "source"};
  const auto run = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> words = {dir / "in.@.exr", "-o", dir / (out + ".@.exr"),
                                      "--pixel-type", "float"};
    words.insert(words.end(), source.begin(), source.end());
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(run_tool(words).code, 0);
  };
  run("mean", {"--temporal", "--frames", "5-6"});
  for (const std::string frame : {"5", "6"}) run("alone", {"--frames", frame, "--seed", frame});
  const Plane<float> mean = ao(dir, "mean.6"), a = ao(dir, "alone.5"), b = ao(dir, "alone.6");
  EXPECT_NE(a.pixels, b.pixels);
  for (std::size_t i = 0; i < mean.size(); ++i) EXPECT_NEAR(mean[i], (a[i] + b[i]) / 2, 1e-5);
}

}  // namespace
}  // namespace ssdo::test::temporal_test
