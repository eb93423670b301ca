// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <variant>
#include <vector>

#include "color/composition.h"
#include "color/results.h"
#include "estimators/estimator.h"
#include "math/channel_view.h"
#include "math/plane.h"
#include "scene/gbuffer.h"
#include "scene/scene.h"

namespace ssdo {

/// Scene-linear colours, premultiplied by alpha.
struct Composite {
  Plane<glm::vec3> color;
  Plane<float> alpha;
};

/// A channel with the name that it has in an output EXR.
struct NamedChannel {
  std::string name;
  ChannelView pixels;
};

/// The channels of a product, or of what one light gives of it.
struct NamedChannels {
  explicit NamedChannels(float at_background) : background(at_background) {}
  NamedChannels(NamedChannels&&) = default;  // a copy would not be what its channels show

  std::vector<NamedChannel> channels;
  float background;  ///< value where there is no surface
  /// The planes that were made for the output; all other channels are views of the products.
  std::variant<std::monostate, Plane<float>, Plane<glm::vec3>, Composite> made;
};

/// The composite that `results.composition` asks for, over the window of the outputs; see
/// compose.cpp. The layers and products that it is made of have to be there.
Composite composite(const Results& results);

/// The channels of the product `name` over the window of the outputs, as the table of products has
/// them: directions in the space of the input's normals, the composite premultiplied. Valid as long
/// as the results are.
NamedChannels product_channels(const std::string& name, const Results& results);

/// The same of each light, "PRODUCT.LIGHT.R" and so on; none where `results.composition` has no
/// layers of lights, or the product has none.
std::vector<NamedChannels> light_channels(const std::string& name, const Results& results);

}  // namespace ssdo
