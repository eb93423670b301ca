// SPDX-License-Identifier: Apache-2.0
#include "prior/prior.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "estimators/guessed.h"
#include "filters/registry.h"
#include "parallel/tiles.h"
#include "prior/inputs.h"
#include "prior/network.h"
#include "simd/width.h"

namespace ssdo {
namespace {

/// The unit of the network's output, in shifts of a logit, and the largest shift.
constexpr float kShiftUnit = 4, kMostShift = 12;

/// Takes what was found at the pixels of the squares, and averages it as the geometry filter does,
/// over patterns of 8 x 8 squares; guesses, of which a square has one ray, twice.
void average_over_squares(const Scene& scene, const Request& request, const Products& found,
                          Squares& s) {
  const Filter& filter = find_filter("geometry");
  s.guesses = guessed_shares(scene, s.pixel, s.first, request.radius, request.seed);
  const auto at_squares = [&](const auto& plane) {
    auto out = std::decay_t<decltype(plane)>(s.pixel.width, s.pixel.height);
    for (std::size_t i = 0; i < out.size(); ++i)
      if (s.pixel[i] != kNoPixel) out[i] = plane[std::size_t(s.pixel[i])];
    return out;
  };
  const auto filtering = [](std::string_view name) { return find_product(name).filtering; };
  FilterPlanes planes;
  planes.push_back({at_squares(found.ao), filtering("ao")});
  planes.push_back({at_squares(found.open_ao), filtering("ao")});
  planes.push_back({std::move(s.guesses), filtering("guessed")});
  planes.push_back({at_squares(found.bent), filtering("bent")});
  planes = filter.apply(std::move(planes), s.surfel, kGuessedPattern);
  s.ao = std::get<Plane<float>>(std::move(planes[0].plane));
  s.open_ao = std::get<Plane<float>>(std::move(planes[1].plane));
  s.guesses = apply_filter(filter, std::get<Plane<float>>(std::move(planes[2].plane)),
                           filtering("guessed"), s.surfel, kGuessedPattern);
  s.guessed = Plane<float>::like(s.ao);
  for (std::size_t i = 0; i < s.ao.size(); ++i)
    s.guessed[i] = guessed_product(s.guesses[i], std::clamp(s.ao[i], 0.0f, 1.0f));
  s.bent = std::get<Plane<glm::vec3>>(std::move(planes[3].plane));
}

std::size_t rounded_up(std::size_t count) {
  return (count + kMostLanes - 1) / kMostLanes * kMostLanes;
}

}  // namespace

PriorField find_prior(const Scene& scene, const Request& request, const Products& found,
                      const std::optional<glm::vec3>& up) {
  const Geometry& geometry = scene.geometry;
  const Window whole{0, 0, geometry.surfel.width, geometry.surfel.height};
  Window part = whole;
  if (const Window& r = request.receivers; r.area() > 0) {
    const int left = geometry.window.x0, top = geometry.window.y0;
    part = {r.x0 - left, r.y0 - top, r.x1 - left, r.y1 - top};
  }
  PriorField field{make_squares(geometry, part), {}};
  average_over_squares(scene, request, found, field.squares);
  const PriorInputs inputs(field.squares, geometry, up, request.radius);
  const Network& network = up ? prior_models().upright : prior_models().camera;
  field.lean = Plane<float>(field.squares.pixel.width, field.squares.pixel.height, 0.5f);
  const std::size_t width = std::size_t(field.lean.width), stride = rounded_up(width);
  // Some rows at a time: what all pixels have in common is added to the network once for each.
  for_each_band(field.lean.height, [&](int y0, int y1) {
    std::vector<float> rows(PriorInputs::kOwn * stride), shifts(network.outputs() * stride);
    const NetworkWithShared told(network, inputs.shared());
    for (int y = y0; y < y1; ++y) {
      inputs.write(y, stride, rows.data());
      told.evaluate(rows.data(), stride, width, shifts.data());
      for (std::size_t x = 0; x < width; ++x) {
        const float shift = std::clamp(kShiftUnit * shifts[x], -kMostShift, kMostShift);
        if (field.squares.pixel(int(x), y) != kNoPixel)
          field.lean(int(x), y) = 1 / (1 + std::exp(-shift));
      }
    }
  });
  return field;
}

std::string describe_prior(bool up_is_known) {
  const PriorModels& models = prior_models();
  const Network& network = up_is_known ? models.upright : models.camera;
  return fmt::format(
      "prior learned: a network of {} weights, trained on {} made scenes, fills what no picture "
      "shows in ao, and in direct under light of one colour{}; all else goes by rules",
      network.weights(), models.frames,
      up_is_known ? "" : ", without knowing which way is up: --env-up tells");
}

}  // namespace ssdo
