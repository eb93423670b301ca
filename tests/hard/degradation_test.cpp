// SPDX-License-Identifier: Apache-2.0
//
// How much worse ao gets in hard cases, method by method: a table, written to the build folder, and
// held to what was measured. Every frame goes through a file and the reading of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimators/bitmask/request.h"
#include "filters/filter_products.h"
#include "filters/registry.h"
#include "hard/every_method.h"
#include "hard/recorded_degradation.h"
#include "support/average_picture.h"
#include "support/report.h"

namespace ssdo::test::degradation_test {
namespace {

const Window kFrame{0, 0, 96, 72};
constexpr float kRadius = 0.5f;

struct Difference {
  double sum2 = 0, count = 0;

  void add(double difference) { sum2 += difference * difference, ++count; }
  double rms() const { return std::sqrt(sum2 / std::max(count, 1.0)); }
};

/// A frame of the still life as a file holds it.
Geometry still_life(Imf::PixelType type, const glm::dvec3& moved) {
  Camera camera = usual_camera(kFrame);
  camera.origin += moved;
  const Surface scene = [&](const Ray& ray) {
    return hard_still_life()({ray.origin - moved, ray.direction});
  };
  FramePart part = frame_of(take_picture(scene, camera, kFrame));
  part.type = type;
  return read_through_file(part);
}

Geometry averaged_still_life(Plane<unsigned char>& averaged) {
  FramePart part =
      frame_of(average_picture(hard_still_life(), usual_camera(kFrame), kFrame, 2, averaged));
  part.channels.erase("ViewLayer.Depth.Z");
  return read_through_file(part);
}

Plane<float> ao_of(const Method& method, const Geometry& g) {
  const HardFrame frame{g, Plane<HalfColor>(g.surfaces.width, g.surfaces.height, glm::vec3(0.5f)),
                        Environment::constant(glm::vec3(1)), kRadius, 0};
  return filter_products(find_filter("geometry"), run_method(method, frame), g.surfaces,
                         method.pattern_size)
      .ao;
}

/// ao of the still life by rays.
Plane<float> truth() {
  Plane<float> ao(kFrame.width(), kFrame.height());
  const Surface scene = hard_still_life();
  const Camera camera = usual_camera(kFrame);
  for_each_row(ao.height, [&](int y) {
    for (int x = 0; x < ao.width; ++x)
      ao(x, y) = float(ao_by_rays(scene, point_at(scene, camera, kFrame, x, y), kRadius, 512));
  });
  return ao;
}

/// An open plane as a file holds it.
Geometry plane_in_file(Imf::PixelType type, const glm::dvec3& moved) {
  Camera camera = usual_camera(kFrame);
  camera.origin += moved;
  FramePart part = frame_of(take_picture(plane(moved, {0, 0, 1}), camera, kFrame));
  part.type = type;
  return read_through_file(part, 30);
}

Geometry tilted_plane(double degrees) {
  return geometry_of(ground(), leaning(camera_from_fov(30, kFrame, 1), degrees), kFrame);
}

struct Column {
  std::string title;
  double found = 0;
};

/// Frames and truth that all methods share.
class Frames {
 public:
  Frames() {
    const glm::dvec3 far(60, -40, 50), farther(1e6, -1e6, 1e6);
    lifes_ = {{"half P", still_life(Imf::HALF, {})},
              {"half P, origin 90 away", still_life(Imf::HALF, far)},
              {"origin 1.7e6 away", still_life(Imf::FLOAT, farther)}};
    planes_ = {{"plane at 50", tilted_plane(50)},
               {"plane, half P, origin 90 away", plane_in_file(Imf::HALF, far)},
               {"plane, origin 1.7e6 away", plane_in_file(Imf::FLOAT, farther)},
               {"plane at 85", tilted_plane(85)},
               {"plane at 89", tilted_plane(89)},
               {"plane at 89.9", tilted_plane(89.9)}};
  }

  std::vector<Column> measure(const Method& method) const {
    const Plane<float> clean = ao_of(method, clean_), averaged = ao_of(method, averaged_);
    std::vector<Column> columns = {{"clean, against rays", between(clean, rays_).rms()}};
    for (const auto& [title, geometry] : lifes_)
      columns.push_back({title, between(ao_of(method, geometry), clean).rms()});
    Difference at_edges, beside;
    for (int y = 0; y < clean.height; ++y) {
      for (int x = 0; x < clean.width; ++x) {
        if (at_edges_(x, y))
          at_edges.add(beyond_neighbours(averaged(x, y), clean, x, y));
        else
          beside.add(averaged(x, y) - clean(x, y));
      }
    }
    columns.push_back({"averaged edges", at_edges.rms()});
    columns.push_back({"beside them", beside.rms()});
    for (const auto& [title, geometry] : planes_) {
      const Plane<float> open(geometry.surfaces.width, geometry.surfaces.height, 1.0f);
      columns.push_back({title, between(ao_of(method, geometry), open).rms()});
    }
    return columns;
  }

 private:
  static Difference between(const Plane<float>& a, const Plane<float>& b) {
    Difference d;
    for (std::size_t i = 0; i < a.size(); ++i) d.add(a[i] - b[i]);
    return d;
  }

  /// How far a value lies beyond all that the clean frame has in and around a pixel: an average
  /// over an edge may be taken for either side of it.
  static double beyond_neighbours(float value, const Plane<float>& clean, int x, int y) {
    float least = 1, most = 0;
    for (int qy = std::max(y - 1, 0); qy < std::min(y + 2, clean.height); ++qy) {
      for (int qx = std::max(x - 1, 0); qx < std::min(x + 2, clean.width); ++qx)
        least = std::min(least, clean(qx, qy)), most = std::max(most, clean(qx, qy));
    }
    return value - std::clamp(value, least, most);
  }

  Geometry clean_ = still_life(Imf::FLOAT, {});
  Plane<unsigned char> at_edges_;
  Geometry averaged_ = averaged_still_life(at_edges_);
  std::vector<std::pair<std::string, Geometry>> lifes_, planes_;
  Plane<float> rays_ = truth();
};

TEST(Degradation, StaysWithinWhatWasMeasured) {
  const Frames frames;
  std::string table;
  for (const Method& method : methods()) {
    const std::vector<Column> columns = frames.measure(method);
    if (table.empty()) {
      std::string rule = "|---|";
      table = "| method |";
      for (const Column& column : columns) table += " " + column.title + " |", rule += "---|";
      table += "\n" + rule + "\n";
    }
    const auto row = kRecordedDegradation.find(method.name);
    const bool known = row != kRecordedDegradation.end() && row->second.size() == columns.size();
    EXPECT_TRUE(known) << method.name << ": nothing is recorded";
    table += fmt::format("| `{}` |", method.name);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double found = columns[i].found;
      table += fmt::format(" {:.4f} |", found);
      if (!known) continue;
      EXPECT_EQ(columns[i].title, kDegradationColumns[i]);
      EXPECT_LT(found, 1.05 * row->second[i] + 0.001) << method.name << ", " << columns[i].title;
    }
    table += "\n";
  }
  write_report(
      "hard_cases.md",
      "RMSE of ao, radius a sixth of the frame's width: of the clean frame against rays; of "
      "others against the same method's clean frame; of open planes against 1.\n\n" +
          table);
}

}  // namespace
}  // namespace ssdo::test::degradation_test
