// SPDX-License-Identifier: Apache-2.0
//
// The error of direct + bounce is how far they are from what very many slices and steps would give
// through the same filter. It has two parts, which are measured apart:
//
//   error = sqrt(noise^2 + steps^2)
//
// `noise` is measured as the difference of two halves of the slices. The signed difference goes
// through the filter as the light does, so that it shrinks as the noise of the light does, and is
// squared after that. Both halves cover all directions (SlicePattern::half_sign). The noise of
// suns, which few rays reach, is the difference from another set of rays
// (filters/sun_errors.cpp); it is added with its sign, as it is independent of that of the
// slices.
//
// `steps` is the bias of few steps. It is the same in every slice, so that halves of the slices do
// not show it; a second run with half of the steps does. The bias falls about as 1 / steps: what
// the second half of the steps changed is about what remains.
//
// Each difference is a single draw of a random error, whose size is taken as the root mean square
// over neighbours on the same surface.
#include "relight/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "filters/light_visibility.h"
#include "math/luminance.h"
#include "prior/prior.h"
#include "scene/light/light_group.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

// The most slices and steps that --error takes: beyond, rounding and guessed geometry are worse.
constexpr int kMostSlices = 64, kMostSteps = 128;

double rms_over_surfaces(const Plane<float>& plane, const Geometry& geometry) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < plane.size(); ++i) {
    if (!geometry.is_surface(i)) continue;
    sum += double(plane[i]) * double(plane[i]);
    count += 1;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

/// Products of the receivers as planes of the whole geometry, as filters and outputs take them; all
/// other pixels are filled like those without a surface.
Products over_geometry(Products found, const Geometry& geometry, const Window& receivers) {
  if (receivers.area() == 0 || receivers == geometry.window) return found;
  const int left = receivers.x0 - geometry.window.x0, top = receivers.y0 - geometry.window.y0;
  const auto place = [&](auto& plane, float background) {
    if (plane.empty()) return;
    using Value = std::decay_t<decltype(plane[0])>;
    Plane<Value> whole(geometry.surfaces.width, geometry.surfaces.height, Value(background));
    for (int y = 0; y < plane.height; ++y)
      std::copy_n(&plane(0, y), plane.width, &whole(left, top + y));
    plane = std::move(whole);
  };
  for_each_plane([&](const Product& product, auto& plane) { place(plane, product.background); },
                 found);
  for_each_visibility([&](auto& plane) { place(plane, 0); }, found);
  for (ShadowSample& sample : found.visibility.samples)
    place(sample.weight, 0), place(sample.width_px, 0);
  for (ShadowSample& sample : found.visibility.samples_again)
    place(sample.weight, 0), place(sample.width_px, 0);
  return found;
}

/// The size of an error from a draw of it: its root mean square among neighbours on a surface.
Plane<float> size_of(Plane<float> draw, const Geometry& geometry) {
  // Small, so that the error of a penumbra does not spread to the pixels beside it.
  constexpr int kNeighbours = 2;
  for (float& e : draw.pixels) e *= e;
  Plane<float> size =
      apply_filter(find_filter("geometry"), std::move(draw), {}, geometry.surfaces, kNeighbours);
  for (float& e : size.pixels) e = std::sqrt(std::max(e, 0.0f));
  return size;
}

/// Scales the difference of two halves of the slices to the noise of all slices. Slices are evenly
/// spaced, so that twice as many halve the error: the difference of halves is sqrt(2^2 - 1) times
/// the error of all. Filters do not change this factor, as the halves of neighbours cover all
/// directions about as evenly as all of their slices do. Measured with 2 to 24 slices on two
/// frames, with the filter and without: the noise is 0.95 to 1.5 times the change by other seeds.
void scale_to_noise(Plane<float>& difference, const Method& method) {
  if (!method.supports.march) return;
  for (float& e : difference.pixels) e /= std::sqrt(3.0f);
}

float brightness(const Products& products, std::size_t i) {
  const float direct = products.direct.empty() ? 0 : luminance(products.direct[i]);
  return direct + (products.bounce.empty() ? 0 : luminance(products.bounce[i]));
}

/// The change of direct + bounce from half of the steps to all, not filtered.
Plane<float> change_by_steps(const Scene& scene, const Method& method, Request fewer,
                             const Products& products, const Progress& progress) {
  fewer.steps = fewer.steps > 1 ? fewer.steps / 2 : 2;
  fewer.products = {.direct = true, .bounce = fewer.products.bounce};
  fewer.by_light = {};
  const Products other = method.estimate(scene, fewer, progress);
  auto change = Plane<float>::like(scene.geometry.surfaces);
  for (std::size_t i = 0; i < change.size(); ++i)
    change[i] = brightness(products, i) - brightness(other, i);
  return change;
}

/// What a method has found, before the filter.
struct Noisy {
  Products products;
  Plane<float> change;  ///< by steps; empty where they are not compared
  std::optional<PriorField> prior;
};

/// Whether no estimate is needed: all outputs are composed of what is known without.
bool is_idle(const Request& request) { return request.products == ProductSet(); }

/// Whether the light is known by its shares between the filter and light_products().
bool has_visibility(const Plan& plan) { return plan.filter->apply || plan.shot; }

/// Completes the products of each light; those of a single light are those of all light.
void finish_lights(const ProductSet& by_light, Products& products) {
  const bool is_all = products.lights.size() == 1;
  for (LightProducts& light : products.lights) {
    if (is_all) light.direct = products.direct, light.bounce = products.bounce;
    if (!by_light.direct) light.direct = {};
    if (!by_light.bounce) light.bounce = {};
  }
}

/// Estimates and filters once.
class Round {
 public:
  Round(const Plan& plan, const Request& request, const Light& light,
        const std::function<void(double)>& on_progress)
      : plan_(plan), request_(request), on_progress_(on_progress) {
    compares_steps_ = request.products.error && plan.method->supports.march;
    if (request.by_light != ProductSet()) {
      for (LightGroup& each : light_groups_of(light)) names_.push_back(std::move(each.name));
    }
    passes_ = (compares_steps_ ? 2.0 : 1.0) * (1.0 + request.bounces) +
              (bounces_by_light() ? double(names_.size()) * request.bounces : 0.0);
  }

  Noisy estimate(const Scene& scene) {
    if (is_idle(request_)) return {};
    const auto progress = [this](std::size_t done, std::size_t count) { tell(done, count); };
    Request request = request_;
    request.visibility_suffices = plan_.filter->apply && !compares_steps_;
    std::optional<PriorField> prior;
    if (plan_.prior) {
      request.ask_prior = asking(prior);
      request.products.guessed = false;  // what the prior expects is in its place
    }
    request.by_light.bounce = bounces_by_light();
    Products found = plan_.method->estimate(scene, request, progress);
    found.lights.resize(names_.size());
    for (std::size_t k = 0; k < names_.size(); ++k) found.lights[k].name = names_[k];
    Noisy out{over_geometry(std::move(found), scene.geometry, request.receivers), {}, {}};
    if (compares_steps_) {
      Request fewer = request_;
      std::optional<PriorField> again;
      if (plan_.prior) fewer.ask_prior = asking(again);
      out.change = change_by_steps(scene, *plan_.method, fewer, out.products, progress);
    }
    out.prior = std::move(prior);
    return out;
  }

  Estimate filter(Noisy noisy, const Scene& scene) const {
    Estimate out;
    if (is_idle(request_)) return out;
    const Geometry& geometry = scene.geometry;
    const int pattern = plan_.method->pattern_size;
    Products& products = out.products = std::move(noisy.products);
    scale_to_noise(products.error, *plan_.method);
    std::function<void(Products&)> lean;
    if (noisy.prior) lean = [&](Products& found) { apply_prior(*noisy.prior, scene, found); };
    products = find_visibility(*plan_.filter, std::move(products), scene, pattern, lean,
                               has_visibility(plan_));
    if (noisy.prior) out.prior = std::move(noisy.prior);
    if (request_.products.error) {
      if (compares_steps_)
        noisy.change =
            apply_filter(*plan_.filter, std::move(noisy.change), {}, geometry.surfaces, pattern);
      out.error = measure(products.error, std::move(noisy.change), geometry);
    }
    return out;
  }

 private:
  /// Whether the method gathers the bounce light by light: that of a single light is all of it.
  bool bounces_by_light() const { return request_.by_light.bounce && names_.size() > 1; }

  /// A function that asks the prior and keeps the answer in `field`.
  AskPrior asking(std::optional<PriorField>& field) const {
    return ask_prior({plan_.prior->up, request_.radius, request_.seed, plan_.prior->of_frame.get()},
                     field);
  }

  void tell(std::size_t done, std::size_t count) {
    on_progress_(std::min((finished_ + double(done) / double(count)) / passes_, 1.0));
    if (done == count) finished_ += 1;
  }

  /// Turns the difference of halves into the product `error`.
  static ErrorFound measure(Plane<float>& error, Plane<float> change, const Geometry& geometry) {
    ErrorFound found;
    error = size_of(std::move(error), geometry);
    found.noise = rms_over_surfaces(error, geometry);
    if (!change.empty()) {
      change = size_of(std::move(change), geometry);
      found.steps = rms_over_surfaces(change, geometry);
      for (std::size_t i = 0; i < error.size(); ++i) error[i] = std::hypot(error[i], change[i]);
    }
    found.all = rms_over_surfaces(error, geometry);
    return found;
  }

  const Plan& plan_;
  const Request& request_;
  const std::function<void(double)>& on_progress_;
  bool compares_steps_;
  std::vector<std::string> names_;  ///< of the lights that have planes of their own
  double passes_, finished_ = 0;
};

/// The scene without the parts that methods alone read.
Scene seen_by_filters(Scene scene) {
  Scene seen;
  seen.geometry = std::move(scene.geometry);
  seen.senders = std::move(scene.senders);
  seen.light = std::move(scene.light);
  seen.roughness = std::move(scene.roughness);
  seen.specular_color = std::move(scene.specular_color);
  return seen;
}

/// The share of the light of a source that arrives at the surfaces of a frame.
double arriving(const LightVisibility& visibility, std::size_t source, const Surfaces& surfaces) {
  const Plane<float>& share = visibility.sources[source];
  const bool weighs =
      source < visibility.samples.size() && !visibility.samples[source].weight.empty();
  double all = 0, arrives = 0;
  for (std::size_t i = 0; i < share.size(); ++i) {
    if (!surfaces[i].is_surface()) continue;
    const double light = weighs ? double(visibility.samples[source].weight[i]) : 1;
    all += light, arrives += light * double(share[i]);
  }
  return all > 0 ? arrives / all : 1;
}

/// The lamps that light next to nothing of what the frame shows, and the share of their light that
/// arrives.
std::vector<std::pair<std::string, double>> unlit_lamps(const Light& light,
                                                        const LightVisibility& visibility,
                                                        const Surfaces& surfaces) {
  // This much of the light of a lamp under the ground arrives, through gaps and at the border.
  constexpr double kNearlyNone = 0.03;
  std::vector<std::pair<std::string, double>> found;
  for (std::size_t k = 0; k < visibility.sources.size(); ++k) {
    const std::string& name = light.sources[k]->name;
    const double share = name.empty() ? 1 : arriving(visibility, k, surfaces);
    if (share < kNearlyNone) found.emplace_back(name, share);
  }
  return found;
}

/// Raises slices and steps towards the error `wanted`. False if they are at their most.
bool refine(Request& request, double wanted, const ErrorFound& found) {
  const double each = wanted / std::sqrt(2.0), larger = std::max(found.noise, found.steps);
  // Too small an increase costs another round. The error falls as count^(-1 / power).
  const auto raise = [&](int& count, int most, double part, double power) {
    if (count >= most || (part <= each && part < larger)) return false;
    const double factor = std::clamp(std::pow(part / each, power), 1.5, 8.0);
    count = std::min(most, int(std::ceil(count * factor)));
    return true;
  };
  const bool slices = raise(request.slices, kMostSlices, found.noise, 1.3),
             steps = raise(request.steps, kMostSteps, found.steps, 1);
  return slices || steps;
}

std::string describe(const ErrorFound& found, const Method& method, const Request& request) {
  std::string text = fmt::format("error of direct + bounce {:.2g}", found.all);
  if (method.supports.march)
    text += fmt::format(": {:.2g} is the noise at {} slices, {:.2g} the bias of {} steps",
                        found.noise, request.slices, found.steps, request.steps);
  return text;
}

}  // namespace

Estimate estimate(Scene scene, const Plan& plan, const std::function<void(double)>& on_progress) {
  Request request = plan.request;
  double estimate_ms = 0, filter_ms = 0;
  for (;;) {
    Stopwatch watch;
    Round round(plan, request, scene.light, on_progress);
    Noisy noisy = round.estimate(scene);
    const auto unlit = unlit_lamps(scene.light, noisy.products.visibility, scene.geometry.surfaces);
    estimate_ms += watch.lap();
    // With --error another round may need all of the scene.
    if (!plan.error) scene = seen_by_filters(std::move(scene));
    Estimate out = round.filter(std::move(noisy), scene);
    filter_ms += watch.lap();
    if (plan.error && out.error->all > *plan.error) {
      if (refine(request, *plan.error, *out.error)) continue;
      out.warnings.push_back(
          fmt::format("--error {:g} is not reached: it is {:.2g} with {} slices and {} steps",
                      *plan.error, out.error->all, request.slices, request.steps));
    }
    if (out.error) out.notes.push_back(describe(*out.error, *plan.method, request));
    out.unlit = unlit;
    out.scene = seen_by_filters(std::move(scene));
    out.request = request;
    out.estimate_ms = estimate_ms, out.filter_ms = filter_ms;
    return out;
  }
}

void light_products(Estimate& found, const Plan& plan, const TemporalInput& temporal) {
  if (is_idle(found.request)) return;
  Stopwatch watch;
  Products& products = found.products;
  products = light_of_visibility(std::move(products), found.scene, has_visibility(plan));
  if (found.prior)
    finish_with_prior(*found.prior, found.scene, found.request.products.guessed, products);
  finish_lights(found.request.by_light, products);
  if (plan.temporal) {
    found.history = accumulate(temporal.history ? &*temporal.history : nullptr,
                               found.scene.geometry, products, temporal.motion);
    products = products_of(found.history);
  }
  found.filter_ms += watch.lap();
}

}  // namespace ssdo
