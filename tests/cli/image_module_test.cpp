// SPDX-License-Identifier: Apache-2.0
//
// What needs the module for image files, and what does without.
#include <gmock/gmock.h>

#include <filesystem>

#include "support/run_tool.h"

namespace ssdo::test::image_module_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

/// The tool in a folder of its own.
class ImageModule : public testing::Test {
 protected:
  ImageModule() : tool_(folder_ / "bin" / "ssdo") {
    fs::create_directory(tool_.parent_path());
    fs::copy_file(tool_path(), tool_);
  }

  fs::path module_of_build() const { return tool_path().parent_path() / "ssdo_images.so"; }
  Finished run(const std::vector<std::string>& arguments) const {
    return run_tool(arguments, {.binary = tool_});
  }
  Finished relight_to(const std::string& name) const {
    return run({data("room_corner.exr"), "-o", folder_ / name, "--quality", "draft"});
  }

  TempDir folder_;
  fs::path tool_;
};

TEST_F(ImageModule, IsNotNeededFromExrToExr) {
  EXPECT_EQ(run({"--version"}).code, 0);
  EXPECT_EQ(run({"info", data("room_corner.exr")}).code, 0);
  const Finished relit = relight_to("a.exr");
  EXPECT_EQ(relit.code, 0) << relit.err;
  // As ldd does it.
  const Finished libraries =
      run_tool({}, {.variables = {{"LD_TRACE_LOADED_OBJECTS", "1"}}, .binary = tool_});
  EXPECT_THAT(libraries.out, HasSubstr("libOpenEXR"));
  EXPECT_THAT(libraries.out, Not(HasSubstr("libOpenImageIO.so")));
}

TEST_F(ImageModule, IsMissedBeforeWorkIsDone) {
  const Finished relit = relight_to("a.png");
  EXPECT_EQ(relit.code, 1);
  EXPECT_THAT(relit.error_line(), HasSubstr("ssdo_images.so: is missing"));
  EXPECT_THAT(relit.error_line(), HasSubstr("install ssdo again"));
  EXPECT_EQ(listing(folder_.path()), std::vector<std::string>{"bin"});
  const Finished dry = run({data("room_corner.exr"), "-o", folder_ / "a.png", "--dry-run"});
  EXPECT_EQ(dry.code, 1) << dry.err;
}

TEST_F(ImageModule, IsFoundBesideTheToolAndWhereItIsInstalled) {
  const fs::path beside = tool_.parent_path() / "ssdo_images.so";
  fs::copy_file(module_of_build(), beside);
  EXPECT_EQ(relight_to("a.png").code, 0);
  fs::remove(beside);
  const fs::path installed = folder_ / "bin" / SSDO_MODULE_FOLDER / "ssdo_images.so";
  fs::create_directories(installed.lexically_normal().parent_path());
  fs::copy_file(module_of_build(), installed.lexically_normal());
  EXPECT_EQ(relight_to("b.png").code, 0);
}

TEST_F(ImageModule, ThatIsNoneIsNamed) {
  fs::copy_file(data("room_corner.exr"), tool_.parent_path() / "ssdo_images.so");
  const Finished relit = relight_to("a.png");
  EXPECT_EQ(relit.code, 1);
  EXPECT_THAT(relit.error_line(), HasSubstr("ssdo_images.so: cannot be loaded"));
}

}  // namespace
}  // namespace ssdo::test::image_module_test
