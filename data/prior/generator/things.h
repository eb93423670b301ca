// SPDX-License-Identifier: Apache-2.0
//
// What scenes are made of: objects, furniture, vehicles, people, plants and parts of buildings.
// Objects stand on z = 0 about the origin; their front looks along -y.
#pragma once

#include <vector>

#include "mesh.h"

// Objects (objects.cpp), about one metre in size.
Mesh blob(Random& r, float amplitude, int segments = 32, float frequency = 1.5f);
Mesh vessel(Random& r);    // turned on a lathe: bottles, bowls, vases
Mesh compound(Random& r);  // a few solids that share their insides
Mesh pile(Random& r);      // flat boxes on each other: books, crates
Mesh thing(Random& r);     // any of the above, and simple solids

// Furniture (furniture.cpp), in metres.
Mesh table(Random& r);
Mesh chair(Random& r);
Mesh shelf(Random& r);
Mesh sofa(Random& r);
Mesh bed(Random& r);
Mesh cabinet(Random& r);
Mesh lamp(Random& r);
Mesh laid_table(Random& r);  // with chairs around it and things on it
Mesh furniture(Random& r);   // any of the above

// People, vehicles and machines (machines.cpp), in metres.
Mesh person(Random& r);
Mesh car(Random& r);
Mesh engine(Random& r);  // housings, pipes, flanges, bolts
Mesh robot(Random& r);

// Plants (plants.cpp). Kinds of trees: 0 conifer, 1 round crowns, 2 bare, 3 with leaves.
Mesh tree(Random& r, int kind = -1);  // about one metre high: scale it
Mesh plant(Random& r);                // a rosette of leaves
struct Patch {
  float x, y, radius;
};
void grass(Random& r, Mesh& scene, Patch where, int blades, float height,
           const std::function<float(float, float)>& ground);

// Parts of buildings (buildings.cpp), in metres.
struct Opening {
  float x0, x1, z0, z1;
};
/// A wall in the plane y = 0..thickness, x = 0..width, with rectangular openings.
Mesh wall(float width, float height, float thickness, const std::vector<Opening>& openings);
std::vector<Opening> windows(Random& r, float width, float height);
struct RoomPlan {
  float x, y, height;         // inner size; the room lies at 0..x, 0..y, 0..height
  float windows = .5f;        // probability of windows in a wall
  float missing_wall = 0;     // probability that a wall is not there
  float missing_ceiling = 0;  // probability that the ceiling is not there
  bool outside = true;        // ground and buildings outside
};
void room(Random& r, Mesh& scene, const RoomPlan& plan);
void furnish(Random& r, Mesh& scene, const RoomPlan& plan, int pieces);
/// The front of a house, at y = 0, x = 0..width, with its body behind it.
Mesh facade(Random& r, float width, float height);
void fence(Random& r, Mesh& scene, Vec a, Vec b, float height);
struct Flight {
  float width, rise, going;  // of a step
  int steps;
};
Mesh stairs(const Flight& flight, bool solid);

/// Adds m at a point, turned about z at random.
inline void place(Random& r, Mesh& scene, const Mesh& m, Vec at, float scale = 1) {
  scene.add(m, about_z(r.angle()), at, scale);
}
void ground(Mesh& scene, float z = 0);
