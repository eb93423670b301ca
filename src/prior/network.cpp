// SPDX-License-Identifier: Apache-2.0
//
// Lanes are places. Compiled once for every instruction set.
#include "prior/network.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <sstream>
#include <utility>

#include "error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prior/network.cpp"
#include <hwy/foreach_target.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// kCount outputs of a layer, from `first` on. A product is rounded before it is added, so that
/// instruction sets with and without fused sums agree.
template <int kCount>
HWY_INLINE void add_products(const DenseLayer& layer, std::size_t first, const float* in,
                             float* out) {
  V sum[kCount];
  for (int k = 0; k < kCount; ++k) sum[k] = set(layer.bias[first + std::size_t(k)]);
  const std::size_t outputs = layer.bias.size();
  const float* weight = layer.weights.data() + first;
  for (std::size_t end = layer.weights.size(); first < end; first += outputs) {
    const V value = load(in);
    for (int k = 0; k < kCount; ++k) sum[k] = sum[k] + set(weight[k]) * value;
    weight += outputs, in += kLanes;
  }
  for (int k = 0; k < kCount; ++k) store(sum[k], out + k * kLanes);
}

/// A layer for a vector of places: values lie by input and by output, a vector each.
HWY_INLINE void apply_layer(const DenseLayer& layer, const float* in, float* out) {
  constexpr int kAtOnce = 8;  // sums that fit the 16 registers of AVX2
  const std::size_t outputs = layer.bias.size();
  std::size_t first = 0;
  for (; first + kAtOnce <= outputs; first += kAtOnce)
    add_products<kAtOnce>(layer, first, in, out + first * kLanes);
  for (; first < outputs; ++first) add_products<1>(layer, first, in, out + first * kLanes);
}

void evaluate_places(const Network& network, const float* inputs, std::size_t stride,
                     std::size_t places, float* outputs) {
  std::size_t most = network.inputs();
  for (const DenseLayer& layer : network.layers) most = std::max(most, layer.bias.size());
  std::vector<float> in(most * std::size_t(kLanes)), out(in.size());
  for (std::size_t place = 0; place < places; place += kLanes) {
    for (std::size_t c = 0; c < network.inputs(); ++c) {
      const V x = load(inputs + c * stride + place),
              scaled = (x - set(network.mean[c])) * set(network.inverse_deviation[c]);
      store(hn::Clamp(scaled, set(-kMostDeviations), set(kMostDeviations)), &in[c * kLanes]);
    }
    for (const DenseLayer& layer : network.layers) {
      apply_layer(layer, in.data(), out.data());
      const bool is_last = &layer == &network.layers.back();
      for (std::size_t k = 0; k < layer.bias.size() && !is_last; ++k)
        store(hn::Max(load(&out[k * kLanes]), set(0)), &out[k * kLanes]);
      std::swap(in, out);
    }
    for (std::size_t k = 0; k < network.outputs(); ++k)
      store(load(&in[k * kLanes]), outputs + k * stride + place);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(evaluate_places);

namespace {

constexpr char kBytes[] =
#include "prior_weights.inc"
    ;

[[noreturn]] void refuse(std::string_view what) {
  throw Error(ExitCode::failed, fmt::format("weights of the prior: {}", what));
}

/// Takes the next `count` floats away from `bytes`.
std::vector<float> take(std::string_view& bytes, std::size_t count) {
  static_assert(std::endian::native == std::endian::little);
  std::vector<float> values(count);
  const std::size_t size = count * sizeof(float);
  if (bytes.size() < size) refuse("they end too early");
  std::memcpy(values.data(), bytes.data(), size);
  bytes.remove_prefix(size);
  return values;
}

/// The file has weights by output, then by input.
DenseLayer take_layer(std::string_view& bytes, std::size_t inputs, std::size_t outputs) {
  const std::vector<float> by_output = take(bytes, inputs * outputs);
  DenseLayer layer;
  layer.weights.resize(by_output.size());
  for (std::size_t i = 0; i < inputs; ++i)
    for (std::size_t o = 0; o < outputs; ++o)
      layer.weights[i * outputs + o] = by_output[o * inputs + i];
  layer.bias = take(bytes, outputs);
  return layer;
}

Network take_network(std::string_view& bytes, const std::vector<std::size_t>& sizes) {
  constexpr std::size_t kMostSize = 4096;
  if (sizes.size() < 2) refuse("a model has no layers");
  for (const std::size_t size : sizes)
    if (size == 0 || size > kMostSize) refuse("a layer has a size that none has");
  Network network;
  network.mean = take(bytes, sizes[0]);
  network.inverse_deviation = take(bytes, sizes[0]);
  for (std::size_t k = 0; k + 1 < sizes.size(); ++k)
    network.layers.push_back(take_layer(bytes, sizes[k], sizes[k + 1]));
  return network;
}

}  // namespace

PriorModels read_models(std::string_view bytes) {
  constexpr std::string_view kEnd = "\nend\n";
  const std::size_t end = bytes.find(kEnd);
  if (!bytes.starts_with("ssdo-prior 1\n") || end == bytes.npos) refuse("unknown format");
  std::istringstream lines{std::string(bytes.substr(0, end))};
  bytes.remove_prefix(end + kEnd.size());
  PriorModels models;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key, kind;
    words >> key;
    if (key == "frames") words >> models.frames;
    if (key != "model") continue;
    words >> kind;
    std::vector<std::size_t> sizes;
    for (std::size_t size; words >> size;) sizes.push_back(size);
    if (kind != "up" && kind != "camera") refuse("a model is of no kind that is known");
    (kind == "up" ? models.upright : models.camera) = take_network(bytes, sizes);
  }
  if (!bytes.empty()) refuse("there are more than the models take");
  if (models.upright.layers.empty() || models.camera.layers.empty()) refuse("a model is missing");
  return models;
}

const PriorModels& prior_models() {
  static const PriorModels models = read_models({kBytes, sizeof kBytes - 1});
  return models;
}

std::size_t Network::weights() const {
  std::size_t count = 0;
  for (const DenseLayer& layer : layers) count += layer.weights.size() + layer.bias.size();
  return count;
}

NetworkWithShared::NetworkWithShared(const Network& network, std::span<const float> shared)
    : network_(network) {
  DenseLayer& first = network_.layers.front();
  const std::size_t outputs = first.bias.size(), own = network.inputs() - shared.size();
  for (std::size_t k = 0; k < shared.size(); ++k) {
    const std::size_t c = own + k;
    const float x = std::clamp((shared[k] - network.mean[c]) * network.inverse_deviation[c],
                               -kMostDeviations, kMostDeviations);
    for (std::size_t o = 0; o < outputs; ++o) first.bias[o] += first.weights[c * outputs + o] * x;
  }
  first.weights.resize(own * outputs);
  network_.mean.resize(own);
  network_.inverse_deviation.resize(own);
}

void NetworkWithShared::evaluate(const float* inputs, std::size_t stride, std::size_t places,
                                 float* outputs) const {
  HWY_DYNAMIC_DISPATCH(evaluate_places)(network_, inputs, stride, places, outputs);
}

}  // namespace ssdo
#endif
