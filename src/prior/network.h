// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ssdo {

/// Inputs are cut off this many deviations from their mean.
inline constexpr float kMostDeviations = 4;

/// Outputs of a dense layer: bias + sum over inputs of weight x input.
struct DenseLayer {
  std::vector<float> weights;  ///< by input, then by output
  std::vector<float> bias;     ///< by output
};

/// A multilayer perceptron. Its inputs are brought to (x - mean) / deviation; the outputs of
/// each layer but the last are no less than 0.
struct Network {
  std::vector<float> mean, inverse_deviation;
  std::vector<DenseLayer> layers;

  std::size_t inputs() const { return mean.size(); }
  std::size_t outputs() const { return layers.back().bias.size(); }
  std::size_t weights() const;  ///< their number, with the biases
};

/// The networks of a file, as data/prior/README.md describes it: lines of text, then floats,
/// little-endian.
struct PriorModels {
  int frames = 0;           ///< that they were trained on
  Network upright, camera;  ///< for directions in upright axes, and in those of the camera
};

/// Errors: ExitCode::failed for anything else.
PriorModels read_models(std::string_view bytes);

/// The networks that are built into the tool.
const PriorModels& prior_models();

/// A network whose last inputs are the same at many places.
class NetworkWithShared {
 public:
  /// `shared` are those inputs; their part of the first layer is summed once.
  NetworkWithShared(const Network& network, std::span<const float> shared);

  /// `inputs` holds a row of `places` values for each of the other inputs, `stride` floats apart,
  /// and `outputs` is written in the same way; both have room for a multiple of kMostLanes places.
  /// Sums have one order, and nothing is fused: the same bits with every instruction set, wherever
  /// a place is among others.
  void evaluate(const float* inputs, std::size_t stride, std::size_t places, float* outputs) const;

 private:
  Network network_;  ///< of the inputs that are not shared
};

}  // namespace ssdo
