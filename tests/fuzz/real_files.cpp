// SPDX-License-Identifier: Apache-2.0
#include "fuzz/real_files.h"

#include <ImfFrameBuffer.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "io/exr/exr_reader.h"
#include "io/exr/file/exr_parts.h"

namespace ssdo::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> paths_in(const std::string& folder, const std::string& ending) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(fs::path(SSDO_SOURCE_DIR) / "data" / folder))
    if (entry.path().extension() == ending) paths.push_back(entry.path());
  std::ranges::sort(paths);
  return paths;
}

/// The pixels in the middle of the first part.
std::string cut(const fs::path& path) {
  const ExrReader file(path);
  const ExrPart& part = file.parts()[0];
  std::vector<std::string> names;
  for (const ExrChannel& channel : part.channels) names.push_back(channel.name);
  const std::vector<StoredChannel> channels = file.read_stored(0, names);

  const Window& all = part.data_window;
  const Imath::Box2i whole({all.x0, all.y0}, {all.x1 - 1, all.y1 - 1});
  const int x = (all.x0 + all.x1) / 2, y = (all.y0 + all.y1) / 2;
  Imf::Header header = part.header;
  for (const char* name : {"chunkCount", "tiles"}) take_out(header, name);
  header.dataWindow() = {{x - 8, y - 4}, {x + 7, y + 3}};
  Imf::FrameBuffer buffer;
  for (const auto& [channel, pixels] : channels) {
    char* const bytes = reinterpret_cast<char*>(const_cast<std::byte*>(pixels.data()));
    buffer.insert(channel.name, Imf::Slice::Make(channel.type, bytes, whole, 0, 0));
  }
  Imf::StdOSStream memory;
  {
    Imf::OutputFile out(memory, header);
    out.setFrameBuffer(buffer);
    out.writePixels(8);
  }
  return memory.str();
}

}  // namespace

std::vector<std::string> joined(std::vector<std::string> some,
                                const std::vector<std::string>& more) {
  some.insert(some.end(), more.begin(), more.end());
  return some;
}

std::vector<std::string> real_frames() {
  std::vector<std::string> frames;
  for (const char* folder : {".", "blender/exports"})
    for (const fs::path& path : paths_in(folder, ".exr")) frames.push_back(cut(path));
  return frames;
}

std::vector<std::string> real_files(const std::string& folder, const std::string& ending) {
  std::vector<std::string> files;
  for (const fs::path& path : paths_in(folder, ending)) {
    std::ifstream in(path, std::ios::binary);
    files.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return files;
}

}  // namespace ssdo::fuzz
