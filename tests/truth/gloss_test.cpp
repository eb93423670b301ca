// SPDX-License-Identifier: Apache-2.0
//
// The product specular against the path tracer, on the small corner of data/truth. All of its
// surfaces are rough mirrors without Fresnel, whose neighbours send no light.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "filters/light_visibility.h"
#include "io/exr/exr_reader.h"
#include "relight/frame.h"
#include "relight/relight.h"

namespace ssdo::test::gloss_test {
namespace {

const std::string kFolder = std::string(SSDO_SOURCE_DIR) + "/data/truth/corner/";

Plane<glm::vec3> found(const std::string& roughness, const std::string& environment,
                       Geometry& geometry) {
  FrameOptions options;
  options.model.set = {"roughness=" + roughness, "ior=1e6"};
  options.output.products = {"specular"};
  options.light.env = environment;
  OtherPictures pictures;
  Frame frame =
      prepare_frame(options, Lighting(options.light), pictures, {kFolder + "gbuffer.exr", {}, {}});
  frame.scene.senders.albedo = {};
  Request request = frame.plan.request;
  request.products.bounce = false, request.bounces = 0;
  const Method& method = *frame.plan.method;
  geometry = frame.scene.geometry;
  return filter_visibility(*frame.plan.filter, method.estimate(frame.scene, request, {}),
                           frame.scene, method.pattern_size)
      .specular;
}

struct Case {
  std::string roughness, world, environment;
  double recorded;  ///< RMSE over the mean
};

TEST(TruthOfMirrors, ErrorsAreThoseRecorded) {
  for (const Case& c : {Case{"0.2", "white", "1", 0.2731},
                        Case{"0.5", "env", kFolder + "environment.exr", 0.2456}}) {
    Geometry geometry;
    const Plane<glm::vec3> specular = found(c.roughness, c.environment, geometry);
    const ExrReader file(kFolder + fmt::format("truth_gloss_{}_{}.exr", c.roughness, c.world));
    const std::vector<std::string> channels = {"ViewLayer.GlossDir.R", "ViewLayer.GlossDir.G",
                                               "ViewLayer.GlossDir.B"};
    const std::vector<Plane<float>> truth = file.read(0, channels);
    double square = 0, mean = 0, bias = 0, count = 0;
    for (std::size_t i = 0; i < specular.size(); ++i) {
      if (!geometry.is_surface(i)) continue;
      for (int k = 0; k < 3; ++k) {
        const double off = double(specular[i][k]) - double(truth[std::size_t(k)][i]);
        square += off * off, bias += off, mean += double(truth[std::size_t(k)][i]), ++count;
      }
    }
    const double error = std::sqrt(square / count) / (mean / count);
    fmt::print("roughness {}, {}: RMSE {:.4f}, recorded {:.4f}, bias {:+.4f}\n", c.roughness,
               c.world, error, c.recorded, bias / mean);
    EXPECT_LT(error, 1.02 * c.recorded + 0.001) << "worse than recorded";
    EXPECT_GT(error, 0.98 * c.recorded - 0.001) << "better than recorded; record the new value";
  }
}

}  // namespace
}  // namespace ssdo::test::gloss_test
