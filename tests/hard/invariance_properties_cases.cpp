// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>

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

/// Filters gaussian and depth have limits in scene units, and so have parameters of methods, as in
/// their sources: the far plane of msvo, the largest distance of hbao where there is one.
bool has_unit(const Plan& plan) {
  const auto& parameters = plan.method->parameters;
  return plan.filter->name == "gaussian" || plan.filter->name == "depth" || plan.half_filter ||
         std::any_of(parameters.begin(), parameters.end(), [&](const Parameter& p) {
           return p.unit == "units" && plan.request.parameters.at(std::string(p.name)) != 0;
         });
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
  if (find_method(model.method).takes.thickness) model.thickness = pixel * random.by_ratio(0.1, 10);
  model.quality = Quality::standard;
  model.slices.reset(), model.steps.reset();
  model.filter = "none";
  model.bounces = 0;
  model.error.reset();
  shot.map = {};
  shot.options.light = {};
  shot.options.output = {};
  shot.options.output.products = {"ao", "direct"};
  return shot;
}

}  // namespace

Measured change_in_units_of_a_power_of_two(const Subject& s) {
  const double by = std::exp2(RandomNumbers(s.shot.seed + 2).whole(-12, 8));
  const auto other = in_pose(s.shot, scaled(s.shot.pose, by));
  if (!other || has_unit(s.frame.plan)) return std::nullopt;
  return largest_change(relit(s.frame.scene, s.frame.plan), products_of_shot(*other));
}

Measured change_in_other_units(const Subject& s) {
  if (has_unit(s.frame.plan)) return std::nullopt;
  return change_of_ao(s, scaled(s.shot.pose, RandomNumbers(s.shot.seed + 3).by_ratio(1e-3, 1e2)));
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
/// by a step, as a sample stands for what is around it, or by two pixels of half the resolution.
/// Not with msvo, which looks as far as the frame goes.
Measured change_by_a_crop(const Subject& s) {
  const Window& all = s.shot.lens.data;
  const bool has_radius = s.frame.plan.method->takes.radius;
  if (!s.shot.is_plain() || !has_radius || all.width() < 6 || all.height() < 6) return std::nullopt;
  RandomNumbers random(s.shot.seed + 6);
  const RandomShot whole = with_all_given(s.shot, random);
  const Window part{all.x0 + random.whole(0, 2), all.y0 + random.whole(0, 2),
                    all.x1 - random.whole(0, 2), all.y1 - random.whole(0, 2)};
  const Products of_all = products_of_shot(whole), of_part = products_of_shot(cropped(whole, part));
  const Camera& camera = s.shot.lens.camera;
  const double radius = *whole.options.model.radius;
  Worst worst;
  for (int y = 0; y < part.height(); ++y) {
    for (int x = 0; x < part.width(); ++x) {
      const int left = x + part.x0 - all.x0, top = y + part.y0 - all.y0;
      const SeenPoint& p = whole.seen(left, top);
      const double pixel =
                       (camera.orthographic ? 1 : -p.position.z) / std::min(camera.fx, camera.fy),
                   far_enough = 2 * radius + 4 * pixel;
      if (!p.surface || distance_to_sides(camera, part, p.position) < far_enough) continue;
      const float one = of_all.ao(left, top), other = of_part.ao(x, y);
      worst.see(std::abs(one - other),
                [&] { return fmt::format("ao at {}, {} is {} and {}", x, y, one, other); });
    }
  }
  return worst;
}

}  // namespace ssdo::test
