// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr_copy.h"

#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledInputPart.h>
#include <ImfDeepTiledOutputPart.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputPart.h>
#include <ImfTiledInputPart.h>
#include <ImfTiledOutputPart.h>
#include <fmt/format.h>

#include "error.h"
#include "io/exr/chunks/chunk_sizes.h"
#include "io/exr/file/exr_parts.h"
#include "io/one_line.h"
#include "io/size_guard.h"

namespace ssdo {
namespace {

template <class OutputPart, class InputPart>
void copy_chunks(Imf::MultiPartInputFile& from, int index, Imf::MultiPartOutputFile& to) {
  OutputPart output(to, index);
  InputPart input(from, index);
  output.copyPixels(input);
}

/// --allow-partial does not help with what only copying needs.
[[noreturn]] void throw_not_copied(const ExrReader& input, const ExrPart& part,
                                   const std::exception& error) {
  throw_unless_of_file(error);
  throw Error(ExitCode::input,
              fmt::format("{}: {} cannot be copied ({}); render or copy the file again, or leave "
                          "out --keep-channels",
                          input.path().string(), label(part), one_line(error.what())));
}

}  // namespace

void check_copy(const ExrReader& input, const ExrPart& part) {
  double value_bytes = 0;  // of a pixel
  for (const ExrChannel& channel : part.channels) value_bytes += float_bytes(channel);
  if (part.deep) value_bytes = sizeof(std::uint32_t);  // its count of samples
  const double chunk = part.deep ? value_bytes * pixels_per_chunk(part) : decoder_bytes(part);
  check_decoded_size(input.path(), input.input().bytes(), claimed_bytes(part, value_bytes), chunk,
                     largest_ratio(part));
  // OpenEXR reads tiles as long as they claim to be, beyond its memory too.
  if (!part.deep && !is_tiled(part)) return;
  try {
    check_chunk_sizes(input, part, part.data_window);
  } catch (const std::exception& error) {
    if (part.deep) throw_not_copied(input, part, error);
    throw_damaged(input, part, error);
  }
  try {
    check_smaller_levels(input, part);
  } catch (const std::exception& error) {
    throw_not_copied(input, part, error);
  }
}

void copy_part(const ExrReader& input, const ExrPart& part, Imf::MultiPartOutputFile& output) {
  const auto copy =
      part.deep && is_tiled(part) ? copy_chunks<Imf::DeepTiledOutputPart, Imf::DeepTiledInputPart>
      : part.deep      ? copy_chunks<Imf::DeepScanLineOutputPart, Imf::DeepScanLineInputPart>
      : is_tiled(part) ? copy_chunks<Imf::TiledOutputPart, Imf::TiledInputPart>
                       : copy_chunks<Imf::OutputPart, Imf::InputPart>;
  try {
    copy(input.file(), part.index, output);
  } catch (const std::exception& error) {
    throw_not_copied(input, part, error);
  }
}

}  // namespace ssdo
