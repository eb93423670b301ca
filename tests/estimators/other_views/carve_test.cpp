// SPDX-License-Identifier: Apache-2.0
#include "scene/other_views/carve.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>

#include "estimators/bitmask/request.h"
#include "scene/other_views/other_pictures.h"
#include "support/boxes.h"
#include "support/frame_file.h"
#include "support/temp_dir.h"

namespace ssdo::test::carve_test {
namespace {

/// Posts on a floor. The share of the pixels that show them whose guessed thickness a view from
/// beside ends.
double share_cut(const Window& view_window) {
  std::vector<Surface> things = {plane({}, {0, 0, 1})};
  for (int i = -4; i <= 4; ++i)
    things.push_back(Box{{0.3 * i - 0.05, -0.05, 0}, {0.3 * i + 0.05, 0.05, 1}}.surface());
  const Surface scene = all_of(things);
  const Window window{0, 0, 160, 120};
  const auto looks = [](const Window& w, double fov, const glm::dvec3& eye) {
    return look_at(camera_from_fov(fov, w, 1), eye, {0, 0, 0.4}, {0, 0, 1});
  };
  Geometry frame = geometry_of(scene, looks(window, 30, {0, -4, 1.2}), window);
  frame.world_known = true;
  const TempDir folder;
  write_frame(folder / "view.exr",
              frame_of(take_picture(scene, looks(view_window, 40, {1.2, -3.8, 1.6}), view_window)));
  Solids solids = guess_solids(frame);
  const Plane<float> guessed = solids.thickness;
  carve(solids, frame, {place(OtherPictures().also(folder / "view.exr"), frame)});
  int posts = 0, cut = 0;
  for (std::size_t i = 0; i < guessed.size(); ++i) {
    const glm::dvec3 p =
        glm::transpose(frame.camera.rotation) * glm::dvec3(frame.surfaces[i].position) +
        frame.camera.origin;
    if (p.z < 0.1) continue;
    ++posts;
    cut += solids.thickness[i] < guessed[i];
  }
  EXPECT_GT(posts, 500);
  fmt::print("{} x {}: {} of {} cut\n", view_window.width(), view_window.height(), cut, posts);
  return double(cut) / posts;
}

TEST(Carve, AViewLooksPastWhatItsPixelsDoNotResolve) { EXPECT_EQ(share_cut({0, 0, 24, 18}), 0); }

TEST(Carve, AViewThatResolvesThingsEndsThem) { EXPECT_GT(share_cut({0, 0, 640, 480}), 0.02); }

/// A box before a wall. The room between them is a quarter as deep as they are apart, and much less
/// than the box is guessed to be.
TEST(Carve, AViewThroughANarrowGapEndsWhatIsBeforeIt) {
  const Window window{0, 0, 160, 120};
  for (const double wall : {0.45, 0.55, 0.65, 0.75, 0.85}) {
    const double gap = 0.875 * wall;  // its middle
    const Surface scene = all_of({plane({0, 0, -wall}, {0, 0, 1}),
                                  Box{{-0.6, -0.6, -0.75 * wall}, {0.6, 0.6, 0}}.surface()});
    const Camera in_front =
        look_at(camera_from_fov(30, window, 1), {0, 0, 6}, {0, 0, 0}, {0, 1, 0});
    Geometry frame = geometry_of(scene, in_front, window);
    frame.world_known = true;
    const Camera beside =
        look_at(camera_from_fov(20, window, 1), {4, 0, -gap}, {0, 0, -gap}, {0, 1, 0});
    const TempDir folder;
    write_frame(folder / "beside.exr", frame_of(take_picture(scene, beside, window)));
    Solids solids = guess_solids(frame);
    const std::size_t middle = frame.surfaces.index(80, 60);
    EXPECT_GT(solids.thickness[middle], 0.95) << wall;
    carve(solids, frame, {place(OtherPictures().also(folder / "beside.exr"), frame)});
    fmt::print("wall {} behind: {:.3f} deep\n", wall, solids.thickness[middle]);
    EXPECT_LT(solids.thickness[middle], wall) << wall;
    EXPECT_GT(solids.thickness[middle], 0.7 * wall) << wall;
  }
}

/// What is left of the floor that is guessed just behind the posts of a fence, of its pixels, after
/// a view from above of the fence and `below`.
double share_of_floor_kept(const Surface& below) {
  std::vector<Surface> posts;
  for (int i = -4; i <= 4; ++i)
    posts.push_back(Box{{0.3 * i - 0.05, -0.05, 0}, {0.3 * i + 0.05, 0.05, 1}}.surface());
  const Surface fence = all_of(posts);
  const Window window{0, 0, 160, 120};
  const auto look_from = [&](double fov, const glm::dvec3& eye) {
    return look_at(camera_from_fov(fov, window, 1), eye, {0, 0, 0.4}, {0, 0, 1});
  };
  Geometry frame =
      geometry_of(all_of({plane({}, {0, 0, 1}), fence}), look_from(30, {0, -4, 1.2}), window);
  frame.world_known = true;
  const TempDir folder;
  write_frame(folder / "above.exr",
              frame_of(take_picture(all_of({below, fence}), look_from(60, {0, 0.5, 4}), window)));
  Solids solids = guess_solids(frame);
  const auto count = [&] {
    int guessed = 0;
    for (const SolidLayer& layer : solids.behind) {
      for (std::size_t i = 0; i < layer.distance.size(); ++i) {
        if (!(layer.distance[i] < std::numeric_limits<float>::infinity())) continue;
        const glm::dvec3 at = glm::transpose(frame.camera.rotation) *
                                  glm::dvec3(point_behind(frame, i, layer.distance[i])) +
                              frame.camera.origin;
        guessed += std::abs(at.z) < 0.1 && at.y > 0.2 && at.y < 1;
      }
    }
    return guessed;
  };
  const int before = count();
  EXPECT_GT(before, 300);
  carve(solids, frame, {place(OtherPictures().also(folder / "above.exr"), frame)});
  return double(count()) / before;
}

TEST(Carve, AGuessedSurfaceStaysWhereAViewShowsOne) {
  EXPECT_GT(share_of_floor_kept(plane({}, {0, 0, 1})), 0.9);
}

TEST(Carve, AGuessedSurfaceEndsWhereAViewShowsNone) {
  EXPECT_LT(share_of_floor_kept(plane({0, 0, -1}, {0, 0, 1})), 0.1);
}

}  // namespace
}  // namespace ssdo::test::carve_test
