// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/selected_coverage.h"

#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>
#include <bit>
#include <deque>

#include "io/exr/file/exr_parts.h"
#include "scene/objects/object_hash.h"
#include "support/error_matchers.h"
#include "support/frame_file.h"
#include "support/temp_dir.h"

namespace ssdo::test::selected_coverage_test {
namespace {

constexpr Window kWindow{0, 0, 4, 2};

float id_of(const std::string& name) { return std::bit_cast<float>(cryptomatte_id(name)); }

/// Writes a frame with a Cryptomatte of objects a, b and c, a layer of ids and a matte.
class SelectedCoverage : public testing::Test {
 protected:
  SelectedCoverage() {
    part_.data = part_.display = kWindow;
    for (const char* layer : {"Crypto00", "Crypto01"}) {
      for (const char* channel : {".r", ".g", ".b", ".a"})
        part_.channels[std::string(layer) + channel] = Plane<float>(4, 2, 0.0f);
    }
    // Pixel (1, 0): a, b and c; (2, 0): a alone; (3, 1): b beside nothing.
    set(1, 0, {{"a", 0.5f}, {"b", 0.3f}, {"c", 0.2f}});
    set(2, 0, {{"a", 1}});
    set(3, 1, {{"b", 0.25f}});
    Plane<float> ids(4, 2, 0.0f), matte(4, 2, 0.0f);
    ids(0, 0) = 5, ids(1, 0) = 7, ids(2, 0) = 6.5f, ids(3, 0) = -2;
    matte(0, 0) = 0.5f, matte(1, 0) = 2, matte(2, 0) = -1, matte(3, 0) = NAN;
    part_.channels["IndexOB.X"] = ids;
    part_.channels["mask.A"] = matte;
    attribute("name", "Crypto");
    attribute("hash", "MurmurHash3_32");
    attribute("conversion", "uint32_to_float32");
    attribute("manifest",
              fmt::format("{{\"a\":\"{:08x}\",\"b\":\"{:08x}\",\"c\":\"{:08x}\"}}",
                          cryptomatte_id("a"), cryptomatte_id("b"), cryptomatte_id("c")));
  }

  void attribute(const std::string& field, const std::string& value) {
    part_.extra.insert("cryptomatte/1234567/" + field, Imf::StringAttribute(value));
  }

  void set(int x, int y, const std::vector<std::pair<std::string, float>>& ranks) {
    const char* const layers[] = {"Crypto00", "Crypto00", "Crypto01"};
    for (std::size_t k = 0; k < ranks.size(); ++k) {
      const std::string layer = layers[k];
      part_.channels[layer + (k % 2 ? ".b" : ".r")](x, y) = id_of(ranks[k].first);
      part_.channels[layer + (k % 2 ? ".a" : ".g")](x, y) = ranks[k].second;
    }
  }

  std::deque<ExrReader> open() {
    write_frame(dir_ / "in.exr", part_);
    std::deque<ExrReader> files;
    files.emplace_back(dir_ / "in.exr");
    return files;
  }

  Plane<float> select(const std::string& text, const Window& window = kWindow,
                      const PixelGrid& grid = {}) {
    const std::deque<ExrReader> files = open();
    warnings_.clear();
    return selected_coverage(parse_selection("--only", text), {files, "", &warnings_}, window,
                             grid);
  }

  Error fault(const std::string& text) {
    return error_of([&] { select(text); });
  }

  const TempDir dir_;
  FramePart part_;
  std::vector<std::string> warnings_;
};

using Values = std::vector<float>;

Values values(const Plane<float>& plane) { return {plane.pixels.begin(), plane.pixels.end()}; }

TEST_F(SelectedCoverage, SumsAllRanks) {
  EXPECT_EQ(values(select("crypto:a")), (Values{0, 0.5f, 1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(values(select("crypto:b")), (Values{0, 0.3f, 0, 0, 0, 0, 0, 0.25f}));
  EXPECT_FLOAT_EQ(select("crypto:c")(1, 0), 0.2f);
  EXPECT_FLOAT_EQ(select("crypto:*")(1, 0), 1);
  EXPECT_FLOAT_EQ(select("crypto:[bc]")(1, 0), 0.5f);
  EXPECT_FLOAT_EQ(select("crypto:?")(3, 1), 0.25f);
}

TEST_F(SelectedCoverage, JoinsNamesAsSets) {
  EXPECT_FLOAT_EQ(select("crypto:a+crypto:b")(1, 0), 0.8f);
  EXPECT_FLOAT_EQ(select("crypto:a+crypto:*")(1, 0), 1);
  // Not 0.5 - 0.3, which coverage alone would give.
  EXPECT_FLOAT_EQ(select("crypto:a-crypto:b")(1, 0), 0.5f);
  EXPECT_FLOAT_EQ(select("crypto:*-crypto:b")(1, 0), 0.7f);
  EXPECT_FLOAT_EQ(select("crypto:b-crypto:*+crypto:c")(1, 0), 0.2f);
}

TEST_F(SelectedCoverage, TakesIdsAndMattes) {
  EXPECT_EQ(values(select("id:IndexOB=5-6")), (Values{1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(values(select("id:IndexOB=-2,7")), (Values{0, 1, 0, 1, 0, 0, 0, 0}));
  EXPECT_EQ(values(select("mask")), (Values{0.5f, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(select("mask.A").pixels, select("mask").pixels);
  EXPECT_EQ(values(select("mask+id:IndexOB=5 - mask")), (Values{0.5f, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(values(select("crypto:a - mask")), (Values{0, 0, 1, 0, 0, 0, 0, 0}));
}

TEST_F(SelectedCoverage, CoversAnyWindow) {
  EXPECT_EQ(values(select("crypto:a", {1, -1, 3, 1})), (Values{0, 0, 0.5f, 1}));
  EXPECT_EQ(values(select("crypto:b", {0, 1, 4, 2}, {.y0 = 1, .y1 = 2})), (Values{0, 0, 0, 0.25f}));
  EXPECT_EQ(values(select("crypto:a", {7, 7, 8, 8})), Values{0});
  part_.data = {1, 0, 3, 2};
  for (auto& [name, plane] : part_.channels) plane = Plane<float>(2, 2, plane(2, 0));
  EXPECT_EQ(values(select("crypto:a")), (Values{0, 1, 1, 0, 0, 1, 1, 0}));
}

TEST_F(SelectedCoverage, AnswersUnknownNamesWithTheNearest) {
  attribute("manifest", R"({"ballroom":"1","box":"2","left wall":"3"})");
  EXPECT_THAT(fault("crypto:balroom"), IsError(ExitCode::layer, "did you mean ballroom?"));
  EXPECT_THAT(fault("crypto:zzz*"), IsError(ExitCode::layer, "there are ballroom, box, left wall"));
  EXPECT_THAT(fault("crypto:box+crypto:left wal"), IsError(ExitCode::layer, "'left wal'"));
  EXPECT_THAT(fault("id:IndexOv=1"), IsError(ExitCode::layer, "did you mean IndexOB?"));
  EXPECT_THAT(fault("masc"), IsError(ExitCode::layer, "did you mean mask?"));
  EXPECT_THAT(fault("a\x1b[2J\n"), IsError(ExitCode::layer, "a\\x1b[2J\\x0a"));
}

TEST_F(SelectedCoverage, HashesNamesWithoutAManifest) {
  take_out(part_.extra, "cryptomatte/1234567/manifest");
  EXPECT_FLOAT_EQ(select("crypto:c")(1, 0), 0.2f);
  EXPECT_TRUE(warnings_.empty());
  EXPECT_FLOAT_EQ(select("crypto:c+crypto:unknown")(1, 0), 0.2f);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_EQ(warnings_[0],
            fmt::format("--only crypto:c+crypto:unknown: no pixel has 'unknown', whose hash is "
                        "{:08x}; the Cryptomatte has no manifest to check the name with",
                        cryptomatte_id("unknown")));
  EXPECT_THAT(fault("crypto:[bc]"), IsError(ExitCode::layer, "no manifest of the names"));
  attribute("hash", "fnv");
  EXPECT_THAT(fault("crypto:a"), IsError(ExitCode::input, "has hash 'fnv'"));
}

/// Blender writes r g b a, Arnold and V-Ray R G B A, Nuke red green blue alpha and a prefix of the
/// attributes; files of Blender 5 and Nuke have a part for each layer.
TEST_F(SelectedCoverage, TakesTheLayoutsOfTools) {
  const auto components = [&](const std::array<const char*, 4>& names) {
    FramePart out = part_;
    std::erase_if(out.channels, [](const auto& c) { return c.first.starts_with("Crypto"); });
    for (const auto& [name, plane] : part_.channels) {
      if (!name.starts_with("Crypto")) continue;
      const std::size_t which = std::string("rgba").find(name.back());
      out.channels[name.substr(0, name.size() - 1) + names[which]] = plane;
    }
    return out;
  };
  const FramePart blender = part_;
  for (const auto& names : {std::array{"R", "G", "B", "A"}, {"red", "green", "blue", "alpha"}}) {
    part_ = components(names);
    EXPECT_FLOAT_EQ(select("crypto:[bc]")(1, 0), 0.5f) << names[0];
    part_ = blender;
  }
  for (const char* prefix : {"exr/", "nuke/exr/"}) {
    Imf::Header renamed;
    for (const char* field : {"name", "manifest"}) {
      const auto& value = blender.extra.typedAttribute<Imf::StringAttribute>(
          std::string("cryptomatte/1234567/") + field);
      renamed.insert(std::string(prefix) + "cryptomatte/1234567/" + field, value);
    }
    part_.extra = renamed;
    EXPECT_FLOAT_EQ(select("crypto:a")(1, 0), 0.5f) << prefix;
    part_ = blender;
  }
  std::vector<FramePart> parts(3, blender);
  for (FramePart& part : parts) part.channels.clear();
  parts[0].name = "beauty", parts[0].channels["R"] = Plane<float>(4, 2, 0.0f);
  for (int layer = 0; layer < 2; ++layer) {
    FramePart& part = parts[std::size_t(layer) + 1];
    part.name = "Crypto0" + std::to_string(layer);
    for (const char* c : {"r", "g", "b", "a"})
      part.channels[c] = blender.channels.at(part.name + "." + c);
  }
  write_frame(dir_ / "parts.exr", parts);
  std::deque<ExrReader> files;
  files.emplace_back(dir_ / "parts.exr");
  const Selection both = parse_selection("--only", "crypto:b+crypto:c");
  EXPECT_FLOAT_EQ(selected_coverage(both, {files, ""}, kWindow, {})(1, 0), 0.5f);
  parts[2].data = {0, 0, 2, 2};
  for (auto& [name, plane] : parts[2].channels) plane = Plane<float>(2, 2, 0.0f);
  write_frame(dir_ / "cut.exr", parts);
  std::deque<ExrReader> cut;
  cut.emplace_back(dir_ / "cut.exr");
  EXPECT_THAT(error_of([&] {
                selected_coverage(both, {cut, ""}, kWindow, {});
              }),
              IsError(ExitCode::layer, "parts with different data windows"));
}

TEST_F(SelectedCoverage, RefusesBrokenCryptomattes) {
  take_out(part_.extra, "cryptomatte/1234567/conversion");
  EXPECT_FLOAT_EQ(select("crypto:a")(2, 0), 1);
  attribute("conversion", "half");
  EXPECT_THAT(fault("crypto:a"), IsError(ExitCode::input, "has conversion 'half'"));
  take_out(part_.extra, "cryptomatte/1234567/conversion");
  const FramePart whole = part_;
  part_.channels.erase("Crypto00.g");
  EXPECT_THAT(fault("crypto:a"), IsError(ExitCode::input, "lacks channel g of Crypto00"));
  part_ = whole;
  part_.channels.erase("Crypto01.b"), part_.channels.erase("Crypto01.a");
  EXPECT_FLOAT_EQ(select("crypto:c")(1, 0), 0.2f);
  for (const char* channel : {".r", ".g", ".b", ".a"})
    part_.channels.erase(std::string("Crypto00") + channel);
  EXPECT_THAT(fault("crypto:a"), IsError(ExitCode::input, "has a layer 01, and none before it"));
  part_ = whole;
  part_.type = Imf::HALF;
  EXPECT_THAT(fault("crypto:a"), IsError(ExitCode::input, "another type than float"));
  part_ = whole;
  std::erase_if(part_.channels, [](const auto& c) { return c.first.starts_with("Crypto"); });
  EXPECT_THAT(fault("crypto:a"), IsError(ExitCode::input, "has no layer Crypto00"));
  part_.extra = {};
  EXPECT_THAT(fault("crypto:a"), IsError(ExitCode::layer, "has no Cryptomatte"));
}

TEST_F(SelectedCoverage, RefusesAnotherDisplayWindow) {
  FramePart other;
  other.data = other.display = {0, 0, 5, 2};
  other.channels["wide.Y"] = Plane<float>(5, 2, 1.0f);
  write_frame(dir_ / "wide.exr", other);
  std::deque<ExrReader> files = open();
  files.emplace_back(dir_ / "wide.exr");
  const std::string name = (dir_ / "wide.exr").string() + ":wide";
  const auto select_wide = [&] {
    selected_coverage(parse_selection("--only", name), {files, ""}, kWindow, {});
  };
  EXPECT_THAT(error_of(select_wide), IsError(ExitCode::layer, "has the display window"));
}

TEST_F(SelectedCoverage, ListsNamesWithTheirShares) {
  const std::deque<ExrReader> files = open();
  std::vector<std::string> warnings;
  const std::vector<ObjectShare> all = objects_of(files[0], "", warnings);
  EXPECT_TRUE(warnings.empty());
  ASSERT_EQ(all.size(), 3u + 4u) << "6.5 is no id";
  EXPECT_EQ(all[0].name, "a");
  EXPECT_FLOAT_EQ(float(all[0].share), 1.5f / 8);
  EXPECT_EQ(all[2].name, "c");
  attribute("manifest", "[]");
  EXPECT_EQ(objects_of(open()[0], "", warnings).size(), 4u);
  EXPECT_EQ(warnings.size(), 1u);
}

}  // namespace
}  // namespace ssdo::test::selected_coverage_test
