// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfCompression.h>
#include <ImfTileDescription.h>

#include <string>
#include <vector>

#include "fuzz/chance.h"

namespace ssdo::fuzz {

/// How an EXR is stored.
struct ExrKind {
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  bool deep = false, tiled = false;
  Imf::LevelMode levels = Imf::ONE_LEVEL;  ///< of a tiled one
  int parts = 1;
  bool deep_behind_flat = false;  ///< all parts but the first are deep
};

/// All that the reader tells apart.
std::vector<ExrKind> flat_kinds();
std::vector<ExrKind> deep_kinds();
std::vector<ExrKind> mixed_kinds();  ///< deep parts beside a flat one

/// A small G-buffer of this kind: layers under the names of several renderers, with a camera in the
/// header or none; names, types, windows and some odd values by chance. In most of them P
/// determines a camera.
std::string exr_sample(const ExrKind& kind, Chance& chance);

/// One for each kind.
std::vector<std::string> exr_samples(const std::vector<ExrKind>& kinds);

}  // namespace ssdo::fuzz
