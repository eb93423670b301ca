// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfFrameBuffer.h>

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "io/exr/exr_output.h"

namespace ssdo {

/// Takes the pixels of an output's planes from the top to the bottom, any number of rows at a time,
/// and hands those of its written window on in strips, which are whole chunks of every compression.
class ExrStrips {
 public:
  /// Takes the next rows of a file.
  using WriteRows = std::function<void(const Imf::FrameBuffer&, int rows)>;

  /// `kept`: channels that are handed on with every strip, all over the written window. `output`
  /// has to live as long as this object.
  ExrStrips(const ExrOutput& output, Imf::FrameBuffer kept, WriteRows write_rows);

  /// The next rows of the known window, one view for each plane. Returns how many half values were
  /// clamped. Errors: ExitCode::failed for views of other sizes; those of `write_rows`.
  std::size_t write(std::span<const ChannelView> planes);

  /// Whether all rows have come.
  bool is_complete() const { return y_ == known_.y1; }

  /// Errors: ExitCode::failed if rows are missing.
  void finish() const;

 private:
  void check(std::span<const ChannelView> planes) const;
  std::size_t fill(std::span<const ChannelView> planes, int y, int rows);
  void hand_on(int end);

  const ExrOutput& output_;
  const Window known_, written_;
  Imf::FrameBuffer slices_;
  WriteRows write_rows_;
  std::vector<std::vector<std::byte>> strip_;  ///< of each plane, in the type of the file
  int filled_ = 0;                             ///< rows of the strip
  int y_;                                      ///< of the next row
};

}  // namespace ssdo
