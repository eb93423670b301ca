// SPDX-License-Identifier: Apache-2.0
//
// What lamps name as what blocks their light is prepared once for all that name it, and only as far
// as rays to sources need it.
#include "estimators/bitmask/rays/linked_occluders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "estimators/bitmask/border/beyond.h"
#include "estimators/bitmask/request.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo::test::linked_occluders_test {
namespace {

const Window kWindow{0, 0, 64, 48};

/// A floor and a wall, with lamps behind the wall, of which the first four name what blocks them.
struct LinkedLamps {
  LinkedLamps() : camera(tilted(camera_from_fov(45, kWindow, 1), 50)) {
    const Surface corner = all_of({plane({}, {0, 0, 1}), plane({0, 1, 0}, {0, -1, 0})});
    scene = scene_of(geometry_of(corner, camera, kWindow));
    scene.solids = guess_solids(scene.geometry);
    Lamp lamp;
    lamp.position = {0, 3, 2}, lamp.radius = 0.1;
    const auto one = std::make_shared<const Scene>(scene),
               other = std::make_shared<const Scene>(scene);
    for (std::size_t k = 0; k < 5; ++k) {
      scene.light.sources.push_back(make_source(lamp, {camera.rotation, camera.origin}, 0.01));
      if (k < 4) scene.linked_occluders[k] = k % 2 ? other : one;
    }
  }

  Camera camera;
  Scene scene;
  Request request{.products = {.direct = true}, .radius = kNoLimit, .extend_offscreen = true};
};

TEST(LinkedOccluders, AreSharedByLampsThatNameTheSame) {
  const LinkedLamps lit;
  const MarchScene frame = make_march_scene(lit.scene.geometry, lit.scene.solids);
  const SlicePattern pattern = mean_ao_pattern(frame.layout, kWindow);
  LinkedOccludersOfSources blockers(lit.scene, lit.request, pattern);
  const LinkedOccluders *const one = blockers.of(0), *const other = blockers.of(1);
  ASSERT_TRUE(one && other);
  EXPECT_NE(one, other);
  EXPECT_EQ(blockers.of(2), one);
  EXPECT_EQ(blockers.of(3), other);
  EXPECT_EQ(blockers.of(4), nullptr);
}

TEST(LinkedOccluders, MeasureWhatRaysToSourcesMeetBeyondTheBorder) {
  const LinkedLamps lit;
  const MarchScene frame = make_march_scene(lit.scene.geometry, lit.scene.solids);
  const SlicePattern pattern = mean_ao_pattern(frame.layout, kWindow);
  LinkedOccludersOfSources blockers(lit.scene, lit.request, pattern);
  const Source& source = *lit.scene.light.sources[0];
  const auto measured = [](const CutSurfaces& cut) {
    return std::ranges::count_if(cut.extents, [](const BorderExtent& extent) {
      return std::ranges::any_of(extent.seen, [](float seen) { return seen > 0; });
    });
  };
  const auto points = points_of(source, 1, 0);
  const auto own = measured(*blockers.of(0)->job(points, source).march.cut),
             all = measured(find_cut_surfaces(frame, up_in_camera(lit.scene), kNoLimit)),
             met = measured(find_cut_surfaces(frame, up_in_camera(lit.scene), kNoLimit,
                                              met_by_rays_to_sources(lit.scene.light)));
  EXPECT_EQ(own, met);
  EXPECT_LT(met, all);
}

}  // namespace
}  // namespace ssdo::test::linked_occluders_test
