// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "support/info_warnings.h"
#include "support/parse_json.h"
#include "support/run_tool.h"
#include "support/stored_shot.h"

namespace ssdo::test {

inline const glm::mat3 kMirror{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// A rotation about no axis of any space.
inline const glm::mat3 kTurn = [] {
  const double a = 0.6, b = 0.9;
  const glm::dmat3 x{{1, 0, 0}, {0, std::cos(a), std::sin(a)}, {0, -std::sin(a), std::cos(a)}},
      z{{std::cos(b), std::sin(b), 0}, {-std::sin(b), std::cos(b), 0}, {0, 0, 1}};
  return glm::mat3(z * x);
}();

/// The plain shot with other layers, and what the tool says and makes of it.
class DataChecks : public testing::Test {
 protected:
  nlohmann::json info(const StoredShot& shot, std::vector<std::string> flags = {}) {
    write_shot(input_, shot);
    flags.insert(flags.begin(), {"info", input_, "--json"});
    const Finished done = run_tool(flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(done.out);
  }

  /// A channel of the result; `said_` has the warnings.
  Plane<float> result(const StoredShot& shot, const std::string& product,
                      std::vector<std::string> flags = {}) {
    write_shot(input_, shot);
    flags.insert(flags.begin(), {input_, "-o", dir_ / "out.exr", "--overwrite", "--products",
                                 product.substr(0, product.find('.')), "--pixel-type", "float"});
    const Finished done = run_tool(flags);
    EXPECT_EQ(done.code, 0) << done.err;
    said_ = done.err;
    return channel(dir_ / "out.exr", product);
  }

  double rmse(const Plane<float>& a, const Plane<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(double(a[i]) - double(b[i]), 2);
    return std::sqrt(sum / double(a.size()));
  }

  double off(const StoredShot& shot, const std::vector<std::string>& flags = {}) {
    static const Plane<float> expected = result(plain_shot(), "ao.Y");
    return rmse(result(shot, "ao.Y", flags), expected);
  }

  /// The plain shot with another layer for one role.
  static StoredShot with(Role role, const Content& content, Imf::PixelType type = Imf::FLOAT) {
    StoredShot shot = plain_shot();
    for (StoredLayer& layer : shot.layers) {
      if (layer.role != role) continue;
      layer.content = content;
      layer.type = type;
    }
    return shot;
  }

  static void drop(StoredShot& shot, Role role) {
    std::erase_if(shot.layers, [&](const StoredLayer& layer) { return layer.role == role; });
  }

  TempDir dir_;
  std::string input_ = dir_ / "frame.exr", said_;
};

}  // namespace ssdo::test
