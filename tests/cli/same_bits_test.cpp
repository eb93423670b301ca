// SPDX-License-Identifier: Apache-2.0
//
// Whole files, EXR and PNG, have the same bytes from run to run, from any number of threads, and
// whatever the order of options that name files and layers. See also tests/hash/same_bits_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>

#include "estimators/registry.h"
#include "support/boxes.h"
#include "support/frame_file.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::same_bits_test {
namespace {

const Window kFrame{0, 0, 64, 48};

/// A box without its front faces.
Surface back_of(const Box& box) {
  return [box](const Ray& ray) -> std::optional<Hit> {
    const auto [enter, leave] = box.cross(ray);
    if (enter > leave || leave < 1e-9) return std::nullopt;
    // Its normals are left to P.
    return Hit{leave, -ray.direction};
  };
}

class SameFiles : public testing::Test {
 protected:
  SameFiles() {
    write("in.exr", scene(), eye());
    write("beside.exr", scene(), look_from({3, -2, 1.5}));
    write("back.exr", back_of(kBox), eye());
    write_deep(path("deep.exr"),
               {{.pixels = merged({plane({}, {0, 0, 1}), kBox.surface()}, eye(), kFrame)}});
  }

  inline static const Box kBox{{-0.4, -0.6, 0}, {0.5, 0.1, 0.6}};
  static Surface scene() { return all_of({plane({}, {0, 0, 1}), kBox.surface()}); }
  static Camera look_from(const glm::dvec3& place) {
    return look_at(camera_from_fov(40, kFrame, 1), place, {0, 0, 0.3}, {0, 0, 1});
  }
  static Camera eye() { return look_from({0, -4, 3}); }

  std::string path(const std::string& name) const { return dir_ / name; }
  void write(const std::string& name, const Surface& shown, const Camera& camera) const {
    write_frame(path(name), frame_of(take_picture(shown, camera, kFrame)));
  }

  /// The bytes of out.exr and out.png after a run with these words.
  std::string files(Words words) const {
    words.insert(words.begin(), {path("in.exr"), "--overwrite", "--env", "1,0.5,2"});
    const Finished done = run_tool(words);
    EXPECT_EQ(done.code, 0) << done.err;
    return read_file(path("out.exr")) + read_file(path("out.png"));
  }
  Words outputs() const { return {"-o", path("out.exr"), "-o", path("out.png")}; }

  TempDir dir_;
};

TEST_F(SameFiles, FromRunToRunAndForAnyThreads) {
  const Words all = outputs() + Words{"--products", "all"};
  for (const Method& method : methods()) {
    SCOPED_TRACE(method.name);
    const bool is_default = &method == &methods().front();
    const Words by = all + Words{"--method", std::string(method.name)};
    const std::string once = files(by + Words{"--threads", "1"});
    for (const char* threads : is_default ? std::vector{"2", "7", "16"} : std::vector{"7"})
      EXPECT_TRUE(files(by + Words{"--threads", threads}) == once) << threads << " threads";
    for (int run = 0; run < (is_default ? 3 : 1); ++run)
      EXPECT_TRUE(files(by) == once) << "run " << run;
  }
}

TEST_F(SameFiles, ForAnyThreadsUnderLamps) {
  for (const char* method : {"bitmask", "trace"}) {
    const Words by =
        outputs() + Words{"--method",   method,
                          "--products", "all",
                          "--light",    "sphere position=1,-1,1 radius=0.2",
                          "--light",    "disk position=0,-9,4 direction=0,1,-0.4 radius=1"};
    const std::string once = files(by + Words{"--threads", "1"});
    EXPECT_TRUE(files(by + Words{"--threads", "7"}) == once) << method;
  }
}

TEST_F(SameFiles, ForOtherViewsInAnyOrder) {
  for (const char* method : {"bitmask", "trace"}) {
    Words views = {"back.exr", "beside.exr", "deep.exr"};
    std::string first;
    do {
      Words also;
      for (const std::string& view : views) also = also + Words{"--also", path(view)};
      const std::string found =
          files(outputs() + Words{"--products", "all", "--method", method} + also);
      if (first.empty()) first = found;
      EXPECT_TRUE(found == first) << method << ": " << views[0] << ", " << views[1];
    } while (std::next_permutation(views.begin(), views.end()));
  }
}

TEST_F(SameFiles, ForOutputsAndLayersInAnyOrder) {
  const Words position = {"--aov", "position=ViewLayer.Position"},
              normal = {"--aov", "normal=ViewLayer.Normal"},
              albedo = {"--aov", "albedo=ViewLayer.DiffCol"};
  const std::string once = files(outputs() + position + normal + albedo);
  EXPECT_TRUE(files(outputs() + albedo + normal + position) == once);
  EXPECT_TRUE(files(Words{"-o", path("out.png"), "-o", path("out.exr")} + normal + position +
                    albedo) == once);
}

}  // namespace
}  // namespace ssdo::test::same_bits_test
