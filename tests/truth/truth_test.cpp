// SPDX-License-Identifier: Apache-2.0
//
// The real frames of data/ against the path tracer, with every method: nothing that is added may
// cost what was reached. The errors are the methods' bias, not noise: the scalar build,
// AVX2 and AVX-512 stay within the margin. Also what overscan brings, there and, where they lie
// beside the repository, on further scenes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numeric>

#include "estimators/registry.h"
#include "io/exr/exr_reader.h"
#include "relight/frame.h"
#include "relight/relight.h"
#include "support/crop.h"
#include "support/estimate_light.h"
#include "truth/recorded_errors.h"

namespace ssdo::test::truth_test {
namespace {

const std::string kData = std::string(SSDO_SOURCE_DIR) + "/data/";

/// A frame, the environment that lights it, where its truth begins, and the radii of that.
struct Subject {
  std::string name, frame, environment, truth;
  double radius_small, radius_large;
  std::vector<std::string> also = {};  ///< other views
};

/// Of data/. `with` is what its file has beside the picture.
Subject of_data(const std::string& name, const std::string& environment, double radius_small,
                double radius_large, const std::string& with = "") {
  return {name + with,
          kData + name + with + ".exr",
          kData + "environments/" + environment,
          kData + "truth/" + name + "/",
          radius_small,
          radius_large};
}
const Subject kStillLife = of_data("still_life", "sky.exr", 0.5, 2),
              kRoomCorner = of_data("room_corner", "studio.exr", 0.25, 1),
              kRoomCornerOverscan = of_data("room_corner", "studio.exr", 0.25, 1, "_overscan");

/// A smaller copy of one of further_scenes(); data/truth/corner/make.py made it.
std::vector<Subject> small_scene(const std::string& file, const std::vector<std::string>& also) {
  const std::string folder = kData + "truth/corner/";
  Subject subject{"corner", folder + file, folder + "environment.exr", folder + "truth_", 0.5, 2};
  for (const std::string& view : also) subject.also.push_back(folder + view);
  return {subject};
}

/// Further scenes, which are too large for the repository: empty where they are not there.
std::vector<Subject> further_scenes(const std::string& file, const std::vector<std::string>& also) {
  const std::string folder = std::string(SSDO_SOURCE_DIR) + "/../shared/truth/";
  if (!std::filesystem::exists(folder)) return {};
  const auto scene = [&](const std::string& name, const std::string& environment,
                         double radius_small, double radius_large) {
    const std::string of_scene = folder + "public/" + name + "/";
    Subject subject{
        name,         of_scene + file, folder + "env/" + environment, of_scene + "truth_",
        radius_small, radius_large};
    for (const std::string& view : also) subject.also.push_back(of_scene + view);
    return subject;
  };
  return {scene("corner", "venice.exr", 0.5, 2), scene("foliage", "venice.exr", 0.1, 0.5),
          scene("props", "sky.exr", 0.5, 2), scene("spheres", "venice.exr", 0.5, 2),
          scene("street", "sky.exr", 2, 10)};
}

struct Case {
  std::string method;
  Subject scene;
  TruthErrors recorded;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const RecordedErrors& errors : kRecordedErrors) {
    all.push_back({errors.method, kStillLife, errors.still_life});
    all.push_back({errors.method, kRoomCorner, errors.room_corner});
  }
  all.push_back({"bitmask", kRoomCornerOverscan, kRecordedRoomCornerOverscan});
  return all;
}

std::array<Plane<float>, 3> read_truth(const Subject& scene, const std::string& name,
                                       const std::string& layer) {
  const ExrReader file(scene.truth + name + ".exr");
  const std::string prefix = "ViewLayer." + layer + ".";
  const std::vector<std::string> channels = {prefix + "R", prefix + "G", prefix + "B"};
  auto planes = file.read(0, channels);
  return {std::move(planes[0]), std::move(planes[1]), std::move(planes[2])};
}

/// Root mean square over the surfaces, after averaging blocks of `block` pixels: the truth of the
/// bounce carries 4 % of noise per pixel.
struct Error2 {
  double rmse = 0, bias = 0, mean = 0;
};

template <class Value>
Error2 compare(const Geometry& g, const std::array<Plane<float>, 3>& truth, int block,
               const Value& value) {
  double sum2 = 0, sum = 0, mean = 0, count = 0;
  for (int y = 0; y + block <= g.surfaces.height; y += block) {
    for (int x = 0; x + block <= g.surfaces.width; x += block) {
      for (int c = 0; c < 3; ++c) {
        double difference = 0, level = 0;
        int surfaces = 0;
        for (int i = 0; i < block * block; ++i) {
          const std::size_t at = g.surfaces.index(x + i % block, y + i / block);
          if (!g.is_surface(at)) continue;
          difference += value(at, c) - truth[std::size_t(c)][at];
          level += truth[std::size_t(c)][at];
          ++surfaces;
        }
        if (surfaces < block * block) continue;
        difference /= surfaces;
        sum += difference, sum2 += difference * difference, mean += level / surfaces, ++count;
      }
    }
  }
  return {std::sqrt(sum2 / count), sum / count, mean / count};
}

/// The pipeline up to the filter, and what of its result the display window shows.
struct Result {
  Geometry geometry;
  Products products;
};

Result shown(const Geometry& geometry, const Products& products) {
  const Window &all = geometry.window, window = intersection(all, geometry.display);
  const Window part{window.x0 - all.x0, window.y0 - all.y0, window.x1 - all.x0, window.y1 - all.y0};
  Result result{crop(geometry, window), {}};
  for_each_plane(
      [&](const Product&, auto& to, const auto& from) {
        if (!from.empty()) to = crop(from, part);
      },
      result.products, products);
  return result;
}

Result run(const std::string& method, const Subject& scene, const LightOptions& light,
           std::optional<double> radius, bool guessed = false) {
  FrameOptions options;
  options.model.method = method;
  if (method == "trace") options.model.set = {"samples=16"};
  if (find_method(method).supports.radius) options.model.radius = radius;
  options.light = light;
  OtherPictures pictures;
  Frame frame =
      prepare_frame(options, Lighting(options.light), pictures, {scene.frame, {}, scene.also});
  frame.plan.request.products.guessed = guessed;
  const Geometry geometry = frame.scene.geometry;
  return shown(geometry, estimate_light(std::move(frame.scene), frame.plan).products);
}

LightOptions environment(const std::string& env) {
  LightOptions light;
  light.env = env;
  return light;
}

Error2 error_of_ao(const Result& r, const Subject& scene, const std::string& truth,
                   const std::string& layer) {
  return compare(r.geometry, read_truth(scene, truth, layer), 1,
                 [&](std::size_t i, int) { return r.products.ao[i]; });
}

Error2 error_of_direct(const Result& r, const Subject& scene, const std::string& of = "env") {
  return compare(r.geometry, read_truth(scene, of + "_direct", "DiffDir"), 1,
                 [&](std::size_t i, int c) { return r.products.direct[i][c]; });
}

Error2 error_of_bounce(const Result& r, const Subject& scene,
                       const std::string& of = "env_bounce1") {
  return compare(r.geometry, read_truth(scene, of, "DiffInd"), 4,
                 [&](std::size_t i, int c) { return r.products.bounce[i][c]; });
}

/// Notices a loss, and a gain that a later loss would hide.
void expect_recorded(const std::string& what, const Error2& error, double relative_to,
                     double recorded) {
  const double found = error.rmse / relative_to, margin = 0.02 * recorded + 0.001;
  fmt::print("{} RMSE {:.4f}, recorded {:.4f}, bias {:+.4f}\n", what, found, recorded,
             error.bias / relative_to);
  EXPECT_LT(found, recorded + margin) << what << ": worse than recorded";
  EXPECT_GT(found, recorded - margin) << what << ": better than recorded; record the new value";
}

class Truth : public testing::TestWithParam<Case> {};

TEST_P(Truth, ErrorsAreThoseRecorded) {
  const auto& [method, scene, recorded] = GetParam();
  for (const double radius : {scene.radius_small, scene.radius_large}) {
    const Error2 e = error_of_ao(run(method, scene, environment("1"), radius), scene,
                                 fmt::format("ao_{:g}", radius), "AO");
    expect_recorded(fmt::format("ao at {:g}", radius), e, 1,
                    radius == scene.radius_small ? recorded.ao_small : recorded.ao_large);
  }
  const Result r = run(method, scene, environment(scene.environment), std::nullopt);
  const Error2 direct = error_of_direct(r, scene);
  expect_recorded("direct", direct, direct.mean, recorded.direct);
  if (r.products.bounce.empty()) return;
  const Error2 bounce = error_of_bounce(r, scene);
  expect_recorded("bounce", bounce, bounce.mean, recorded.bounce);
}

/// How well the product guessed predicts the error of ao.
class Prediction {
 public:
  void add(const Result& r, const Subject& scene, const std::string& truth,
           const std::string& layer) {
    constexpr int kBlock = 8;
    const Plane<float> right = std::move(read_truth(scene, truth, layer)[0]);
    const Surfaces& surfaces = r.geometry.surfaces;
    for (int y = 0; y + kBlock <= surfaces.height; y += kBlock) {
      for (int x = 0; x + kBlock <= surfaces.width; x += kBlock) {
        double error = 0, guessed = 0;
        int count = 0;
        for (int i = 0; i < kBlock * kBlock; ++i) {
          const std::size_t at = surfaces.index(x + i % kBlock, y + i / kBlock);
          if (!r.geometry.is_surface(at)) continue;
          const double e = double(r.products.ao[at]) - double(right[at]),
                       g = double(r.products.guessed[at]);
          if (g < kLittle) little_.rmse += e * e, little_.mean += 1;
          error += std::abs(e), guessed += g, ++count;
        }
        if (count < kBlock * kBlock) continue;
        errors_.push_back(error / count), guesses_.push_back(guessed / count);
      }
    }
  }

  /// RMSE of the pixels of which less than this is guessed.
  static constexpr double kLittle = 0.05;
  double rmse_of_little() const { return std::sqrt(little_.rmse / little_.mean); }

  /// Spearman's correlation over blocks.
  double rank_correlation() const {
    const std::vector<double> a = ranks(errors_), b = ranks(guesses_);
    const double middle = double(a.size() - 1) / 2;
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double u = a[i] - middle, v = b[i] - middle;
      ab += u * v, aa += u * u, bb += v * v;
    }
    return ab / std::sqrt(aa * bb);
  }

 private:
  /// Equal values share their mean rank.
  static std::vector<double> ranks(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t j) { return values[i] < values[j]; });
    std::vector<double> rank(values.size());
    for (std::size_t from = 0, to = 0; from < order.size(); from = to) {
      while (to < order.size() && values[order[to]] == values[order[from]]) ++to;
      for (std::size_t i = from; i < to; ++i) rank[order[i]] = double(from + to - 1) / 2;
    }
    return rank;
  }

  Error2 little_;  ///< sum of squares, and their number as `mean`
  std::vector<double> errors_, guesses_;
};

/// The means over scenes of what the default method is wrong by.
class KnownGeometry : public testing::TestWithParam<RecordedKnownGeometry> {
 protected:
  /// Holds them to what is recorded; returns how well the product guessed predicts errors of ao.
  Prediction expect_recorded_over(const std::vector<Subject>& scenes) const;
};

Prediction KnownGeometry::expect_recorded_over(const std::vector<Subject>& scenes) const {
  const RecordedKnownGeometry& recorded = GetParam();
  Error2 small, large, white, direct, bounce;
  Prediction prediction;
  for (const Subject& scene : scenes) {
    const auto add = [&](Error2& sum, const std::string& what, const Error2& e, double relative) {
      fmt::print("{} {} {:.4f}\n", scene.name, what, e.rmse / relative);
      sum.rmse += e.rmse / relative / double(scenes.size());
      sum.bias += e.bias / relative / double(scenes.size());
    };
    const auto add_ao = [&](Error2& sum, std::optional<double> radius, const std::string& truth,
                            const std::string& layer) {
      const Result r = run("bitmask", scene, environment("1"), radius, true);
      add(sum, truth, error_of_ao(r, scene, truth, layer), 1);
      prediction.add(r, scene, truth, layer);
    };
    add_ao(small, scene.radius_small, fmt::format("ao_{:g}", scene.radius_small), "AO");
    add_ao(large, scene.radius_large, fmt::format("ao_{:g}", scene.radius_large), "AO");
    add_ao(white, std::nullopt, "white", "DiffDir");
    const Result r = run("bitmask", scene, environment(scene.environment), std::nullopt);
    const Error2 d = error_of_direct(r, scene), b = error_of_bounce(r, scene);
    add(direct, "direct", d, d.mean);
    add(bounce, "bounce", b, b.mean);
  }
  expect_recorded("ao, small radius", small, 1, recorded.ao_small);
  expect_recorded("ao, large radius", large, 1, recorded.ao_large);
  expect_recorded("ao, white world", white, 1, recorded.white);
  expect_recorded("direct", direct, 1, recorded.direct);
  expect_recorded("bounce", bounce, 1, recorded.bounce);
  return prediction;
}

TEST_P(KnownGeometry, ErrorsAreThoseRecorded) {
  const RecordedKnownGeometry& recorded = GetParam();
  const std::vector<Subject> scenes = further_scenes(recorded.file, recorded.also);
  if (scenes.empty()) GTEST_SKIP() << "the scenes are not there";
  if (std::getenv("CI") && !recorded.also.empty()) GTEST_SKIP() << "takes too long for CI";
  const Prediction prediction = expect_recorded_over(scenes);
  fmt::print("guessed: RMSE of ao {:.4f} where it is below {}, rank correlation {:.3f}\n",
             prediction.rmse_of_little(), Prediction::kLittle, prediction.rank_correlation());
  EXPECT_LT(prediction.rmse_of_little(), 0.035);
  EXPECT_NEAR(prediction.rank_correlation(), recorded.rank_guessed, 0.02);
}

class KnownGeometryOfASmallScene : public KnownGeometry {};

TEST_P(KnownGeometryOfASmallScene, ErrorsAreThoseRecorded) {
  expect_recorded_over(small_scene(GetParam().file, GetParam().also));
}

/// One lamp in a black world.
class Lamp : public testing::TestWithParam<RecordedLamp> {};

TEST_P(Lamp, ErrorsAreThoseRecorded) {
  const RecordedLamp& recorded = GetParam();
  const Subject scene = small_scene(recorded.file, recorded.also).front();
  LightOptions light = environment("0");
  light.lamp_files = {kData + "truth/corner/light_" + recorded.lamp + ".json"};
  const Result r = run("bitmask", scene, light, std::nullopt);
  const Error2 direct = error_of_direct(r, scene, "light_" + recorded.lamp),
               bounce = error_of_bounce(r, scene, "light_" + recorded.lamp + "_bounce");
  expect_recorded("direct", direct, direct.mean, recorded.direct);
  expect_recorded("bounce", bounce, bounce.mean, recorded.bounce);
}

INSTANTIATE_TEST_SUITE_P(Corner, Lamp, testing::ValuesIn(kRecordedLamps), [](const auto& one) {
  return one.param.lamp + std::to_string(one.param.also.size());
});

std::string name_of(const testing::TestParamInfo<RecordedKnownGeometry>& one) {
  return std::filesystem::path(one.param.file).stem().string() +
         std::to_string(one.param.also.size());
}

INSTANTIATE_TEST_SUITE_P(FurtherScenes, KnownGeometry, testing::ValuesIn(kRecordedKnownGeometry),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Corner, KnownGeometryOfASmallScene,
                         testing::ValuesIn(kRecordedKnownGeometryOfASmallScene), name_of);

INSTANTIATE_TEST_SUITE_P(Frames, Truth, testing::ValuesIn(cases()), [](const auto& one) {
  std::string name = one.param.method + "_" + one.param.scene.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace ssdo::test::truth_test
