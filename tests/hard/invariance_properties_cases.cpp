// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "hard/frame_properties.h"

namespace ssdo::test {
namespace {

/// The products of a shot by the usual way.
Products products_of_shot(const RandomShot& shot) {
  const Frame frame = read_frame(shot);
  return relit(frame.scene, frame.plan);
}

/// Light in units of the brightest pixel.
Worst largest_change(const Products& one, const Products& other) {
  const double brightest = brightest_of(one);
  Worst worst;
  for_each_pair(one, other, [&](const Pair& pair) {
    const bool light = pair.is_light() || pair.product.kind == ProductKind::deviation;
    worst.see(std::abs(pair.one - pair.other) / (light ? brightest : 1),
              [&] { return pair.place(); });
  });
  return worst;
}

/// The mean of all pixels, and where the change is largest.
Worst mean_change_of_ao(const Products& one, const Products& other) {
  Worst worst;
  double sum = 0;
  for (std::size_t i = 0; i < one.ao.size(); ++i) {
    const double change = std::abs(double(one.ao[i]) - double(other.ao[i]));
    sum += change;
    worst.see(change, [&] {
      return fmt::format("ao of pixel {} is {} and {}", i, one.ao[i], other.ao[i]);
    });
  }
  worst.value = sum / double(std::max<std::size_t>(1, one.ao.size()));
  return worst;
}

/// Filters gaussian and depth have limits in scene units, as in their sources.
bool has_unit(const Plan& plan) {
  const Filter& filter = plan.half_filter ? *plan.half_filter : *plan.filter;
  return filter.name == "gaussian" || filter.name == "depth";
}

/// The shot in another pose; nothing where either is not plain.
std::optional<RandomShot> in_pose(const RandomShot& shot, const Pose& pose) {
  RandomShot other = shot;
  other.pose = pose;
  if (!shot.is_plain() || !other.is_plain()) return std::nullopt;
  return other;
}

Pose scaled(Pose pose, double by) {
  pose.unit *= by, pose.origin *= by;
  return pose;
}

/// The shot twice, with and without all its lengths times `by`: also those that its method has as
/// parameters, and none of a filter. Nothing where a pose is not plain or a parameter too large.
std::optional<std::pair<RandomShot, RandomShot>> in_two_units(const Subject& s, double by) {
  RandomShot one = s.shot;
  const Plan& plan = s.frame.plan;
  if (has_unit(plan)) one.options.model.filter = "none";
  auto other = in_pose(one, scaled(one.pose, by));
  if (!other) return std::nullopt;
  for (const Parameter& p : plan.method->parameters) {
    if (p.unit != "units") continue;
    const double value = by * plan.request.parameters.at(std::string(p.name));
    if (value < p.low || value > p.high) return std::nullopt;
    other->options.model.set.push_back(fmt::format("{}={:.17g}", p.name, value));
  }
  return std::pair{one, *other};
}

Measured change_of_ao(const Subject& s, const Pose& pose) {
  const auto other = in_pose(s.shot, pose);
  if (!other) return std::nullopt;
  return mean_change_of_ao(relit(s.frame.scene, s.frame.plan), products_of_shot(*other));
}

/// Least distance of a point in camera space from the planes through the eye and the sides of the
/// middles of a window's outermost pixels.
double distance_to_sides(const Camera& camera, const Window& window, const glm::dvec3& p) {
  double least = HUGE_VAL;
  const auto side = [&](double f, double c, double edge, double across) {
    const double distance =
        camera.orthographic ? std::abs(across - (edge - c) / f)
                            : std::abs(f * across - (edge - c) * -p.z) / std::hypot(f, edge - c);
    least = std::min(least, distance);
  };
  side(camera.fx, camera.cx, window.x0 + 0.5, p.x);
  side(camera.fx, camera.cx, window.x1 - 0.5, p.x);
  side(-camera.fy, camera.cy, window.y0 + 0.5, p.y);
  side(-camera.fy, camera.cy, window.y1 - 0.5, p.y);
  return least;
}

/// A shot with all that a crop would change given: radius, thickness, light of one colour.
RandomShot with_all_given(RandomShot shot, RandomNumbers& random) {
  ModelOptions& model = shot.options.model;
  double depth = 0;
  for (const SeenPoint& p : shot.seen.pixels) depth = std::max(depth, -p.position.z);
  const double pixel = (shot.lens.camera.orthographic ? 1 : depth) / shot.lens.camera.fx;
  model.radius = pixel * random.by_ratio(0.1, 1.5);
  if (find_method(model.method).supports.thickness)
    model.thickness = pixel * random.by_ratio(0.1, 10);
  model.quality = Quality::standard;
  model.slices.reset(), model.steps.reset();
  model.filter = "none";
  const bool bounces = find_method(model.method).products.bounce && random.chance(0.5);
  model.bounces = bounces;
  model.error.reset();
  shot.map = {};
  shot.options.light = {};
  shot.options.output = {};
  shot.options.output.products = {"ao", "direct"};
  if (bounces) shot.options.output.products.push_back("bounce");
  return shot;
}

}  // namespace

Measured change_in_units_of_a_power_of_two(const Subject& s) {
  const auto shots = in_two_units(s, std::exp2(RandomNumbers(s.shot.seed + 2).whole(-12, 8)));
  if (!shots) return std::nullopt;
  return largest_change(products_of_shot(shots->first), products_of_shot(shots->second));
}

Measured change_in_other_units(const Subject& s) {
  const auto shots = in_two_units(s, RandomNumbers(s.shot.seed + 3).by_ratio(1e-3, 1e2));
  if (!shots) return std::nullopt;
  return mean_change_of_ao(products_of_shot(shots->first), products_of_shot(shots->second));
}

Measured change_in_a_turned_world(const Subject& s) {
  RandomNumbers random(s.shot.seed + 4);
  const glm::dmat3 turn = random_rotation(random);
  Pose pose = s.shot.pose;
  pose.to_world = turn * pose.to_world;
  pose.origin = turn * pose.origin;
  return change_of_ao(s, pose);
}

Measured change_in_a_moved_world(const Subject& s) {
  RandomNumbers random(s.shot.seed + 5);
  Pose pose = s.shot.pose;
  pose.origin += random.direction() * (10 * pose.unit);
  return change_of_ao(s, pose);
}

/// Pixels that are far enough from the new sides keep their bits. That is farther than the radius
/// by a step, as a sample stands for what is around it; of a bounce, twice as far, as what sends
/// has its own radius. The points of ssao-fade lie up to five radii away, and its pixels are means
/// of those around them, which may be nearer. Not with msvo, which looks as far as the frame goes.
/// Of most random frames no pixel is that far inside: the shot is made three times as fine.
Measured change_by_a_crop(const Subject& s) {
  const RandomShot shot = random_shot(s.shot.seed, 3);
  if (!shot.is_plain() || !find_method(shot.options.model.method).supports.radius)
    return std::nullopt;
  RandomNumbers random(shot.seed + 6);
  const RandomShot whole = with_all_given(shot, random);
  const Window& all = shot.lens.data;
  const Window part{all.x0 + random.whole(0, 2), all.y0 + random.whole(0, 2),
                    all.x1 - random.whole(0, 2), all.y1 - random.whole(0, 2)};
  if (part.width() < 1 || part.height() < 1) return std::nullopt;
  const Products of_all = products_of_shot(whole), of_part = products_of_shot(cropped(whole, part));
  const Camera& camera = shot.lens.camera;
  const ModelOptions& model = whole.options.model;
  const bool is_fade = model.method == "ssao-fade";
  const int around = is_fade ? 3 : 0;
  const auto is_inside = [&](int left, int top) {
    const SeenPoint& p = whole.seen(left, top);
    const double depth = camera.orthographic ? 1 : -p.position.z,
                 pixel = depth / std::min(camera.fx, camera.fy),
                 reach = (1 + model.bounces) * ((is_fade ? 5 : 2) * *model.radius + 4 * pixel);
    return !p.surface || distance_to_sides(camera, part, p.position) >= reach;
  };
  bool compared = false;
  Worst worst;
  for (int y = around; y < part.height() - around; ++y) {
    for (int x = around; x < part.width() - around; ++x) {
      const int left = x + part.x0 - all.x0, top = y + part.y0 - all.y0;
      bool inside = whole.seen(left, top).surface;
      for (int dy = -around; dy <= around; ++dy)
        for (int dx = -around; dx <= around; ++dx)
          inside = inside && is_inside(left + dx, top + dy);
      if (!inside) continue;
      compared = true;
      for_each_plane(
          [&](const Product& product, const auto& one, const auto& other) {
            if (one.empty()) return;
            worst.see(!(one(left, top) == other(x, y)),
                      [&] { return fmt::format("{} of pixel {}, {}", product.name, x, y); });
          },
          of_all, of_part);
    }
  }
  return compared ? Measured(worst) : std::nullopt;
}

}  // namespace ssdo::test
