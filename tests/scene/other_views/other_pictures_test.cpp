// SPDX-License-Identifier: Apache-2.0
#include "scene/other_views/other_pictures.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <future>

#include "error.h"
#include "support/frame_file.h"
#include "support/temp_dir.h"

namespace ssdo::test::other_pictures_test {
namespace {

namespace fs = std::filesystem;
using Picture = OtherPictures::Picture;

class OtherPicturesOf : public testing::Test {
 protected:
  OtherPicturesOf() {
    for (const std::string name : {"a", "b"}) write_frame(path(name), frame_of(small_picture()));
  }
  std::string path(const std::string& name) const { return folder / (name + ".exr"); }
  FrameFiles also(const std::vector<std::string>& names) const {
    FrameFiles files;
    for (const std::string& name : names) files.also.push_back(path(name));
    return files;
  }
  TempDir folder;
  OtherPictures pictures;
};

TEST_F(OtherPicturesOf, ARunAreReadOnce) {
  const Picture first = pictures.also(path("a"));
  ASSERT_TRUE(first);
  fs::remove(path("a"));
  EXPECT_EQ(pictures.also(path("a")), first);
  EXPECT_NE(pictures.also(path("b")), first);
}

TEST_F(OtherPicturesOf, ARunAreKeptUntilNoFrameExpectsThem) {
  const FrameFiles one = also({"a"}), two = also({"a", "b"});
  pictures.expect(one);
  pictures.expect(two);
  std::weak_ptr<const OtherPicture> a = pictures.also(path("a")), b = pictures.also(path("b"));
  pictures.release(one);
  EXPECT_FALSE(a.expired());
  pictures.release(two);
  EXPECT_TRUE(a.expired());
  EXPECT_TRUE(b.expired());
  EXPECT_TRUE(pictures.also(path("a"))) << "read anew";
}

TEST_F(OtherPicturesOf, ARunAreReadOnceByManyThreads) {
  std::vector<std::future<Picture>> asked;
  for (int i = 0; i < 8; ++i)
    asked.push_back(std::async(std::launch::async, [&] { return pictures.also(path("a")); }));
  const Picture one = pictures.also(path("a"));
  for (std::future<Picture>& picture : asked) EXPECT_EQ(picture.get(), one);
}

TEST_F(OtherPicturesOf, DamagedFilesFailEveryTime) {
  fs::resize_file(path("a"), fs::file_size(path("a")) / 2);
  EXPECT_THROW(pictures.also(path("a")), Error);
  fs::copy_file(path("b"), path("a"), fs::copy_options::overwrite_existing);
  EXPECT_THROW(pictures.also(path("a")), Error) << "a run has one picture of a file";
}

}  // namespace
}  // namespace ssdo::test::other_pictures_test
