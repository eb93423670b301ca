// SPDX-License-Identifier: Apache-2.0
//
// Paths that are no plain files, where a file is wanted.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::odd_files_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class OddFiles : public testing::Test {
 protected:
  OddFiles() {
    write_frame(path("in.exr"), frame_of(small_picture()));
    fs::create_directory(path("folder.exr"));
    mkfifo(path("pipe.exr").c_str(), 0600);
  }
  std::string path(const std::string& name) const { return dir_ / name; }
  void expect_refused(const std::vector<std::string>& arguments, int code,
                      const std::string& says) const {
    const Finished done = run_tool(arguments);
    EXPECT_EQ(done.code, code) << testing::PrintToString(arguments);
    EXPECT_THAT(done.error_line(), HasSubstr(says)) << testing::PrintToString(arguments);
  }
  TempDir dir_;
};

TEST_F(OddFiles, AreNoInputs) {
  const std::string out = path("out.exr");
  expect_refused({path("pipe.exr"), "-o", out}, 3, "pipe.exr: is a device, pipe or socket");
  expect_refused({path("folder.exr"), "-o", out}, 3, "is a folder");
  expect_refused({"/dev/null", "-o", out}, 3, "is a device");
  fs::create_symlink("gone.exr", path("dangling.exr"));
  expect_refused({path("dangling.exr"), "-o", out}, 3, "dangling.exr: does not exist");
  fs::create_symlink("loop.exr", path("loop.exr"));
  expect_refused({path("loop.exr"), "-o", out}, 3, "loop.exr: cannot be opened");
  expect_refused({path("in.exr/in.exr"), "-o", out}, 3, "in.exr/in.exr: ");
  expect_refused({path("in.exr"), "-o", out, "--env", path("folder.exr")}, 3, "is a folder");
  expect_refused({path("in.exr"), "-o", out, "--env", data("demo.sh")}, 3, "demo.sh: ");
  expect_refused({path("in.exr"), "-o", path("out.png"), "--ocio", path("folder.exr")}, 3,
                 "is a folder");
  expect_refused({path("in.exr"), "-o", path("out.png"), "--ocio", path("in.exr")}, 3,
                 "not a config");
  expect_refused({path("in.exr"), "-o", out, "--config", path("gone.toml")}, 2, "gone.toml");
  EXPECT_FALSE(fs::exists(out) || fs::exists(path("out.png")));
}

TEST_F(OddFiles, AreNoOutputs) {
  const std::string in = path("in.exr");
  expect_refused({in, "-o", path("pipe.exr"), "--overwrite"}, 5, "is a device, pipe or socket");
  expect_refused({in, "-o", path("folder.exr"), "--overwrite"}, 5, "is a folder");
  expect_refused({in, "-o", path("in.exr/out.exr"), "--create-dirs"}, 5, "is a file, not a folder");
  expect_refused({in, "-o", ""}, 2, "--output: its value is empty");
  expect_refused({in, "-o", path("out")}, 2, "unknown kind of output");
  expect_refused({in, "-o", "/dev/stdout"}, 2, "unknown kind of output");
  expect_refused({in, "-o", path("out.exr"), "--stats", path("gone/stats.json")}, 5,
                 "gone/stats.json");
  expect_refused({in, "-o", path("out.exr"), "--stats", path("folder.exr")}, 5, "is a folder");
  EXPECT_THAT(listing(dir_.path()), testing::ElementsAre("folder.exr", "in.exr", "pipe.exr"));
}

TEST_F(OddFiles, TheSameFileUnderTwoNamesIsOneOutput) {
  const std::string in = path("in.exr");
  fs::create_symlink(dir_.path(), path("here"));
  for (const std::string& other :
       {path("./out.exr"), path("folder.exr/../out.exr"), path("here/out.exr")}) {
    expect_refused({in, "-o", path("out.exr"), "-o", other}, 2, "named twice");
    expect_refused({in, "--save", "ao=" + path("out.exr"), "--save", "direct=" + other}, 2,
                   "named twice");
  }
}

TEST_F(OddFiles, ALinkIsWrittenThrough) {
  fs::create_directory(path("store"));
  std::ofstream(path("store/real.exr")) << "old";
  fs::create_symlink("store/real.exr", path("link.exr"));
  expect_refused({path("in.exr"), "-o", path("link.exr")}, 5, "exists");
  EXPECT_EQ(run_tool({path("in.exr"), "-o", path("link.exr"), "--overwrite"}).code, 0);
  EXPECT_TRUE(fs::is_symlink(path("link.exr")));
  EXPECT_EQ(channel_names(path("store/real.exr")).size(), 11u);
  EXPECT_THAT(listing(path("store")), testing::ElementsAre("real.exr"));
}

/// Issue 13: the run failed with a library's exception after its EXR was there.
TEST_F(OddFiles, NamesThatAreNotUtf8AreNames) {
  const std::string odd = path("d\xE9j\xE0.exr"), out = path("vu_\xFF.exr");
  FramePart part = frame_of(small_picture());
  part.channels["caf\xE9.Y"] = part.channels["ViewLayer.Depth.Z"];
  part.name = "r\xE9sum\xE9";
  write_frame(odd, part);
  const auto text_of = [](const json& value) {
    return fs::path(value.get<std::string>()).filename();
  };

  EXPECT_EQ(run_tool({odd, "-o", out, "--stats", path("s.json")}).code, 0);
  EXPECT_TRUE(fs::exists(out));
  const json frame = parse_json(read_file(path("s.json"))).at(0);
  EXPECT_EQ(text_of(frame["input"]), "d\\xe9j\\xe0.exr");
  EXPECT_EQ(text_of(frame["output"]), "vu_\\xff.exr");

  const Finished told = run_tool({"info", odd, "--json"});
  ASSERT_EQ(told.code, 0) << told.err;
  const json info = parse_json(told.out);
  EXPECT_EQ(text_of(info["file"]), "d\\xe9j\\xe0.exr");
  EXPECT_EQ(info["parts"][0]["name"], "r\\xe9sum\\xe9");
  EXPECT_EQ(info["parts"][0]["channels"].back()["name"], "caf\\xe9.Y");

  const Finished compared = run_tool({"compare", odd, odd, "--json"});
  ASSERT_EQ(compared.code, 0) << compared.err;
  EXPECT_EQ(text_of(parse_json(compared.out)["a"]), "d\\xe9j\\xe0.exr");

  const Finished bench =
      run_tool({"bench", odd, "--methods", "ssao", "--products", "ao", "-q", "--report",
                path("r.json"), "--report", path("r.html"), "--report", path("r.csv")});
  ASSERT_EQ(bench.code, 0) << bench.err;
  EXPECT_EQ(text_of(parse_json(read_file(path("r.json")))["input"]), "d\\xe9j\\xe0.exr");
}

TEST_F(OddFiles, NamesWithSpacesAndSignsAreNames) {
  const std::string odd = path("a b (1) é 'q' $x;.exr");
  fs::copy_file(path("in.exr"), odd);
  EXPECT_EQ(run_tool({odd, "-o", path("out -o.exr")}).code, 0);
  EXPECT_TRUE(fs::exists(path("out -o.exr")));
  // A sign that would be a pattern is none in a name that exists.
  fs::create_directory(path("ann@studio 50%"));
  fs::copy_file(path("in.exr"), path("ann@studio 50%/a#b.exr"));
  EXPECT_EQ(run_tool({path("ann@studio 50%/a#b.exr"), "-o", path("ann@studio 50%/out.exr")}).code,
            0);
  EXPECT_TRUE(fs::exists(path("ann@studio 50%/out.exr")));
}

}  // namespace
}  // namespace ssdo::test::odd_files_test
