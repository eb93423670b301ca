// SPDX-License-Identifier: Apache-2.0
#include "relight/frame.h"
#include "parallel/planes.h"

#include <utility>

namespace ssdo {

const Layer& Frame::lead() const {
  return layers[Role::position] ? *layers[Role::position] : *layers[Role::depth];
}

const ExrPart& Frame::part() const {
  return files[std::size_t(lead().file)].parts()[std::size_t(lead().part)];
}

std::vector<const ExrReader*> Frame::readers() const {
  std::vector<const ExrReader*> all;
  for (const ExrReader& file : files) all.push_back(&file);
  return all;
}

std::vector<std::string> Frame::warnings() const {
  std::vector<std::string> all = gbuffer.warnings;
  all.insert(all.end(), report.warnings.begin(), report.warnings.end());
  return all;
}

void Frame::warn(const std::vector<std::string>& lines) {
  report.warnings.insert(report.warnings.end(), lines.begin(), lines.end());
}

std::vector<std::string> Frame::losses() const {
  std::vector<std::string> all;
  for (const ExrReader& file : files)
    for (const std::string& line : file.losses()) all.push_back(line);
  all.insert(all.end(), losses_of_views.begin(), losses_of_views.end());
  return all;
}

Scene take_scene(GBuffer& gbuffer, Geometry geometry) {
  Scene scene;
  scene.geometry = std::move(geometry);
  scene.senders = {in_half(gbuffer.albedo), std::move(gbuffer.radiance)};
  gbuffer.albedo = {};  // on its own line: an assignment of a plane keeps memory
  scene.roughness = std::move(gbuffer.roughness);
  if (!gbuffer.specular_color.empty()) scene.specular_color = in_half(gbuffer.specular_color);
  gbuffer.specular_color = {};
  return scene;
}

ColorTags color_tags(const Frame& frame) {
  const Imf::Header& header = frame.part().header;
  ColorTags tags;
  tags.path = frame.input;
  tags.interop_id = string_attribute(header, "colorInteropID");
  tags.aces_container = int_attribute(header, "acesImageContainerFlag") == 1;
  tags.chromaticities = chromaticities_of(header);
  return tags;
}

}  // namespace ssdo
