// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr_headers.h"

#include <ImfChannelList.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "error.h"
#include "io/exr/compression.h"
#include "io/exr/exr_copy.h"
#include "io/exr/file/exr_parts.h"
#include "io/one_line.h"

namespace ssdo {
namespace {

[[noreturn]] void fail_to_crop(const ExrOutput& output, const ExrPart& part,
                               const std::string& reason) {
  throw Error(ExitCode::input,
              fmt::format("{}: {} cannot be cropped: {}; leave out --crop or --keep-channels",
                          output.input->path().string(), label(part), reason));
}

/// OpenEXR wants windows that the subsampling of every channel divides.
void check_crop(const ExrOutput& output, const ExrPart& part,
                const std::vector<ExrChannel>& channels) {
  const Window window = written_window(output, part);
  if (window == known_window(output, part)) return;
  if (window.area() == 0) {
    fail_to_crop(output, part,
                 fmt::format("its data window, {}, lies outside of the display window, {}",
                             text_of(part.data_window), text_of(part.display_window)));
  }
  for (const ExrChannel& channel : channels) {
    const int x = channel.x_sampling, y = channel.y_sampling;
    if (window.x0 % x || window.width() % x || window.y0 % y || window.height() % y) {
      fail_to_crop(output, part,
                   fmt::format("channel '{}' is subsampled {}x{}, which does not divide {}",
                               channel.name, x, y, text_of(window)));
    }
  }
}

/// Attributes that say how pixels were stored.
constexpr std::array<std::string_view, 4> kStorage = {"tiles", "chunkCount", "version",
                                                      "maxSamplesPerPixel"};

/// Removes attributes of Cryptomattes and ids whose channels are in no part of the output: a part
/// with planes loses its channels without `keep_channels`, and always if deep.
void take_out_mattes(Imf::Header& header, const ExrOutput& output) {
  if (output.keep_channels && !part_of(output).deep) return;
  const auto is_kept = [&](const std::string& matte) {
    const auto shows = [&](const ExrPart& part) {
      return part.index != output.part &&
             std::ranges::any_of(part.channels, [&](const ExrChannel& channel) {
               return channel.name.starts_with(matte) ||
                      (part.name + "." + channel.name).starts_with(matte);
             });
    };
    return output.keep_channels && !matte.empty() &&
           std::ranges::any_of(output.input->parts(), shows);
  };
  static constexpr std::string_view kFolder = "cryptomatte/";
  std::vector<std::string> lost = {"idManifest"};
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = it.name();
    const auto folder = name.find(kFolder);
    if (folder == name.npos) continue;
    const auto id_end = name.find('/', folder + kFolder.size());
    if (!is_kept(string_attribute(header, name.substr(0, id_end) + "/name"))) lost.push_back(name);
  }
  for (const std::string& name : lost) take_out(header, name);
}

/// Removes the preview unless the output shows the same picture as the input.
void take_out_preview(Imf::Header& header, const ExrOutput& output,
                      const std::vector<KeptChannel>& kept) {
  const ExrPart& part = part_of(output);
  const bool has_all = kept.size() == part.channels.size() &&
                       std::ranges::all_of(kept, [](const KeptChannel& channel) {
                         return channel.name == channel.stored.channel.name;
                       });
  const bool makes_colors =
      std::ranges::find(output.planes, "R", &ExrPlane::name) != output.planes.end();
  if (!has_all || makes_colors) take_out(header, "preview");
}

/// The header of a part whose pixels are written anew, in scanlines.
Imf::Header scanline_header(const ExrOutput& output, const ExrPart& part) {
  Imf::Header header;
  for (auto it = part.header.begin(); it != part.header.end(); ++it)
    if (std::ranges::find(kStorage, it.name()) == kStorage.end())
      header.insert(it.name(), it.attribute());
  header.setType(Imf::SCANLINEIMAGE);
  header.lineOrder() = Imf::INCREASING_Y;
  const Window window = written_window(output, part);
  if (window != output.downsampling.small(part.data_window)) take_out(header, "preview");
  const Window display = output.downsampling.small(part.display_window);
  header.dataWindow() = {{window.x0, window.y0}, {window.x1 - 1, window.y1 - 1}};
  header.displayWindow() = {{display.x0, display.y0}, {display.x1 - 1, display.y1 - 1}};
  return header;
}

/// The header of a part without planes.
Imf::Header other_header(const ExrOutput& output, const ExrPart& part) {
  if (!Imf::isSupportedType(part.header.type())) {
    throw Error(
        ExitCode::input,
        fmt::format("{}: {} is of the type '{}', which no EXR of pixels has, and cannot be "
                    "kept; leave out --keep-channels",
                    output.input->path().string(), label(part), printable(part.header.type())));
  }
  if (!is_changed(output, part)) {
    check_copy(*output.input, part);
    Imf::Header header = part.header;
    take_out(header, "chunkCount");  // OpenEXR sets its own; a wrong type makes it fail
    return header;
  }
  check_crop(output, part, part.channels);
  Imf::Header header = scanline_header(output, part);
  if (is_lossy(header.compression())) header.compression() = Imf::ZIP_COMPRESSION;
  return header;
}

Imf::Header header_for(const ExrOutput& output, const std::vector<KeptChannel>& kept) {
  std::vector<ExrChannel> stored_channels;
  for (const KeptChannel& channel : kept) stored_channels.push_back(channel.stored.channel);
  check_crop(output, part_of(output), stored_channels);
  Imf::Header header = scanline_header(output, part_of(output));
  header.compression() = compression_for(output);
  header.channels() = Imf::ChannelList();
  for (const auto& [name, stored] : kept) {
    header.channels().insert(name, part_of(output).header.channels()[stored.channel.name]);
  }
  for (const ExrPlane& plane : output.planes) {
    header.channels().insert(plane.name, Imf::Channel(plane.type));
  }
  take_out_mattes(header, output);
  take_out_preview(header, output, kept);
  take_out(header, std::string(kEarlierProducts));
  if (output.keep_channels) {
    header.insert(std::string(kEarlierProducts), Imf::StringAttribute(products_text(output, kept)));
  }
  for (const auto& [name, text] : output.attributes) {
    // insert() replaces an attribute of an earlier run, but fails if the types differ.
    if (!header.findTypedAttribute<Imf::StringAttribute>(name)) take_out(header, name);
    header.insert(name, Imf::StringAttribute(text));
  }
  // OpenEXR keeps the level outside of the attributes: copying only these would lose it.
  if (const auto level = level_for(output, header.compression())) set_level(header, *level);
  return header;
}

}  // namespace

std::vector<Imf::Header> headers_for(const std::vector<ExrOutput>& parts,
                                     const std::vector<std::vector<KeptChannel>>& kept) {
  std::vector<Imf::Header> headers;
  for (const ExrPart& part : parts.front().input->parts()) {
    const auto with_planes = std::ranges::find(parts, part.index, &ExrOutput::part);
    if (with_planes != parts.end())
      headers.push_back(header_for(*with_planes, kept[std::size_t(with_planes - parts.begin())]));
    else if (parts.front().keep_channels)
      headers.push_back(other_header(parts.front(), part));
  }
  return headers;
}

}  // namespace ssdo
