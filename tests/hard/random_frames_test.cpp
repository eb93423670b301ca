// SPDX-License-Identifier: Apache-2.0
//
// Random frames, from file to products, held to what is true of every frame. A frame that fails
// prints its seed:
//   SSDO_RANDOM_SEED=0x...  makes that frame alone and says all about it
//   SSDO_RANDOM_FRAMES=N    makes N frames; the first ones are those of a usual run
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <exception>
#include <fstream>
#include <map>

#include "error.h"
#include "hard/frame_properties.h"
#include "support/estimate_light.h"
#include "support/report.h"

namespace ssdo::test::random_frames_test {
namespace {

constexpr int kShards = 4, kFrames = 600;

/// Most frames that may be refused: those whose camera nothing tells.
constexpr double kMostRefused = 0.15;

/// One frame in so many at least has a property measured.
constexpr int kFewest = 20;

constexpr int kMostPrinted = 20;

/// What a property was found to be over many frames.
struct Tally {
  int frames = 0;
  double worst = 0, sum = 0;

  void add(double value) {
    ++frames, sum += value;
    if (!(value <= worst)) worst = value;
  }
};

class RandomFrames : public testing::TestWithParam<int> {
 protected:
  void check(std::uint64_t seed, bool says_all) {
    const RandomShot shot = random_shot(seed);
    if (says_all) fmt::print("{}\n", shot.describe());
    ++frames_;
    try {
      check(shot, says_all);
    } catch (const Error& error) {
      if (says_all) fmt::print("  refused: {}\n", error.what());
      ++refused_;
      if (error.code != ExitCode::layer) fail(shot, fmt::format("refused: {}", error.what()));
    } catch (const std::exception& error) {
      fail(shot, fmt::format("exception: {}", error.what()));
    }
  }

  void check_means() {
    for (const FrameProperty& property : frame_properties()) {
      const Tally& tally = tallies_[property.name];
      EXPECT_LE(tally.sum, property.mean_bound * tally.frames) << property.name;
      EXPECT_GE(tally.frames, frames_ / kFewest) << property.name << " is hardly measured";
    }
    EXPECT_LE(refused_, kMostRefused * frames_ + 5);
  }

  std::string report() const {
    std::string text = fmt::format("random frames: {} made, {} refused\n\n", frames_, refused_);
    text += "| | frames | mean | worst |\n|---|---|---|---|\n";
    for (const auto& [name, tally] : tallies_)
      text += fmt::format("| {} | {} | {:.2g} | {:.2g} |\n", name, tally.frames,
                          tally.sum / std::max(tally.frames, 1), tally.worst);
    return text;
  }

 private:
  void check(const RandomShot& shot, bool says_all) {
    const Frame frame = read_frame(shot);
    if (says_all)
      for (const std::string& reason : frame.plan.reasons) fmt::print("  {}\n", reason);
    const Estimate found = estimate_light(frame.scene, frame.plan);
    for (const FrameProperty& property : frame_properties()) {
      if (frame.plan.prior && !property.holds_with_prior) continue;
      const Measured measured = property.measure({shot, frame, found});
      if (!measured) continue;
      tallies_[property.name].add(measured->value);
      const std::string what =
          fmt::format("{}: {:.3g}, {}", property.name, measured->value, measured->where);
      if (says_all) fmt::print("  {}\n", what);
      if (!(measured->value <= property.bound)) fail(shot, what);
    }
  }

  void fail(const RandomShot& shot, const std::string& what) {
    if (++failures_ > kMostPrinted) return;
    ADD_FAILURE() << fmt::format("SSDO_RANDOM_SEED={:#x}: {} | {}", shot.seed, what,
                                 shot.describe());
  }

  std::map<std::string_view, Tally> tallies_;
  int frames_ = 0, refused_ = 0, failures_ = 0;
};

/// Of frame number `i`: spread over all numbers.
std::uint64_t seed_of(int i) { return 0x9e3779b97f4a7c15u * std::uint64_t(i + 1); }

TEST_P(RandomFrames, KeepWhatIsTrueOfEveryFrame) {
  if (const char* seed = std::getenv("SSDO_RANDOM_SEED")) {
    if (GetParam() == 0) check(std::strtoull(seed, nullptr, 0), true);
    return;
  }
  const char* count = std::getenv("SSDO_RANDOM_FRAMES");
  const int frames = count ? std::atoi(count) : kFrames;
  // A crash or a test that does not end leaves the seed of its frame here.
  const std::string last = fmt::format("{}/random_frames_{}.seed", SSDO_REPORT_DIR, GetParam());
  for (int i = GetParam(); i < frames; i += kShards) {
    std::ofstream(last) << fmt::format("SSDO_RANDOM_SEED={:#x}\n", seed_of(i));
    check(seed_of(i), false);
  }
  check_means();
  write_report(fmt::format("random_frames_{}.md", GetParam()), report());
}

INSTANTIATE_TEST_SUITE_P(Shards, RandomFrames, testing::Range(0, kShards));

}  // namespace
}  // namespace ssdo::test::random_frames_test
