// SPDX-License-Identifier: Apache-2.0
#include "prior/inputs.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "prior/vectors.h"

namespace ssdo::test::inputs_test {
namespace {

/// Depth and normals of the frame that the training has its vectors of, in the space of a camera
/// with these values.
Geometry frame_of_vectors(const std::vector<float>& camera) {
  const auto axis = [&](std::size_t i) {
    return glm::vec3(camera[i], camera[i + 1], camera[i + 2]);
  };
  // Rows right, up and back.
  const glm::mat3 to_camera = glm::transpose(glm::mat3(axis(0), axis(3), -axis(6)));
  const auto file = OIIO::ImageInput::open(SSDO_SOURCE_DIR "/data/room_corner.exr");
  const OIIO::ImageSpec& spec = file->spec();
  std::vector<float> pixels(std::size_t(spec.width) * std::size_t(spec.height) *
                            std::size_t(spec.nchannels));
  file->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.data());
  const auto channel = [&](const char* name) {
    const int at = spec.channelindex(std::string("ViewLayer.") + name);
    EXPECT_GE(at, 0) << name;
    return std::size_t(std::max(at, 0));
  };
  const std::size_t depth = channel("Depth.Z"), normal = channel("Normal.X");
  Geometry g;
  g.window = g.display = {0, 0, spec.width, spec.height};
  g.camera.fx = spec.width / (2 * double(camera[9])), g.camera.cx = spec.width / 2.0;
  g.camera.fy = spec.height / (2 * double(camera[10])), g.camera.cy = spec.height / 2.0;
  g.surfaces = Surfaces(spec.width, spec.height);
  for (int y = 0; y < spec.height; ++y) {
    for (int x = 0; x < spec.width; ++x) {
      const float* from = &pixels[g.surfaces.index(x, y) * std::size_t(spec.nchannels)];
      const glm::vec3 n(from[normal], from[normal + 1], from[normal + 2]);
      if (!(from[depth] < 1e9f) || glm::length(n) == 0) continue;
      const glm::vec3 p(g.camera.unproject({x + 0.5, y + 0.5}, double(from[depth])));
      g.surfaces.set(x, y, {p, to_camera * glm::normalize(n), 0});
    }
  }
  return g;
}

/// The estimate that data/prior/vectors.py makes up.
PriorGrid made_up(const Geometry& g) {
  PriorGrid s = make_prior_grid(g, {0, 0, g.surfaces.width, g.surfaces.height});
  EXPECT_EQ(s.step, 1);
  s.ao = s.open_ao = s.guessed = Plane<float>::like(g.surfaces);
  s.bent = Plane<glm::vec3>::like(g.surfaces);
  for (int y = 0; y < g.surfaces.height; ++y) {
    for (int x = 0; x < g.surfaces.width; ++x) {
      const double ao = 0.5 + 0.3 * std::sin(0.05 * x) * std::cos(0.07 * y);
      s.ao(x, y) = float(ao), s.open_ao(x, y) = float(std::min(1.0, ao + 0.1));
      s.guessed(x, y) = float(0.3 + 0.2 * std::cos(0.03 * (x + y)));
      s.bent(x, y) = g.surfaces(x, y).normal;
    }
  }
  return s;
}

TEST(PriorInputs, AreThoseOfTheTraining) {
  const PriorVectors vectors = prior_vectors();
  ASSERT_EQ(vectors.camera.size(), 11u);
  ASSERT_GE(vectors.places.size(), 32u);
  const Geometry geometry = frame_of_vectors(vectors.camera);
  const PriorGrid grid = made_up(geometry);
  // z is up.
  const glm::vec3 up(vectors.camera[2], vectors.camera[5], -vectors.camera[8]);
  for (const PriorVector& place : vectors.places) {
    const PriorInputs inputs(grid, geometry, place.upright ? std::optional(up) : std::nullopt,
                             place.radius);
    const auto stride = std::size_t(geometry.surfaces.width);
    std::vector<float> rows(PriorInputs::kOwn * stride);
    inputs.write(place.row, stride, rows.data());
    std::vector<float> found;
    for (std::size_t c = 0; c < PriorInputs::kOwn; ++c)
      found.push_back(rows[c * stride + std::size_t(place.column)]);
    found.insert(found.end(), inputs.shared().begin(), inputs.shared().end());
    ASSERT_EQ(found.size(), place.inputs.size());
    for (std::size_t c = 0; c < found.size(); ++c)
      EXPECT_NEAR(found[c], place.inputs[c], 2e-4)
          << "input " << c << " at column " << place.column;
  }
}

}  // namespace
}  // namespace ssdo::test::inputs_test
