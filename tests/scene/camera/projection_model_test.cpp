// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/projection_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

namespace ssdo::test::projection_model_test {
namespace {

/// A camera beside the axes, before points of a unit cube.
ProjectionModel true_model() {
  ProjectionModel model;
  model.rotation = glm::dmat3(glm::rotate(glm::dmat4(1), 0.4, glm::dvec3(1, 2, -1)));
  model.translation = {0.1, -0.2, 6};
  model.fx = 900, model.fy = 950, model.cx = 310, model.cy = 245;
  return model;
}

/// 500 points and where `model` shows them; `flat`: in the plane z = 0.
Samples samples_of(const ProjectionModel& model, bool flat = false) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> in_cube(-1, 1);
  Samples samples;
  for (int i = 0; i < 500; ++i) {
    const double x = in_cube(random), y = in_cube(random), z = in_cube(random);
    const glm::dvec3 p(x, y, flat ? 0 : z);
    samples.items.push_back({p, model.project(p)});
  }
  return samples;
}

TEST(ProjectionModel, ProjectsByHand) {
  ProjectionModel model;
  model.translation = {0, 0, 2};
  model.fx = 100, model.fy = 200, model.cx = 50, model.cy = 40;
  EXPECT_EQ(model.project({1, -0.5, 2}), glm::dvec2(75, 15));
  model.orthographic = true;
  EXPECT_EQ(model.project({1, -0.5, 2}), glm::dvec2(150, -60));
}

TEST(ProjectionModel, RefiningFindsTheCameraAgain) {
  const ProjectionModel truth = true_model();
  const Samples samples = samples_of(truth);
  ProjectionModel model = truth;
  model.rotation =
      glm::dmat3(glm::rotate(glm::dmat4(1), 0.02, glm::dvec3(0, 1, 1))) * truth.rotation;
  model.translation += glm::dvec3(0.05, -0.03, 0.2);
  model.fx *= 1.03, model.fy *= 0.98, model.cx += 6, model.cy -= 4;
  EXPECT_GT(reprojection_rms(model, samples), 1);
  refine(model, samples, false);
  EXPECT_LT(reprojection_rms(model, samples), 1e-8);
  EXPECT_NEAR(model.fx, truth.fx, 1e-6);
  EXPECT_NEAR(model.cy, truth.cy, 1e-6);
  EXPECT_LT(glm::distance(model.translation, truth.translation), 1e-8);
}

TEST(ProjectionModel, RefiningThePoseLeavesTheLens) {
  const ProjectionModel truth = true_model();
  ProjectionModel model = truth;
  model.translation += glm::dvec3(0.05, -0.03, 0.2);
  refine(model, samples_of(truth), true);
  EXPECT_LT(glm::distance(model.translation, truth.translation), 1e-8);
  EXPECT_EQ(model.fx, truth.fx);
  EXPECT_EQ(model.cx, truth.cx);
}

TEST(ProjectionModel, InliersLeaveOutWhatTheModelDoesNotExplain) {
  const ProjectionModel model = true_model();
  Samples samples = samples_of(model);
  for (int i = 0; i < 500; ++i) samples.items[std::size_t(i)].pixel.x += i % 2 ? 0.1 : -0.1;
  for (std::size_t i = 0; i < 50; ++i) samples.items[i].pixel.y += 3;
  EXPECT_EQ(inliers(model, samples).items.size(), 450u);
}

TEST(ProjectionModel, APlaneLeavesTheFocalLengthUncertain) {
  const ProjectionModel model = true_model();
  EXPECT_LT(focal_uncertainty(model, samples_of(model)), 1e-5);
  EXPECT_GT(focal_uncertainty(model, samples_of(model, true)), 0.01);
}

TEST(CollectSamples, CentresAndScalesWhatItTakes) {
  const Window window{10, 20, 74, 68};
  Plane<glm::vec3> positions(64, 48);
  Plane<unsigned char> valid(64, 48, 1);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) positions(x, y) = glm::vec3(100 + x, 3 * y, (x * y) % 7);
  valid(0, 0) = 0;
  const Samples samples = collect_samples(positions, valid, window);
  ASSERT_EQ(samples.items.size(), 64u * 48 - 1);
  EXPECT_EQ(samples.items[0].pixel, glm::dvec2(11.5, 20.5));
  glm::dvec3 mean(0), square(0);
  for (const Sample& s : samples.items) mean += s.p, square += s.p * s.p;
  EXPECT_LT(glm::length(mean), 1e-9 * double(samples.items.size()));
  EXPECT_NEAR((square.x + square.y + square.z) / double(samples.items.size()), 3, 1e-9);
  const glm::dvec3 first = samples.centre + samples.scale * samples.items[0].p;
  EXPECT_LT(glm::distance(first, glm::dvec3(101, 0, 0)), 1e-9);
  EXPECT_GT(std::abs(samples.axes[2].y), 0.99) << "the longest axis comes last";
}

TEST(CollectSamples, OfALargeFrameAreSpreadOverIt) {
  const Plane<glm::vec3> positions(400, 300, glm::vec3(1));
  const Samples samples =
      collect_samples(positions, Plane<unsigned char>(400, 300, 1), {0, 0, 400, 300});
  EXPECT_GT(samples.items.size(), 10000u);
  EXPECT_LT(samples.items.size(), 40000u);
  EXPECT_GT(samples.items.back().pixel.y, 299);
}

TEST(Quantile, IsTheValueBelowWhichAShareLies) {
  EXPECT_EQ(quantile({5, 1, 4, 2, 3}, 0.5), 3);
  EXPECT_EQ(quantile({5, 1, 4, 2, 3}, 1), 5);
  EXPECT_EQ(quantile({}, 0.5), 0);
}

}  // namespace
}  // namespace ssdo::test::projection_model_test
