// SPDX-License-Identifier: Apache-2.0
#include "io/exr/file/exr_file.h"

#include <ImfMultiPartInputFile.h>
#if __has_include(<ImfContextInit.h>)
#include <ImfContextInit.h>
#endif
#include <ImfTestFile.h>
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include "error.h"
#include "io/exr/file/attribute_sizes.h"
#include "io/exr/file/chunk_tables.h"
#include "io/exr/file/exr_stream.h"
#include "io/one_line.h"

namespace fs = std::filesystem;

namespace ssdo {
namespace {

[[noreturn]] void fail(const fs::path& file, std::string_view what) {
  throw Error(ExitCode::input, fmt::format("{}: {}", file.string(), what));
}

/// Opens `file` if its first bytes are those of an EXR. Otherwise throws an error that says what it
/// is: OpenEXR's own messages do not tell a missing file from a folder.
std::unique_ptr<InputFile> open_exr(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) {
    fail(file, "does not exist; check the path and the frame number");
  }
  if (fs::is_directory(status)) fail(file, "is a folder, not an EXR file; name a file in it");
  if (fs::status_known(status) && !fs::is_regular_file(status)) {
    fail(file, "is a device, pipe or socket; an EXR is read out of order, so name a file");
  }
  errno = 0;
  auto opened = std::make_unique<InputFile>(file);
  if (!opened->is_open()) {
    fail(file, fmt::format("cannot be opened: {}; check its permissions",
                           std::generic_category().message(errno)));
  }
  std::array<std::byte, 4> magic = {};
  if (opened->read(0, magic) == 0) fail(file, "is empty; render or copy it again");
  constexpr unsigned char kMagic[] = {0x76, 0x2f, 0x31, 0x01};
  if (std::memcmp(magic.data(), kMagic, sizeof kMagic) != 0) {
    fail(file,
         "is not an EXR file, by its first four bytes; convert it, for example with oiiotool");
  }
  return opened;
}

/// The message of OpenEXR 3.4 on why a file cannot be opened, which its exceptions do not say.
/// Empty with earlier versions.
thread_local std::string reported;

/// Opens the file, and keeps in `reported` what OpenEXR 3.4 would print.
std::unique_ptr<Imf::MultiPartInputFile> open_parts(ExrInputStream& stream) {
#if __has_include(<ImfContextInit.h>)
  reported.clear();
  Imf::ContextInitializer context;
  context.setInputStream(&stream).setErrorHandler(
      [](exr_const_context_t, exr_result_t, const char* message) { reported = message; });
  return std::make_unique<Imf::MultiPartInputFile>(stream.fileName(), context);
#else
  return std::make_unique<Imf::MultiPartInputFile>(stream);
#endif
}

}  // namespace

ExrFile::ExrFile(const std::filesystem::path& path, Salvage salvage)
    : input_(open_exr(path)),
      tables_(check_attribute_sizes(*input_)),
      salvage_(salvage),
      stream_(std::make_unique<ExrInputStream>(*input_)) {
  try {
    file_ = open_parts(*stream_);
    for (int i = 0; i < file_->parts(); ++i) parts_.push_back(describe_part(*file_, i));
  } catch (const std::exception& error) {
    throw_unless_of_file(error);
    fail(path, fmt::format("is damaged or cut short in its header ({}); render or copy it again",
                           one_line(reported.empty() ? error.what() : reported)));
  }
}

ExrFile::~ExrFile() = default;

const ChunkTables& ExrFile::chunk_tables() const {
  if (!chunk_tables_)
    chunk_tables_ = std::make_unique<ChunkTables>(*input_, *file_, parts_, tables_);
  return *chunk_tables_;
}

void ExrFile::recover() const {
  stream_->clear();
  file_->flushPartCache();  // its parts remember the old place in the stream
}

bool begins_as_exr(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && Imf::isOpenExrFile(file.c_str());
}

void throw_unless_of_file(const std::exception& error) {
  if (const auto* no_memory = dynamic_cast<const std::bad_alloc*>(&error)) throw *no_memory;
  if (const auto* of_disk = dynamic_cast<const Error*>(&error)) throw *of_disk;
}

void throw_damaged(const ExrFile& file, const ExrPart& part, const std::exception& error) {
  throw_unless_of_file(error);
  const char* state = file.chunk_tables().is_complete(part)
                          ? "is damaged or cut short"
                          : "is incomplete: its writing was interrupted";
  const bool offers = file.salvage() == Salvage::offered;
  fail(file.path(), fmt::format("{} ({}: {}); render or copy it again{}", state, label(part),
                                one_line(error.what()),
                                offers ? ", or take what is there with --allow-partial" : ""));
}

}  // namespace ssdo
