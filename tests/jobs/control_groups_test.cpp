// SPDX-License-Identifier: Apache-2.0
//
// What control groups say, in made-up /proc and /sys.
#include "jobs/machine/control_groups.h"

#include <gmock/gmock.h>

#include "support/fake_root.h"

namespace ssdo::test::control_groups_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ControlGroups, OfVersion2SpeakFromTheInsideOut) {
  const FakeRoot root{{"proc/self/cgroup", "0::/job/step\n"},
                      {"sys/fs/cgroup/job/step/memory.max", "1\n"},
                      {"sys/fs/cgroup/job/memory.max", "max\n2\n"},
                      {"sys/fs/cgroup/memory.max", "3\n"},
                      {"sys/fs/cgroup/job/other/memory.max", "4\n"},
                      {"sys/fs/cgroup/memory/job/step/memory.max", "5\n"}};
  EXPECT_THAT(lines_of_control_groups("", "memory.max", root.path()), ElementsAre("1", "max", "3"));
  EXPECT_THAT(lines_of_control_groups("", "cpu.max", root.path()), IsEmpty());
}

TEST(ControlGroups, OfVersion1AreThoseOfTheController) {
  const FakeRoot root{{"proc/self/cgroup",
                       "12:cpuset:/other\n7:name=memory:/other\n4:cpu,memory,pids:/job:1\n0::/a\n"},
                      {"sys/fs/cgroup/memory/job:1/limit", "1\n"},
                      {"sys/fs/cgroup/memory/limit", "2\n"},
                      {"sys/fs/cgroup/memory/other/limit", "3\n"},
                      {"sys/fs/cgroup/a/limit", "4\n"},
                      {"sys/fs/cgroup/limit", "5\n"}};
  EXPECT_THAT(lines_of_control_groups("memory", "limit", root.path()), ElementsAre("1", "2"));
  EXPECT_THAT(lines_of_control_groups("", "limit", root.path()), ElementsAre("4", "5"));
}

/// In a container, whose own group is the topmost one that it sees.
TEST(ControlGroups, ThatAreOutOfSightAreLeftOut) {
  for (const char* group : {"/docker/0123", "/../../job", "/..", "/", "/job/"}) {
    const FakeRoot root{{"proc/self/cgroup", std::string("0::") + group + "\n"},
                        {"sys/fs/cgroup/memory.max", "7\n"},
                        {"sys/fs/memory.max", "8\n"},
                        {"memory.max", "9\n"}};
    EXPECT_THAT(lines_of_control_groups("", "memory.max", root.path()), ElementsAre("7")) << group;
  }
}

TEST(ControlGroups, AreTheTopmostOnesWhereNoneIsNamed) {
  for (const char* text : {"", "nonsense\n", "0:\n", "1:cpu:/job\n"}) {
    const FakeRoot root{{"proc/self/cgroup", text},
                        {"sys/fs/cgroup/job/memory.max", "6\n"},
                        {"sys/fs/cgroup/memory.max", "7\n"}};
    EXPECT_THAT(lines_of_control_groups("", "memory.max", root.path()), ElementsAre("7")) << text;
  }
  EXPECT_THAT(lines_of_control_groups("", "memory.max", FakeRoot{}.path()), IsEmpty());
}

}  // namespace
}  // namespace ssdo::test::control_groups_test
