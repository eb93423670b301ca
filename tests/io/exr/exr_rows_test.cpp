// SPDX-License-Identifier: Apache-2.0
//
// Files that are written some rows at a time: against the same file written at once, and against
// what OpenEXR writes of the same pixels.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <glm/vec3.hpp>
#include <iterator>

#include "io/exr/exr_writer.h"
#include "support/error_matchers.h"
#include "support/exr_fixture.h"
#include "support/run_tool.h"
#include "support/temp_dir.h"

namespace fs = std::filesystem;

namespace ssdo::test::exr_rows_test {
namespace {

using Imath::Box2i;

constexpr Imf::Compression kCompressions[] = {
    Imf::NO_COMPRESSION,   Imf::RLE_COMPRESSION,   Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
    Imf::PIZ_COMPRESSION,  Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION,  Imf::B44A_COMPRESSION,
    Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION};

/// The rows of a plane from `first` on, `rows` of them or those that are left.
ChannelView rows_of(ChannelView plane, int first, int rows) {
  plane.first = plane.at(0, first);
  plane.height = std::min(rows, plane.height - first);
  return plane;
}

/// An input of two strips and a rest, and a half and a float plane over it.
class Rows : public testing::Test {
 protected:
  Rows() {
    const Box2i data({-30, -200}, {36, 400});
    Imf::Header header = test_header(data, {{"Z"}, {"id", Imf::UINT}});
    header.displayWindow() = Box2i({-20, -63}, {25, 301});
    write_test_exr(dir_ / "in.exr",
                   {named(header, "first"), named(header, "second"), named(header, "third")});
    input_.emplace(dir_ / "in.exr");
    plane_ = Plane<glm::vec3>(data.size().x + 1, data.size().y + 1);
    for (std::size_t i = 0; i < plane_.size(); ++i)
      plane_[i] = {std::sin(0.01f * float(i)), 7, std::cos(0.02f * float(i))};
  }

  ExrOutput output(Imf::Compression compression = Imf::ZIP_COMPRESSION) const {
    ExrOutput o;
    o.input = &*input_;
    o.part = 1;
    o.planes = {{"half", Imf::HALF, ChannelView(plane_, 0)},
                {"float", Imf::FLOAT, ChannelView(plane_, 2)}};
    o.compression = compression;
    return o;
  }

  /// Gives the views of the rows [y, y + rows) to `writer`.
  static std::size_t write_rows(ExrWriter& writer, const ExrOutput& o, int y, int rows) {
    std::vector<ChannelView> views;
    for (const ExrPlane& plane : o.planes) views.push_back(rows_of(plane.pixels, y, rows));
    return writer.write(views);
  }

  /// Writes `rows` at a time. Returns how many values were clamped.
  std::size_t write(const ExrOutput& wanted, int rows) {
    ExrOutput without_pixels = wanted;
    for (ExrPlane& plane : without_pixels.planes) plane.pixels = {};
    SafeFile file(dir_ / "rows.exr", {.overwrite = true});
    ExrWriter writer(file, {without_pixels});
    std::size_t clamped = 0;
    for (int y = 0; y < plane_.height; y += rows) clamped += write_rows(writer, wanted, y, rows);
    writer.finish();
    file.commit();
    return clamped;
  }

  std::string bytes(const ExrOutput& o, int rows) {
    write(o, rows);
    return read_file(dir_ / "rows.exr");
  }

  std::string bytes_at_once(const ExrOutput& o) {
    SafeFile file(dir_ / "whole.exr", {.overwrite = true});
    write_exr(file, {o});
    file.commit();
    return read_file(dir_ / "whole.exr");
  }

  TempDir dir_;
  std::optional<ExrReader> input_;
  Plane<glm::vec3> plane_;
};

TEST_F(Rows, HowManyComeAtATimeDoesNotChangeTheFile) {
  for (const Imf::Compression compression : kCompressions) {
    for (const bool changed : {false, true}) {
      ExrOutput o = output(compression);
      o.crop = o.keep_channels = changed;
      const std::string whole = bytes_at_once(o);
      ASSERT_FALSE(whole.empty());
      for (const int rows : {256, 512, 100})
        EXPECT_TRUE(bytes(o, rows) == whole) << compression << ", " << changed << ", " << rows;
    }
  }
}

/// The pixels of `plane` that a file shows, from the window `known` of the plane.
std::vector<float> cut(const ChannelView& plane, const Window& known, const Window& shown) {
  std::vector<float> pixels;
  for (int y = shown.y0; y < shown.y1; ++y)
    for (int x = shown.x0; x < shown.x1; ++x)
      pixels.push_back(*plane.at(x - known.x0, y - known.y0));
  return pixels;
}

/// Writes the file again with OpenEXR, from those pixels of the planes that its window shows.
void write_with_openexr(const fs::path& path, const ExrReader& like, const ExrOutput& o) {
  const ExrPart& part = like.parts()[0];
  const Window known = o.input->parts()[std::size_t(o.part)].data_window;
  const std::vector<float> floats = cut(o.planes[1].pixels, known, part.data_window);
  std::vector<half> halves;
  std::ranges::copy(cut(o.planes[0].pixels, known, part.data_window), std::back_inserter(halves));
  Imf::FrameBuffer slices;
  const Box2i window = part.header.dataWindow();
  slices.insert("half", Imf::Slice::Make(Imf::HALF, halves.data(), window));
  slices.insert("float", Imf::Slice::Make(Imf::FLOAT, floats.data(), window));
  Imf::MultiPartOutputFile file(path.c_str(), &part.header, 1);
  Imf::OutputPart out(file, 0);
  out.setFrameBuffer(slices);
  out.writePixels(part.data_window.height());
}

TEST_F(Rows, HoldThePixelsThatOpenExrWrites) {
  const Window display{-20, -63, 26, 302};
  for (const Imf::Compression compression : kCompressions) {
    for (const bool crop : {false, true}) {
      SCOPED_TRACE(testing::Message() << compression << (crop ? " cropped" : ""));
      ExrOutput o = output(compression);
      o.crop = crop;
      const std::string found = bytes(o, 256);
      const ExrReader ours(dir_ / "rows.exr");
      EXPECT_EQ(ours.parts()[0].data_window, crop ? display : input_->parts()[1].data_window);
      write_with_openexr(dir_ / "theirs.exr", ours, o);
      const ExrReader theirs(dir_ / "theirs.exr");
      for (const std::string name : {"half", "float"})
        EXPECT_TRUE(ours.read(0, {&name, 1})[0].pixels == theirs.read(0, {&name, 1})[0].pixels)
            << name;
      const bool zip = compression == Imf::ZIP_COMPRESSION || compression == Imf::ZIPS_COMPRESSION;
      EXPECT_TRUE(zip || found == read_file(dir_ / "theirs.exr"));
    }
  }
}

TEST_F(Rows, StandAmongTheOtherParts) {
  ExrOutput o = output();
  o.keep_channels = true;
  write(o, 256);
  const ExrReader written(dir_ / "rows.exr");
  const std::vector<std::string> names = {"Z", "id"};
  for (const int part : {0, 1, 2}) {
    const auto before = input_->read_stored(part, names), after = written.read_stored(part, names);
    for (const int i : {0, 1}) EXPECT_TRUE(before[i].pixels == after[i].pixels) << part << names[i];
  }
}

TEST_F(Rows, CountWhatIsClampedAndWritten) {
  for (const int row : {0, 150, 255, 256, 600}) plane_(40, row).x = 1e6f, plane_(40, row).z = 1e6f;
  EXPECT_EQ(write(output(), 256), 5u);
  EXPECT_EQ(write(output(), 100), 5u);
  ExrOutput cropped = output();
  cropped.crop = true;
  EXPECT_EQ(write(cropped, 100), 3u);
}

TEST_F(Rows, OfOtherSizesAreADefect) {
  const ExrOutput o = output();
  const auto expect_defect = [&](const std::vector<ChannelView>& planes, const std::string& text) {
    SafeFile file(dir_ / "rows.exr", {});
    ExrWriter writer(file, {o});
    write_rows(writer, o, 0, 512);
    EXPECT_THAT(error_of([&] { writer.write(planes); }), IsError(ExitCode::failed, text));
  };
  const ChannelView a = rows_of(o.planes[0].pixels, 512, 89), b = rows_of(a, 0, 88);
  ChannelView narrow = a;
  narrow.width = 66;
  expect_defect({a}, "in.exr: 1 planes came for the 2 of the output");
  expect_defect({}, "0 planes");
  expect_defect({a, a, a}, "3 planes");
  expect_defect({a, narrow}, "plane 'float' is 66x89, the output of part 1 is 67x89 from row 312");
  expect_defect({a, b}, "plane 'float' is 67x88");
  const ChannelView more = rows_of(o.planes[0].pixels, 0, 90);
  expect_defect({more, more}, "plane 'half' is 67x90");
}

TEST_F(Rows, ThatAreMissingAreADefect) {
  const ExrOutput o = output();
  for (const int rows : {1, 256, 600}) {
    SafeFile file(dir_ / "rows.exr", {});
    ExrWriter writer(file, {o});
    write_rows(writer, o, 0, rows);
    EXPECT_THAT(error_of([&] { writer.finish(); }),
                IsError(ExitCode::failed, std::to_string(601 - rows) + " rows"));
  }
}

TEST_F(Rows, ThatEndEarlyLeaveNoFile) {
  {
    SafeFile file(dir_ / "rows.exr", {});
    ExrWriter writer(file, {output()});
    write_rows(writer, output(), 0, 300);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_.path()), {}), 1) << "only in.exr stays";
}

/// Files of this process end after so many bytes, until the end of the scope.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, on_signal_);
  }

 private:
  void (*on_signal_)(int) = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before_;
};

TEST_F(Rows, MeetAFullDiskWhereverItStrikes) {
  for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION}) {
    const ExrOutput o = output(compression);
    const rlim_t size = bytes_at_once(o).size();
    fs::remove(dir_ / "whole.exr");
    // In the header, in the rows, and in the very last byte.
    for (const rlim_t limit : {rlim_t(0), rlim_t(100), size / 3, size * 2 / 3, size - 1}) {
      const FullDisk full(limit);
      EXPECT_THAT(error_of([&] { write(o, 256); }),
                  IsError(ExitCode::output, "rows.exr: cannot be written: File too large"))
          << compression << ", limit of " << limit << " of " << size << " bytes";
      EXPECT_EQ(std::distance(fs::directory_iterator(dir_.path()), {}), 1) << "only in.exr stays";
    }
  }
}

}  // namespace
}  // namespace ssdo::test::exr_rows_test
