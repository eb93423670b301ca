// SPDX-License-Identifier: Apache-2.0
//
// A real frame whose layers are stored in other ways, or wrongly: the picture stays the same.
#include <gmock/gmock.h>

#include <ImfOutputFile.h>
#include <cmath>
#include <fstream>
#include <functional>
#include <glm/mat3x3.hpp>
#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::wrong_layers_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kPosition = "ViewLayer.Position";
constexpr const char* kNormal = "ViewLayer.Normal";
constexpr const char* kDepth = "ViewLayer.Depth.Z";

/// P, N, albedo and depth of the still life, without alpha.
FramePart still_life() {
  const ExrReader file(data("still_life.exr"));
  const ExrPart& part = file.parts()[0];
  FramePart frame{"", part.data_window, part.display_window, {}, Imf::FLOAT, {}};
  for (const ExrChannel& c : part.channels) {
    if (c.name.find("Combined") == std::string::npos)
      frame.channels[c.name] = file.read(0, std::vector{c.name})[0];
  }
  return frame;
}

/// Replaces every vector of a layer; `map` is given the pixel's index too.
void change(FramePart& part, const std::string& layer,
            const std::function<glm::vec3(const glm::vec3&, std::size_t)>& map) {
  Plane<float>&x = part.channels.at(layer + ".X"), &y = part.channels.at(layer + ".Y"),
  &z = part.channels.at(layer + ".Z");
  for (std::size_t i = 0; i < x.size(); ++i) {
    const glm::vec3 v = map({x[i], y[i], z[i]}, i);
    x[i] = v.x, y[i] = v.y, z[i] = v.z;
  }
}

/// The camera that the frame was rendered with.
struct Pose {
  glm::dmat3 rotation;
  glm::dvec3 translation;
};

Pose pose() {
  const json rows = parse_json(read_file(data("still_life.camera.json")))["world_to_camera"];
  Pose p;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) p.rotation[column][row] = rows[row][column];
    p.translation[row] = rows[row][3];
  }
  return p;
}

class WrongLayers : public testing::Test {
 protected:
  Plane<float> ao(const FramePart& part, std::vector<std::string> flags = {}) {
    write_frame(dir_ / "in.exr", part);
    flags.insert(flags.begin(),
                 {dir_ / "in.exr", "-o", dir_ / "out.exr", "--overwrite", "--products", "ao",
                  "--quality", "draft", "--pixel-type", "float"});
    const Finished done = run_tool(flags);
    EXPECT_EQ(done.code, 0) << done.err;
    said_ = done.err;
    return channel(dir_ / "out.exr", "ao.Y");
  }

  /// RMSE over the surfaces against the frame as it is.
  double off(const FramePart& part, const std::vector<std::string>& flags = {}) {
    static const FramePart frame = still_life();
    static const Plane<float> expected = ao(frame);
    const Plane<float> found = ao(part, flags);
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (frame.channels.at(kDepth)[i] > 1e9f) {
        EXPECT_EQ(found[i], 1);  // background
        continue;
      }
      sum += std::pow(double(found[i]) - double(expected[i]), 2);
      count += 1;
    }
    return std::sqrt(sum / count);
  }

  TempDir dir_;
  std::string said_;
};

TEST_F(WrongLayers, NormalsOfOtherAxesAreBroughtToThoseOfP) {
  const glm::mat3 to_camera(pose().rotation);
  FramePart opencv = still_life(), y_up = opencv, mirrored = opencv;
  change(opencv, kNormal,
         [&](const glm::vec3& n, std::size_t) { return to_camera * n * glm::vec3(1, -1, -1); });
  change(y_up, kNormal, [](const glm::vec3& n, std::size_t) { return glm::vec3(n.x, n.z, -n.y); });
  change(mirrored, kNormal,
         [](const glm::vec3& n, std::size_t) { return n * glm::vec3(-1, 1, 1); });
  EXPECT_LT(off(opencv), 2e-3);
  EXPECT_LT(off(y_up), 2e-3);
  EXPECT_LT(off(mirrored), 2e-3);
}

TEST_F(WrongLayers, NormalsOfAShiftedFrameAreRebuiltWithAWarning) {
  const FramePart right = still_life();
  for (const std::size_t shift : {10, 40}) {
    FramePart shifted = right;
    change(shifted, kNormal, [&](const glm::vec3&, std::size_t i) {
      const std::size_t from = (i + shift) % right.channels.at(kDepth).size();
      return glm::vec3(right.channels.at("ViewLayer.Normal.X")[from],
                       right.channels.at("ViewLayer.Normal.Y")[from],
                       right.channels.at("ViewLayer.Normal.Z")[from]);
    });
    EXPECT_LT(off(shifted), 0.05);
    EXPECT_THAT(said_, HasSubstr("normals do not belong to P"));
  }
}

TEST_F(WrongLayers, DepthNeverOverrulesP) {
  const FramePart right = still_life();
  const auto with = [&](const std::function<float(float)>& map) {
    FramePart part = right;
    for (float& z : part.channels.at(kDepth).pixels) z = map(z);
    return part;
  };
  // Background as the far clip, beside P and N of 0.
  for (const float far : {1e4f, 65504.0f}) {
    EXPECT_LT(off(with([=](float z) { return z > 1e9f ? far : z; })), 1e-6);
    EXPECT_EQ(said_, "");
  }
  EXPECT_LT(off(with([](float z) { return std::clamp((z - 8) / 12, 0.0f, 1.0f); })), 1e-6);
  EXPECT_THAT(said_, HasSubstr("depth contradicts P"));
  EXPECT_LT(off(with([](float z) { return -z; })), 1e-6);
  EXPECT_THAT(said_, HasSubstr("sign is turned"));
}

TEST_F(WrongLayers, PInCameraSpaceIsSoBesideACameraFile) {
  const Pose camera = pose();
  for (const glm::vec3& signs : {glm::vec3(1), glm::vec3(1, -1, -1)}) {
    FramePart part = still_life();
    change(part, kPosition, [&](const glm::vec3& p, std::size_t i) {
      if (part.channels.at(kDepth)[i] > 1e9f) return glm::vec3(0);
      return signs * glm::vec3(camera.rotation * glm::dvec3(p) + camera.translation);
    });
    EXPECT_LT(off(part, {"--camera", data("still_life.camera.json")}), 2e-3);
    EXPECT_EQ(said_, "");
  }
}

TEST_F(WrongLayers, LossyCompressionOfPIsWarnedOf) {
  const FramePart part = still_life();
  for (const auto& [compression, name] :
       {std::pair{Imf::DWAA_COMPRESSION, "DWA"}, std::pair{Imf::PXR24_COMPRESSION, "PXR24"}}) {
    Imf::Header header(box_of(part.display), box_of(part.data));
    header.compression() = compression;
    Imf::FrameBuffer buffer;
    for (const auto& [channel, plane] : part.channels) {
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
      buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, plane.pixels.data(), box_of(part.data)));
    }
    {
      Imf::OutputFile file((dir_ / "lossy.exr").c_str(), header);
      file.setFrameBuffer(buffer);
      file.writePixels(part.data.height());
    }
    const Finished done = run_tool({"info", dir_ / "lossy.exr"});
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.out, HasSubstr(std::string("lossy compression (") + name + ")"));
  }
  EXPECT_THAT(run_tool({"info", data("still_life.exr")}).out, Not(HasSubstr("lossy")));
}

TEST_F(WrongLayers, PixelsWithoutNeighboursKeepTheirNormals) {
  FramePart part = still_life();
  const int width = part.data.width();
  const auto shows = [=](std::size_t i) { return (int(i) % width + int(i) / width) % 2 == 0; };
  for (const char* layer : {kPosition, kNormal}) {
    change(part, layer,
           [&](const glm::vec3& v, std::size_t i) { return shows(i) ? v : glm::vec3(0); });
  }
  for (std::size_t i = 0; i < part.channels.at(kDepth).size(); ++i)
    if (!shows(i)) part.channels.at(kDepth)[i] = 1e10f;
  write_frame(dir_ / "checkerboard.exr", part);
  const Finished done = run_tool({"info", dir_ / "checkerboard.exr", "--json"});
  ASSERT_EQ(done.code, 0) << done.err;
  const json found = parse_json(done.out);
  EXPECT_EQ(found["normals"]["space"], "the space of P");
  EXPECT_EQ(found["normals"]["rebuilt"], 0);
}

}  // namespace
}  // namespace ssdo::test::wrong_layers_test
