// SPDX-License-Identifier: Apache-2.0
#include "io/images/image_file.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "error.h"
#include "io/files/checked_file.h"
#include "io/images/codec.h"
#include "io/images/png_chunks.h"
#include "io/one_line.h"
#include "io/size_guard.h"
#include "io/threads.h"
#include "parallel/thread_start.h"

namespace fs = std::filesystem;

namespace ssdo {
namespace {

[[noreturn]] void fail(ExitCode code, const fs::path& file, std::string_view what) {
  throw Error(code, fmt::format("{}: {}", file.string(), what));
}

void check_exists(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    fail(ExitCode::input, path, "does not exist; check the path");
  }
  if (fs::is_directory(status)) {
    fail(ExitCode::input, path, "is a folder, not an image; name a file in it");
  }
  if (fs::status_known(status) && !fs::is_regular_file(status)) {
    fail(ExitCode::input, path, "is a device, pipe or socket, not an image; name a file");
  }
}

/// The places of the module: beside the tool, in the folder of an installation, above the tests.
std::vector<fs::path> places_of_codec() {
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  return {folder / kCodecFile, folder / SSDO_MODULE_FOLDER / kCodecFile,
          folder.parent_path() / kCodecFile};
}

/// The libraries of the module start threads when they are loaded: OpenImageIO's pool, and five
/// others at most (Debian 12). Some libraries wait for ever if one of their threads does not start.
void check_threads() {
  const int needed = std::max(1, io_threads() - 1) + 5;
  if (count_startable(needed) < needed) throw Error(ExitCode::failed, kNoThread);
}

/// The codec, or null if the module cannot be loaded. The module is never closed: its libraries'
/// threads live on. An exception in an initialiser of a library ends the process, because it leaves
/// the loader locked.
const ImageCodec* load(const fs::path& place) noexcept {
  void* const module = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const found = module ? dlsym(module, kCodecFunction) : nullptr;
  return found ? reinterpret_cast<GetImageCodec*>(found)(io_threads(), memory_limit()) : nullptr;
}

const ImageCodec& open_codec() {
  const std::vector<fs::path> places = places_of_codec();
  const auto place = std::find_if(places.begin(), places.end(),
                                  [](const fs::path& path) { return fs::exists(path); });
  if (place == places.end()) {
    throw Error(
        ExitCode::failed,
        fmt::format("{}: is missing, and not in {} either; pictures and maps other than EXR "
                    "need it: install ssdo again",
                    places[1].lexically_normal().string(), places[0].string()));
  }
  check_threads();
  const ImageCodec* const codec = load(*place);
  if (!codec) {
    throw Error(ExitCode::failed, fmt::format("{}: cannot be loaded ({}); raise the limits "
                                              "on memory and open files, or install ssdo again",
                                              place->string(), one_line(dlerror())));
  }
  return *codec;
}

/// Loaded when the first image is read or written.
const ImageCodec& codec() {
  static const ImageCodec& loaded = open_codec();
  return loaded;
}

}  // namespace

void load_image_codec() { codec(); }

Image read_image(const fs::path& path) {
  check_exists(path);
  check_png_chunks(path);
  return codec().read(path, nullptr);
}

void read_image_rows(const fs::path& path, const TakeRows& take) {
  check_exists(path);
  check_png_chunks(path);
  codec().read(path, &take);
}

std::vector<unsigned char> encode_image(const fs::path& name, const ImageSpec& spec,
                                        std::span<const float> values) {
  return codec().encode(name, spec, values);
}

void write_image(const SafeFile& file, const ImageSpec& spec, std::span<const float> values) {
  const std::vector<unsigned char> bytes = encode_image(file.target(), spec, values);
  CheckedFile checked(file);
  checked.write(bytes.data(), bytes.size());
  checked.close();
}

}  // namespace ssdo
