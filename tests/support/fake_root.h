// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>

#include "support/temp_dir.h"

namespace ssdo::test {

/// A folder with files that stands in for the root of the file system.
class FakeRoot {
 public:
  struct File {
    std::string name;  ///< its path below the root
    std::string text;
  };

  FakeRoot(std::initializer_list<File> files) {
    for (const auto& [name, text] : files) {
      std::filesystem::create_directories((dir_ / name).parent_path());
      std::ofstream(dir_ / name, std::ios::binary) << text;
    }
  }
  const std::filesystem::path& path() const { return dir_.path(); }

 private:
  TempDir dir_;
};

}  // namespace ssdo::test
