// SPDX-License-Identifier: Apache-2.0
#include "metrics/shot_points.h"

#include <fmt/format.h>

#include <utility>

#include "error.h"
#include "io/sequence.h"
#include "scene/view.h"

namespace ssdo {

std::optional<SharedPoints> ShotPoints::next(int number, const Window& display,
                                             const std::function<bool(int x, int y)>& counts,
                                             std::vector<std::string>& notes) {
  const std::optional<Seen> before = std::exchange(before_, std::nullopt);
  const std::string file = expand_pattern(pattern_, number);
  CameraOptions camera;
  camera.file = camera_;
  View view = read_view(open_view(file, {}), {}, {}, camera,
                        {Role::albedo, Role::beauty, Role::radiance, Role::ambient, Role::specular,
                         Role::light, Role::roughness, Role::specular_color});
  if (!view.geometry.world_known) {
    throw Error(ExitCode::layer, fmt::format("--points {}: P is in camera space, which does not "
                                             "tell the same point in two frames; give --camera",
                                             file));
  }
  const Window& own = view.geometry.display;
  if (!(own == display)) {
    throw Error(ExitCode::layer,
                fmt::format("--points {}: is {} x {}, and the picture is {} x {}; give the "
                            "G-buffer that it was made from, without --downsample",
                            file, own.width(), own.height(), display.width(), display.height()));
  }
  before_ = Seen{number, std::move(view.geometry)};
  if (!before) return std::nullopt;
  const bool leads_there = before->number == number - 1;
  SharedPoints shared =
      find_shared_points(before->geometry, before_->geometry,
                         leads_there ? view.gbuffer.motion : Plane<glm::vec2>(), counts);
  if (shared.motion_is_wrong) {
    notes.push_back(
        fmt::format("--points {}: the motion layer moves most points other ways than "
                    "the cameras say, and is not used",
                    file));
  }
  return shared;
}

}  // namespace ssdo
