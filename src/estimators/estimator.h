// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "math/plane.h"
#include "parallel/tiles.h"
#include "scene/scene.h"

namespace ssdo {

/// What a method may be asked for. Definitions: man ssdo, PRODUCTS.
struct ProductSet {
  bool ao = false;
  bool direct = false;
  bool bounce = false;
  bool bent = false;
  bool reflection = false;
  bool error = false;
};

/// The planes that were asked for, over the geometry's window or the request's receivers; the
/// others are empty. Linear, without the receiver's albedo. Background: ao and reflection 1, all
/// else 0.
struct Products {
  Plane<float> ao;
  Plane<glm::vec3> direct, bounce;
  Plane<glm::vec3> bent;    ///< unit, camera space
  Plane<float> reflection;  ///< share of a reflection that is not occluded
  Plane<float> error;  ///< of the luminance of direct + bounce, with the sign of one draw of noise
};

/// A parameter of one method, set with --set NAME=VALUE.
struct Parameter {
  std::string_view name;
  double value;  ///< default
  double low, high;
  std::string_view unit;
  std::string_view meaning;
  bool whole = false;  ///< takes whole numbers only
};

using ParameterValues = std::map<std::string, double, std::less<>>;

/// What is asked of a method.
struct Request {
  ProductSet products;
  float radius = 0;  ///< scene units; infinity: without limit
  int bounces = 0;
  unsigned seed = 0;             ///< of the sampling pattern
  ParameterValues parameters{};  ///< every one that the method has

  // Of methods that march through slices of the frame.
  int slices = 2;                ///< per pixel
  int steps = 16;                ///< per side of a slice, from one pixel to the frame's diagonal
  bool extend_offscreen = true;  ///< surfaces go on beyond the frame
  /// Pixels that gather, within the geometry's window: products have its size, and all of the
  /// geometry blocks and sends. Area 0: the whole window.
  Window receivers;
};

/// A row in the table of methods.
struct Method {
  std::string_view name, summary;
  ProductSet products;  ///< what it can make
  int pattern_size;     ///< its noise repeats every pattern_size pixels
  std::vector<Parameter> parameters;
  bool marches;  ///< through slices of the frame, as --slices, --steps and --thickness say
  int (*samples_per_pixel)(const ParameterValues&);  ///< null where it marches
  Products (*estimate)(const Scene&, const Request&, const Progress&);
  bool has_solids = false;  ///< without marching, takes --thickness and endless radii
  bool has_radius = true;   ///< takes --radius; else its sizes are its own

  /// Whether it takes the solids of the scene.
  bool takes_solids() const { return marches || has_solids; }
};

}  // namespace ssdo
