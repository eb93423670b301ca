// SPDX-License-Identifier: Apache-2.0
//
// The real frames of data/ against the path tracer. The errors are printed; the bounds are what was
// measured plus a few per cent, so that a loss is noticed. They are the method's bias, not noise.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "filters/geometry_filter.h"
#include "frame.h"
#include "io/exr_reader.h"

namespace ssdo::test {
namespace {

const std::string kData = std::string(SSDO_SOURCE_DIR) + "/data/";

struct Bounds {
  double ao_small, ao_large, direct, bounce;
};

struct Scene {
  std::string name, environment, method;
  double radius_small, radius_large;  ///< of the occlusion truth
  Bounds bounds;
};

std::array<Plane<float>, 3> read_truth(const Scene& scene, const std::string& name,
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

Result run(const Scene& scene, const std::string& environment, std::optional<double> radius) {
  Options options;
  options.model.method = scene.method;
  options.model.radius = radius;
  options.light.env = environment;
  Frame frame = prepare_frame(options, Light(options.light), kData + scene.name + ".exr", {});
  const Plan& plan = frame.plan;
  const Products raw = plan.method->estimate({frame.geometry,
                                              frame.gbuffer.albedo,
                                              frame.gbuffer.radiance,
                                              frame.environment,
                                              plan.products,
                                              plan.radius,
                                              plan.bounces,
                                              0,
                                              plan.parameters,
                                              {},
                                              plan.slices,
                                              plan.steps,
                                              &frame.hidden,
                                              frame.light_model ? &*frame.light_model : nullptr});
  Products filtered = filter_geometry(raw, frame.geometry, plan.method->pattern_size);
  return {std::move(frame.geometry), std::move(filtered)};
}

class Truth : public testing::TestWithParam<Scene> {};

TEST_P(Truth, AoDirectAndBounceStayWithinWhatWasMeasured) {
  const Scene& scene = GetParam();
  for (const double radius : {scene.radius_small, scene.radius_large}) {
    const Result r = run(scene, "1", radius);
    const Error2 e = compare(r.geometry, read_truth(scene, fmt::format("ao_{:g}", radius), "AO"), 1,
                             [&](std::size_t i, int) { return r.products.ao[i]; });
    fmt::print("{:<8} {:<12} ao, radius {:<5g} RMSE {:.3f}  bias {:+.3f}\n", scene.method,
               scene.name, radius, e.rmse, e.bias);
    EXPECT_LT(e.rmse, radius == scene.radius_small ? scene.bounds.ao_small : scene.bounds.ao_large);
  }
  const Result r = run(scene, kData + "environments/" + scene.environment, std::nullopt);
  const Error2 direct = compare(r.geometry, read_truth(scene, "env_direct", "DiffDir"), 1,
                                [&](std::size_t i, int c) { return r.products.direct[i][c]; });
  const Error2 bounce = compare(r.geometry, read_truth(scene, "env_bounce1", "DiffInd"), 4,
                                [&](std::size_t i, int c) { return r.products.bounce[i][c]; });
  fmt::print("{:<8} {:<12} direct           relative RMSE {:.3f}  bias {:+.3f}\n", scene.method,
             scene.name, direct.rmse / direct.mean, direct.bias / direct.mean);
  fmt::print("{:<8} {:<12} bounce, 4x4      relative RMSE {:.3f}  bias {:+.3f}\n", scene.method,
             scene.name, bounce.rmse / bounce.mean, bounce.bias / bounce.mean);
  EXPECT_LT(direct.rmse / direct.mean, scene.bounds.direct);
  EXPECT_LT(bounce.rmse / bounce.mean, scene.bounds.bounce);
}

INSTANTIATE_TEST_SUITE_P(
    Frames, Truth,
    testing::Values(
        Scene{"still_life", "sky.exr", "bitmask", 0.5, 2, {0.052, 0.053, 0.15, 0.39}},
        Scene{"room_corner", "studio.exr", "bitmask", 0.25, 1, {0.039, 0.037, 0.19, 0.31}},
        Scene{"still_life", "sky.exr", "ssdo", 0.5, 2, {0.124, 0.232, 0.26, 1.15}},
        Scene{"room_corner", "studio.exr", "ssdo", 0.25, 1, {0.069, 0.132, 0.18, 0.75}}),
    [](const auto& scene) { return scene.param.method + "_" + scene.param.name; });

}  // namespace
}  // namespace ssdo::test
