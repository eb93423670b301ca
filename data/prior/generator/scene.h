// SPDX-License-Identifier: Apache-2.0
//
// A scene is a mesh and a camera; a family makes scenes of one kind.
#pragma once

#include <vector>

#include "things.h"

struct Camera {
  Vec eye{0, 0, 0}, target{0, 1, 0};
  float fov = 50;         // degrees, over the longer side of the frame
  float ortho_width = 0;  // over the longer side; 0: perspective
};

struct Scene {
  Mesh mesh;
  Camera camera;
};

struct Family {
  const char* name;
  void (*make)(Random& r, Scene& scene);
  bool outdoor;     // things may be put behind the camera
  bool validation;  // never trained on
};

/// All families, in the order of their numbers: append only, the number is part of the data.
const std::vector<Family>& families();
/// The number of the family that frame `id` is of, where none is named.
int family_of(int id);
/// What frame `id` has around an outdoor scene. Later frames have nothing behind the camera, and
/// many show all that there is: much of what is rendered was built for one camera.
void surround(Random& r, Scene& scene, int id);
/// Whether frame `id` has something close to the camera, by chance.
bool has_foreground(Random& r, int id);

// The families of each file.
std::vector<Family> room_families();
std::vector<Family> town_families();
std::vector<Family> nature_families();
std::vector<Family> object_families();
std::vector<Family> set_families();
std::vector<Family> open_set_families();
std::vector<Family> open_place_families();
std::vector<Family> cutaway_families();
std::vector<Family> backlot_families();

// Cameras as people place them (cameras.cpp).
struct Range {
  float low, high;
};
/// Looks at a point from around it: distance in metres, elevation in degrees.
Camera orbit(Random& r, Vec at, Range distance, Range elevation, Range fov);
/// Stands in a box 0..x, 0..y at a person's heights, often near a wall or in a corner.
Camera inside(Random& r, Vec size, Range fov);
/// Walks along +x: the eye at `eye`, the view turned by at most `turn` radians.
Camera walk(Random& r, Vec eye, float turn, Range fov);
/// Puts one or two things between the camera and what it looks at (foregrounds.cpp).
void foreground(Random& r, Scene& scene);
/// With some probability, builds what stands behind the camera: houses, walls, trees, a crew.
void behind_camera(Random& r, Scene& scene);
