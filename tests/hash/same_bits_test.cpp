// SPDX-License-Identifier: Apache-2.0
//
// The same bits from any number of threads, in any order of tiles, bands and rows, from any build
// and from any compiler: what every method makes of a fixed frame is held to recorded hashes. AVX2,
// AVX-512 and NEON have the same bits, and one lane differs from them within bounds.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <span>

#include "filters/registry.h"
#include "parallel/task_order.h"
#include "relight/estimate.h"
#include "support/chosen_isa.h"
#include "support/crop.h"
#include "support/estimate_light.h"
#include "support/fixed_frame.h"
#include "support/recorded_hashes.h"
#include "support/report.h"

namespace ssdo::test::same_bits_test {
namespace {

constexpr float kRadius = 0.75f, kInfiniteLength = std::numeric_limits<float>::infinity();

struct Case {
  std::string_view method, filter;
  float radius = kRadius;
  bool learned = false;  ///< the prior

  std::string name() const {
    return fmt::format("{}{}{}/{}", method, learned ? "-learned" : "",
                       radius == kInfiniteLength ? "-endless" : "", filter);
  }
};

void PrintTo(const Case& of, std::ostream* out) { *out << of.name(); }

/// Every method without a filter and with the default one, then every other filter.
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Method& method : methods()) {
    for (const char* filter : {"none", "geometry"}) all.push_back({method.name, filter});
    if (method.supports.infinite_radius) all.push_back({method.name, "none", kInfiniteLength});
  }
  for (const Filter& filter : filters()) {
    if (filter.name != "none" && filter.name != "geometry")
      all.push_back({methods().front().name, filter.name});
  }
  all.push_back({methods().front().name, "geometry", kInfiniteLength, true});
  return all;
}

Products products_of(const Case& of) {
  static const Scene scene = fixed_scene();
  Plan plan;
  plan.method = &find_method(of.method);
  plan.filter = &find_filter(of.filter);
  plan.request = fixed_request(*plan.method, of.radius);
  if (of.learned) {
    const glm::dvec3 up(0, 0, 1);
    plan.prior = LearnedPrior{glm::vec3(scene.geometry.camera.rotation * up)};
  }
  return estimate_light(scene, plan).products;
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
  int compared = 0;
  for (const char* isa : kIsas) {
    if (!has_isa(isa)) continue;
    ++compared;
    const ChosenIsa chosen(isa);
    for (const Case& one : cases()) {
      for (const auto& [product, hash] : hashes_of(products_of(one)))
        recorded.expect(one.name() + "/" + product, isa, hash);
    }
  }
  recorded.write();
  EXPECT_GT(compared, 0);
}

/// How far a method by vectors may be from its scalar build: fused multiplications round once, and
/// what they move across the edge of a sector, a pixel or a thing is there or not.
struct Bound {
  std::string_view method;
  double rms;      ///< over the frame
  double largest;  ///< of one pixel
};
constexpr Bound kBounds[] = {
    {"bitmask", 5e-4, 0.05}, {"trace", 2e-5, 2e-3},      {"ssdo", 1e-6, 1e-5},
    {"ssao", 1e-6, 1e-5},    {"ssao-range", 5e-4, 0.05}, {"ssao-fade", 1e-6, 1e-5},
    {"hbao", 1e-6, 1e-5},    {"gtao", 1e-6, 1e-5},       {"sao", 1e-6, 1e-5},
    {"msvo", 1e-6, 1e-5},
};

/// Of all products of a method, light and its error in units of their mean.
class Distance {
 public:
  void add(const Product& product, const auto& scalar, const auto& vector) {
    const auto numbers = [](const auto& plane) {
      const float* begin = reinterpret_cast<const float*>(plane.pixels.data());
      return std::span(begin, plane.size() * sizeof(plane[0]) / sizeof(float));
    };
    const std::span<const float> a = numbers(scalar), b = numbers(vector);
    ASSERT_EQ(a.size(), b.size()) << product.name;
    double mean = 0, sum = 0, most = 0;
    for (const float value : a) mean += std::abs(double(value)) / double(a.size());
    const bool is_light =
        product.kind == ProductKind::light || product.kind == ProductKind::deviation;
    const double unit = is_light ? mean : 1;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double off = std::abs(double(a[i]) - double(b[i])) / unit;
      sum += off * off, most = std::max(most, off);
    }
    rms_ = std::max(rms_, std::sqrt(sum / double(a.size())));
    largest_ = std::max(largest_, most);
  }
  double rms() const { return rms_; }
  double largest() const { return largest_; }

 private:
  double rms_ = 0, largest_ = 0;
};

Products products_by(const char* isa, const Case& of) {
  const ChosenIsa chosen(isa);
  return products_of(of);
}

TEST(SameBits, VectorsAreWithinABoundOfOneLane) {
  std::string report =
      "Instruction sets against one lane, without a filter\n\n"
      "| method | set | RMS | largest |\n| --- | --- | ---: | ---: |\n";
  for (const Bound& bound : kBounds) {
    const Case one{bound.method, "none"};
    if (!has_isa("scalar")) return;
    const Products scalar = products_by("scalar", one);
    for (const char* isa : kVectorIsas) {
      if (!has_isa(isa)) continue;
      const Products vector = products_by(isa, one);
      Distance distance;
      for_each_plane(
          [&](const Product& product, const auto& a, const auto& b) {
            if (!a.empty()) distance.add(product, a, b);
          },
          scalar, vector);
      EXPECT_LE(distance.rms(), bound.rms) << bound.method << " by " << isa;
      EXPECT_LE(distance.largest(), bound.largest) << bound.method << " by " << isa;
      report += fmt::format("| {} | {} | {:.1e} | {:.1e} |\n", bound.method, isa, distance.rms(),
                            distance.largest());
    }
  }
  EXPECT_EQ(std::size(kBounds), methods().size());
  write_report("instruction_sets.md", report);
}

/// A row of the man page for each method.
TEST(SameBits, BoundsAreThoseOfTheManPage) {
  std::ifstream in(std::string(SSDO_SOURCE_DIR) + "/man/ssdo-methods.7");
  const std::string page(std::istreambuf_iterator<char>(in), {});
  for (const Bound& bound : kBounds) {
    const std::string row =
        fmt::format("\n{}\t{:g}\t{:g}\n", bound.method, bound.rms, bound.largest);
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
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

/// The columns [x0, x1) of the fixed scene, in one light from everywhere, and as thick everywhere.
Scene columns(int x0, int x1) {
  Scene scene = fixed_scene();
  const Window window{x0, 0, x1, scene.geometry.window.y1};
  scene.geometry = crop(scene.geometry, window);
  scene.senders.albedo = crop(scene.senders.albedo, window);
  scene.solids = constant_thickness(scene.geometry, 0.25f);
  scene.light = model_light(Environment::constant({1, 0.5f, 2}), scene.geometry.world_to_camera);
  return scene;
}

/// The methods on solids; for the others see view_space/point_methods_test.cpp, sao_test.cpp and
/// msvo_test.cpp.
TEST(SameBits, InACropFartherThanTheRadiusFromItsEdge) {
  constexpr float kNear = 0.2f;  // less than 10 pixels
  constexpr int kLeft = 10, kRight = 122, kMargin = 24;
  for (const char* name : {"bitmask", "trace"}) {
    const Method& method = find_method(name);
    Request request = fixed_request(method, kNear);
    request.products = {.ao = true, .direct = true, .bounce = true, .bent = true};
    request.bounces = 1;
    const Products whole = method.estimate(columns(0, 130), request, {}),
                   part = method.estimate(columns(kLeft, kRight), request, {});
    for_each_plane(
        [&](const Product& product, const auto& all, const auto& some) {
          if (some.empty()) return;
          const Window middle{kLeft + kMargin, 0, kRight - kMargin, all.height};
          EXPECT_EQ(hash_of(crop(all, middle)),
                    hash_of(crop(some, {kMargin, 0, middle.x1 - kLeft, all.height})))
              << name << ": " << product.name;
        },
        whole, part);
    EXPECT_LT(*std::min_element(whole.ao.pixels.begin(), whole.ao.pixels.end()), 0.9f) << name;
  }
}

std::string test_name(const testing::TestParamInfo<Case>& info) {
  std::string name = info.param.name();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
  return name;
}

/// Without those that stop before a filter that another case has.
std::vector<Case> longest_cases() {
  std::vector<Case> longest = cases();
  std::erase_if(longest, [](const Case& c) { return c.filter == "none" && c.radius == kRadius; });
  return longest;
}

INSTANTIATE_TEST_SUITE_P(Methods, AnyOrder, testing::ValuesIn(longest_cases()), test_name);

}  // namespace
}  // namespace ssdo::test::same_bits_test
