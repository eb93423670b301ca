// SPDX-License-Identifier: Apache-2.0
#include "scene/other_views/merge.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "estimators/bitmask/request.h"
#include "scene/other_views/other_pictures.h"
#include "support/boxes.h"
#include "support/frame_file.h"
#include "support/temp_dir.h"

namespace ssdo::test::merge_test {
namespace {

const Window kFrame{0, 0, 120, 90}, kFine{0, 0, 96, 72}, kCoarse{0, 0, 48, 36};

class Merge : public testing::Test {
 protected:
  Merge()
      : frame_(geometry_of(
            scene_, look_at(camera_from_fov(40, kFrame, 1), {0, -5, 1}, {0, 0, 0.4}, {0, 0, 1}),
            kFrame)) {
    frame_.world_known = true;
  }

  OtherView view(const std::string& name, const Window& window, const glm::dvec3& eye,
                 bool albedo = true) {
    const Camera camera = look_at(camera_from_fov(45, window, 1), eye, {0, 0.3, 0.4}, {0, 0, 1});
    FramePart part = frame_of(take_picture(scene_, camera, window));
    for (const char* c : {"R", "G", "B"})
      if (!albedo) part.channels.erase(std::string("ViewLayer.DiffCol.") + c);
    write_frame(folder_.path() / name, part);
    return place(OtherPictures().also(folder_.path() / name), frame_);
  }

  OtherSurfaces merge(const std::vector<OtherView>& views) {
    std::vector<MergeCounts> counts;
    return merge_views(views, frame_, {}, counts);
  }

  const Box near_{{-0.5, -0.6, 0}, {0.5, -0.4, 1.1}}, far_{{-0.4, 0.3, 0}, {0.4, 0.7, 0.8}};
  const Surface scene_ = all_of({plane({}, {0, 0, 1}), near_.surface(), far_.surface()});
  Geometry frame_;
  TempDir folder_;
};

/// Area of triangles, in scene units.
double area(const OtherSurfaces& surfaces) {
  double sum = 0;
  for (const auto& [i, j, k] : surfaces.added) {
    const glm::vec3 a = surfaces.vertices[i].position, b = surfaces.vertices[j].position,
                    c = surfaces.vertices[k].position;
    sum += 0.5 * double(glm::length(glm::cross(b - a, c - a)));
  }
  return sum;
}

TEST_F(Merge, OfWhatSeveralViewsShowTheFinestAddsIt) {
  const glm::dvec3 eye(-3.5, 2.5, 2.5);
  const OtherView fine = view("z_fine.exr", kFine, eye),
                  coarse = view("a_coarse.exr", kCoarse, eye);
  const OtherSurfaces alone = merge({fine}), both = merge({coarse, fine});
  fmt::print("{} triangles of one view, {} of two; area {:.3f}, {:.3f}\n", alone.added.size(),
             both.added.size(), area(alone), area(both));
  EXPECT_GT(alone.added.size(), 1000u);
  EXPECT_LT(double(both.added.size()), 1.05 * double(alone.added.size()));
  EXPECT_NEAR(area(both), area(alone), 0.05 * area(alone));
}

TEST_F(Merge, AViewWithoutAlbedoTakesNoLightFromOneThatHasIt) {
  const glm::dvec3 eye(-3.5, 2.5, 2.5);
  const OtherView fine = view("fine.exr", kFine, eye, false),
                  coarse = view("coarse.exr", kCoarse, eye);
  const std::size_t of_coarse = merge({coarse}).added.size(), of_fine = merge({fine}).added.size();
  EXPECT_EQ(merge({coarse, fine}).added.size(), of_coarse + of_fine);
}

TEST_F(Merge, OfEqualViewsOneAddsIt) {
  const glm::dvec3 eye(-3.5, 2.5, 2.5);
  const OtherView one = view("one.exr", kFine, eye), other = view("other.exr", kFine, eye);
  const OtherSurfaces alone = merge({one}), both = merge({other, one});
  EXPECT_EQ(both.added.size(), alone.added.size());
}

TEST_F(Merge, IsTheSameInAnyOrderOfViews) {
  const OtherView one = view("one.exr", kFine, {-3.5, 2.5, 2.5}),
                  equal = view("equal.exr", kFine, {-3.5, 2.5, 2.5}),
                  right = view("right.exr", kCoarse, {3.5, 2.5, 2.5});
  const OtherSurfaces first = merge({one, equal, right});
  const auto all_of = [](const Vertex& v) {
    return std::tuple(v.position, v.normal, v.albedo, v.footprint, v.sender);
  };
  for (const auto& views : {std::vector{equal, right, one}, {right, one, equal}}) {
    const OtherSurfaces again = merge(views);
    EXPECT_EQ(again.added, first.added);
    EXPECT_TRUE(std::ranges::equal(again.vertices, first.vertices, {}, all_of, all_of));
  }
}

TEST_F(Merge, WhatOneViewAloneShowsStays) {
  const OtherView left = view("left.exr", kFine, {-3.5, 2.5, 2.5}),
                  right = view("right.exr", kFine, {3.5, 2.5, 2.5});
  const double of_left = area(merge({left})), of_right = area(merge({right})),
               of_both = area(merge({left, right}));
  fmt::print("area {:.3f} and {:.3f}, together {:.3f}\n", of_left, of_right, of_both);
  EXPECT_GT(of_both, 1.1 * std::max(of_left, of_right));
  EXPECT_LT(of_both, of_left + of_right);
}

}  // namespace
}  // namespace ssdo::test::merge_test
