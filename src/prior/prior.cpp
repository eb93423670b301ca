// SPDX-License-Identifier: Apache-2.0
#include "prior/prior.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
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
void average_over_squares(const PriorQuestion& question, const PriorSettings& asked, PriorGrid& s) {
  const Filter& filter = find_filter("geometry");
  s.guesses = guessed_shares(question.scene, s.pixel, s.first, asked.radius, asked.seed);
  s.ao = s.open_ao = Plane<float>(s.pixel.width, s.pixel.height, 0.0f);
  s.bent = Plane<glm::vec3>(s.pixel.width, s.pixel.height, glm::vec3(0));
  for (std::size_t i = 0; i < s.pixel.size(); ++i) {
    if (s.pixel[i] == kNoPixel) continue;
    const FoundVisibility found = question.found(std::size_t(s.pixel[i]));
    s.ao[i] = found.ao, s.open_ao[i] = found.open_ao, s.bent[i] = found.bent;
  }
  const auto filtering = [](std::string_view name) { return find_product(name).filtering; };
  FilterPlanes planes;
  planes.push_back({std::move(s.ao), filtering("ao")});
  planes.push_back({std::move(s.open_ao), filtering("ao")});
  planes.push_back({std::move(s.guesses), filtering("guessed")});
  planes.push_back({std::move(s.bent), filtering("bent")});
  planes = filter.apply(std::move(planes), s.surfaces, kGuessedPattern);
  s.ao = std::get<Plane<float>>(std::move(planes[0].plane));
  s.open_ao = std::get<Plane<float>>(std::move(planes[1].plane));
  s.guesses = apply_filter(filter, std::get<Plane<float>>(std::move(planes[2].plane)),
                           filtering("guessed"), s.surfaces, kGuessedPattern);
  s.guessed = Plane<float>::like(s.ao);
  for (std::size_t i = 0; i < s.ao.size(); ++i)
    s.guessed[i] = guessed_product(s.guesses[i], std::clamp(s.ao[i], 0.0f, 1.0f));
  s.bent = std::get<Plane<glm::vec3>>(std::move(planes[3].plane));
}

/// Added to both terms of r of prior.h: a smaller ao tells nothing of a sun.
constexpr float kLeastOpen = 0.03f;

/// ao' of prior.h, of the mean of a square.
float leaned(float ao, float g, float u) {
  const float lo = std::max(ao - g, 0.0f), hi = std::min(ao + g, 1.0f), width = hi - lo,
              s = std::clamp((ao - lo) / std::max(width, 1e-6f), kLeastShare, 1 - kLeastShare),
              open = s * u, closed = (1 - s) * (1 - u);
  return std::clamp(ao + width * (open / (open + closed) - s), lo, hi);
}

float sigmoid(float x) { return 1 / (1 + std::exp(-x)); }

std::size_t rounded_up(std::size_t count) {
  return (count + kMostLanes - 1) / kMostLanes * kMostLanes;
}

}  // namespace

float part_of_ao(const Geometry& geometry, float radius) {
  if (std::isinf(radius) || geometry.median_depth <= 0) return 1;
  constexpr float kMany = 8;  // frames of the training have at most 1.5
  const float times = radius / (kMany * geometry.frame_height_at(geometry.median_depth));
  return 1 - (1 - kPartWithinRadius) / (1 + times * times);
}

PriorField find_prior(const PriorQuestion& question, const PriorSettings& asked) {
  const Geometry& geometry = question.scene.geometry;
  const std::optional<glm::vec3>& up = asked.up;
  PriorField field;
  field.part = part_of_ao(geometry, asked.radius);
  PriorGrid& grid = field.grid =
      make_prior_grid(geometry, question.part,
                      question.scene.caster_surfaces ? &*question.scene.caster_surfaces : nullptr);
  average_over_squares(question, asked, grid);
  const PriorInputs inputs(grid, geometry, up, asked.radius, asked.of_frame);
  field.context = inputs.context();
  const Network& network = up ? prior_models().upright : prior_models().camera;
  const glm::mat3 from_axes = glm::transpose(prior_axes(up));
  for (Plane<float>* plane :
       {&field.visibility_bias, &field.change, &field.offscreen_sun, &field.open_border_gain,
        &field.moment[0], &field.moment[1], &field.moment[2], &field.spread})
    *plane = Plane<float>(grid.pixel.width, grid.pixel.height, 0.0f);
  const std::size_t width = std::size_t(field.visibility_bias.width), stride = rounded_up(width);
  // Some rows at a time: what all pixels have in common is added to the network once for each.
  for_each_band(field.visibility_bias.height, [&](int y0, int y1) {
    std::vector<float> rows(PriorInputs::kOwn * stride), outputs(network.outputs() * stride);
    const NetworkWithShared told(network, inputs.shared());
    for (int y = y0; y < y1; ++y) {
      inputs.write(y, stride, rows.data());
      told.evaluate(rows.data(), stride, width, outputs.data());
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t i = grid.pixel.index(int(x), y);
        if (grid.pixel[i] == kNoPixel) continue;
        const auto output = [&](int k) { return outputs[std::size_t(k) * stride + x]; };
        const float ao = std::clamp(grid.ao[i], 0.0f, 1.0f), guessed = grid.guessed[i],
                    room = std::min(ao + guessed, 1.0f) - std::max(ao - guessed, 0.0f);
        const float shift = std::clamp(kShiftUnit * output(0), -kMostShift, kMostShift);
        field.visibility_bias[i] = sigmoid(shift) - 0.5f;
        const float after = std::lerp(ao, leaned(ao, guessed, sigmoid(shift)), field.part);
        field.change[i] = after - ao;
        const float open = (after + kLeastOpen) / (grid.open_ao[i] + kLeastOpen),
                    closed = std::max(1 - open, 0.0f);
        field.offscreen_sun[i] = 1 - closed * closed;
        field.open_border_gain[i] = grid.open_ao[i] - grid.ao[i];
        const glm::vec3 change(output(1), output(2), output(3));
        const glm::vec3 moment = field.part * room * (from_axes * change);
        for (int c = 0; c < 3; ++c) field.moment[std::size_t(c)][i] = moment[c];
        field.spread[i] = room * sigmoid(output(4) - 1);
      }
    }
  });
  return field;
}

AskPrior ask_prior(const PriorSettings& asked, std::optional<PriorField>& field) {
  return [asked, &field](const PriorQuestion& question) {
    field = find_prior(question, asked);
    return question.for_light ? by_pixel(*field, question.scene.geometry, question.offscreen_sun)
                              : LearnedVisibility();
  };
}

std::string describe_prior(bool up_is_known) {
  const PriorModels& models = prior_models();
  const Network& network = up_is_known ? models.upright : models.camera;
  return fmt::format(
      "prior learned: a network of {} weights, trained on {} generated scenes, fills what no "
      "picture shows in ao, bent, the light of sky and suns, specular, and bounce{}; guessed is "
      "its expected error of ao; lamps and reflection go by rules",
      network.weights(), models.frames,
      up_is_known ? "" : ", without knowing which way is up: --env-up tells");
}

}  // namespace ssdo
