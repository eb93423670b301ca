// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepTiledInputPart.h>

#include <cstddef>
#include <cstdint>
#include <optional>

#include "io/exr/file/exr_file.h"

namespace ssdo {

/// The address that (0, 0) of the display window has in a plane over `window`.
template <class T>
char* at_origin(T* first, const Window& window) {
  const std::ptrdiff_t offset = std::ptrdiff_t(window.y0) * window.width() + window.x0;
  return reinterpret_cast<char*>(reinterpret_cast<std::uintptr_t>(first) -
                                 std::uintptr_t(offset) * sizeof(T));
}

/// A deep part, of scanlines or tiles, that OpenEXR reads into `buffer`. Windows are those of the
/// part's chunks, or its whole data window. Errors: those of OpenEXR.
class DeepChunks {
 public:
  DeepChunks(const ExrFile& file, const ExrPart& part, const Imf::DeepFrameBuffer& buffer);

  void read_counts(const Window& window);
  void read_samples(const Window& window);  ///< of counts that have been read

 private:
  const ExrPart& part_;
  std::optional<Imf::DeepScanLineInputPart> lines_;
  std::optional<Imf::DeepTiledInputPart> tiles_;
};

/// Has a chunk of a deep part read, for what is wrong with it. Throws std::runtime_error for more
/// samples than the file can hold, and what OpenEXR throws.
void try_deep_chunk(const ExrFile& file, const ExrPart& part, const Window& chunk);

}  // namespace ssdo
