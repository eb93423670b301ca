// SPDX-License-Identifier: Apache-2.0
//
// A single depth layer tells neither how thick objects are nor what lies behind them. This is the
// largest error of all screen-space light, an order of magnitude above sampling noise. Two guesses
// are made, both from runs: pixels along a line of the frame that show one surface.
//
// - Objects are kDepthOfWidth times as thick as they are wide. The width at a pixel is the least
//   length, in space, of the runs through it in four directions (rows, columns, diagonals). A run
//   with one end behind something nearer, or at the border of the frame, shows only a part of the
//   object: its length counts kPartlySeen times. With two such ends the width is unknown. So walls
//   and grounds are endless, blades of grass are thin, and a box is about as deep as it is wide.
//
//   The pixel grid makes the runs across a straight, tilted post differ by a pixel, which is a
//   large part of the width of a side that is seen edge-on. Where a nearer object meets the post in
//   the picture, runs show only a part of it. The shadow of such a post under a sun would be a
//   comb. So the width of a run is the mean over the runs beside it that are about as long, up to
//   kWidthReach to each side. Runs that are seen whole give the width of those that are not.
//
//   The sides of an object may tell more (scene/solids/shown_depth.h): a board whose side should be
//   seen, but is not, is thin, and a box is as deep as its side is long. Across a run, the depth
//   follows the shape of the object (depth_across.cpp). No surface is so thin that it is open
//   between a pixel and the next.
//
// - Surfaces go on as a second layer. Where a run ends and something farther begins, the farther
//   surface continues behind the run as its tangent plane. Each pixel takes the surface that
//   reaches it from the nearest end of its runs.
//
// Measured against path-traced occlusion on the seven frames that this was developed with: see man
// ssdo-methods.
#include "scene/solids/solids.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>

#include "math/infinity.h"
#include "math/pixel_grid.h"
#include "parallel/planes.h"
#include "parallel/tiles.h"
#include "scene/normals/normals.h"
#include "scene/pixel_footprint.h"
#include "scene/solids/connections.h"
#include "scene/solids/depth_across.h"
#include "scene/solids/shown_depth.h"
#include "scene/solids/width_of_run.h"

namespace ssdo {
namespace {

/// Factor on the width of a run of which only one end is seen. Mean over four scenes of Cycles:
/// with 1.5, 3 and 6 the RMSE of ao is 0.072, 0.071 and 0.073 at a small radius and 0.134, 0.136
/// and 0.139 without one, the relative error of direct light 0.411, 0.418 and 0.430. So it matters
/// little: no value is the best for all of them, and 3 is for occluders nearby.
constexpr float kPartlySeen = 3;

/// How the surface of a pixel meets the next pixel of its line that shows another one, or none.
enum class Meets : unsigned char {
  ends,         ///< before something farther, or nothing
  goes_behind,  ///< something nearer
  border,
  cut,  ///< where the known rows end, but not the frame
};

/// A normal was rebuilt from a neighbour's P if this lies so few footprints off the tangent plane.
constexpr float kOnPlane = 0.05f;

/// Lines to each side of a partly seen run in which runs that are seen whole give its width.
constexpr int kReachOfPart = 4 * kWidthReach;

/// Weight of the own width of a partly seen run; runs that are seen whole weigh up to 1.
constexpr float kWeightOfPart = 0.02f;

/// A run of pixels of one surface, as far as a walk along its line has come.
struct Run {
  bool goes_on = false;   ///< to the next pixel of the walk
  std::size_t first = 0;  ///< pixel
  int pixels = 0;         ///< so far
  Meets meets_before = Meets::border;
  float depth = kInfinity;            ///< guessed, of what the run shows, in the mean
  std::optional<DepthAcross> across;  ///< by pixel; empty: `depth` in all

  // The surface that continues behind the run, from where the walk entered it.
  int sender = -1;  ///< pixel that shows it; -1: none does
  int away = 0;     ///< pixels from there
  glm::vec3 point{0}, normal{0};
};

struct Pixel {
  int x, y;
};

/// The runs of one direction.
struct Runs {
  Plane<int> starts;         ///< the first pixel of each pixel's run
  Plane<WidthOfRun> widths;  ///< at these
};

/// What was found along the lines of the directions so far.
struct Guess {
  Plane<float> thickness;    ///< the least
  Plane<float> distance_px;  ///< from where the surface behind comes
  SolidLayer second;
};

/// Guesses along the lines of one direction: forward to measure the runs and to continue what is
/// before them, then back to use their widths and to continue what is after them. Lines side by
/// side are walked together, so that memory is read in its order.
class GuessAlongLines {
 public:
  GuessAlongLines(const Geometry& geometry, const Plane<unsigned char>& connections, std::size_t k,
                  const std::optional<SolidsOfOverview>& overview, Runs& runs, Guess& out)
      : geometry_(geometry),
        overview_(overview),
        connections_(connections),
        k_(k),
        direction_(kDirections[k]),
        step_px_(direction_.dx != 0 && direction_.dy != 0 ? 1.41421356f : 1.0f),
        footprint_(geometry.camera),
        starts_(runs.starts),
        widths_(runs.widths),
        out_(out) {}

  /// All lines, which share no pixels. Widths are averaged over lines, when all are measured.
  void run() const {
    for_each_line([this](Run& run, int x, int y) { go_forward(run, x, y); }, false);
    for_each_row(connections_.height, [this](int y) {
      for (std::size_t i = connections_.index(0, y); i < connections_.index(0, y + 1); ++i) {
        const bool starts = connections_[i] & kShowsSurface && starts_[i] == int(i);
        if (starts && widths_[i].is_whole) limit_depth(i);
      }
    });
    for_each_line([this](Run& run, int x, int y) { go_back(run, x, y); }, true);
  }

 private:
  /// Lines that are walked together: their connections in a row fill a cache line.
  static constexpr int kTogether = 64;

  template <class Visit>
  void for_each_line(const Visit& visit, bool back) const {
    const int w = geometry_.surfaces.width, h = geometry_.surfaces.height;
    if (direction_.dy == 0) {
      return for_each_row(h, [&](int y) {
        Run run;
        for (int i = 0; i < w; ++i) visit(run, back ? w - 1 - i : i, y);
      });
    }
    // Lines that begin in the first row, and in the column that the others come from.
    const int lines = w + (direction_.dx == 0 ? 0 : h - 1);
    for_each_task(std::size_t((lines + kTogether - 1) / kTogether), [&](std::size_t strip) {
      std::vector<Run> runs(kTogether);
      const int left = int(strip) * kTogether - (direction_.dx > 0 ? h - 1 : 0);
      for (int i = 0; i < h; ++i) {
        const int y = back ? h - 1 - i : i, first = left + direction_.dx * y;
        for (int x = std::max(0, first); x < std::min(w, first + kTogether); ++x)
          visit(runs[std::size_t(x - first)], x, y);
      }
    });
  }

  void go_forward(Run& run, int x, int y) const {
    const std::size_t pixel = connections_.index(x, y);
    const unsigned char here = connections_[pixel];
    if (!(here & kShowsSurface)) return;
    if (!run.goes_on) {
      run.first = pixel;
      run.pixels = 0;
      run.meets_before = enter(run, pixel, x - direction_.dx, y - direction_.dy, false);
    }
    continue_behind(run, pixel);
    starts_[pixel] = int(run.first);
    ++run.pixels;
    run.goes_on = here >> k_ & 1;
    if (run.goes_on) return;
    const Meets after = meet(pixel, x + direction_.dx, y + direction_.dy, true);
    widths_[run.first] = width_of(run, pixel, after);
  }

  void go_back(Run& run, int x, int y) const {
    const std::size_t pixel = connections_.index(x, y);
    const unsigned char here = connections_[pixel];
    if (!(here & kShowsSurface)) return;
    const bool is_last = !(here >> k_ & 1);
    if (is_last) {
      enter(run, pixel, x + direction_.dx, y + direction_.dy, true);
      run.depth = depth_beside(pixel);
      run.across = depth_across(pixel, run.depth);
    }
    const float depth = run.across              ? run.across->at(place_in_run(pixel))
                        : run.depth == kUnknown ? depth_in_overview(*overview_, geometry_, x, y)
                                                : run.depth;
    float& least = out_.thickness[pixel];
    if (depth < kInfinity) least = std::min(least, depth);
    continue_behind(run, pixel);
  }

  std::ptrdiff_t stride() const {
    return direction_.dy * std::ptrdiff_t(connections_.width) + direction_.dx;
  }

  /// Limits the depth of a run that is seen whole by shown_depth(). The ends of the runs beside it
  /// that are about as long show its silhouettes.
  void limit_depth(std::size_t start) const {
    WidthOfRun& own = widths_[start];
    WholeRun run{start, stride(), own.pixels, step_px_};
    const auto add_edges = [&](int side) {
      int farthest = int(start);
      Pixel at = middle_of_run(farthest);
      for (int i = 1; i <= kWidthReach && steps_along(at, k_ ^ 1, side); ++i) {
        const int next = starts_(at.x, at.y);
        if (likeness(own, widths_[std::size_t(next)]) <= 0) break;
        farthest = next, at = middle_of_run(next);
        ++run.lines;
      }
      const auto last =
          std::size_t(farthest + (widths_[std::size_t(farthest)].pixels - 1) * stride());
      run.first_edge += float(side) * geometry_.surfaces[std::size_t(farthest)].position;
      run.last_edge += float(side) * geometry_.surfaces[last].position;
    };
    add_edges(-1), add_edges(1);
    const MeanDepth found = shown_depth(geometry_, run);
    own.depth = std::min(own.depth, found.most);
    own.shown = found.shown;
  }

  /// The harmonic mean of the depths of a pixel's run and those beside it: some may be infinite.
  float depth_beside(std::size_t pixel) const {
    const WidthOfRun& own = widths_[std::size_t(starts_[pixel])];
    if (own.depth == kUnknown) return kUnknown;
    const int reach = own.is_whole ? kWidthReach : kReachOfPart;
    float weights = own.is_whole ? 1 : kWeightOfPart, sum = weights / own.depth;
    for (const int side : {-1, 1}) {
      Pixel at = middle_of_run(starts_[pixel]);
      for (int i = 1; i <= reach && steps_along(at, k_ ^ 1, side); ++i) {
        const int start = starts_(at.x, at.y);
        const WidthOfRun& beside = widths_[std::size_t(start)];
        const float alike = likeness(own, beside);
        if (alike <= 0) break;
        at = middle_of_run(start);
        if (!beside.is_whole) continue;
        const float weight = alike * (1 - float(i) / float(reach + 1));
        weights += weight, sum += weight / beside.depth;
      }
    }
    return weights / sum;
  }

  /// How the mean depth of a run changes across it; empty where it is not seen whole: then what is
  /// hidden of it is not known.
  std::optional<DepthAcross> depth_across(std::size_t pixel, float mean) const {
    const auto start = std::size_t(starts_[pixel]);
    const WidthOfRun& own = widths_[start];
    if (!own.is_whole || own.pixels < 2 || !(mean < kInfinity)) return {};
    return DepthAcross(geometry_, {start, stride(), own.pixels, step_px_}, {mean, own.shown});
  }

  int place_in_run(std::size_t pixel) const {
    return int((std::ptrdiff_t(pixel) - std::ptrdiff_t(starts_[pixel])) / stride());
  }

  Pixel middle_of_run(int start) const {
    const int w = connections_.width, steps = widths_[std::size_t(start)].pixels / 2;
    return {start % w + steps * direction_.dx, start / w + steps * direction_.dy};
  }

  /// Moves to the next pixel in a direction, or against it; false if the surface ends before.
  bool steps_along(Pixel& at, std::size_t k, int side) const {
    const Pixel from = at;
    at = {at.x + side * kDirections[k].dx, at.y + side * kDirections[k].dy};
    if (at.x < 0 || at.x >= connections_.width || at.y < 0 || at.y >= connections_.height)
      return false;
    const Pixel& first = side > 0 ? from : at;
    return connections_(first.x, first.y) >> k & 1;
  }

  /// How the surface of a pixel meets a neighbour, which is on another surface or on none. At equal
  /// depths, the earlier pixel of the line goes behind the later one.
  Meets meet(std::size_t pixel, int x, int y, bool is_after) const {
    const Surfaces& surfaces = geometry_.surfaces;
    if (x < 0 || x >= surfaces.width) return Meets::border;
    if (y < 0 || y >= surfaces.height) return frame_goes_on(y) ? Meets::cut : Meets::border;
    const Surfel &here = surfaces[pixel], &other = surfaces(x, y);
    if (!other.is_surface()) return Meets::ends;
    const bool before_other =
        is_after ? here.position.z > other.position.z : here.position.z >= other.position.z;
    return before_other ? Meets::ends : Meets::goes_behind;
  }

  /// Whether the frame goes on to row `y`, outside of the raster.
  bool frame_goes_on(int y) const {
    if (!overview_ || !geometry_.part_of) return false;
    return y < 0 ? geometry_.window.y0 > geometry_.part_of->y0
                 : geometry_.window.y1 < geometry_.part_of->y1;
  }

  /// Whether the normal of a pixel was rebuilt from P across the step to another surface. Where a
  /// surface is seen through a slit one pixel wide, its tangent plane is not known.
  bool leans_on_an_edge(int x, int y) const {
    const Surfel& here = geometry_.surfaces(x, y);
    for (const std::size_t axis : {0, 1}) {
      bool joined = false, leans = false;
      for (const int side : {-1, 1}) {
        Pixel at{x, y};
        joined = joined || steps_along(at, axis, side);
        const auto beside = surface_at(geometry_.surfaces, at.x, at.y);
        leans =
            leans || (beside && std::abs(glm::dot(beside->position - here.position, here.normal)) <=
                                    kOnPlane * footprint_.at(-here.position.z));
      }
      if (!joined && leans) return true;
    }
    return false;
  }

  /// Enters a run at `pixel`, coming from (x, y).
  Meets enter(Run& run, std::size_t pixel, int x, int y, bool is_after) const {
    const Meets meets = meet(pixel, x, y, is_after);
    run.away = 0;
    run.sender = -1;
    if (meets != Meets::ends || !geometry_.surfaces(x, y).is_surface()) return meets;
    if (leans_on_an_edge(x, y)) return meets;
    const Surfel& beyond = geometry_.surfaces(x, y);
    run.sender = int(geometry_.surfaces.index(x, y));
    run.point = beyond.position, run.normal = beyond.normal;
    return meets;
  }

  WidthOfRun width_of(const Run& run, std::size_t last_pixel, Meets after) const {
    WidthOfRun out{kInfinity, run.pixels};
    if (run.meets_before == Meets::cut || after == Meets::cut) {
      out.depth = kUnknown;
      return out;
    }
    const int unknown_ends = (run.meets_before != Meets::ends) + (after != Meets::ends);
    out.is_whole = unknown_ends == 0;
    if (unknown_ends == 2) return out;
    const Surfel &first = geometry_.surfaces[run.first], &last = geometry_.surfaces[last_pixel];
    const float between = glm::distance(first.position, last.position);
    const float ends =
        0.5f * step_px_ * (footprint_.at(-first.position.z) + footprint_.at(-last.position.z));
    out.depth = kDepthOfWidth * (between + ends) * (out.is_whole ? 1 : kPartlySeen);
    return out;
  }

  /// Continues the surface that the walk came from behind this pixel of the run, unless another
  /// surface reaches the pixel from a nearer end.
  void continue_behind(Run& run, std::size_t pixel) const {
    if (run.sender < 0) return;
    const float away_px = float(++run.away) * step_px_;
    if (away_px >= out_.distance_px[pixel]) return;
    const glm::vec3 front = geometry_.surfaces[pixel].position;
    const glm::vec3 along = -direction_to_viewer(front, geometry_.camera.orthographic);
    const float distance = glm::dot(run.normal, run.point - front) / glm::dot(run.normal, along);
    if (!(distance > 0 && distance < kInfinity)) return;
    out_.distance_px[pixel] = away_px;
    out_.second.distance[pixel] = distance;
    out_.second.sender[pixel] = run.sender;
  }

  const Geometry& geometry_;
  const std::optional<SolidsOfOverview>& overview_;
  const Plane<unsigned char>& connections_;
  std::size_t k_;
  Direction direction_;
  float step_px_;
  PixelFootprint footprint_;
  Plane<int>& starts_;
  Plane<WidthOfRun>& widths_;
  Guess& out_;
};

}  // namespace

Solids guess_solids(const Geometry& geometry, const std::optional<SolidsOfOverview>& overview) {
  const int w = geometry.surfaces.width, h = geometry.surfaces.height;
  Guess guess{filled(w, h, kInfinity), filled(w, h, kInfinity),
              SolidLayer(w, h, Provenance::guessed)};
  guess.second.thickness = {};  // a surface is as thick behind something as where it is seen
  const Plane<unsigned char> connections = find_connections(geometry);
  Runs runs{Plane<int>(w, h), Plane<WidthOfRun>(w, h)};
  for (std::size_t k = 0; k < kDirections.size(); ++k)
    GuessAlongLines(geometry, connections, k, overview, runs, guess).run();
  for_each_row(h, [&](int y) {
    for (std::size_t i = connections.index(0, y); i < connections.index(0, y + 1); ++i) {
      float& thickness = guess.thickness[i];
      if (thickness < kInfinity) thickness = std::max(thickness, least_depth(geometry, i));
    }
  });
  Solids solids{std::move(guess.thickness), {}, {}, {}};
  solids.behind.push_back(std::move(guess.second));
  return solids;
}

}  // namespace ssdo
