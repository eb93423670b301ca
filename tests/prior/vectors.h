// SPDX-License-Identifier: Apache-2.0
//
// data/prior/vectors.txt: what the training says of some pixels of a frame.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "prior/inputs.h"

namespace ssdo::test {

/// One pixel.
struct PriorVector {
  bool upright = false;
  float radius = 0;
  int row = 0, column = 0;
  std::vector<float> inputs, outputs;  ///< of the network
};

struct PriorVectors {
  std::vector<float> camera;  ///< right, up, forward, half of width and height at depth 1
  std::vector<PriorVector> places;
};

inline PriorVectors prior_vectors() {
  PriorVectors all;
  std::ifstream file(SSDO_SOURCE_DIR "/data/prior/vectors.txt");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind, radius;
    words >> kind;
    if (kind == "#") continue;
    PriorVector place;
    place.upright = kind == "up";
    if (kind != "camera" || !all.camera.empty()) {
      words >> radius >> place.row >> place.column;
      place.radius = std::stof(radius);
    }
    std::vector<float> values;
    for (float value; words >> value;) values.push_back(value);
    if (radius.empty()) {
      all.camera = values;
      continue;
    }
    const auto inputs = std::ptrdiff_t(PriorInputs::kOwn + PriorInputs::kShared);
    place.inputs.assign(values.begin(), values.begin() + inputs);
    place.outputs.assign(values.begin() + inputs, values.end());
    all.places.push_back(place);
  }
  return all;
}

}  // namespace ssdo::test
