// SPDX-License-Identifier: Apache-2.0
#include "scene/deep/channels.h"

#include <gtest/gtest.h>

#include "support/error_matchers.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::channels_test {
namespace {

struct Part {
  std::string name;
  std::vector<std::string> channels;
  bool deep = true;
  std::string view = {};
};

class DeepChannelNames : public testing::Test {
 protected:
  void write(const std::vector<Part>& parts) const {
    std::vector<Imf::Header> headers;
    for (const Part& part : parts) {
      std::vector<TestChannel> channels;
      for (const std::string& name : part.channels) channels.push_back({name});
      headers.push_back(
          named(test_header({{0, 0}, {3, 3}}, channels, Imf::ZIPS_COMPRESSION), part.name));
      if (part.deep) headers.back().setType(Imf::DEEPSCANLINE);
      if (!part.view.empty()) headers.back().setView(part.view);
    }
    write_test_exr(dir_ / "a.exr", headers);
  }

  /// "part:Z part:ZBack part:A", a dash for what there is none of.
  std::string found(const std::string& wanted = "") const {
    const auto channels = find_deep_channels(ExrReader(dir_ / "a.exr"), wanted);
    if (!channels) return "none";
    std::string text;
    for (const DeepChannel& c : {channels->front, channels->back, channels->alpha})
      text += c.name.empty() ? " -" : " " + std::to_string(c.part) + ":" + c.name;
    return text.substr(1);
  }

  TempDir dir_;
};

TEST_F(DeepChannelNames, MayHaveALayer) {
  write({{"a", {"A", "B", "G", "R", "Z", "ZBack"}}});
  EXPECT_EQ(found(), "0:Z 0:ZBack 0:A");
  write({{"a", {"A", "depth.Z", "depth.ZBack"}}});
  EXPECT_EQ(found(), "0:depth.Z 0:depth.ZBack 0:A");
  write({{"a", {"A", "deep.A", "deep.Z", "P.X", "P.Y", "P.Z"}}});
  EXPECT_EQ(found(), "0:deep.Z - 0:deep.A") << "the third coordinate is no depth";
  write({{"a", {"Z"}}});
  EXPECT_EQ(found(), "0:Z - -");
}

TEST_F(DeepChannelNames, MayStandInPartsOfTheirOwn) {
  write({{"flat", {"R", "Z"}, false}, {"depth", {"Z", "ZBack"}}, {"color", {"A", "R"}}});
  EXPECT_EQ(found(), "1:Z 1:ZBack 2:A");
  write({{"l", {"A", "Z"}, true, "left"}, {"r", {"A", "Z"}, true, "right"}});
  EXPECT_EQ(found("right"), "1:Z - 1:A");
  EXPECT_EQ(found("l"), "0:Z - 0:A");
  EXPECT_EQ(found("1"), "1:Z - 1:A");
  EXPECT_EQ(found("middle"), "none");
  write({{"flat", {"R", "Z"}, false}});
  EXPECT_EQ(found(), "none");
}

TEST_F(DeepChannelNames, AreRefusedWhereTheyDoNotTell) {
  write({{"a", {"A", "R"}}});
  EXPECT_THAT(error_of([&] { found(); }), IsError(ExitCode::layer, "its deep samples have no Z"));
  write({{"a", {"x.Z", "y.Z"}}});
  EXPECT_THAT(error_of([&] { found(); }),
              IsError(ExitCode::layer, "2 deep channels could be the depth: 'x.Z' in part 0 'a'"));
}

}  // namespace
}  // namespace ssdo::test::channels_test
