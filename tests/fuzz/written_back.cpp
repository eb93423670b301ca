// SPDX-License-Identifier: Apache-2.0
#include "fuzz/written_back.h"

#include "fuzz/target.h"
#include "io/exr/exr_writer.h"
#include "support/temp_dir.h"

namespace ssdo::fuzz {
namespace {

const char* const kProduct = "product of the fuzzer";

std::vector<std::string> names_of(const ExrPart& part) {
  std::vector<std::string> names;
  for (const ExrChannel& channel : part.channels)
    if (channel.name != kProduct) names.push_back(channel.name);
  return names;
}

void compare(const ExrReader& file, const ExrReader& copy, const ExrPart& part) {
  const std::vector<std::string> names = names_of(part);
  const auto before = file.read_stored(part.index, names),
             after = copy.read_stored(part.index, names);
  for (std::size_t i = 0; i < before.size(); ++i) {
    require(before[i].channel.type == after[i].channel.type, "a kept channel has another type");
    require(before[i].pixels == after[i].pixels, "a kept channel has other bits");
  }
}

}  // namespace

void write_back(const ExrReader& file, const ExrPart& part, unsigned choices) {
  static const test::TempDir folder;
  ExrOutput output;
  output.input = &file;
  output.part = part.index;
  output.keep_channels = true;
  output.crop = choices % 4 == 1;
  const Window& display = part.display_window;
  if (choices % 4 == 2 && display.width() % 2 == 0 && display.height() % 2 == 0)
    output.downsampling = {2, display};
  if (choices / 4 % 2 == 1)
    output.compression = Imf::Compression(choices / 8 % Imf::NUM_COMPRESSION_METHODS);
  const Window pixels = known_window(output, part);
  const Plane<float> product(pixels.width(), pixels.height(), 0.5f);
  output.planes = {{kProduct, Imf::HALF, &product}};

  const SafeFile written(folder / "out.exr", {});
  write_exr(written, {output});
  const ExrReader copy(written.temporary());
  require(copy.parts().size() == file.parts().size(), "a part is lost");
  if (output.crop || !output.downsampling.is_identity() || file.salvage() != Salvage::none) return;
  for (const ExrPart& kept : file.parts())
    if (!kept.deep) compare(file, copy, kept);
}

}  // namespace ssdo::fuzz
