// SPDX-License-Identifier: Apache-2.0
//
// The same bits from any number of threads, in any order of tiles, bands and rows, from any build
// and from any compiler: what every method makes of a fixed frame is held to recorded hashes.
// Instruction sets differ from each other within recorded bounds.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <cmath>
#include <limits>

#include "estimate.h"
#include "filters/registry.h"
#include "parallel/task_order.h"
#include "support/chosen_isa.h"
#include "support/fixed_frame.h"
#include "support/recorded_hashes.h"
#include "support/report.h"

namespace ssdo::test {
namespace {

constexpr float kRadius = 0.75f, kEndless = std::numeric_limits<float>::infinity();

struct Case {
  std::string_view method, filter;
  float radius = kRadius;

  std::string name() const {
    return fmt::format("{}{}/{}", method, radius == kEndless ? "-endless" : "", filter);
  }
};

/// Every method without a filter and with the default one, then every other filter.
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Method& method : methods()) {
    for (const char* filter : {"none", "geometry"}) all.push_back({method.name, filter});
    if (method.takes.endless_radius) all.push_back({method.name, "none", kEndless});
  }
  for (const Filter& filter : filters()) {
    if (filter.name != "none" && filter.name != "geometry")
      all.push_back({methods().front().name, filter.name});
  }
  return all;
}

Products products_of(const Case& of) {
  static const Scene scene = fixed_scene();
  Plan plan;
  plan.method = &find_method(of.method);
  plan.filter = &find_filter(of.filter);
  plan.request = fixed_request(*plan.method, of.radius);
  return estimate(scene, plan, [](double) {}, {}).products;
}

/// Calls visit(name, plane) for each product that was made.
template <class Visit>
void for_each_made(const Products& products, const Visit& visit) {
  for_each_plane(
      [&](const Product& product, const auto& plane) {
        if (!plane.empty()) visit(std::string(product.name), plane);
      },
      products);
}

std::map<std::string, std::string> hashes_of(const Products& products) {
  std::map<std::string, std::string> hashes;
  for_each_made(products,
                [&](const std::string& name, const auto& plane) { hashes[name] = hash_of(plane); });
  return hashes;
}

TEST(SameBits, AsRecorded) {
  RecordedHashes recorded;
  for (const char* isa : RecordedHashes::kSets) {
    if (!has_isa(isa)) continue;
    const ChosenIsa chosen(isa);
    for (const Case& one : cases()) {
      for (const auto& [product, hash] : hashes_of(products_of(one)))
        recorded.expect(one.name() + "/" + product, isa, hash);
    }
  }
  recorded.write();
}

/// As many threads as there are, even on a machine with fewer cores.
template <class Work>
auto on_threads(int count, const Work& work) {
  const ThreadLimit limit(count);
  tbb::task_arena arena(count);
  return arena.execute(work);
}

class AnyOrder : public testing::TestWithParam<Case> {};

TEST_P(AnyOrder, OfTilesOnAnyNumberOfThreads) {
  const auto one = hashes_of(on_threads(1, [] { return products_of(GetParam()); }));
  for (int threads = 1; threads <= 16; ++threads) {
    const ShuffledOrder shuffled{unsigned(threads)};
    EXPECT_EQ(hashes_of(on_threads(threads, [] { return products_of(GetParam()); })), one)
        << threads << " threads";
  }
}

std::string test_name(const testing::TestParamInfo<Case>& info) {
  std::string name = info.param.name();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Methods, AnyOrder, testing::ValuesIn(cases()), test_name);

}  // namespace
}  // namespace ssdo::test
