// SPDX-License-Identifier: Apache-2.0
#include "prior/network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include "prior/inputs.h"
#include "prior/vectors.h"
#include "simd/width.h"
#include "support/chosen_isa.h"
#include "support/error_matchers.h"

namespace ssdo::test::network_test {
namespace {

/// All outputs at `places` places that are told the same.
std::vector<float> evaluated(const PriorVector& vector, std::size_t places) {
  const PriorModels& models = prior_models();
  const Network& network = vector.upright ? models.upright : models.camera;
  const std::span<const float> all(vector.inputs);
  const NetworkWithShared told(network, all.subspan(PriorInputs::kOwn));
  const std::size_t stride = (places + kMostLanes - 1) / kMostLanes * kMostLanes;
  std::vector<float> rows(PriorInputs::kOwn * stride), outputs(network.outputs() * stride);
  for (std::size_t c = 0; c < PriorInputs::kOwn; ++c)
    std::fill_n(&rows[c * stride], places, vector.inputs[c]);
  told.evaluate(rows.data(), stride, places, outputs.data());
  return outputs;
}

TEST(PriorNetwork, GivesWhatTheTrainingGives) {
  const std::vector<PriorVector> all = prior_vectors().places;
  ASSERT_GE(all.size(), 8u);
  for (const PriorVector& vector : all) {
    constexpr std::size_t kPlaces = 37, kStride = 48;
    const std::vector<float> outputs = evaluated(vector, kPlaces);
    for (std::size_t k = 0; k < outputs.size() / kStride; ++k)
      for (std::size_t x = 0; x < kPlaces; ++x)
        EXPECT_NEAR(outputs[k * kStride + x], vector.outputs[k], 1e-5);
  }
}

TEST(PriorNetwork, HasTheSameBitsOnEveryInstructionSet) {
  if (!has_isa("scalar")) GTEST_SKIP() << "this build has one instruction set";
  for (const PriorVector& vector : prior_vectors().places) {
    std::vector<float> first;
    {
      const ChosenIsa scalar("scalar");
      first = evaluated(vector, 16);
    }
    for (const char* name : kVectorIsas) {
      if (!has_isa(name)) continue;
      const ChosenIsa isa(name);
      EXPECT_EQ(evaluated(vector, 16), first) << name;
    }
  }
}

TEST(PriorNetwork, TakesTheInputsThatTheToolHas) {
  for (const Network* network : {&prior_models().upright, &prior_models().camera})
    EXPECT_EQ(network->inputs(), PriorInputs::kOwn + PriorInputs::kShared);
}

TEST(PriorNetwork, RefusesWeightsThatAreCutShortOrTooLong) {
  std::ifstream file(SSDO_SOURCE_DIR "/data/prior/prior.bin", std::ios::binary);
  std::ostringstream all;
  all << file.rdbuf();
  const std::string bytes = all.str();
  EXPECT_GT(read_models(bytes).frames, 0);
  const auto expect_refused = [](const std::string& text, const std::string& what) {
    EXPECT_THAT(error_of([&] { read_models(text); }), IsError(ExitCode::failed, what));
  };
  expect_refused(bytes.substr(0, bytes.size() - 1), "end too early");
  expect_refused(bytes + "1234", "more than the models take");
  expect_refused("ssdo-prior 2\nend\n", "unknown format");
  expect_refused("ssdo-prior 1\nmodel up 3\nend\n", "no layers");
  expect_refused("ssdo-prior 1\nframes 1\nend\n", "a model is missing");
}

}  // namespace
}  // namespace ssdo::test::network_test
