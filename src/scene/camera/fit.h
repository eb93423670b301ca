// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "math/plane.h"
#include "scene/camera/camera.h"

namespace ssdo {

/// Finds the camera under which every position projects to the centre of its own pixel.
///
/// Direct linear transform in double over recentred and scaled coordinates (Hartley and Zisserman,
/// Multiple View Geometry, 7.1; 6.3 for the affine camera), then Gauss-Newton on the ten parameters
/// of a camera without skew, with pixels that do not belong to the fit left out (averaged
/// silhouettes lie on no surface).
///
/// `positions` are over `window`; a pixel takes part where `valid` is not 0. Returns nothing where
/// P leaves the camera undetermined: fewer than six pixels, all of them in a plane, or a focal
/// length that the pixels do not pin down to 1 %, or axes of an orthographic camera not to 2 %.
std::optional<Camera> fit_camera(const Plane<glm::vec3>& positions,
                                 const Plane<unsigned char>& valid, const Window& window);

/// Whether the positions lie before the camera and half of them project to within half a pixel of
/// their own. `step`, in scene units, by which P may have been rounded, is allowed on top.
bool explains(const Camera& camera, const Plane<glm::vec3>& positions,
              const Plane<unsigned char>& valid, const Window& window, double step = 0);

/// The camera with the projection of `projection` for P in camera space, with whatever signs of the
/// axes; nothing where P is not in camera space.
std::optional<Camera> in_own_space(const Camera& projection, const Plane<glm::vec3>& positions,
                                   const Plane<unsigned char>& valid, const Window& window);

/// The median of measure_residual() over a sample of at most some ten thousand pixels.
double median_miss_px(const Camera& camera, const Plane<glm::vec3>& positions,
                      const Plane<unsigned char>& valid, const Window& window);

/// The same under the best of all projections of space to the picture, skew and scales of the axes
/// included: small where P is an affine function of positions. Infinite for fewer than six pixels.
double projective_miss_px(const Plane<glm::vec3>& positions, const Plane<unsigned char>& valid,
                          const Window& window);

/// How well `camera` explains the positions.
Residual measure_residual(const Camera& camera, const Plane<glm::vec3>& positions,
                          const Plane<unsigned char>& valid, const Window& window);

}  // namespace ssdo
