// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr_output.h"

#include "io/exr/compression.h"

namespace ssdo {

const ExrPart& part_of(const ExrOutput& output) {
  return output.input->parts()[std::size_t(output.part)];
}

Window known_window(const ExrOutput& output, const ExrPart& part) {
  const bool has_planes = part.index == output.part;
  return output.downsampling.small(has_planes ? output.window.value_or(part.data_window)
                                              : part.data_window);
}

Window written_window(const ExrOutput& output, const ExrPart& part) {
  const Window known = known_window(output, part);
  if (!output.crop || part.deep) return known;
  return intersection(known, output.downsampling.small(part.display_window));
}

bool is_changed(const ExrOutput& output, const ExrPart& part) {
  return written_window(output, part) != known_window(output, part) ||
         !output.downsampling.is_identity() ||
         (!part.deep && !output.input->missing(part.index).windows.empty());
}

Imf::Compression compression_for(const ExrOutput& output) {
  const Imf::Compression wanted = output.compression.value_or(part_of(output).header.compression());
  const bool may_lose = output.compression && !output.keep_channels;
  return is_lossy(wanted) && !may_lose ? Imf::ZIP_COMPRESSION : wanted;
}

std::optional<int> level_for(const ExrOutput& output, Imf::Compression compression) {
  return output.compression == compression ? output.compression_level : std::nullopt;
}

}  // namespace ssdo
