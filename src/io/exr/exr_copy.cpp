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
#include "io/exr/exr_parts.h"
#include "io/one_line.h"

namespace ssdo {
namespace {

template <class OutputPart, class InputPart>
void copy_chunks(Imf::MultiPartInputFile& from, int index, Imf::MultiPartOutputFile& to) {
  OutputPart output(to, index);
  InputPart input(from, index);
  output.copyPixels(input);
}

}  // namespace

void copy_part(const ExrReader& input, const ExrPart& part, Imf::MultiPartOutputFile& output) {
  const auto copy =
      part.deep && is_tiled(part) ? copy_chunks<Imf::DeepTiledOutputPart, Imf::DeepTiledInputPart>
      : part.deep      ? copy_chunks<Imf::DeepScanLineOutputPart, Imf::DeepScanLineInputPart>
      : is_tiled(part) ? copy_chunks<Imf::TiledOutputPart, Imf::TiledInputPart>
                       : copy_chunks<Imf::OutputPart, Imf::InputPart>;
  try {
    copy(input.file(), part.index, output);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ExitCode::input,
                fmt::format("{}: {} cannot be copied ({}); render or copy the file again, or leave "
                            "out --keep-channels",
                            input.path().string(), label(part), one_line(error.what())));
  }
}

}  // namespace ssdo
