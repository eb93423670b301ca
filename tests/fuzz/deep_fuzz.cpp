// SPDX-License-Identifier: Apache-2.0
//
// Deep EXRs: the channels that say where something is, their samples, and the solids of each ray.
// The last byte chooses whether files are salvaged.
#include "fuzz/exr_mutation.h"
#include "fuzz/target.h"
#include "scene/deep/channels.h"
#include "scene/deep/deep_frame.h"
#include "scene/deep/ray_solids.h"

namespace ssdo::fuzz {
namespace {

void find_solids(const DeepImage& image, float far) {
  constexpr std::size_t kMost = 4;
  RaySolids solids(far);
  for (int y = image.window.y0; y < image.window.y1; ++y) {
    for (int x = image.window.x0; x < image.window.x1; ++x) {
      solids.add(image.at(x, y));
      for (const RaySolid& solid : solids.find(kMost))
        require(solid.front <= solid.back, "a solid that ends before it begins");
    }
  }
}

}  // namespace

void read_input(Bytes input) {
  static MemoryFile memory;
  memory.hold(input);
  const bool salvages = !input.empty() && input.back() % 4 == 3;
  may_refuse([&] {
    const ExrReader file(memory.path(), salvages ? Salvage::done : Salvage::none);
    const auto channels = find_deep_channels(file, "");
    if (!channels) return;
    std::vector<std::string> warnings;
    const DeepImage image = read_deep_frame(file, *channels, {}, warnings);
    const float far = farthest_sample({});
    nearest_surfaces(image, far);
    find_solids(image, far);
  });
}

std::vector<std::string> seeds() { return exr_samples(deep_kinds()); }

}  // namespace ssdo::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  return ssdo::fuzz::mutate_exr(data, size, most, ssdo::fuzz::deep_kinds(), seed);
}
