// SPDX-License-Identifier: Apache-2.0
//
// Files whose headers lie, in every place where a file is read: one line that says so, before time
// and memory are spent on what is not there.
#include <ImfBoxAttribute.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "support/deep_file.h"
#include "support/exr_bytes.h"
#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::lies_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

using Words = std::vector<std::string>;

/// What a refusal may cost; a good frame of this size takes 0.1 s and 45 MB, and a picture 0.4 s
/// and 140 MB for the libraries of OpenImageIO. A loaded machine does not change the processor
/// time.
constexpr double kMostSeconds = 2;
constexpr long kMostKilobytes = 300 << 10;

/// A lie told in a good file of 64 x 48 pixels in three chunks.
struct ExrLie {
  std::string name;
  std::function<void(ExrBytes&)> tell;
  std::string message;
};

std::function<void(ExrBytes&)> window(const std::string& attribute, const Words& numbers) {
  return [=](ExrBytes& file) {
    for (std::size_t i = 0; i < 4; ++i)
      file.put_int(file.value_of(attribute) + 4 * i, std::stoi(numbers[i]));
  };
}

std::function<void(ExrBytes&)> size(const std::string& attribute, std::int32_t bytes) {
  return [=](ExrBytes& file) { file.put_int(file.size_of(attribute), bytes); };
}

std::function<void(ExrBytes&)> places(std::uint64_t first, std::uint64_t others) {
  return [=](ExrBytes& file) {
    const std::size_t table = file.table(3);
    for (std::size_t i = 0; i < 3; ++i) file.put_place(table + 8 * i, i == 0 ? first : others);
  };
}

/// The size that the second chunk says it has.
std::function<void(ExrBytes&)> chunk_size(std::int32_t bytes) {
  return [=](ExrBytes& file) { file.put_int(std::size_t(file.places(3)[1]) + 4, bytes); };
}

/// Gives the first channel or attribute of this name another of the same length.
std::function<void(ExrBytes&)> rename(const std::string& name, const std::string& other) {
  return [=](ExrBytes& file) { file.put_text(file.place_of(name), other); };
}

const std::string kIntMin = "-2147483648", kIntMax = "2147483647", kDamaged = "is damaged";

/// OpenEXR 3.4 opens these files; that chunks are missing shows when their pixels are asked for.
const std::string kDamagedOrLater = "is damaged|is incomplete|GiB of memory for its pixels";

const std::vector<ExrLie> kExrLies = {
    {"window_of_100k", window("dataWindow", {"0", "0", "99999", "99999"}), kDamagedOrLater},
    {"window_wide", window("dataWindow", {"0", "0", "1073741820", "0"}), kDamaged},
    {"window_tall", window("dataWindow", {"0", "0", "0", "1073741820"}), kDamaged},
    {"window_reversed", window("dataWindow", {"9", "9", "5", "5"}), "Invalid data window"},
    {"window_empty", window("dataWindow", {"0", "0", "-1", "-1"}), "Invalid data window"},
    {"window_beyond_int", window("dataWindow", {kIntMin, "0", kIntMax, "9"}),
     "Invalid data window"},
    {"window_at_int_max", window("dataWindow", {kIntMax, kIntMax, kIntMax, kIntMax}),
     "Invalid data window"},
    {"window_elsewhere", window("dataWindow", {"1000000", "1000000", "1000063", "1000047"}),
     kDamaged},
    {"display_reversed", window("displayWindow", {"9", "9", "5", "5"}), "Invalid display window"},
    {"display_beyond_int", window("displayWindow", {kIntMin, kIntMin, kIntMax, kIntMax}),
     "Invalid display window"},
    {"channels_of_2_gb", size("channels", 2147483647), "attribute 'channels' claims 2147483647"},
    {"text_of_2_gb", size("notes", 2147483647), "attribute 'notes' claims 2147483647 bytes"},
    {"text_of_1_gb", size("notes", 1 << 30), "attribute 'notes' claims 1073741824 bytes"},
    {"text_of_less_than_nothing", size("notes", -5), "attribute 'notes' claims -5 bytes"},
    {"number_of_6_bytes", size("pixelAspectRatio", 6), "claims 6 bytes, and its value takes 4"},
    {"list_of_7_bytes", size("channels", 7), "attribute 'channels' claims 7 bytes, and its value"},
    {"channel_twice", rename("ViewLayer.DiffCol.G", "ViewLayer.DiffCol.B"), kDamaged},
    {"window_twice", rename("dataWindox", "dataWindow"), kDamaged},
    {"table_beyond_the_file", places(1ull << 40, 1ull << 40), kDamaged},
    {"table_beyond_int64", places(1ull << 63, ~0ull), kDamagedOrLater},
    {"table_in_the_header", places(8, 9), kDamaged},
    {"chunk_of_2_gb", chunk_size(2147483647), "claims more bytes than its pixels take"},
    {"chunk_of_less_than_nothing", chunk_size(-1), kDamaged},
    {"ends_in_the_table", [](ExrBytes& file) { file.cut(file.table(3) + 9); },
     "in its header|is incomplete"},
    {"ends_in_the_header", [](ExrBytes& file) { file.cut(file.table(3) - 50); }, "in its header"},
};

/// `words` are texts with | between them.
bool says_one_of(const std::string& line, const std::string& words) {
  std::istringstream texts(words);
  for (std::string text; std::getline(texts, text, '|');)
    if (line.find(text) != std::string::npos) return true;
  return false;
}

/// Where a file is read, with what says what became of it: an error, a warning, or that it is made
/// anew.
struct Role {
  std::string name;
  std::function<Words(const std::string& lie, const std::string& good, const std::string& out)>
      words;
  int code = 3;
};

const std::vector<Role> kExrRoles = {
    {"input",
     [](auto& lie, auto&, auto& out) {
       return Words{lie, "-o", out};
     }},
    {"info",
     [](auto& lie, auto&, auto&) {
       return Words{"info", lie};
     }},
    {"aov",
     [](auto& lie, auto& good, auto& out) {
       return Words{good, "--aov", "normal=" + lie + ":ViewLayer.Normal", "-o", out};
     }},
    {"also",
     [](auto& lie, auto& good, auto& out) {
       return Words{good, "--also", lie, "-o", out};
     }},
    {"env",
     [](auto& lie, auto& good, auto& out) {
       return Words{good, "--env", lie + ":DiffCol", "-o", out};
     }},
    {"compare",
     [](auto& lie, auto& good, auto&) {
       return Words{"compare", good, lie};
     }},
    {"truth",
     [](auto& lie, auto& good, auto&) {
       return Words{"bench", good, "--methods", "ssao", "--truth", "ao=" + lie + ":Depth.Z"};
     }},
};

class Lies : public testing::Test {
 protected:
  Lies() {
    FramePart part = frame_of(small_picture());
    part.extra.insert("notes", Imf::StringAttribute("none"));
    part.extra.insert("dataWindox", Imf::Box2iAttribute({{0, 0}, {9, 9}}));  // for window_twice
    write_frame(path("good.exr"), part);
  }

  std::string path(const std::string& name) const { return dir_ / name; }

  /// The memory of this process, with a copy of which a child begins.
  static long resident_kilobytes() {
    std::ifstream file("/proc/self/statm");
    long all = 0, resident = 0;
    file >> all >> resident;
    return resident * (sysconf(_SC_PAGESIZE) / 1024);
  }

  void expect_cheap(const Finished& done) const {
    const auto seconds = [](const timeval& t) {
      return double(t.tv_sec) + 1e-6 * double(t.tv_usec);
    };
    EXPECT_LT(seconds(done.used.ru_utime) + seconds(done.used.ru_stime), kMostSeconds);
    EXPECT_LT(done.used.ru_maxrss, std::max(kMostKilobytes, resident_kilobytes() * 11 / 10));
  }

  void expect_refused(const Words& words, const std::string& file, const std::string& message,
                      const Surroundings& around = {}) {
    SCOPED_TRACE(testing::PrintToString(words));
    const Finished done = run_tool(words, around);
    EXPECT_EQ(done.code, 3) << done.err;
    const std::string last = done.err.substr(done.err.rfind("ssdo: ", done.err.size()));
    EXPECT_THAT(last, HasSubstr(path(file)));
    EXPECT_TRUE(says_one_of(last, message)) << last << "instead of " << message;
    EXPECT_EQ(std::count(last.begin(), last.end(), '\n'), 1);
    expect_cheap(done);
    EXPECT_FALSE(fs::exists(path("out.exr")));
  }

  TempDir dir_;
};

TEST_F(Lies, OfHeadersAreRefusedWhereverTheyAreRead) {
  for (const ExrLie& lie : kExrLies) {
    ExrBytes bytes(path("good.exr"));
    lie.tell(bytes);
    const std::string file = lie.name + ".exr";
    bytes.write(path(file));
    for (const Role& role : kExrRoles) {
      // Another display window is no layer of this frame, and no frame to measure.
      const bool differs = lie.name.starts_with("window_elsewhere");
      if (differs && role.name == "truth") continue;
      expect_refused(role.words(path(file), path("good.exr"), path("out.exr")), file, lie.message);
    }
  }
}

TEST_F(Lies, OfAFrameBesideItLeaveItOut) {
  fs::copy_file(path("good.exr"), path("shot.1.exr"));
  for (const ExrLie& lie : kExrLies) {
    ExrBytes bytes(path("good.exr"));
    lie.tell(bytes);
    bytes.write(path("shot.2.exr"));
    const Finished done = run_tool({path("shot.@.exr"), "--frames", "1", "--shot", "1", "-o",
                                    path("out.@.exr"), "--overwrite"});
    EXPECT_EQ(done.code, 0) << lie.name;
    EXPECT_THAT(done.err, HasSubstr("the frames around it do without it: " + path("shot.2.exr")))
        << lie.name;
    expect_cheap(done);
  }
}

TEST_F(Lies, OfAnOutputHaveItMadeAnew) {
  for (const ExrLie& lie : kExrLies) {
    if (lie.name.starts_with("display")) continue;
    ExrBytes bytes(path("good.exr"));
    lie.tell(bytes);
    bytes.write(path("out.exr"));
    const Finished done =
        run_tool({path("good.exr"), "-o", path("out.exr"), "--skip-existing", "-v"});
    EXPECT_EQ(done.code, 0) << lie.name;
    EXPECT_THAT(done.err, testing::Not(HasSubstr("skipped"))) << lie.name;
    expect_cheap(done);
  }
}

TEST_F(Lies, ADisplayWindowThatNoPictureCanShow) {
  ExrBytes bytes(path("good.exr"));
  window("displayWindow", {"0", "0", "999999", "999999"})(bytes);
  bytes.write(path("huge.exr"));
  EXPECT_EQ(run_tool({path("huge.exr"), "-o", path("small.exr")}).code, 0);
  for (const char* name : {"out.png", "out.jpg", "out.tif"}) {
    const Finished done = run_tool({path("huge.exr"), "-o", path(name)});
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.error_line(), HasSubstr("huge.exr: needs 14901.2 GiB of memory")) << name;
    expect_cheap(done);
  }
}

/// A frame of one pixel and 4000 channels costs little, more than the list may hold is refused.
TEST_F(Lies, OfThousandsOfChannels) {
  FramePart part{"", {0, 0, 1, 1}, {0, 0, 1, 1}, {}, Imf::HALF, {}};
  for (int i = 0; i < 4000; ++i) part.channels[fmt::format("layer{:05}.Y", i)] = Plane<float>(1, 1);
  write_frame(path("many.exr"), part);
  for (const Words& words :
       {Words{"info", path("many.exr")}, Words{"compare", path("many.exr"), path("many.exr")},
        Words{"compare", path("many.exr") + ":layer00000", path("many.exr")},
        Words{path("many.exr"), "-o", path("out.exr"), "--keep-channels"}}) {
    const Finished done = run_tool(words);
    EXPECT_NE(done.code, 1) << done.err;
    expect_cheap(done);
  }
  for (int i = 4000; i < 10000; ++i)
    part.channels[fmt::format("layer{:05}.Y", i)] = Plane<float>(1, 1);
  write_frame(path("more.exr"), part);
  for (const Role& role : kExrRoles)
    expect_refused(role.words(path("more.exr"), path("good.exr"), path("out.exr")), "more.exr",
                   "lists 283 KiB of channels");
}

/// A deep image whose one pixel has as many samples as an int can count.
TEST_F(Lies, OfDeepSamples) {
  DeepPart deep{DeepPixels({0, 0, 1, 1})};
  deep.pixels.at(0, 0) = {{1, 2, 1}};
  write_deep(path("deep.exr"), {deep});
  for (const std::int32_t samples : {1'000'000'000, 2'147'483'647, -1}) {
    ExrBytes bytes(path("deep.exr"));
    constexpr std::size_t kHead = 4 + 3 * 8;  // the row, and the sizes of counts and samples
    bytes.put_int(std::size_t(bytes.places(1)[0]) + kHead, samples);
    bytes.write(path("lie.exr"));
    expect_refused({path("lie.exr"), "-o", path("out.exr")}, "lie.exr", kDamaged);
  }
}

/// A map that packs a thousandfold, of more memory than the run may use.
TEST_F(Lies, OfMapsThatPackWell) {
  const Window window{0, 0, 4096, 4352};
  FramePart part{"", window, window, {}, Imf::HALF, {}};
  part.channels["Y"] = Plane<float>(window.width(), window.height());
  write_frame(path("map.exr"), part);
  EXPECT_LT(fs::file_size(path("map.exr")), 100'000u);
  expect_refused(
      {path("good.exr"), "--env", path("map.exr"), "-o", path("out.exr"), "--mem-limit", "64M"},
      "map.exr", "raise --mem-limit");
  expect_refused({"compare", path("map.exr"), path("map.exr")}, "map.exr", "$SSDO_MEM_LIMIT",
                 {.variables = {{"SSDO_MEM_LIMIT", "64M"}}});
}

std::string big_endian(std::uint32_t value) {
  return {char(value >> 24), char(value >> 16), char(value >> 8), char(value)};
}

std::string little_endian(std::uint32_t value) {
  return {char(value), char(value >> 8), char(value >> 16), char(value >> 24)};
}

/// A Radiance HDR of this size, with the colours of one pixel.
std::string hdr(const std::string& width, const std::string& height) {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + height + " +X " + width + "\nabcd";
}

/// The beginning of a PNG of RGB in 8 bits. The sum of its header is left out.
std::string png(std::uint32_t width, std::uint32_t height) {
  return "\x89PNG\r\n\x1a\n" + big_endian(13) + "IHDR" + big_endian(width) + big_endian(height) +
         std::string("\x08\x02\0\0\0", 5) + "sums";
}

/// A TIFF of one grey tile or strip of 16 bytes that stands after the header.
std::string tiff(std::uint32_t width, std::uint32_t height, std::uint32_t tile) {
  std::map<std::uint32_t, std::uint32_t> tags = {{256, width}, {257, height}, {258, 8},
                                                 {259, 1},     {262, 1},      {277, 1}};
  if (tile == 0)
    tags.insert({{273, 8}, {278, height}, {279, 16}});
  else
    tags.insert({{322, tile}, {323, tile}, {324, 8}, {325, 16}});
  std::string text = "II*" + std::string(1, '\0') + little_endian(24) + std::string(16, 'x') +
                     std::string{char(tags.size()), '\0'};
  for (const auto& [tag, value] : tags)
    text += std::string{char(tag), char(tag >> 8), '\4', '\0'} + little_endian(1) +
            little_endian(value);
  return text + little_endian(0);
}

TEST_F(Lies, OfPicturesAndMaps) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"huge.hdr", hdr("100000", "100000")},
      {"wide.hdr", hdr("2147483647", "1")},
      {"beyond_int.hdr", hdr("99999999999999999999", "99999999999999999999")},
      {"negative.hdr", hdr("-5", "-5")},
      {"empty.hdr", hdr("0", "0")},
      {"short.hdr", hdr("1000", "1000")},
      {"huge.png", png(100000, 100000)},
      {"beyond_int.png", png(0xffffffff, 0xffffffff)},
      {"empty.png", png(0, 0)},
      {"huge.tif", tiff(100000, 100000, 0)},
      {"beyond_int.tif", tiff(0xffffffff, 0xffffffff, 0)},
      {"large_tile.tif", tiff(64, 32, 65520)},
      {"empty.tif", tiff(0, 0, 0)},
  };
  for (const auto& [name, bytes] : files) {
    std::ofstream(path(name), std::ios::binary) << bytes;
    expect_refused({path("good.exr"), "--env", path(name), "-o", path("out.exr")}, name,
                   name + ": ");
    expect_refused({"compare", path("good.exr") + ":DiffCol", path(name)}, name, name + ": ");
  }
}

/// Texts that are larger than any of their kind, or nested too deeply.
TEST_F(Lies, OfTexts) {
  const auto repeated = [](const std::string& text, int times) {
    std::string all;
    for (int i = 0; i < times; ++i) all += text;
    return all;
  };
  struct Text {
    std::string option, bytes;
    int code;
    std::string message;
  };
  const std::vector<Text> texts = {
      {"--camera", repeated("[", 100000), 3, "not a camera"},
      {"--camera", repeated("[", 100000) + repeated("]", 100000), 3, "not a camera"},
      {"--camera", repeated("{\"a\":", 100000), 3, "not a camera"},
      {"--camera", "{\"a\": \"" + std::string(20 << 20, 'a') + "\"}", 3, "has 20480 KiB"},
      {"--config", "radius=" + repeated("[", 30000), 2, "not TOML"},
      {"--config", "radius=" + repeated("{a=", 20000), 2, "not TOML"},
      {"--config", "[" + repeated("a.", 30000) + "a]\nx=1", 2, "a: is a table"},
      {"--config", "[" + repeated("a.", 100000) + "a]\nx=1", 2, "has 195 KiB"},
      {"--config", "radius=\"" + std::string(20 << 20, '1') + "\"", 2, "has 20480 KiB"},
      {"--ocio", "ocio_profile_version: 2\nx: " + repeated("[", 100000), 3, "not a config"},
      {"--ocio", "ocio_profile_version: 2\nx: " + std::string(20 << 20, 'x'), 3, "has 20480 KiB"},
      {"--ocio", std::string("\x76\x2f\x31\x01\0\xff", 6), 3, "not a config"},
  };
  for (const Text& text : texts) {
    std::ofstream(path("text")) << text.bytes;
    const Finished done =
        run_tool({path("good.exr"), "-o", path("out.png"), text.option, path("text")});
    SCOPED_TRACE(text.option + " " + text.message);
    EXPECT_EQ(done.code, text.code);
    EXPECT_THAT(done.error_line(), AllOf(HasSubstr(path("text")), HasSubstr(text.message)));
    expect_cheap(done);
  }
}

}  // namespace
}  // namespace ssdo::test::lies_test
