// SPDX-License-Identifier: Apache-2.0
#include "io/exr/kept_channels.h"

#include <ImfChannelList.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "error.h"
#include "io/exr/file/exr_parts.h"
#include "io/exr/pixel_filter.h"
#include "io/json_text.h"

namespace ssdo {
namespace {

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

/// A channel over the window `from`, laid onto a window that holds it: 0 around, which is no
/// surface in a position or depth. Errors: ExitCode::input where the subsampling of the channel
/// does not divide `to`.
StoredChannel laid_onto(const Window& to, const StoredChannel& stored, const Window& from,
                        const ExrReader& input) {
  const auto& [channel, pixels] = stored;
  const int x = channel.x_sampling, y = channel.y_sampling;
  if (to.x0 % x || to.width() % x || to.y0 % y || to.height() % y) {
    throw Error(
        ExitCode::input,
        fmt::format("{}: channel '{}' is subsampled {}x{}, which does not divide the window "
                    "of the outputs, {}; leave out --keep-channels",
                    input.path().string(), channel.name, x, y, text_of(to)));
  }
  const std::size_t bytes = bytes_of(channel.type), row = bytes * std::size_t(from.width() / x),
                    wide_row = bytes * std::size_t(to.width() / x);
  StoredChannel laid{channel, std::vector<std::byte>(wide_row * std::size_t(to.height() / y))};
  std::byte* first = laid.pixels.data() + wide_row * std::size_t((from.y0 - to.y0) / y) +
                     bytes * std::size_t((from.x0 - to.x0) / x);
  for (std::size_t i = 0; i < std::size_t(from.height() / y); ++i)
    std::copy_n(pixels.data() + i * row, row, first + i * wide_row);
  return laid;
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

/// The new name of a channel whose name a plane takes; no other channel has the new name.
std::string moved_name(const ExrPart& part, const std::string& name) {
  std::string moved = name;
  do moved = "input." + moved;
  while (has_channel(part, moved));
  return moved;
}

/// The text of an attribute of ssdo, even if another program has put a prefix before its name.
std::string text_by_ssdo(const ExrPart& part, std::string_view name) {
  for (auto it = part.header.begin(); it != part.header.end(); ++it) {
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute());
    if (text && std::string_view(it.name()).ends_with(name)) return text->value();
  }
  return "";
}

}  // namespace

EarlierProducts earlier_products(const ExrPart& part) {
  EarlierProducts products;
  const auto said = nlohmann::json::parse(text_by_ssdo(part, kEarlierProducts), nullptr, false);
  if (said.is_object()) {
    for (const auto& [name, moved] : said.items()) {
      const std::string to = moved.is_string() ? moved.get<std::string>() : "";
      if (has_channel(part, name)) products[name] = has_channel(part, to) ? to : "";
    }
  } else if (!text_by_ssdo(part, "ssdo/version").empty()) {
    for (const ExrChannel& channel : part.channels) {
      const std::string moved = "input." + channel.name;
      if (has_channel(part, moved)) products[channel.name] = moved;
    }
  }
  return products;
}

std::string products_text(const ExrOutput& output, const std::vector<KeptChannel>& kept) {
  const EarlierProducts earlier = earlier_products(part_of(output));
  EarlierProducts products;
  const auto note_earlier = [&](const std::string& name) {
    if (const auto found = earlier.find(name); found != earlier.end()) products.insert(*found);
  };
  for (const ExrPlane& plane : output.planes) {
    note_earlier(plane.name);
    products.try_emplace(plane.name);
  }
  for (const auto& [name, stored] : kept) {
    note_earlier(name);
    if (name != stored.channel.name) products[stored.channel.name] = name;
  }
  nlohmann::json text = nlohmann::json::object();
  for (const auto& [name, moved] : products)
    text[name] = moved.empty() ? nlohmann::json() : nlohmann::json(moved);
  return json_text(text);
}

std::vector<KeptChannel> kept_channels(const ExrOutput& output) {
  const ExrPart& part = part_of(output);
  // Deep samples do not fit into a flat part.
  if (!output.keep_channels || part.deep) return {};
  const EarlierProducts earlier = earlier_products(part);
  std::vector<std::string> from, to;
  for (const ExrChannel& channel : part.channels) {
    const bool taken = has_plane(output, channel.name);
    if (taken && earlier.contains(channel.name)) continue;
    from.push_back(channel.name);
    to.push_back(taken ? moved_name(part, channel.name) : channel.name);
  }
  std::vector<StoredChannel> stored = read_channels(output, part, from);
  const Window own = output.downsampling.small(part.data_window),
               known = known_window(output, part);
  std::vector<KeptChannel> kept;
  for (std::size_t i = 0; i < to.size(); ++i) {
    kept.push_back({to[i], own == known ? std::move(stored[i])
                                        : laid_onto(known, stored[i], own, *output.input)});
  }
  return kept;
}

std::vector<KeptChannel> all_channels(const ExrOutput& output, const ExrPart& part) {
  std::vector<std::string> names;
  for (const ExrChannel& channel : part.channels) names.push_back(channel.name);
  std::vector<KeptChannel> kept;
  for (StoredChannel& channel : read_channels(output, part, names))
    kept.push_back({channel.channel.name, std::move(channel)});
  return kept;
}

Imf::FrameBuffer slices_of(const std::vector<KeptChannel>& channels, const Window& known) {
  const Imath::Box2i full({known.x0, known.y0}, {known.x1 - 1, known.y1 - 1});
  Imf::FrameBuffer slices;
  for (const auto& [name, stored] : channels) {
    slices.insert(name, Imf::Slice::Make(stored.channel.type, stored.pixels.data(), full, 0, 0,
                                         stored.channel.x_sampling, stored.channel.y_sampling));
  }
  return slices;
}

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

}  // namespace ssdo
