// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/manifest.h"

#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "error.h"
#include "io/one_line.h"
#include "io/size_guard.h"

namespace ssdo {
namespace {

using nlohmann::json;

/// Largest file of a manifest: a million names of 200 letters.
constexpr std::size_t kMostBytes = std::size_t(256) << 20;

/// A manifest of one Cryptomatte of a picture.
class Manifest {
 public:
  Manifest(const CryptomatteHeader& header, const std::filesystem::path& picture)
      : header_(header),
        from_(printable(picture.string()) +
              fmt::format(": Cryptomatte '{}'", printable(header.name))),
        folder_(picture.parent_path()) {}

  std::map<std::string, std::uint32_t> read() const {
    const json all = parse(text());
    if (!all.is_object())
      refuse(fmt::format("its manifest is {} and no object of names and ids", all.type_name()));
    std::map<std::string, std::uint32_t> ids;
    for (const auto& [name, id] : all.items()) ids[name] = id_of(name, id);
    return ids;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ExitCode::input,
                fmt::format("{}: {}; render it again, or select by another layer", from_, what));
  }

  std::string text() const {
    if (!header_.manifest.empty() || header_.file.empty()) return header_.manifest;
    const std::filesystem::path path = folder_ / header_.file;
    std::error_code ignored;
    std::ifstream in(path, std::ios::binary);
    if (!is_regular_file(path, ignored) || !in.is_open()) {
      refuse(fmt::format("its manifest {} cannot be read beside the picture",
                         printable(path.string())));
    }
    return read_text(in, path, kMostBytes, ExitCode::input);
  }

  /// A name that occurs twice would be ambiguous.
  json parse(const std::string& text) const {
    std::set<std::string> names;
    const auto note = [&](int depth, json::parse_event_t event, const json& parsed) {
      if (event != json::parse_event_t::key || depth != 1) return true;
      const auto& name = parsed.get_ref<const std::string&>();
      if (!names.insert(name).second)
        refuse(fmt::format("its manifest has the name '{}' twice", printable(name)));
      return true;
    };
    try {
      return json::parse(text, note);
    } catch (const json::exception& e) {
      refuse("its manifest is not JSON: " + printable(one_line(e.what())));
    }
  }

  std::uint32_t id_of(const std::string& name, const json& id) const {
    std::uint32_t bits = 0;
    if (id.is_string()) {
      const auto& hex = id.get_ref<const std::string&>();
      const auto [end, fault] = std::from_chars(hex.data(), hex.data() + hex.size(), bits, 16);
      if (!hex.empty() && fault == std::errc() && end == hex.data() + hex.size()) return bits;
    }
    refuse(fmt::format("its manifest gives '{}' an id that is no hexadecimal number of 32 bits",
                       printable(name)));
  }

  const CryptomatteHeader& header_;
  std::string from_;
  std::filesystem::path folder_;
};

}  // namespace

std::map<std::string, std::uint32_t> read_manifest(const CryptomatteHeader& header,
                                                   const std::filesystem::path& picture) {
  if (header.manifest.empty() && header.file.empty()) return {};
  return Manifest(header, picture).read();
}

}  // namespace ssdo
