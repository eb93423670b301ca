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

/// Planes with the frame's size and camera, to be filled.
ViewPlanes empty_planes(const Geometry& g) {
  ViewPlanes planes(g.surfel.width, g.surfel.height);
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

}  // namespace

ViewPlanes::ViewPlanes(int width, int height)
    : layout(width, height),
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
      nx(layout),
      ny(layout),
      nz(layout),
      rounding(layout) {}

void ViewPlanes::clear_row(int y) {
  z.fill_row(y, kBackgroundDepth);
  for (PaddedPlane* plane : {&nx, &ny, &nz, &rounding}) plane->fill_row(y, 0.0f);
}

void ViewPlanes::set(int x, int y, const Surfel& s) {
  if (!s.is_usable()) return;
  z.row(y)[x] = s.position.z;
  nx.row(y)[x] = s.normal.x, ny.row(y)[x] = s.normal.y, nz.row(y)[x] = s.normal.z;
  rounding.row(y)[x] = s.rounding;
}

ViewPlanes make_view_planes(const Geometry& g) {
  ViewPlanes planes = empty_planes(g);
  for_each_row(planes.height(), [&](int y) {
    planes.clear_row(y);
    for (int x = 0; x < planes.width(); ++x) planes.set(x, y, g.surfel(x, y));
  });
  return planes;
}

ViewPlanes make_depth_planes(const Geometry& g) {
  ViewPlanes planes = empty_planes(g);
  for_each_row(planes.height(), [&](int y) {
    planes.z.fill_row(y, kBackgroundDepth);
    float* z = planes.z.row(y);
    for (int x = 0; x < planes.width(); ++x) {
      const Surfel& s = g.surfel(x, y);
      if (s.is_usable()) z[x] = s.position.z;
    }
  });
  return planes;
}

}  // namespace ssdo
