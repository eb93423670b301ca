// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_planes.h"

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

ViewPlanes::ViewPlanes(int width, int height)
    : layout(width, height),
      orthographic(false),
      fx(1),
      fy(1),
      cx(0),
      cy(0),
      first_column(0),
      first_row(0),
      z(layout),
      nx(layout),
      ny(layout),
      nz(layout),
      rounding(layout) {}

bool is_usable(const Surfel& s) {
  return s.position.w != 0 && s.position.z < -1e-15f &&
         std::isfinite(glm::dot(s.position, s.position)) &&
         std::isfinite(glm::dot(s.normal, s.normal));
}

ViewPlanes make_view_planes(const Geometry& g) {
  ViewPlanes planes(g.surfel.width, g.surfel.height);
  const Camera& camera = g.camera;
  planes.orthographic = camera.orthographic;
  planes.fx = float(camera.fx), planes.fy = float(camera.fy);
  planes.cx = float(camera.cx - g.display.x0), planes.cy = float(camera.cy - g.display.y0);
  planes.first_column = g.window.x0 - g.display.x0;
  planes.first_row = g.window.y0 - g.display.y0;
  // Depth is -z: a perspective ray is the slope times -1.
  const double sign = camera.orthographic ? 1 : -1;
  planes.rays_x = rays(g.window.x0, planes.width(), camera.cx, sign / camera.fx);
  planes.rays_y = rays(g.window.y0, planes.height(), camera.cy, -sign / camera.fy);
  for_each_row(planes.height(), [&](int y) {
    planes.z.fill_row(y, kBackgroundDepth);
    for (PaddedPlane* p : {&planes.nx, &planes.ny, &planes.nz, &planes.rounding})
      p->fill_row(y, 0.0f);
    float *z = planes.z.row(y), *nx = planes.nx.row(y), *ny = planes.ny.row(y),
          *nz = planes.nz.row(y), *rounding = planes.rounding.row(y);
    const Surfel* surfel = &g.surfel(0, y);
    for (int x = 0; x < planes.width(); ++x) {
      const Surfel& s = surfel[x];
      if (!is_usable(s)) continue;
      z[x] = s.position.z;
      nx[x] = s.normal.x, ny[x] = s.normal.y, nz[x] = s.normal.z;
      rounding[x] = s.normal.w;
    }
  });
  return planes;
}

}  // namespace ssdo
