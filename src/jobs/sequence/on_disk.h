// SPDX-License-Identifier: Apache-2.0
//
// The large arrays of what waits in a shot, and how they go to disk.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

#include "filters/shot/findings.h"
#include "io/files/scratch_file.h"
#include "jobs/work.h"

namespace ssdo {

/// Calls visit(std::vector<T>) for the arrays of what a frame has found, surfaces and motion first.
constexpr std::size_t kArraysOfGeometry = 2;
template <class Visit>
void for_each_array(Findings& findings, const Visit& visit) {
  visit(findings.surfaces.pixels);
  visit(findings.motion.pixels);
  visit(findings.values);
  visit(findings.glow);
}

/// The same for a view that was estimated and waits for the rest of its shot. An array that is not
/// visited stays in memory.
template <class Visit>
void for_each_array(WorkOnView& work, const Visit& visit) {
  const auto visit_plane = [&](auto& plane) { visit(plane.pixels); };
  Products& products = work.relit.found.products;
  for_each_plane([&](const Product&, auto& plane) { visit_plane(plane); }, products);
  for_each_visibility(visit_plane, products);
  for (std::vector<ShadowSample>* samples :
       {&products.visibility.samples, &products.visibility.samples_again})
    for (ShadowSample& sample : *samples) visit_plane(sample.weight), visit_plane(sample.width_px);
  visit_plane(work.relit.products.lit), visit_plane(work.relit.products.lit_without);
  Scene& scene = work.relit.found.scene;
  scene.geometry.surfaces.for_each_plane(visit_plane);
  visit_plane(scene.senders.albedo), visit_plane(scene.senders.radiance);
  visit_plane(scene.roughness), visit_plane(scene.specular_color);
  GBuffer& layers = work.frame.gbuffer;
  for (Plane<glm::vec3>* plane :
       {&layers.position, &layers.normal, &layers.albedo, &layers.radiance, &layers.beauty,
        &layers.ambient, &layers.specular, &layers.specular_color})
    visit_plane(*plane);
  for (auto& [name, plane] : layers.lights) visit_plane(plane);
  for (Plane<float>* plane : {&layers.depth, &layers.alpha, &layers.roughness, &layers.masks.kept,
                              &layers.masks.held_out})
    visit_plane(*plane);
  visit_plane(layers.motion), visit_plane(layers.valid), visit_plane(layers.broken);
}

/// Bytes of the arrays.
template <class Thing>
std::size_t bytes_of(Thing& thing) {
  std::size_t bytes = 0;
  for_each_array(thing, [&](const auto& array) { bytes += array.size() * sizeof(array[0]); });
  return bytes;
}

/// The arrays of something that is without them meanwhile. Errors: those of ScratchFile.
class OnDisk {
 public:
  /// Writes the arrays, and frees them.
  template <class Thing>
  explicit OnDisk(Thing& thing) {
    for_each_array(thing, [this](auto& array) {
      using Value = std::remove_reference_t<decltype(array[0])>;
      static_assert(std::is_standard_layout_v<Value> && std::is_trivially_destructible_v<Value>);
      sizes_.push_back(array.size());
      file_.write(array.data(), array.size() * sizeof(Value));
      std::remove_reference_t<decltype(array)>().swap(array);
    });
  }

  /// Fills the arrays of the same thing, or of its copy: the first `count` of them.
  template <class Thing>
  void read(Thing& thing, std::size_t count = std::numeric_limits<std::size_t>::max()) const {
    std::size_t number = 0, from = 0;
    for_each_array(thing, [&](auto& array) {
      if (number == std::min(count, sizes_.size())) return;
      array.resize(sizes_[number++]);
      const std::size_t bytes = array.size() * sizeof(array[0]);
      file_.read(from, array.data(), bytes);
      from += bytes;
    });
  }

 private:
  ScratchFile file_;
  std::vector<std::size_t> sizes_;
};

}  // namespace ssdo
