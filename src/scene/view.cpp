// SPDX-License-Identifier: Apache-2.0
#include "scene/view.h"

#include "stopwatch.h"

namespace ssdo {

View read_view(const std::string& input, const std::vector<LayerRequest>& aovs,
               const InputOptions& options, const CameraOptions& camera,
               const std::vector<Role>& unused) {
  View view;
  Stopwatch watch;
  for (const std::string& path : files_of_frame(input, aovs)) view.files.emplace_back(path);
  std::vector<const ExrReader*> files;
  for (const ExrReader& file : view.files) files.push_back(&file);
  view.layers = find_layers(files, aovs, options.part, unused);
  require_position(view.layers, view.files.front(),
                   options.listed ? "" : " ('ssdo info' lists the layers)");
  view.gbuffer = read_gbuffer(files, view.layers, options.gbuffer);
  view.read_ms = watch.lap();

  view.geometry = build_geometry(view.gbuffer, camera, input, view.report);
  // From here on there is one position and one normal: those of the geometry.
  view.gbuffer.position = view.gbuffer.normal = {};
  view.gbuffer.depth = {};
  return view;
}

}  // namespace ssdo
