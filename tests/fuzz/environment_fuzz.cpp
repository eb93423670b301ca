// SPDX-License-Identifier: Apache-2.0
//
// Environment maps: EXR, and the pictures that OpenImageIO reads; the light and suns in them.
#include <cmath>

#include "fuzz/exr_mutation.h"
#include "fuzz/real_files.h"
#include "fuzz/target.h"
#include "io/images/image_file.h"
#include "scene/light/environment_map.h"
#include "scene/light/light.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace ssdo::fuzz {
namespace {

constexpr std::string_view kExr = "\x76\x2f\x31\x01";

/// The light of a map takes a hundred times as long as its file: the last byte of one in 32 asks
/// for it.
bool is_lit(Bytes input, std::size_t texels) {
  constexpr std::size_t kMostTexels = 1 << 12;
  return texels > 0 && texels <= kMostTexels && input.back() % 32 == 1;
}

void light_by(Plane<glm::vec3> texels) {
  const Environment environment(std::make_shared<const Plane<glm::vec3>>(std::move(texels)), {});
  const Light light = model_light(environment, glm::mat3(1));
  for (const glm::vec3& c : light.coefficients) {
    for (int i = 0; i < 3; ++i) require(std::isfinite(c[i]), "light that is not finite");
  }
}

/// Radiance HDR without runs: four bytes for each pixel.
std::string radiance_picture(int width, int height) {
  std::string out = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " +
                    std::to_string(width) + "\n";
  for (int i = 0; i < width * height; ++i)
    out += {char(100 + i), char(50 + 2 * i), char(i), char(i == 5 ? 150 : 128)};
  return out;
}

std::string picture(const char* name, int bits, int channels) {
  const ImageSpec spec{8, 4, channels, bits, 1};
  std::vector<float> values(std::size_t(spec.width * spec.height * channels));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i % 7) / 7;
  const std::vector<unsigned char> bytes = encode_image(name, spec, values);
  return {bytes.begin(), bytes.end()};
}

std::vector<ExrKind> kinds() {
  std::vector<ExrKind> all = flat_kinds();
  std::erase_if(all, [](const ExrKind& kind) { return kind.levels != Imf::ONE_LEVEL; });
  return all;
}

}  // namespace

void read_input(Bytes input) {
  static MemoryFile memory;
  memory.hold(input);
  may_refuse([&] {
    EnvironmentMap map = read_environment_map(memory.path());
    if (is_lit(input, map.texels.size())) light_by(std::move(map.texels));
  });
}

std::vector<std::string> seeds() {
  std::vector<std::string> all = joined(exr_samples(kinds()), real_files("environments", ".exr"));
  all.push_back(radiance_picture(8, 4));
  for (const int channels : {1, 3, 4}) {
    for (const int bits : {8, 16}) {
      for (const char* name : {"map.png", "map.tif", "map.jpg"})
        all.push_back(picture(name, bits, channels));
    }
  }
  return all;
}

}  // namespace ssdo::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (!bytes.starts_with(ssdo::fuzz::kExr)) return LLVMFuzzerMutate(data, size, most);
  return ssdo::fuzz::mutate_exr(data, size, most, ssdo::fuzz::kinds(), seed);
}
