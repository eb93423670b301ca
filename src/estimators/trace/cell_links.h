// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>

#include "scene/solids/solids.h"

namespace ssdo {

/// Which fronts at the corners of a cell, a square between the centres of four pixels, are of one
/// surface. For each side k, from corner k to the next, and each node at the start of the side: the
/// joined node at the end of the side, or -1.
struct CellLinks {
  int to[4][kMostLayers];
  bool seen[4][kMostLayers] = {};

  CellLinks() {
    for (auto& side : to) std::fill(std::begin(side), std::end(side), -1);
  }
  int count() const {
    int n = 0;
    for (const auto& side : to)
      n += int(std::count_if(std::begin(side), std::end(side), [](int l) { return l >= 0; }));
    return n;
  }
  /// The node at the start of side k that is joined to node `l` at its end.
  int from(int k, int l) const {
    const auto* found = std::find(std::begin(to[k]), std::end(to[k]), l);
    return found == std::end(to[k]) ? -1 : int(found - std::begin(to[k]));
  }
};

/// Nodes that are joined, one in each corner at most; layers[k] is -1 where there is none.
struct CellGroup {
  int layers[4] = {-1, -1, -1, -1};
  bool joined_to_next[4] = {};
};

/// All nodes that are joined to a node, directly or by others; they become `seen`.
inline CellGroup group_from(CellLinks& links, int corner, int layer) {
  CellGroup group;
  group.layers[corner] = layer;
  links.seen[corner][layer] = true;
  for (int k = corner, l = layer; (l = links.to[k][l]) >= 0;) {
    const int next = (k + 1) % 4;
    if (group.layers[next] >= 0) {
      group.joined_to_next[k] = group.layers[next] == l;
      break;
    }
    if (links.seen[next][l]) break;
    group.joined_to_next[k] = true;
    group.layers[next] = l;
    links.seen[next][l] = true;
    k = next;
  }
  for (int k = corner, l = layer;;) {
    const int before = (k + 3) % 4;
    l = links.from(before, l);
    if (l < 0 || group.layers[before] >= 0 || links.seen[before][l]) break;
    group.joined_to_next[before] = true;
    group.layers[before] = l;
    links.seen[before][l] = true;
    k = before;
  }
  return group;
}

}  // namespace ssdo
