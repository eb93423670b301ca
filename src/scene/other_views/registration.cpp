// SPDX-License-Identifier: Apache-2.0
//
// P of another view may be in another unit, have y up in place of z, or be of another scene.
// Whether it fits is tested where both cameras look: a sample of one picture, seen from the other
// camera, lies
//
// - on a surface that the other picture shows: they share it;
// - before it: they contradict each other, for the other camera would see the sample;
// - behind it, or out of the picture: nothing is known.
//
// Among the samples that are shared or contradictory, the share of shared ones is near 1 for every
// view of the scene, also for a view from behind, which shares few of its pixels. Worlds differ by
// a unit, by which axis is up and by the signs of the axes: all of these that keep camera space
// right-handed are tried.
#include "scene/other_views/registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "scene/normals/normals.h"
#include "scene/other_views/back_faces.h"
#include "scene/other_views/sight.h"
#include "scene/pixel_footprint.h"

namespace ssdo {
namespace {

/// The approximate number of pixels that are sampled in a picture.
constexpr int kSamples = 1500;

/// Pixels more than this many times as wide as the other picture's are not compared: from far
/// enough away, everything is in one place.
constexpr double kCoarsest = 10;

/// Least cosine between a surface and the way to a camera that sees it.
constexpr float kLeastFacing = 0.2f;

/// Fewest samples in all, and on one side, from which agreement is judged.
constexpr std::size_t kFewest = 30, kFewestOfSide = 20;

/// A view fits as stored if share() is at least kLeastShared, or if kLeastOfAll of all samples are
/// shared: the rest is then taken for things that have moved. Another unit or other axes fit if
/// share() is at least kLeastOfOtherWorld over two sides or more, and the shared samples are at
/// least kLeastOfFrame of those of the frame. Views of five scenes of Cycles share 0.95 and more,
/// panoramas of the other scenes 0.02 to 0.71, and one 0.90.
constexpr double kLeastShared = 0.75, kLeastOfAll = 0.9, kLeastOfOtherWorld = 0.9,
                 kLeastOfFrame = 0.5;

/// Metres, millimetres, centimetres and decimetres, inches and feet in one another.
constexpr std::array<double, 17> kUnits = {1,          0.01,   100,        0.1,  10,       0.001,
                                           1000,       0.0254, 1 / 0.0254, 2.54, 1 / 2.54, 0.3048,
                                           1 / 0.3048, 30.48,  1 / 30.48,  12,   1.0 / 12};

/// Surfaces as a camera sees them.
struct Shown {
  const Camera& camera;  ///< from the space of points to its own, in the unit of `surfaces` * unit
  double unit;
  const Surfaces& surfaces;  ///< in its own camera space
  Window window;
  bool closed;

  float footprint(double depth) const {
    return float((camera.orthographic ? 1.0 : depth) / std::min(camera.fx, camera.fy));
  }

  /// What this camera knows of the surface at `p`, with the unit normal `n` on the side that is
  /// seen. `width` is what a pixel of the other camera covers there.
  enum class Sees { nothing, it, past_it };
  Sees look_at(const glm::dvec3& p, const glm::dvec3& n, double rounding, double width) const {
    const glm::dvec3 own = camera.to_camera(p), normal = camera.rotation * n;
    const double depth = camera.depth_of(own);
    if (!camera.orthographic && !(depth > 0)) return Sees::nothing;
    const glm::dvec3 to_viewer =
        camera.orthographic ? glm::dvec3(0, 0, 1) : -own / glm::length(own);
    if (!(glm::dot(normal, to_viewer) > double(kLeastFacing))) return Sees::nothing;
    const glm::dvec2 at = camera.project(own);
    const double px = std::floor(at.x - window.x0), py = std::floor(at.y - window.y0);
    if (!(px >= 0 && py >= 0 && px < surfaces.width && py < surfaces.height)) return Sees::nothing;
    if (double(footprint(depth)) > kCoarsest * width) return Sees::nothing;
    const double tolerance = double(kSurfaceTolerance * footprint(depth)) + rounding;
    bool past = true;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        int x = int(px) + dx;
        if (closed) x = (x + surfaces.width) % surfaces.width;
        const auto s = surface_at(surfaces, x, int(py) + dy);
        if (!s) continue;
        const glm::dvec3 place = unit * glm::dvec3(s->position), facing(s->normal);
        const double most = tolerance + unit * double(s->rounding);
        if (glm::dot(facing, normal) > 0 && std::abs(glm::dot(own - place, facing)) <= most)
          return Sees::it;
        past = past && camera.depth_of(place) > depth + tolerance;
      }
    }
    return past ? Sees::past_it : Sees::nothing;
  }
};

/// Surfaces of a picture, evenly spread, in their own camera space.
std::vector<Surfel> samples_of(const Surfaces& surfaces) {
  const int apart = std::max(1, int(std::sqrt(double(surfaces.size()) / kSamples)));
  std::vector<Surfel> samples;
  for (int y = apart / 2; y < surfaces.height; y += apart) {
    for (int x = apart / 2; x < surfaces.width; x += apart)
      if (surfaces(x, y).is_surface()) samples.push_back(surfaces(x, y));
  }
  return samples;
}

/// Compares samples of each picture with the other picture.
class Comparison {
 public:
  Comparison(const OtherPicture& picture, const Geometry& frame)
      : picture_(picture),
        frame_(frame),
        of_view_(samples_of(picture.surfaces)),
        of_frame_(samples_of(frame.surfaces)),
        own_(frame.camera) {
    own_.rotation = glm::dmat3(1), own_.origin = glm::dvec3(0);
  }

  std::size_t of_frame() const { return of_frame_.size(); }

  /// How well a view agrees with the frame if it has this camera and its lengths are multiplied by
  /// `unit`.
  Agreement of(const Camera& camera, double unit) const {
    Agreement found;
    const auto count = [&](Shown::Sees sees, const glm::dvec3& normal) {
      Agreement::Side& side = found.sides[side_of(normal)];
      side.shared += sees == Shown::Sees::it;
      side.contradictory += sees == Shown::Sees::past_it;
    };
    const Shown view{camera, unit, picture_.surfaces, picture_.window, picture_.closed},
        frame{own_, 1, frame_.surfaces, frame_.window, false};
    for (const Surfel& s : of_frame_) {
      const glm::dvec3 p(s.position), n(s.normal);
      count(view.look_at(p, n, double(s.rounding), frame.footprint(own_.depth_of(p))), n);
    }
    const glm::dmat3 to_frame = glm::transpose(camera.rotation);
    for (const Surfel& s : of_view_) {
      const glm::dvec3 p = to_frame * (unit * glm::dvec3(s.position)) + camera.origin;
      const glm::dvec3 n = to_frame * glm::dvec3(s.normal);
      const double width = view.footprint(unit * camera.depth_of(glm::dvec3(s.position)));
      count(frame.look_at(p, n, unit * double(s.rounding), width), n);
    }
    return found;
  }

 private:
  /// The side of a cube that a normal points to, 0 to 5.
  static std::size_t side_of(const glm::dvec3& normal) {
    const glm::dvec3 size = glm::abs(normal);
    const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    return std::size_t(2 * axis + (normal[axis] < 0));
  }

  const OtherPicture& picture_;
  const Geometry& frame_;
  const std::vector<Surfel> of_view_, of_frame_;
  Camera own_;
};

/// p of the frame's world = unit * axes * p of the view's.
struct OtherWorld {
  double unit;
  glm::dmat3 axes;
};

/// The camera of a picture for P in the frame's world.
Camera in_world(Camera camera, const OtherWorld& world) {
  if (camera.orthographic) camera.fx /= world.unit, camera.fy /= world.unit;
  camera.origin = world.unit * (world.axes * camera.origin);
  camera.rotation = camera.rotation * glm::transpose(world.axes);
  return camera;
}

OtherView::Picture in_world(const OtherPicture& picture, const OtherWorld& world) {
  OtherPicture out = picture;
  out.camera = in_world(picture.camera, world);
  const auto unit = float(world.unit);
  out.surfaces.change_each([unit](Surfel& s) {
    s.position *= unit;
    if (s.is_surface()) s.rounding *= unit;
  });
  for (float& depth : out.depth.pixels) depth *= unit;
  return std::make_shared<const OtherPicture>(std::move(out));
}

/// y up or z up, with any signs; the unchanged first.
std::vector<glm::dmat3> all_axes() {
  std::vector<glm::dmat3> all;
  for (const auto& order : {std::array{0, 1, 2}, std::array{0, 2, 1}}) {
    for (int signs = 0; signs < 8; ++signs) {
      glm::dmat3 axes(0);
      for (int row = 0; row < 3; ++row)
        axes[order[std::size_t(row)]][row] = signs >> row & 1 ? -1 : 1;
      all.push_back(axes);
    }
  }
  return all;
}

/// Whether axes are turned by 180 degrees. No two tools differ by that, and in a symmetric room a
/// view in the opposite direction would fit.
bool is_half_turn(const glm::dmat3& axes) {
  const bool keeps_axes = axes[0][0] != 0 && axes[1][1] != 0 && axes[2][2] != 0;
  return keeps_axes && axes != glm::dmat3(1) && glm::determinant(axes) > 0;
}

/// "(x, -z, y)"
std::string describe(const glm::dmat3& axes) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (axes[column][row] == 0) continue;
      text +=
          fmt::format("{}{}{}", row ? ", " : "(", axes[column][row] < 0 ? "-" : "", "xyz"[column]);
    }
  }
  return text + ")";
}

std::string describe(const OtherWorld& world) {
  const bool turned = world.axes != glm::dmat3(1);
  if (world.unit == 1) return "P taken as " + describe(world.axes);
  return fmt::format("P taken {:.4g} times as large{}", world.unit,
                     turned ? " and as " + describe(world.axes) : "");
}

bool contradicts(const Agreement& found) {
  return found.all() >= kFewest && found.share() < kLeastShared &&
         double(found.shared()) < kLeastOfAll * double(found.all());
}

/// Needs more than one side: a single flat surface fits in many worlds.
bool fits_well(const Agreement& found, std::size_t of_frame) {
  return double(found.shared()) >= kLeastOfFrame * double(of_frame) && found.known_sides() > 1 &&
         found.share() >= kLeastOfOtherWorld;
}

}  // namespace

std::size_t Agreement::shared() const {
  std::size_t sum = 0;
  for (const Side& side : sides) sum += side.shared;
  return sum;
}

std::size_t Agreement::all() const {
  std::size_t sum = 0;
  for (const Side& side : sides) sum += side.all();
  return sum;
}

int Agreement::known_sides() const {
  return int(std::count_if(sides.begin(), sides.end(),
                           [](const Side& side) { return side.all() >= kFewestOfSide; }));
}

double Agreement::share() const {
  if (known_sides() == 0) return double(shared()) / double(std::max<std::size_t>(all(), 1));
  double sum = 0;
  for (const Side& side : sides)
    if (side.all() >= kFewestOfSide) sum += double(side.shared) / double(side.all());
  return sum / known_sides();
}

Registration register_view(OtherView view, const Geometry& frame) {
  const Comparison comparison(*view.picture, frame);
  const Agreement own = comparison.of(view.camera, 1);
  if (own.all() >= kFewest && !contradicts(own)) return {std::move(view), {}};
  const std::string& file = view.picture->file;
  Agreement best;
  std::optional<OtherWorld> fits;
  for (const glm::dmat3& axes : all_axes()) {
    if (is_half_turn(axes)) continue;
    for (const double unit : kUnits) {
      const OtherWorld world{unit, axes};
      const Camera camera = seen_from(in_world(view.picture->camera, world), frame.camera);
      if (glm::determinant(camera.rotation) < 0) continue;
      const Agreement found = comparison.of(camera, unit);
      if (!fits_well(found, comparison.of_frame()) || found.shared() <= best.shared()) continue;
      best = found, fits = world;
    }
  }
  if (fits) {
    return {place(in_world(*view.picture, *fits), frame),
            fmt::format("{}: {}: {:.0f} % of what it and the frame should both show then agrees, "
                        "{:.0f} % as stored; render it in the unit and axes of the frame",
                        file, describe(*fits), 100 * best.share(), 100 * own.share())};
  }
  if (!contradicts(own)) return {std::move(view), {}};
  return {std::nullopt,
          fmt::format("{}: left out: {:.0f} % of what it and the frame should both show fits, and "
                      "no more in other units or axes; give a view of the same scene, at the same "
                      "time",
                      file, 100 * own.share())};
}

}  // namespace ssdo
