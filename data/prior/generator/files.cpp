// SPDX-License-Identifier: Apache-2.0
#include "files.h"

#include <OpenImageIO/imageio.h>

#include <cstdio>
#include <memory>
#include <stdexcept>

Vec file_axes(Vec v, const FrameHeader& header) {
  return header.up_axis == 1 ? Vec{v.x, v.z, -v.y} : v;
}

void write_frame(const std::string& path, const Frame& f, const FrameHeader& header) {
  constexpr int kChannels = 10;
  OIIO::ImageSpec spec(f.width, f.height, kChannels, OIIO::TypeDesc::FLOAT);
  spec.channelnames = {"ViewLayer.Depth.Z",   "ViewLayer.DiffCol.R",  "ViewLayer.DiffCol.G",
                       "ViewLayer.DiffCol.B", "ViewLayer.Normal.X",   "ViewLayer.Normal.Y",
                       "ViewLayer.Normal.Z",  "ViewLayer.Position.X", "ViewLayer.Position.Y",
                       "ViewLayer.Position.Z"};
  spec.attribute("compression", "none");
  std::vector<float> out(f.valid.size() * kChannels, 0.f);
  for (size_t i = 0; i < f.valid.size(); ++i) {
    float* o = &out[i * kChannels];
    o[0] = 1e10f;
    if (!f.valid[i]) continue;
    o[0] = f.depth[i] * header.scale;
    const Vec n = file_axes(f.normal[i], header);
    const Vec p = file_axes(f.position[i], header) * header.scale;
    const float rest[9] = {f.albedo[i].x, f.albedo[i].y, f.albedo[i].z, n.x, n.y,
                           n.z,           p.x,           p.y,           p.z};
    for (int k = 0; k < 9; ++k) o[k + 1] = rest[k];
  }
  const auto file = OIIO::ImageOutput::create(path);
  if (!file || !file->open(path, spec) || !file->write_image(OIIO::TypeDesc::FLOAT, out.data()) ||
      !file->close())
    throw std::runtime_error(path + ": cannot write: " + OIIO::geterror());
}

void write_truth(const std::string& path, const std::vector<Truth>& rows,
                 const FrameHeader& header) {
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "wb"));
  if (!file || std::fwrite(&header, sizeof(header), 1, file.get()) != 1 ||
      std::fwrite(rows.data(), sizeof(Truth), rows.size(), file.get()) != rows.size())
    throw std::runtime_error(path + ": cannot write");
}
