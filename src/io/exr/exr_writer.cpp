// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr_writer.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <functional>

#include "error.h"
#include "io/checked_file.h"
#include "io/exr/compression.h"
#include "io/exr/exr_copy.h"
#include "io/exr/exr_parts.h"
#include "io/exr/exr_stream.h"
#include "io/exr/zip_output.h"
#include "io/one_line.h"
#include "io/pixel_filter.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

// A whole number of chunks of every compression (1, 16, 32 or 256 lines), and enough of them to
// keep the thread pool busy.
constexpr int kStripRows = 256;

constexpr float kLargestHalf = 65504.0f;

const ExrPart& part_of(const ExrOutput& output) {
  return output.input->parts()[std::size_t(output.part)];
}

/// A channel of the input on its way into the output.
struct KeptChannel {
  std::string name;  ///< in the output
  StoredChannel stored;
};

bool has_plane(const ExrOutput& output, const std::string& name) {
  return std::any_of(output.planes.begin(), output.planes.end(),
                     [&](const ExrPlane& plane) { return plane.name == name; });
}

bool has_channel(const ExrPart& part, const std::string& name) {
  return part.header.channels().findChannel(name) != nullptr;
}

std::string lower_case(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Whether the values of a channel have a mean. The ids of a Cryptomatte have not, nor have the
/// directions, depths and coordinates that layers of X, Y and Z hold.
bool is_color(const ExrPart& part, const std::string& name) {
  const std::size_t dot = name.rfind('.') + 1;  // 0 where there is none
  const std::string lower = lower_case(name), component = lower.substr(dot);
  if (lower.find("crypto") != std::string::npos) return false;
  if (component == "y") {
    const std::string x = name[dot] == 'Y' ? "X" : "x";
    return !has_channel(part, name.substr(0, dot) + x);
  }
  return component == "r" || component == "g" || component == "b" || component == "a";
}

/// Channels of a part, at the output's size.
std::vector<StoredChannel> read_channels(const ExrOutput& output, const ExrPart& part,
                                         const std::vector<std::string>& names) {
  std::vector<StoredChannel> channels = output.input->read_stored(part.index, names);
  if (output.downsampling.is_identity()) return channels;
  for (StoredChannel& stored : channels) {
    const std::string& name = stored.channel.name;
    const bool is_geometry = std::find(output.geometry.begin(), output.geometry.end(),
                                       ChannelOfPart{part.index, name}) != output.geometry.end();
    stored = filter_stored(stored, part.data_window, output.downsampling,
                           is_geometry || !is_color(part, name));
  }
  return channels;
}

/// Errors: ExitCode::input for a part that is kept and cannot be downsampled.
void check_downsampling(const ExrOutput& output, const ExrPart& part) {
  if (!output.keep_channels || output.downsampling.is_identity()) return;
  const auto fail = [&](const std::string& reason) {
    throw Error(ExitCode::input, fmt::format("{}: {} {}, and cannot be downsampled; leave out "
                                             "--downsample or --keep-channels",
                                             output.input->path().string(), label(part), reason));
  };
  if (part.deep && part.index != output.part) fail("is deep");
  for (const ExrChannel& channel : part.channels) {
    if (channel.x_sampling != 1 || channel.y_sampling != 1)
      fail(fmt::format("has a subsampled channel '{}'", channel.name));
  }
}

std::vector<KeptChannel> kept_channels(const ExrOutput& output) {
  const ExrPart& part = part_of(output);
  // Deep samples do not fit into a flat part.
  if (!output.keep_channels || part.deep) return {};
  std::vector<std::string> from, to;
  for (const ExrChannel& channel : part.channels) {
    const bool taken = has_plane(output, channel.name);
    if (taken && has_channel(part, "input." + channel.name)) continue;
    from.push_back(channel.name);
    to.push_back(taken ? "input." + channel.name : channel.name);
  }
  std::vector<StoredChannel> stored = read_channels(output, part, from);
  std::vector<KeptChannel> kept;
  for (std::size_t i = 0; i < to.size(); ++i) kept.push_back({to[i], std::move(stored[i])});
  return kept;
}

/// The pixels of a part that are known, at the output's size.
Window known_window(const ExrOutput& output, const ExrPart& part) {
  return output.downsampling.small(part.data_window);
}

/// Those that are written.
Window written_window(const ExrOutput& output, const ExrPart& part) {
  const Window known = known_window(output, part);
  if (!output.crop || part.deep) return known;
  return intersection(known, output.downsampling.small(part.display_window));
}

bool is_cropped(const ExrOutput& output, const ExrPart& part) {
  return written_window(output, part) != known_window(output, part);
}

/// Whether the pixels of another part than the one with the planes have to be written anew.
bool is_changed(const ExrOutput& output, const ExrPart& part) {
  return is_cropped(output, part) || !output.downsampling.is_identity();
}

[[noreturn]] void fail_to_crop(const ExrOutput& output, const ExrPart& part,
                               const std::string& reason) {
  throw Error(ExitCode::input,
              fmt::format("{}: {} cannot be cropped: {}; leave out --crop or --keep-channels",
                          output.input->path().string(), label(part), reason));
}

/// All of a part of the input that is kept, to be written again.
std::vector<KeptChannel> all_channels(const ExrOutput& output, const ExrPart& part) {
  std::vector<std::string> names;
  for (const ExrChannel& channel : part.channels) names.push_back(channel.name);
  std::vector<KeptChannel> kept;
  for (StoredChannel& channel : read_channels(output, part, names))
    kept.push_back({channel.channel.name, std::move(channel)});
  return kept;
}

/// OpenEXR wants windows that the subsampling of every channel divides.
void check_crop(const ExrOutput& output, const ExrPart& part,
                const std::vector<ExrChannel>& channels) {
  if (!is_cropped(output, part)) return;
  const Window window = written_window(output, part);
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

/// The level for what is written with `compression`, which may have taken the place of another.
std::optional<int> level_for(const ExrOutput& output, Imf::Compression compression) {
  return output.compression == compression ? output.compression_level : std::nullopt;
}

/// The header of a part whose pixels are written anew, in scanlines.
Imf::Header scanline_header(const ExrOutput& output, const ExrPart& part) {
  Imf::Header header = part.header;
  for (const char* storage : {"tiles", "chunkCount", "version", "maxSamplesPerPixel"}) {
    header.erase(storage);
  }
  header.setType(Imf::SCANLINEIMAGE);
  header.lineOrder() = Imf::INCREASING_Y;
  const Window window = written_window(output, part);
  const Window display = output.downsampling.small(part.display_window);
  header.dataWindow() = {{window.x0, window.y0}, {window.x1 - 1, window.y1 - 1}};
  header.displayWindow() = {{display.x0, display.y0}, {display.x1 - 1, display.y1 - 1}};
  return header;
}

/// That of another part than the one with the planes.
Imf::Header other_header(const ExrOutput& output, const ExrPart& part) {
  if (!is_changed(output, part)) return part.header;
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
  if (const auto level = level_for(output, header.compression())) set_level(header, *level);
  header.channels() = Imf::ChannelList();
  for (const auto& [name, stored] : kept) {
    header.channels().insert(name, part_of(output).header.channels()[stored.channel.name]);
  }
  for (const ExrPlane& plane : output.planes) {
    header.channels().insert(plane.name, Imf::Channel(plane.type));
  }
  for (const auto& [name, text] : output.attributes) {
    header.erase(name);
    header.insert(name, Imf::StringAttribute(text));
  }
  return header;
}

std::vector<Imf::Header> headers_for(const ExrOutput& output,
                                     const std::vector<KeptChannel>& kept) {
  std::vector<Imf::Header> headers;
  for (const ExrPart& part : output.input->parts()) {
    if (part.index == output.part)
      headers.push_back(header_for(output, kept));
    else if (output.keep_channels)
      headers.push_back(other_header(output, part));
  }
  return headers;
}

/// Clamps and rounds `count` values that are `step` apart. Returns how many were clamped.
std::size_t round_to_half(const float* values, int step, std::size_t count, half* rounded) {
  std::size_t clamped = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float value = values[i * std::size_t(step)];
    clamped += std::abs(value) > kLargestHalf;  // false for NaN, which stays
    rounded[i] = half(value > kLargestHalf ? kLargestHalf : std::max(value, -kLargestHalf));
  }
  return clamped;
}

void copy_values(const float* values, int step, std::size_t count, float* to) {
  for (std::size_t i = 0; i < count; ++i) to[i] = values[i * std::size_t(step)];
}

/// Takes the next rows of a file.
using WriteRows = std::function<void(const Imf::FrameBuffer&, int rows)>;

/// Writes `window` of planes and channels, which are all over the window `known`.
std::size_t write_strips(const WriteRows& write_rows, const Imath::Box2i& window,
                         const Window& known, const std::vector<ExrPlane>& planes,
                         const std::vector<KeptChannel>& kept) {
  const Imath::Box2i full({known.x0, known.y0}, {known.x1 - 1, known.y1 - 1});
  const auto columns = std::size_t(window.max.x - window.min.x + 1);
  std::vector<std::vector<half>> halves(planes.size());
  std::vector<std::vector<float>> floats(planes.size());
  std::atomic<std::size_t> clamped = 0;
  for (int y = window.min.y; y <= window.max.y; y += kStripRows) {
    const int rows = std::min(kStripRows, window.max.y + 1 - y);
    const Imath::Box2i strip_window({window.min.x, y}, {window.max.x, y + rows - 1});
    Imf::FrameBuffer frame_buffer;
    for (const auto& [name, stored] : kept) {
      frame_buffer.insert(name,
                          Imf::Slice::Make(stored.channel.type, stored.pixels.data(), full, 0, 0,
                                           stored.channel.x_sampling, stored.channel.y_sampling));
    }
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const auto& [name, type, pixels] = planes[i];
      const auto fill = [&](auto& strip, const auto& convert) {
        strip.resize(std::size_t(rows) * columns);
        for_each_row(rows, [&](int row) {
          convert(pixels.at(window.min.x - full.min.x, y + row - full.min.y), pixels.step, columns,
                  &strip[std::size_t(row) * columns]);
        });
        frame_buffer.insert(name, Imf::Slice::Make(type, strip.data(), strip_window));
      };
      if (type == Imf::HALF)
        fill(halves[i], [&](auto... row) { clamped += round_to_half(row...); });
      else
        fill(floats[i], copy_values);
    }
    write_rows(frame_buffer, rows);
  }
  return clamped;
}

std::size_t write_strips(Imf::OutputPart& out, const Window& known,
                         const std::vector<ExrPlane>& planes,
                         const std::vector<KeptChannel>& kept) {
  const auto write_rows = [&](const Imf::FrameBuffer& frame_buffer, int rows) {
    out.setFrameBuffer(frame_buffer);
    out.writePixels(rows);
  };
  return write_strips(write_rows, out.header().dataWindow(), known, planes, kept);
}

/// A file with one part.
std::size_t write_zip(Imf::OStream& stream, const Imf::Header& header, const ExrOutput& output,
                      const std::vector<KeptChannel>& kept) {
  ZipOutput out(stream, header,
                level_for(output, header.compression()).value_or(ZipOutput::kDefaultLevel));
  const std::size_t clamped = write_strips(
      [&](const Imf::FrameBuffer& frame_buffer, int rows) { out.write(frame_buffer, rows); },
      header.dataWindow(), known_window(output, part_of(output)), output.planes, kept);
  out.finish();
  return clamped;
}

void check_planes(const ExrOutput& output) {
  const Window window = known_window(output, part_of(output));
  for (const ExrPlane& plane : output.planes) {
    if (plane.pixels.width == window.width() && plane.pixels.height == window.height()) continue;
    throw Error(ExitCode::failed,
                fmt::format("{}: plane '{}' is {}x{}, the output of part {} is {}x{}; this "
                            "is a defect in ssdo: please report it",
                            output.input->path().string(), plane.name, plane.pixels.width,
                            plane.pixels.height, output.part, window.width(), window.height()));
  }
}

std::size_t write_parts(CheckedFile& checked, const SafeFile& file, const ExrOutput& output,
                        const std::vector<KeptChannel>& kept) {
  const std::vector<Imf::Header> headers = headers_for(output, kept);
  ExrStream stream(checked, file.temporary().string());
  if (headers.size() == 1 && ZipOutput::takes(headers.front()))
    return write_zip(stream, headers.front(), output, kept);
  Imf::MultiPartOutputFile exr(stream, headers.data(), int(headers.size()));
  if (!output.keep_channels) {
    Imf::OutputPart part(exr, 0);
    return write_strips(part, known_window(output, part_of(output)), output.planes, kept);
  }
  std::size_t clamped = 0;
  for (const ExrPart& part : output.input->parts()) {
    if (part.index == output.part) {
      Imf::OutputPart written(exr, part.index);
      clamped = write_strips(written, known_window(output, part), output.planes, kept);
    } else if (is_changed(output, part)) {
      Imf::OutputPart written(exr, part.index);
      write_strips(written, known_window(output, part), {}, all_channels(output, part));
    } else {
      copy_part(*output.input, part, exr);
    }
  }
  return clamped;
}

}  // namespace

Imf::Compression compression_for(const ExrOutput& output) {
  const Imf::Compression wanted = output.compression.value_or(part_of(output).header.compression());
  const bool may_lose = output.compression && !output.keep_channels;
  return is_lossy(wanted) && !may_lose ? Imf::ZIP_COMPRESSION : wanted;
}

std::size_t write_exr(const SafeFile& file, const ExrOutput& output) {
  check_planes(output);
  for (const ExrPart& part : output.input->parts()) check_downsampling(output, part);
  const std::vector<KeptChannel> kept = kept_channels(output);
  CheckedFile checked(file);
  std::size_t clamped = 0;
  try {
    clamped = write_parts(checked, file, output, kept);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    if (checked.failed()) checked.close();
    throw Error(ExitCode::output, fmt::format("{}: cannot be written as EXR ({})",
                                              file.target().string(), one_line(error.what())));
  }
  // Reports also what OpenEXR's destructors, which write the offset tables, have swallowed.
  checked.close();
  return clamped;
}

}  // namespace ssdo
