// SPDX-License-Identifier: Apache-2.0
#include "io/images/kind.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace fs = std::filesystem;

namespace ssdo {
namespace {

std::string ending(const fs::path& path) {
  std::string text = path.extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

bool is_jpeg(const fs::path& path) { return ending(path) == ".jpg" || ending(path) == ".jpeg"; }

}  // namespace

bool is_display_image(const fs::path& path) {
  const std::string kind = ending(path);
  return kind == ".png" || kind == ".tif" || kind == ".tiff" || is_jpeg(path);
}

bool keeps_alpha(const fs::path& path) { return !is_jpeg(path); }

bool has_exr_ending(const fs::path& path) { return ending(path) == ".exr"; }

}  // namespace ssdo
