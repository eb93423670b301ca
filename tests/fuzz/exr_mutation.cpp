// SPDX-License-Identifier: Apache-2.0
#include "fuzz/exr_mutation.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string_view>

#include "fuzz/exr_layout.h"
#include "fuzz/exr_packing.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace ssdo::fuzz {
namespace {

/// Names that mean something to layers, views and cameras.
constexpr std::string_view kChannelNames[] = {
    "P.X",      "P.Y",      "P.Z",        "N.X",      "N.Y",     "N.Z",     "R",
    "G",        "B",        "A",          "Z",        "ZBack",   "Y",       "albedo.R",
    "albedo.G", "albedo.B", "depth",      "P.left.X", "ao.Y",    "Depth.V", "AR",
    "X",        "motion.X", "crypto00.R", "RY",       "right.Z", ".",       "P."};
constexpr std::string_view kAttributeNames[] = {"worldToCamera",
                                                "worldToNDC",
                                                "cameraTransform",
                                                "cameraFov",
                                                "cameraAperture",
                                                "cameraFocalLength",
                                                "cameraProjection",
                                                "rs/camera/transform",
                                                "rs/camera/fov",
                                                "view",
                                                "multiView",
                                                "Software",
                                                "chromaticities",
                                                "pixelAspectRatio",
                                                "exr/worldToCamera",
                                                "unreal/camera/curPos/x",
                                                "unreal/camera/FinalImage/fov",
                                                "chunkCount",
                                                "tiles",
                                                "type"};

void mutate(std::string& bytes, std::size_t most) {
  const std::size_t size = bytes.size();
  bytes.resize(std::max<std::size_t>(most, 1));
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()), size, bytes.size()));
}

/// A number at an odd or even place becomes an odd one.
void set_number(std::string& bytes, Chance& chance) {
  if (bytes.size() < 4) return mutate(bytes, bytes.size() + 4);
  const std::size_t places = bytes.size() / 4, place = 4 * std::size_t(chance.below(int(places)));
  const std::string number =
      chance.one_in(2) ? stored(chance.pick(kOddInts)) : stored(chance.pick(kOddFloats));
  bytes.replace(place, 4, number);
}

std::vector<RawAttribute>& any_header(ExrLayout& layout, Chance& chance) {
  return chance.pick(layout.headers);
}

RawAttribute* find(std::vector<RawAttribute>& header, std::string_view name) {
  const auto found = std::find_if(header.begin(), header.end(),
                                  [&](const RawAttribute& a) { return a.name == name; });
  return found == header.end() ? nullptr : &*found;
}

void change_attribute(ExrLayout& layout, Chance& chance) {
  std::vector<RawAttribute>& header = any_header(layout, chance);
  if (header.empty()) return;
  RawAttribute& attribute = chance.pick(header);
  if (chance.one_in(2))
    set_number(attribute.value, chance);
  else
    mutate(attribute.value, attribute.value.size() + (chance.one_in(2) ? 8 : 0));
}

void move_attribute(ExrLayout& layout, Chance& chance) {
  std::vector<RawAttribute>& from = any_header(layout, chance);
  if (from.empty()) return;
  RawAttribute attribute = chance.pick(from);
  if (chance.one_in(2)) attribute.name = chance.pick(kAttributeNames);
  std::vector<RawAttribute>& to = any_header(layout, chance);
  RawAttribute* const old = find(to, attribute.name);
  if (old && chance.one_in(4))
    to.erase(to.begin() + (old - to.data()));
  else if (old)
    *old = attribute;
  else
    to.push_back(attribute);
}

/// Renames a channel, changes its type or sampling, or adds one.
void change_channels(ExrLayout& layout, Chance& chance) {
  RawAttribute* const list = find(any_header(layout, chance), "channels");
  if (!list) return;
  constexpr std::size_t kBehindName = 16;  // type, linearity, samplings
  std::vector<std::string> rows;
  for (std::size_t place = 0; place + 1 < list->value.size();) {
    const std::size_t end = list->value.find('\0', place);
    if (end == std::string::npos || end + 1 + kBehindName > list->value.size()) return;
    rows.push_back(list->value.substr(place, end + 1 + kBehindName - place));
    place = end + 1 + kBehindName;
  }
  if (rows.empty()) return;
  std::string& row = chance.pick(rows);
  const std::size_t behind = row.size() - kBehindName;
  const std::string renamed = std::string(chance.pick(kChannelNames)) + '\0' + row.substr(behind);
  switch (chance.below(4)) {
    case 0:
      row = renamed;
      break;
    case 1:
      rows.push_back(renamed);
      break;
    case 2:
      row.replace(behind, 4, stored(chance.below(3)));
      break;
    default:
      row.replace(behind + (chance.one_in(2) ? 8 : 12), 4, stored(1 + chance.below(3)));
  }
  std::sort(rows.begin(), rows.end());
  list->value.clear();
  for (const std::string& each : rows) list->value += each;
  list->value += '\0';
}

void change_compression(ExrLayout& layout, Chance& chance) {
  if (RawAttribute* const found = find(any_header(layout, chance), "compression"))
    found->value = std::string(1, char(chance.below(11)));
}

/// Moves a window, or one side of it.
void change_window(ExrLayout& layout, Chance& chance) {
  std::vector<RawAttribute>& header = any_header(layout, chance);
  RawAttribute* const window = find(header, chance.one_in(2) ? "dataWindow" : "displayWindow");
  if (!window || window->value.size() != 16) return;
  constexpr int kSteps[] = {-16, -1, 1, 2, 7, 16, 100, 1 << 20};
  const int step = chance.pick(kSteps), axis = chance.below(2);
  const bool both = chance.one_in(2);
  for (const int side : {axis, axis + 2}) {
    if (side < 2 && !both) continue;
    const auto place = std::size_t(4 * side);
    const auto old = std::uint32_t(number_at<std::int32_t>(window->value, place));
    window->value.replace(place, 4, stored(std::int32_t(old + std::uint32_t(step))));
  }
}

void change_pixels(std::string& pixels, Chance& chance) {
  for (int count = 1 + chance.below(8); count > 0; --count) set_number(pixels, chance);
  if (chance.one_in(4)) mutate(pixels, pixels.size() + (chance.one_in(4) ? 64 : 0));
}

/// Packed pixels: what they hold, or the packed bytes.
void change_packed(std::string& data, std::string_view compression, Chance& chance) {
  auto pixels = compression.empty() ? std::nullopt : unpack(compression[0], data);
  if (!pixels || chance.one_in(4)) return mutate(data, data.size());
  change_pixels(*pixels, chance);
  data = pack(compression[0], *pixels);
}

/// The size of what was changed, right but now and then. One of 64 bits may be odd in its upper
/// half.
template <class Number>
std::string size_of(const std::string& data, Chance& chance) {
  if (!chance.one_in(20)) return stored(Number(data.size()));
  const auto odd = std::uint64_t(chance.pick(kOddInts));
  const bool is_upper = sizeof(Number) == 8 && chance.one_in(2);
  return stored(Number(is_upper ? odd << 32 : odd));
}

void change_flat_chunk(std::string& chunk, const ExrLayout& layout, Chance& chance) {
  const std::size_t sizes = layout.sizes_of(chunk);
  if (chunk.size() < sizes + 4) return mutate(chunk, chunk.size());
  std::string data = chunk.substr(sizes + 4);
  change_packed(data, value_of(layout.header_of(chunk), "compression"), chance);
  chunk.resize(sizes);
  chunk += size_of<std::int32_t>(data, chance) + data;
}

void change_deep_chunk(std::string& chunk, const ExrLayout& layout, Chance& chance) {
  const std::size_t sizes = layout.sizes_of(chunk), begin = sizes + 24;
  if (chunk.size() < begin) return mutate(chunk, chunk.size());
  const auto table_size = number_at<std::uint64_t>(chunk, sizes);
  if (table_size > chunk.size() - begin) return mutate(chunk, chunk.size());
  std::string table = chunk.substr(begin, table_size), samples = chunk.substr(begin + table_size),
              unpacked = chunk.substr(sizes + 16, 8);
  if (chance.one_in(20)) set_number(unpacked, chance);
  change_packed(chance.one_in(2) ? table : samples,
                value_of(layout.header_of(chunk), "compression"), chance);
  chunk.resize(sizes);
  chunk += size_of<std::uint64_t>(table, chance) + size_of<std::uint64_t>(samples, chance) +
           unpacked + table + samples;
}

void change_chunk(ExrLayout& layout, Chance& chance) {
  if (layout.chunks.empty()) return;
  std::string& chunk = chance.pick(layout.chunks);
  (layout.is_deep(chunk) ? change_deep_chunk : change_flat_chunk)(chunk, layout, chance);
}

/// Changes where a chunk says it belongs, or takes one away, or puts it in another's place.
void change_order(ExrLayout& layout, Chance& chance) {
  if (layout.chunks.empty()) return;
  std::string& chunk = chance.pick(layout.chunks);
  switch (chance.below(4)) {
    case 0:
      std::swap(chunk, chance.pick(layout.chunks));
      break;
    case 1:
      chunk.clear();
      break;
    case 2:
      chunk = chance.pick(layout.chunks);
      break;
    default:
      if (chunk.size() >= 16)
        chunk.replace(std::size_t(4 * chance.below(4)), 4, stored(chance.below(20)));
  }
}

constexpr void (*kChanges[])(ExrLayout&, Chance&) = {
    change_attribute, change_attribute, move_attribute, change_channels, change_compression,
    change_window,    change_chunk,     change_chunk,   change_chunk,    change_order};

}  // namespace

std::string mutated_exr(const std::string& bytes, const std::vector<ExrKind>& kinds,
                        std::size_t most_bytes, Chance& chance) {
  std::string out;
  auto layout = take_apart(bytes);
  if (chance.one_in(50)) {
    out = exr_sample(chance.pick(kinds), chance);
  } else if (!layout || chance.one_in(10)) {
    out = bytes;
    mutate(out, most_bytes);
  } else {
    for (int count = 1 + chance.below(3); count > 0; --count)
      chance.pick(kChanges)(*layout, chance);
    out = put_together(*layout);
  }
  if (out.size() > most_bytes) out.resize(most_bytes);
  return out;
}

std::size_t mutate_exr(std::uint8_t* bytes, std::size_t size, std::size_t most_bytes,
                       const std::vector<ExrKind>& kinds, unsigned seed) {
  Chance chance(seed);
  const std::string out =
      mutated_exr({reinterpret_cast<const char*>(bytes), size}, kinds, most_bytes, chance);
  std::memcpy(bytes, out.data(), out.size());
  return out.size();
}

}  // namespace ssdo::fuzz
