// SPDX-License-Identifier: Apache-2.0
//
// The real frames of data/ against the path tracer, with every method: nothing that is added may
// cost what was reached. The errors are the methods' bias, not noise: the scalar build,
// AVX2 and AVX-512 stay within the margin.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "estimators/recorded_errors.h"
#include "estimators/registry.h"
#include "filters/geometry_filter.h"
#include "frame.h"
#include "io/exr_reader.h"

namespace ssdo::test {
namespace {

const std::string kData = std::string(SSDO_SOURCE_DIR) + "/data/";

/// A frame, the radii of its truth, and the environment that lights it.
struct Subject {
  std::string name, environment;
  double radius_small, radius_large;
};
const Subject kStillLife{"still_life", "sky.exr", 0.5, 2},
    kRoomCorner{"room_corner", "studio.exr", 0.25, 1};

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
  return all;
}

std::array<Plane<float>, 3> read_truth(const Subject& scene, const std::string& name,
                                       const std::string& layer) {
  const ExrReader file(kData + "truth/" + scene.name + "/" + name + ".exr");
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
  for (int y = 0; y + block <= g.surfel.height; y += block) {
    for (int x = 0; x + block <= g.surfel.width; x += block) {
      for (int c = 0; c < 3; ++c) {
        double difference = 0, level = 0;
        int surfaces = 0;
        for (int i = 0; i < block * block; ++i) {
          const std::size_t at = g.surfel.index(x + i % block, y + i / block);
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

/// The pipeline up to the filter.
struct Result {
  Geometry geometry;
  Products products;
};

Result run(const std::string& method, const Subject& scene, const std::string& environment,
           std::optional<double> radius) {
  FrameOptions options;
  options.model.method = method;
  if (method == "trace") options.model.set = {"samples=16"};
  if (find_method(method).takes.radius) options.model.radius = radius;
  options.light.env = environment;
  Frame frame =
      prepare_frame(options, Lighting(options.light), {kData + scene.name + ".exr", {}, {}});
  const Plan& plan = frame.plan;
  Geometry& geometry = frame.scene.geometry;
  Products filtered = filter_geometry(plan.method->estimate(frame.scene, plan.request, {}),
                                      geometry, plan.method->pattern_size);
  return {std::move(geometry), std::move(filtered)};
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
    const Result r = run(method, scene, "1", radius);
    const Error2 e = compare(r.geometry, read_truth(scene, fmt::format("ao_{:g}", radius), "AO"), 1,
                             [&](std::size_t i, int) { return r.products.ao[i]; });
    expect_recorded(fmt::format("ao at {:g}", radius), e, 1,
                    radius == scene.radius_small ? recorded.ao_small : recorded.ao_large);
  }
  const Result r = run(method, scene, kData + "environments/" + scene.environment, std::nullopt);
  const Error2 direct = compare(r.geometry, read_truth(scene, "env_direct", "DiffDir"), 1,
                                [&](std::size_t i, int c) { return r.products.direct[i][c]; });
  expect_recorded("direct", direct, direct.mean, recorded.direct);
  if (r.products.bounce.empty()) return;
  const Error2 bounce = compare(r.geometry, read_truth(scene, "env_bounce1", "DiffInd"), 4,
                                [&](std::size_t i, int c) { return r.products.bounce[i][c]; });
  expect_recorded("bounce", bounce, bounce.mean, recorded.bounce);
}

INSTANTIATE_TEST_SUITE_P(Frames, Truth, testing::ValuesIn(cases()), [](const auto& one) {
  std::string name = one.param.method + "_" + one.param.scene.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace ssdo::test
