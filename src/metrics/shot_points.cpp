// SPDX-License-Identifier: Apache-2.0
#include "metrics/shot_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "error.h"

namespace ssdo {

View read_points(const FrameFiles& files, const InputOptions& input, const CameraOptions& camera) {
  const std::vector<Role> unused = {Role::albedo,    Role::beauty,        Role::radiance,
                                    Role::ambient,   Role::specular,      Role::light,
                                    Role::roughness, Role::specular_color};
  std::vector<LayerRequest> aovs = files.aovs;
  std::erase_if(aovs, [&](const LayerRequest& request) {
    return std::ranges::find(unused, request.role) != unused.end();
  });
  return read_view(open_view(files.input, aovs, input.allow_partial), aovs, for_view(input, files),
                   camera, unused);
}

std::optional<SharedPoints> ShotPoints::next(int number, View view, const Window& display,
                                             const std::function<bool(int x, int y)>& counts,
                                             std::vector<std::string>& notes) {
  const std::optional<Seen> before = std::exchange(before_, std::nullopt);
  const std::string file = view.files.front().path().string();
  if (!view.geometry.world_known) {
    throw Error(ExitCode::layer, fmt::format("{}: P is in camera space, which does not "
                                             "tell the same point in two frames; give --camera",
                                             file));
  }
  const Window& own = view.geometry.display;
  if (!(own == display)) {
    throw Error(ExitCode::layer,
                fmt::format("{}: is {} x {}, and the picture is {} x {}; give the "
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
        fmt::format("{}: the motion layer moves most points other ways than "
                    "the cameras say, and is not used",
                    file));
  }
  return shared;
}

}  // namespace ssdo
