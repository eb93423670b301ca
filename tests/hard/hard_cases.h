// SPDX-License-Identifier: Apache-2.0
//
// Frames that are hard on methods: what renderers get wrong, what files lose, and what scenes have
// at their extremes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "math/half_color.h"
#include "scene/light/environment.h"
#include "support/analytic_scene.h"
#include "support/frame_file.h"

namespace ssdo::test {

/// What a method is given, and what is asked of the default one.
struct HardFrame {
  Geometry geometry;
  Plane<HalfColor> albedo;
  Environment environment;
  float radius = 0.5f;
  int bounces = 1;
  bool open_plane = false;  ///< nothing hides anything: ao is 1 to within 1e-4

  /// What a frame that was read from a file has to show; empty where that is not known.
  Surfaces shown = {};
  float position_error = 0;  ///< that the file's precision leaves
};

struct HardCase {
  std::string name;
  std::function<HardFrame()> make;
};

/// Frames as methods get them, of scenes, views, lights and broken values.
std::vector<HardCase> scene_cases();

/// Frames that were written to a file and read from it.
std::vector<HardCase> file_cases();

/// Those of them that have to show what the scene shows.
std::vector<HardCase> faithful_file_cases();

/// A floor before a wall, and two balls.
Surface hard_still_life();

/// A plane through the origin.
Surface ground();

/// A sky with a soft sun.
Environment plain_sky();

/// A camera in the plane x = 0 that looks at the origin from `degrees` beside the z axis.
Camera leaning(const Camera& projection, double degrees, double distance = 6);

/// The camera that most cases have.
Camera usual_camera(const Window& display);

/// The frame of a scene, as files without loss would give it.
HardFrame hard_frame(const Surface& scene, const Camera& camera, const Window& window);

/// What reading `part` from a file gives. `fov` stands for --fov, 0: the camera is fitted.
Geometry read_through_file(const FramePart& part, double fov = 0, Plane<HalfColor>* albedo = {});

}  // namespace ssdo::test
