// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/measure.h"

namespace ssdo {

/// The products whose error can be measured, in the order of tables.
std::vector<std::string> measured_products();

/// A value of --truth: FILE:LAYER, and its product.
struct TruthRequest {
  std::string product;  ///< empty: the layer's name tells
  std::string picture;
};

/// [PRODUCT=]FILE[:LAYER], where bench measures the product.
TruthRequest parse_truth(const std::string& text);

/// A layer that is the truth of a product.
struct Truth {
  std::string product;
  std::string file, layer;
  Window display;  ///< of the picture
  Channels channels;
};

/// Errors: ExitCode::input for a file that cannot be read; layer for a layer that does not exist,
/// is one of several or has another number of channels than its product; usage for one whose name
/// does not tell the product.
Truth read_truth(const TruthRequest& request);

}  // namespace ssdo
