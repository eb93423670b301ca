// SPDX-License-Identifier: Apache-2.0
#include "support/bench_frame.h"

namespace ssdo::test {

BenchFrame::BenchFrame() : frame(folder / "it's <!--<script>.exr"), truth(folder / "truth.exr") {
  const Window window{0, 0, 32, 24};
  FramePart layers = frame_of(small_picture(window, window));
  for (int i = 0; i < 32 * kSky; ++i) {
    for (const char* name :
         {"Position.X", "Position.Y", "Position.Z", "Normal.X", "Normal.Y", "Normal.Z"})
      layers.channels[std::string("ViewLayer.") + name][std::size_t(i)] = 0;
    layers.channels["ViewLayer.Depth.Z"][std::size_t(i)] = 1e10f;
  }
  write_frame(frame, layers);
  FramePart part{"", window, window, {}, Imf::FLOAT, {}};
  Plane<float> ao(32, 24);
  Plane<glm::vec3> direct(32, 24), bounce(32, 24);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      ao(x, y) = 0.5f + float(x) / 64;
      direct(x, y) = {float(x) / 32, 0.5f, float(y) / 24};
      bounce(x, y) = glm::vec3(0.1f, 0.2f, float(x) / 64);
    }
  }
  part.channels["AO.Y"] = ao;
  part.add("View.DiffDir", direct, "RGB");
  part.add("strange", bounce, "RGB");
  write_frame(truth, part);
}

std::vector<std::string> BenchFrame::arguments(const std::vector<std::string>& more) const {
  std::vector<std::string> all = {
      "bench", frame, "--methods", "bitmask,trace,ssao", "--env", data("environments/sky.exr"),
      "-q"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace ssdo::test
