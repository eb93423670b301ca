// SPDX-License-Identifier: Apache-2.0
//
// A frame, flat or deep, up to its surfaces in camera space: layers, G-buffer, the camera of the
// header and that of P, depth, normals. The last two bytes of the file choose the options.
#include <cmath>

#include "fuzz/exr_mutation.h"
#include "fuzz/real_files.h"
#include "fuzz/target.h"
#include "scene/view.h"

namespace ssdo::fuzz {
namespace {

/// What --aov may ask for: layers of some files, a channel of a layer, and what no file has.
const LayerRequest kRequests[] = {
    {Role::position, "", "ViewLayer.Position"}, {Role::normal, "", "N"},
    {Role::depth, "", "ViewLayer.Depth.Z"},     {Role::depth, "", "P.X"},
    {Role::ambient, "", "ViewLayer.Combined"},  {Role::motion, "", "none"}};

struct Choices {
  InputOptions input;
  bool allow_partial = false;
  CameraOptions camera;
};

Choices choices_of(unsigned bits) {
  Choices choices;
  const auto take = [&](unsigned count) {
    const unsigned value = bits % count;
    bits /= count;
    return value;
  };
  GBufferOptions& gbuffer = choices.input.gbuffer;
  if (take(2)) choices.camera.fov = 43;
  gbuffer.beauty = take(2) == 1;
  if (take(2) == 1) gbuffer.depth_kind = DepthKind::ray;
  if (take(4) == 1) gbuffer.grid = PixelGrid{.stride = kOverviewStride};
  if (take(2)) choices.input.view = "left";
  if (take(2)) gbuffer.background_depth = 5.0f;
  choices.allow_partial = take(2) == 1;
  gbuffer.downsample = int(1 + take(2));
  for (unsigned count = take(3); count > 0; --count)
    choices.input.aovs.push_back(kRequests[take(std::size(kRequests))]);
  return choices;
}

std::vector<ExrKind> kinds() {
  std::vector<ExrKind> all = flat_kinds();
  for (const ExrKind& kind : deep_kinds()) all.push_back(kind);
  return all;
}

void check(const Geometry& geometry) {
  for (const Surfel& surfel : geometry.surfaces) {
    if (!surfel.is_surface()) continue;
    for (int i = 0; i < 3; ++i) {
      require(std::isfinite(surfel.position[i]), "a surface whose position is not finite");
      require(std::isfinite(surfel.normal[i]), "a surface whose normal is not finite");
    }
  }
}

}  // namespace

void read_input(Bytes input) {
  static MemoryFile memory;
  memory.hold(input);
  may_refuse([&] {
    const Choices choices = choices_of(tail_of(input));
    const View view = read_view(open_view(memory.path(), {}, choices.allow_partial),
                                choices.input.aovs, choices.input, choices.camera, {});
    check(view.geometry);
  });
}

std::vector<std::string> seeds() { return joined(exr_samples(kinds()), real_frames()); }

}  // namespace ssdo::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  const std::size_t out = ssdo::fuzz::mutate_exr(data, size, most, ssdo::fuzz::kinds(), seed);
  if (out > 1 && seed % 8 == 0) {
    data[out - 1] = std::uint8_t(seed >> 8);
    data[out - 2] = std::uint8_t(seed >> 16);
  }
  return out;
}
