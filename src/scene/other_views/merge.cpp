// SPDX-License-Identifier: Apache-2.0
//
// A pixel of another view adds what it shows only where the frame does not show it:
//
// - What lies within kSurfaceTolerance footprints of a surface that the frame shows there is that
//   surface. The frame knows it better: coarse triangles would cut through the finer surface.
// - A surface before what the frame shows there would hide it. It has moved, and is dropped.
// - All else is new: behind what the frame shows, outside the frame, or the other side of a
//   surface. If several views show a place, the view with the finest pixels there adds it.
//
// Neighbouring pixels of a view are joined by the rule for pixels of the frame if they have the
// same Fate. Where they are not joined, each reaches half-way to the next on its own tangent plane:
// leaves and wires are single pixels of a small view, and would be lost between triangles.
#include "scene/other_views/merge.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numeric>

#include "parallel/tiles.h"
#include "scene/normals/normals.h"
#include "scene/other_views/sight.h"
#include "scene/pixel_footprint.h"
#include "scene/same_surface.h"

namespace ssdo {
namespace {

/// The most columns to which the frame is thinned as one of the surfaces that light other views.
constexpr int kFrameColumns = 320;

/// The other eye is of another scene if at least kFewestInCommon of its pixels should be seen by
/// the frame too, and less than kLeastInCommon of these are: as --temporal finds cuts.
constexpr std::size_t kFewestInCommon = 50;
constexpr double kLeastInCommon = 0.5;

/// Least share of the surfaces of the other eye that the frame shows too; less means another scene,
/// place or unit.
constexpr double kLeastSeenByOtherEye = 0.02;

enum class Fate : unsigned char { none, added, repeated, seen, contradictory };

class Merger {
 public:
  explicit Merger(const Geometry& frame) : frame_(frame), footprint_(frame.camera) {}

  /// Compares a view's surface with what the frame shows at its place.
  Fate judge(const Surfel& s) const {
    const glm::vec3 p = s.position;
    const bool ortho = frame_.camera.orthographic;
    if (!ortho && !(p.z < 0)) return Fate::added;
    const bool faces_away = glm::dot(s.normal, direction_to_viewer(p, ortho)) <= 0;
    const glm::dvec2 at = frame_.camera.project(glm::dvec3(p));
    const double px = std::floor(at.x - frame_.window.x0), py = std::floor(at.y - frame_.window.y0);
    if (!(px >= 0 && py >= 0 && px < frame_.surfaces.width && py < frame_.surfaces.height))
      return Fate::added;
    bool behind = false;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto shown = surface_at(frame_.surfaces, int(px) + dx, int(py) + dy);
        if (!shown) continue;
        const float tolerance =
            kSurfaceTolerance * footprint_.at(-shown->position.z) + s.rounding + shown->rounding;
        const bool faces = glm::dot(s.normal, shown->normal) > 0;
        if (!faces_away && faces &&
            std::abs(glm::dot(p - shown->position, shown->normal)) <= tolerance)
          return Fate::seen;
        // The frame sees the back of a sheet where the view sees its front, and solids have a rim.
        if (faces_away)
          behind |= -p.z > -shown->position.z - tolerance;
        else
          behind |= dx == 0 && dy == 0 && -p.z > -shown->position.z;
      }
    }
    return behind ? Fate::added : Fate::contradictory;
  }

 private:
  const Geometry& frame_;
  PixelFootprint footprint_;
};

/// A view, compared with the other views by how finely it shows a surface.
class Rival {
 public:
  explicit Rival(const OtherView& view) : view_(view) {}

  bool has_albedo() const { return !view_.picture->albedo.empty(); }

  /// Width, in scene units, that a pixel of the view covers on the surface `s`; infinite if the
  /// view sees this surface from behind or nearly edge-on.
  float width_of(const Surfel& s) const {
    const glm::dvec3 own = view_.camera.to_camera(glm::dvec3(s.position));
    return width_of(own, view_.camera.rotation * glm::dvec3(s.normal));
  }

  /// width_of() if the view shows this surface; else infinite.
  float width_if_shown(const Surfel& s) const {
    const Camera& camera = view_.camera;
    const glm::dvec3 own = camera.to_camera(glm::dvec3(s.position)),
                     normal = camera.rotation * glm::dvec3(s.normal);
    const float width = width_of(own, normal);
    if (width == kNowhere) return width;
    const glm::dvec2 at = camera.project(own);
    const Window& window = view_.picture->window;
    const double px = std::floor(at.x - window.x0), py = std::floor(at.y - window.y0);
    if (!(std::abs(px) < 1e6 && std::abs(py) < 1e6)) return kNowhere;
    const auto shown = surface_at(view_.picture->surfaces, int(px), int(py));
    if (!shown || glm::dot(glm::vec3(normal), shown->normal) < kAlike) return kNowhere;
    const float off =
        std::abs(glm::dot(glm::vec3(own - glm::dvec3(shown->position)), shown->normal));
    return off <= width + s.rounding + shown->rounding ? width : kNowhere;
  }

 private:
  static constexpr float kNowhere = std::numeric_limits<float>::infinity();
  static constexpr float kLeastFacing = 0.1f, kAlike = 0.7f;  ///< cosines

  float width_of(const glm::dvec3& own, const glm::dvec3& normal) const {
    const auto depth = float(view_.camera.depth_of(own));
    const float facing =
        glm::dot(glm::vec3(normal), direction_to_viewer(glm::vec3(own), view_.camera.orthographic));
    if (!(facing > kLeastFacing) || (!view_.camera.orthographic && !(depth > 0))) return kNowhere;
    return view_.footprint(depth) / facing;
  }

  const OtherView& view_;
};

/// Marks as repeated the pixels of view `k` whose surface another view shows more finely, or as
/// finely and earlier in the order. A view without albedo replaces none with albedo: its surfaces
/// send no light.
void leave_out_repeated(const std::vector<Rival>& rivals, std::size_t k, const Surfaces& surfaces,
                        Plane<Fate>& fates) {
  for_each_row(surfaces.height, [&](int y) {
    for (int x = 0; x < surfaces.width; ++x) {
      if (fates(x, y) != Fate::added) continue;
      const float own = rivals[k].width_of(surfaces(x, y));
      for (std::size_t j = 0; j < rivals.size(); ++j) {
        if (j == k || (rivals[k].has_albedo() && !rivals[j].has_albedo())) continue;
        const float other = rivals[j].width_if_shown(surfaces(x, y));
        if (other < own || (j < k && other == own && std::isfinite(other)))
          fates(x, y) = Fate::repeated;
      }
    }
  });
}

/// The pixels of a view, or every so many of them.
struct Grid {
  const Surfaces& surfaces;
  const Plane<HalfColor>& albedo;
  Camera camera;  ///< of the view, posed in the frame's camera space
  Window window;
  bool closed;  ///< the last column lies beside the first
  int step;
  const std::map<std::string, Plane<float>>* receives;  ///< of the view; null: it is the frame
};

/// Makes vertices and triangles of a grid.
class Mesher {
 public:
  Mesher(const Grid& grid, const Plane<Fate>& fates, OtherSurfaces& out)
      : grid_(grid),
        fates_(fates),
        out_(out),
        to_frame_(glm::transpose(grid.camera.rotation)),
        width_((grid.surfaces.width + grid.step - 1) / grid.step),
        height_((grid.surfaces.height + grid.step - 1) / grid.step),
        index_(width_, height_, kNone) {}

  void run() {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) add_vertex(x, y);
    for (int y = 0; y + 1 < height_; ++y)
      for (int x = 0; x + (grid_.closed ? 0 : 1) < width_; ++x) add_cell(x, y);
  }

 private:
  static constexpr std::uint32_t kNone = ~0u;

  Fate fate(int x, int y) const { return fates_(x * grid_.step, y * grid_.step); }

  void add_vertex(int x, int y) {
    if (fate(x, y) != Fate::added && fate(x, y) != Fate::seen) return;
    const std::size_t from = grid_.surfaces.index(x * grid_.step, y * grid_.step);
    const Surfel& s = grid_.surfaces[from];
    const double depth = grid_.camera.depth_of(grid_.camera.to_camera(glm::dvec3(s.position)));
    const double width = (grid_.camera.orthographic ? 1.0 : depth) /
                         std::min(grid_.camera.fx, grid_.camera.fy) * grid_.step;
    const auto own = std::uint32_t(out_.vertices.size());
    index_(x, y) = own;
    out_.vertices.push_back({s.position, s.normal,
                             grid_.albedo.empty() ? glm::vec3(0) : glm::vec3(grid_.albedo[from]),
                             float(width), own});
    if (!grid_.receives) {
      out_.vertices.back().frame_pixel = std::uint32_t(from);
    } else {
      for (const auto& [text, coverage] : *grid_.receives) {
        std::vector<float>& taken = out_.receives[text];
        taken.resize(out_.vertices.size(), 0);
        taken.back() = coverage[from];
      }
    }
    // One pixel of each 2 x 2 is lit for all of them that are on its surface: a bounce averages
    // over many pixels.
    const int lit_x = x & ~1, lit_y = y & ~1;
    const std::uint32_t lit = index_(lit_x, lit_y);
    if (lit != kNone && fate(x, y) == fate(lit_x, lit_y) && joined(own, lit))
      out_.vertices.back().sender = lit;
  }

  bool joined(std::uint32_t i, std::uint32_t j) const {
    const Vertex &a = out_.vertices[i], &b = out_.vertices[j];
    return on_one_surface(SurfacePoint{a.position, a.normal}, SurfacePoint{b.position, b.normal},
                          std::min(a.footprint, b.footprint));
  }

  void add_triangle(std::uint32_t i, std::uint32_t j, std::uint32_t k, bool is_new) {
    out_.all.push_back({i, j, k});
    if (is_new) out_.added.push_back({i, j, k});
  }

  /// Fills the cell between four neighbours: with one surface, or with the tangent plane of each up
  /// to the middle.
  void add_cell(int x, int y) {
    struct Corner {
      int x, y;
      std::uint32_t index;
      Fate fate;
    };
    Corner corners[4];
    bool whole = true;
    for (int k = 0; k < 4; ++k) {
      // In the order of a circle.
      const int cx = x + (k == 1 || k == 2), cy = y + (k >= 2), column = cx % width_;
      corners[k] = {cx, cy, index_(column, cy), fate(column, cy)};
      whole = whole && corners[k].index != kNone && corners[k].fate == corners[0].fate;
    }
    for (int k = 0; k < 4 && whole; ++k)
      whole = joined(corners[k].index, corners[(k + 1) % 4].index);
    if (whole) {
      const bool is_new = corners[0].fate == Fate::added;
      add_triangle(corners[0].index, corners[3].index, corners[1].index, is_new);
      add_triangle(corners[1].index, corners[3].index, corners[2].index, is_new);
      return;
    }
    for (const Corner& corner : corners) {
      if (corner.index == kNone) continue;
      const double middle_x = x + 0.5, middle_y = y + 0.5;
      const std::uint32_t beside = add_place(corner.index, middle_x, corner.y),
                          centre = add_place(corner.index, middle_x, middle_y),
                          below = add_place(corner.index, corner.x, middle_y);
      const bool is_new = corner.fate == Fate::added;
      add_triangle(corner.index, beside, centre, is_new);
      add_triangle(corner.index, centre, below, is_new);
    }
  }

  /// Adds the point of a vertex's tangent plane that is seen at (x, y) of the grid.
  std::uint32_t add_place(std::uint32_t of, double x, double y) {
    Vertex place = out_.vertices[of];
    const glm::dvec2 pixel(grid_.window.x0 + x * grid_.step + 0.5,
                           grid_.window.y0 + y * grid_.step + 0.5);
    const Camera::Ray ray = grid_.camera.ray(pixel);
    const glm::dvec3 origin = to_frame_ * ray.origin + grid_.camera.origin,
                     direction = to_frame_ * ray.direction, normal(place.normal);
    const double along = glm::dot(normal, direction),
                 t = glm::dot(normal, glm::dvec3(place.position) - origin) / along;
    const glm::dvec3 at = origin + t * direction;
    // A plane that is seen nearly edge-on would lead far away from its pixel.
    if (t > 0 && glm::distance(at, glm::dvec3(place.position)) < kWidest * place.footprint)
      place.position = glm::vec3(at);
    out_.vertices.push_back(place);
    return std::uint32_t(out_.vertices.size() - 1);
  }

  /// The largest distance from the middle of a pixel to its corner, in footprints.
  static constexpr double kWidest = 4;

  const Grid& grid_;
  const Plane<Fate>& fates_;
  OtherSurfaces& out_;
  glm::dmat3 to_frame_;
  int width_, height_;
  Plane<std::uint32_t> index_;
};

Plane<Fate> judge(const Surfaces& surfaces, const Merger& merger, MergeCounts& counts) {
  Plane<Fate> fates(surfaces.width, surfaces.height, Fate::none);
  for_each_row(surfaces.height, [&](int y) {
    for (int x = 0; x < surfaces.width; ++x) {
      const Surfel& s = surfaces(x, y);
      if (s.is_surface()) fates(x, y) = merger.judge(s);
    }
  });
  for (const Fate fate : fates.pixels) {
    counts.added += fate == Fate::added;
    counts.seen += fate == Fate::seen;
    counts.contradictory += fate == Fate::contradictory;
  }
  return fates;
}

}  // namespace

bool MergeCounts::is_of_another_scene() const {
  if (!is_other_eye) return false;
  if (double(seen) < kLeastSeenByOtherEye * double(added + in_common())) return true;
  return in_common() >= kFewestInCommon && double(seen) < kLeastInCommon * double(in_common());
}

OtherSurfaces merge_views(const std::vector<OtherView>& views, const Geometry& frame,
                          const Plane<HalfColor>& albedo, std::vector<MergeCounts>& counts) {
  OtherSurfaces out;
  const Merger merger(frame);
  counts.assign(views.size(), {});
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return views[a].picture->file < views[b].picture->file;
  });
  struct Judged {
    const OtherView* view;
    Plane<Fate> fates;
  };
  std::vector<Judged> judged;
  std::vector<Rival> rivals;
  for (const std::size_t k : order) {
    const OtherView& view = views[k];
    counts[k].file = view.picture->file;
    counts[k].has_albedo = !view.picture->albedo.empty();
    counts[k].is_other_eye = view.is_other_eye;
    Plane<Fate> fates = judge(view.surfels_in_frame(), merger, counts[k]);
    if (!counts[k].is_of_another_scene()) {
      judged.push_back({&view, std::move(fates)});
      rivals.emplace_back(view);
    }
  }
  for (std::size_t k = 0; k < judged.size(); ++k) {
    auto& [view, fates] = judged[k];
    const Surfaces surfaces = view->surfels_in_frame();
    leave_out_repeated(rivals, k, surfaces, fates);
    const OtherPicture& picture = *view->picture;
    Mesher({surfaces, picture.albedo, view->camera, picture.window, picture.closed, 1,
            &picture.receives},
           fates, out)
        .run();
  }
  Camera own = frame.camera;  // what it shows is in its own camera space
  own.rotation = glm::dmat3(1), own.origin = glm::dvec3(0);
  Plane<Fate> fates(frame.surfaces.width, frame.surfaces.height, Fate::none);
  for (std::size_t i = 0; i < fates.size(); ++i)
    if (frame.surfaces[i].is_usable()) fates[i] = Fate::seen;
  const int step = (frame.surfaces.width + kFrameColumns - 1) / kFrameColumns;

  Mesher({frame.surfaces, albedo, own, frame.window, false, step, nullptr}, fates, out).run();
  for (auto& [text, taken] : out.receives) taken.resize(out.vertices.size(), 0);
  return out;
}

}  // namespace ssdo
