// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfStandardAttributes.h>

#include <string>
#include <vector>

#include "scene/layers/layers.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test {

using Channels = std::vector<std::string>;

/// A part of a file that is there for the names of its layers.
struct LayerPart {
  std::string name;
  Channels channels;
  std::string view = {};     ///< the attribute `view`; empty: none
  Channels multi_view = {};  ///< the attribute `multiView`; empty: none
};

/// An EXR of 2 x 2 pixels: one part, or several with names.
class LayerFile {
 public:
  explicit LayerFile(const Channels& names) : LayerFile(std::vector<LayerPart>{{"", names}}) {}
  explicit LayerFile(const std::vector<LayerPart>& parts) {
    std::vector<Imf::Header> headers;
    for (const LayerPart& part : parts) {
      std::vector<TestChannel> channels;
      for (const std::string& name : part.channels) channels.push_back({name});
      Imf::Header header = test_header({{0, 0}, {1, 1}}, channels);
      if (!part.name.empty()) header.setName(part.name);
      if (!part.view.empty()) header.setView(part.view);
      if (!part.multi_view.empty()) Imf::addMultiView(header, part.multi_view);
      headers.push_back(header);
    }
    write_test_exr(path(), headers);
  }

  LayerTable find(const std::vector<std::string>& aov = {}, const std::string& part = "") const {
    const ExrReader reader(path());
    std::vector<LayerRequest> requests;
    for (const std::string& text : aov) requests.push_back(parse_layer_request(text));
    return find_layers({&reader}, requests, part);
  }
  std::filesystem::path path() const { return dir_ / "frame.exr"; }

 private:
  TempDir dir_;
};

inline Channels channels_of(const LayerTable& table, Role role) {
  return table[role] ? table[role]->channels : Channels{};
}

inline std::string name_of(const LayerTable& table, Role role) {
  return table[role] ? table[role]->name : "none";
}

inline int part_of(const LayerTable& table, Role role) {
  return table[role] ? table[role]->part : -1;
}

}  // namespace ssdo::test
