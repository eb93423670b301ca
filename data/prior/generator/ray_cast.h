// SPDX-License-Identifier: Apache-2.0
//
// The G-buffer of a scene, and what its pixels see of the world, by ray casting with Embree.
#pragma once

#include <embree3/rtcore.h>

#include <vector>

#include "scene.h"

/// Ray casting against one mesh, which must outlive it.
class RayCaster {
 public:
  RayCaster(RTCDevice device, const Mesh& mesh);
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  struct Hit {
    float distance;  // infinite where nothing is hit
    Vec normal;      // of the triangle, towards the ray's origin
    Vec shading;     // interpolated, on the same side
    Vec albedo;
  };
  Hit first_hit(Vec origin, Vec direction) const;
  bool is_open(Vec origin, Vec direction) const;

 private:
  const Mesh& mesh_;
  RTCScene scene_;
};

struct Frame {
  int width, height;
  std::vector<char> valid;
  std::vector<float> depth;  // planar
  std::vector<Vec> position, normal, facet, albedo;
  Vec eye, right, up, forward;
  float half_width, half_height;  // at depth 1, or in scene units if orthographic
  bool ortho;
  float mean_depth;  // geometric mean over the valid pixels
};
/// One ray through the centre of each pixel. `roll` turns the camera about its axis.
Frame render(const RayCaster& rays, const Camera& camera, int width, int height, float roll);

/// What one pixel sees, from cosine-weighted directions d in the scene's axes, z up, whatever the
/// axes of the file; V is 1 where nothing is hit.
struct Truth {
  float pixel;       // y * width + x
  float ao_radius;   // share without a hit within the frame's radius
  float moments[9];  // means of V times 1, x, y, z, xy, yz, 3zz-1, xz, xx-yy
  float bounce[3];   // one diffuse bounce in the white world, as irradiance / pi
  float sun;         // 1 if the sun is visible
  float before;      // turned frames: the pixel of the frame before; else 0
};
struct TruthPlan {
  float radius;  // scene units
  Vec sun;
  int step;  // one pixel of every step x step
  int rays;  // side of the square of strata
};
std::vector<Truth> trace_truth(const RayCaster& rays, const Frame& frame, const TruthPlan& plan,
                               Random& r);
