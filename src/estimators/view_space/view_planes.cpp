// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_space/view_planes.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// Rays of the pixels' centres along one axis of the picture, in double and rounded once.
std::vector<float> rays(int first, int count, double centre, double scale) {
  std::vector<float> values;
  for (int i = -PaddedLayout::kPad; i < count + 2 * PaddedLayout::kPad; ++i)
    values.push_back(float((first + i + 0.5 - centre) * scale));
  return values;
}

}  // namespace

ViewPlanes::ViewPlanes(const Surfaces& shown)
    : layout(shown.width, shown.height),
      orthographic(false),
      fx(1),
      fy(1),
      slope_x(0),
      slope_y(0),
      cx(0),
      cy(0),
      first_column(0),
      first_row(0),
      z(layout),
      surfaces(shown) {
  for_each_row(height(), [&](int y) {
    z.fill_row(y, kBackgroundDepth);
    float* depth = z.row(y);
    for (int x = 0; x < width(); ++x) {
      const Surfel& s = surfaces(x, y);
      if (s.is_usable()) depth[x] = s.position.z;
    }
  });
}

ViewPlanes make_view_planes(const Geometry& g) {
  ViewPlanes planes(g.surfaces);
  const Camera& camera = g.camera;
  planes.orthographic = camera.orthographic;
  planes.fx = float(camera.fx), planes.fy = float(camera.fy);
  planes.slope_x = (planes.orthographic ? 1 : -1) / planes.fx;
  planes.slope_y = (planes.orthographic ? -1 : 1) / planes.fy;
  planes.cx = float(camera.cx - g.display.x0), planes.cy = float(camera.cy - g.display.y0);
  planes.first_column = g.window.x0 - g.display.x0;
  planes.first_row = g.window.y0 - g.display.y0;
  // Depth is -z: a perspective ray is the slope times -1.
  const double sign = camera.orthographic ? 1 : -1;
  planes.rays_x = rays(g.window.x0, planes.width(), camera.cx, sign / camera.fx);
  planes.rays_y = rays(g.window.y0, planes.height(), camera.cy, -sign / camera.fy);
  return planes;
}

}  // namespace ssdo
