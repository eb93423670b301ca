// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "relight/frame.h"
#include "scene/objects/selected_coverage.h"

namespace ssdo {

/// What of a frame options can select by name or id.
struct ObjectListing {
  std::vector<ObjectShare> objects;
  std::vector<std::string> warnings;  ///< of Cryptomattes that cannot be read
};

ObjectListing list_objects(const Frame& frame);

/// A line for each layer that has names or ids, and for each warning.
std::string text_of(const ObjectListing& listing);

/// By layer: the share of the display window that each name covers.
nlohmann::json to_json(const ObjectListing& listing);

}  // namespace ssdo
