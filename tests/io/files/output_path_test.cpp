// SPDX-License-Identifier: Apache-2.0
#include "io/files/output_path.h"

#include <gtest/gtest.h>

#include <climits>

#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace ssdo::test::output_path_test {
namespace {

namespace fs = std::filesystem;

TEST(OutputPath, FollowsLinksToAFileThatDoesNotExistYet) {
  const TempDir dir;
  fs::create_directory(dir / "sub");
  fs::create_symlink("sub/b.exr", dir / "a.exr");
  fs::create_symlink("../c.exr", dir / "sub/b.exr");
  EXPECT_EQ(follow_links(dir / "a.exr"), dir / "sub/../c.exr");
  EXPECT_EQ(follow_links(dir / "plain.exr"), dir / "plain.exr");
}

TEST(OutputPath, RefusesALoopOfLinks) {
  const TempDir dir;
  fs::create_symlink("b.exr", dir / "a.exr");
  fs::create_symlink("a.exr", dir / "b.exr");
  EXPECT_THAT(error_of([&] { follow_links(dir / "a.exr"); }),
              IsError(ExitCode::output, (dir / "a.exr").string()));
}

TEST(OutputPath, TemporariesAreHiddenUniqueAndKeepTheExtension) {
  const fs::path target = "folder/beauty.0001.exr", temporary = temporary_beside(target);
  EXPECT_EQ(temporary.parent_path(), "folder");
  EXPECT_EQ(temporary.extension(), ".exr");
  EXPECT_TRUE(temporary.filename().string().starts_with(".beauty.0001."));
  EXPECT_NE(temporary, temporary_beside(target));
}

TEST(OutputPath, TemporariesOfLongNamesAreCutBetweenCharacters) {
  for (const std::string start : {"", "x"}) {
    std::string name = start;
    while (name.size() + 6 <= NAME_MAX) name += "\xC3\xA9";
    const std::string temporary = temporary_beside(name + ".exr").string();
    EXPECT_LE(temporary.size(), std::size_t(NAME_MAX));
    const std::size_t kept = temporary.find(".ssdo-") - 1 - start.size();
    EXPECT_GT(kept, 100u);
    EXPECT_EQ(kept % 2, 0u) << temporary;
  }
}

}  // namespace
}  // namespace ssdo::test::output_path_test
