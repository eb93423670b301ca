// SPDX-License-Identifier: Apache-2.0
#include "support/layer_file.h"

#include <ImfStandardAttributes.h>

#include "io/exr/exr_reader.h"

namespace ssdo::test {

LayerFile::LayerFile(const std::vector<LayerPart>& parts) {
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

LayerTable LayerFile::find(const std::vector<std::string>& aov, const std::string& part) const {
  const ExrReader reader(path());
  std::vector<LayerRequest> requests;
  for (const std::string& text : aov) requests.push_back(parse_layer_request(text));
  return find_layers({&reader}, requests, part);
}

Channels channels_of(const LayerTable& table, Role role) {
  return table[role] ? table[role]->channels : Channels{};
}

std::string name_of(const LayerTable& table, Role role) {
  return table[role] ? table[role]->name : "none";
}

int part_of(const LayerTable& table, Role role) { return table[role] ? table[role]->part : -1; }

}  // namespace ssdo::test
