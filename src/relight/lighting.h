// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/pictures/primaries.h"
#include "scene/light/environment.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo {

/// What the user says about the light.
struct LightOptions {
  std::string env = "1,1,1";            ///< a lat-long map, or R,G,B
  double rotate_degrees = 0;            ///< about the up axis, counter-clockwise from above
  std::optional<UpAxis> up;             ///< from the header where not given
  double exposure_stops = 0;            ///< -100 to 100
  std::vector<std::string> lamp_files;  ///< JSON; see read_lamps()
  std::vector<std::string> lamps;       ///< see parse_lamp()
};

/// The environment around one frame.
struct FrameEnvironment {
  Environment environment;
  std::string description;            ///< one line: the map or the colour
  std::vector<std::string> warnings;  ///< of the map
};

/// The environment and the lamps as they were asked for, read once for all frames of a sequence.
/// All light is finite and at most kBrightest, exposure included.
class Lighting {
 public:
  /// Errors: those of read_environment_map(), read_lamps(), parse_lamp() and name_lamps();
  /// ExitCode::usage for a colour that is none, and for an exposure that makes light brighter than
  /// kBrightest.
  explicit Lighting(const LightOptions& options);

  /// Whether the axis that is up makes a difference, and the user gives none: to a map, and to what
  /// surfaces beyond the border hide of lamps.
  bool needs_up() const { return (map_ || !lamps_.empty()) && !options_.up; }

  /// The environment of a frame. `up_of_frame` is used where the user gives no axis. A map that
  /// says which primaries its colours have is converted to `primaries` of the frame, if it has any.
  FrameEnvironment around(UpAxis up_of_frame, const std::optional<Chromaticities>& primaries) const;

  /// In the world of P: those of the files, then those of the command line.
  const std::vector<Lamp>& lamps() const { return lamps_; }

 private:
  void read_environment();
  void read_map();
  void check_exposure(float brightest);

  LightOptions options_;
  std::shared_ptr<const Plane<glm::vec3>> map_;
  std::optional<Chromaticities> primaries_;  ///< of the map
  glm::vec3 constant_{1};
  std::string description_;
  std::vector<std::string> warnings_;
  std::vector<Lamp> lamps_;
};

}  // namespace ssdo
