// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "options.h"
#include "scene/environment.h"

namespace ssdo {

/// The environment as it was asked for, read once for all frames of a sequence.
class Light {
 public:
  /// Errors: ExitCode::input for a map that cannot be read, ExitCode::usage for a colour that is
  /// none.
  explicit Light(const LightOptions& options);

  /// The environment around a frame. `up_of_frame` is used where the user gives no axis.
  Environment around(UpAxis up_of_frame) const;

  /// One line: the map or the colour.
  const std::string& description() const { return description_; }

 private:
  LightOptions options_;
  std::shared_ptr<const Plane<glm::vec3>> map_;
  glm::vec3 constant_{1};
  std::string description_;
};

}  // namespace ssdo
