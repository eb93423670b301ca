// SPDX-License-Identifier: Apache-2.0
//
// A node is the front of a solid in one pixel: in layer 0 what the pixel shows
// (scene/solids/solids.h). Nodes of neighbouring pixels are joined where they are on one surface
// (scene/same_surface.h). Four pixels around a corner make a cell:
//
//   a---b   All four joined: two triangles from centre to centre, and two between their backs.
//   |   |   Else each group of joined nodes has the quarters of its own pixels, which end halfway
//   d---c   to the others: there the surface goes on as its tangent plane, and a wall along the
//           view rays leads from its front to its back.
#include "estimators/trace/height_field.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>

#include "estimators/trace/cell_links.h"
#include "parallel/tiles.h"
#include "scene/normals/geometric_normal.h"
#include "scene/normals/normals.h"
#include "scene/same_surface.h"
#include "scene/surfaces.h"

namespace ssdo {
namespace {

constexpr int kRowsOfBlock = 32;

/// Length at which endless walls are cut. Embree places the end of a triangle to within 1e-7 of its
/// length: at this length, far below a pixel.
constexpr float kExactLengthPx = 4096;

/// A place of the picture, and the heights of a front and a back there.
struct Point {
  glm::vec2 at;
  float front, back;
};

Point middle(const Point& a, const Point& b) {
  return {0.5f * (a.at + b.at), 0.5f * (a.front + b.front), 0.5f * (a.back + b.back)};
}

/// The corners of a cell, in the order around it.
constexpr int kCornerX[] = {0, 1, 1, 0}, kCornerY[] = {0, 0, 1, 1};

class Builder {
 public:
  Builder(const Geometry& geometry, const Solids& solids)
      : geometry_(geometry),
        solids_(solids),
        width_(geometry.surfaces.width),
        height_(geometry.surfaces.height),
        footprint_(geometry.camera),
        out_{PictureSpace(geometry), {}, {}} {}

  HeightField build() {
    check_layers(solids_);
    make_nodes();
    std::vector<Block> blocks(std::size_t(height_ + kRowsOfBlock - 1) / kRowsOfBlock);
    for_each_row(int(blocks.size()), [&](int b) {
      const int end = std::min((b + 1) * kRowsOfBlock, height_);
      // Cells hang over the border by one pixel on every side.
      for (int y = b == 0 ? -1 : b * kRowsOfBlock; y < end; ++y) {
        for (int x = -1; x < width_; ++x) add_cell(x, y, blocks[std::size_t(b)]);
      }
    });
    for (Block& block : blocks) append(block);
    return std::move(out_);
  }

 private:
  /// The front of a solid.
  struct Node {
    int pixel = -1, layer = 0;
    std::uint32_t corner = 0;  ///< in the sheets
  };

  /// The nodes of one pixel, near to far.
  struct Nodes {
    std::array<Node, kMostLayers> node;
    int count = 0;

    const Node& operator[](int k) const { return node[std::size_t(k)]; }
    const Node* first() const { return count > 0 ? &node[0] : nullptr; }
  };

  /// The triangles that a block of rows adds.
  struct Block {
    std::vector<std::array<std::uint32_t, 3>> sheets;
    TriangleMesh cuts;
  };

  bool is_solid(std::size_t pixel) const { return geometry_.surfaces[pixel].is_usable(); }

  bool has_solid(int layer, std::size_t pixel) const {
    const Solid solid = solids_.at(layer, pixel);
    return solid.exists() && is_solid(pixel) &&
           (solid.sender < 0 || is_solid(std::size_t(solid.sender)));
  }

  /// Corners: fronts layer by layer and pixel by pixel, then the backs in the same order. Layer 0
  /// has a corner for every pixel.
  void make_nodes() {
    TriangleMesh& sheets = out_.sheets;
    const std::size_t count = geometry_.surfaces.size();
    sheets.corners.reserve(2 * count);
    sheets.owners.reserve(2 * count);
    backs_.reserve(count);
    bool all_endless = true;
    const auto add = [&](const glm::vec3& position, int layer, const Solid& solid) {
      sheets.corners.push_back(out_.space.point(position));
      sheets.owners.push_back({sheets.corners.back().z, solid.sender, layer});
      const float thickness = std::max(solid.thickness, 0.0f);
      all_endless &= std::isinf(thickness);
      backs_.push_back(out_.space.height_behind(sheets.corners.back().z, position, thickness));
      finite_.push_back(!std::isinf(thickness));
    };
    for (std::size_t i = 0; i < count; ++i) {
      add(is_solid(i) ? geometry_.surfaces[i].position : glm::vec3(0, 0, -1), 0, solids_.at(0, i));
    }
    for (int layer = 1; layer < solids_.layers(); ++layer) {
      behind_.emplace_back(count, 0);
      for (std::size_t i = 0; i < count; ++i) {
        if (!has_solid(layer, i)) continue;
        behind_.back()[i] = std::uint32_t(sheets.corners.size());
        const Solid solid = solids_.at(layer, i);
        add(point_behind(geometry_, i, solid.distance), layer, solid);
      }
    }
    nodes_ = std::uint32_t(sheets.corners.size());
    if (all_endless) return;
    for (std::uint32_t n = 0; n < nodes_; ++n) {
      sheets.corners.emplace_back(glm::vec2(sheets.corners[n]), backs_[n]);
      sheets.owners.push_back(sheets.owners[n]);
    }
  }

  Nodes nodes_at(int x, int y) const {
    Nodes nodes;
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return nodes;
    const std::size_t pixel = geometry_.surfaces.index(x, y);
    if (!is_solid(pixel)) return nodes;
    nodes.node[0] = {int(pixel), 0, std::uint32_t(pixel)};
    nodes.count = 1;
    for (std::size_t k = 0; k < behind_.size(); ++k) {
      if (behind_[k][pixel] == 0) continue;
      nodes.node[std::size_t(nodes.count++)] = {int(pixel), int(k + 1), behind_[k][pixel]};
    }
    return nodes;
  }

  SurfacePoint surface_point(const Node& n) const {
    const auto pixel = std::size_t(n.pixel);
    const Surfel& seen = geometry_.surfaces[pixel];
    if (n.layer == 0) return {seen.position, seen.normal};
    return {point_behind(geometry_, pixel, solids_.at(n.layer, pixel).distance),
            normal_of_solid(geometry_, solids_, n.layer, pixel)};
  }
  const glm::vec3& corner(const Node& n) const { return out_.sheets.corners[n.corner]; }

  bool joined(const Node& a, const Node& b) const {
    return on_one_surface(surface_point(a), surface_point(b), footprint_);
  }

  /// The point of a node's tangent plane at another place of the picture. None if its height
  /// differs by more than half the step to `other`, the surface on the far side of the cut, or
  /// without `other` by more than half the node's own height.
  std::optional<Point> continued(const Node& n, const glm::vec2& at, const Node* other) const {
    const glm::vec3& c = corner(n);
    SurfacePoint here = surface_point(n);
    const glm::vec3 view = direction_to_viewer(here.position, out_.space.orthographic());
    if (n.layer == 0) {
      const int w = geometry_.surfaces.width;
      here.normal = geometric_normal(geometry_.surfaces, n.pixel % w, n.pixel / w, view);
    }
    const float step = glm::dot(out_.space.slope(here.position, here.normal), at - glm::vec2(c));
    const float room = other ? std::abs(corner(*other).z - c.z) : std::abs(c.z);
    // At the outline of facets, interpolated normals may face away.
    if (!(glm::dot(here.normal, view) > 0) || !(std::abs(step) <= 0.5f * room)) return std::nullopt;
    const float front = c.z + step, back = backs_[n.corner];
    return Point{at, front, out_.space.orthographic() ? back + step : back * (front / c.z)};
  }

  Point point(const Node& n) const { return {glm::vec2(corner(n)), corner(n).z, backs_[n.corner]}; }

  using Cell = std::array<Nodes, 4>;

  void add_cell(int x, int y, Block& block) const {
    Cell at;
    bool any = false, simple = true;
    for (std::size_t k = 0; k < 4; ++k) {
      at[k] = nodes_at(x + kCornerX[k], y + kCornerY[k]);
      any |= at[k].count > 0;
      simple &= at[k].count == 1;
    }
    if (!any) return;
    CellLinks links = link(at);
    if (simple && links.count() == 4)
      return add_sheet({at[0][0], at[1][0], at[2][0], at[3][0]}, block);
    const Camera& camera = geometry_.camera;
    const glm::vec2 centre_px(glm::dvec2(geometry_.window.x0 + x + 1 - camera.cx,
                                         geometry_.window.y0 + y + 1 - camera.cy));
    for (int k = 0; k < 4; ++k) {
      for (int layer = 0; layer < at[std::size_t(k)].count; ++layer) {
        if (links.seen[k][layer]) continue;
        add_group(at, links, k, layer, centre_px, block);
      }
    }
  }

  /// Joins nodes of the same layer first, then nodes of different layers.
  CellLinks link(const Cell& at) const {
    CellLinks links;
    for (int k = 0; k < 4; ++k) {
      const Nodes &here = at[std::size_t(k)], &next = at[std::size_t(k + 1) % 4];
      bool taken[kMostLayers] = {};
      for (const bool same_layer : {true, false}) {
        for (int a = 0; a < here.count; ++a) {
          for (int b = 0; b < next.count; ++b) {
            if ((here[a].layer == next[b].layer) != same_layer || links.to[k][a] >= 0 || taken[b])
              continue;
            if (!joined(here[a], next[b])) continue;
            links.to[k][a] = b;
            taken[b] = true;
          }
        }
      }
    }
    return links;
  }

  void add_group(const Cell& at, CellLinks& links, int corner, int layer,
                 const glm::vec2& centre_px, Block& block) const {
    const CellGroup group = group_from(links, corner, layer);
    std::array<const Node*, 4> nodes{};
    int size = 0, sides = 0;
    for (int k = 0; k < 4; ++k) {
      if (group.layers[k] < 0) continue;
      nodes[k] = &at[k][group.layers[k]];
      ++size;
      sides += group.joined_to_next[k];
    }
    // Three joins around four corners leave a cut that ends in the cell: the surface is whole.
    if (size == 4 && sides >= 3)
      return add_sheet({*nodes[0], *nodes[1], *nodes[2], *nodes[3]}, block);

    // A round silhouette lies behind all of its tangent planes: the farthest one is taken.
    std::optional<Point> farthest;
    glm::vec2 at_all(0);
    bool all_continued = true;
    for (int k = 0; k < 4; ++k) {
      if (!nodes[k]) continue;
      const Node* across = at[(k + 2) % 4].first();
      const auto p = continued(*nodes[k], centre_px, nodes[(k + 2) % 4] ? nullptr : across);
      const Point here = p.value_or(point(*nodes[k]));
      all_continued &= p.has_value();
      at_all += here.at / float(size);
      if (!farthest || here.front < farthest->front) farthest = here;
    }
    const Point centre{all_continued ? centre_px : at_all, farthest->front, farthest->back};
    for (int k = 0; k < 4; ++k) {
      if (!nodes[k]) continue;
      const Node& n = *nodes[k];
      const auto side = [&](int to, bool is_joined) {
        if (is_joined) return middle(point(n), point(*nodes[to]));
        const glm::vec2 px = centre_px + 0.5f * glm::vec2(kCornerX[k] + kCornerX[to] - 1,
                                                          kCornerY[k] + kCornerY[to] - 1);
        return continued(n, px, at[to].first()).value_or(point(n));
      };
      const int next = (k + 1) % 4, before = (k + 3) % 4;
      const bool to_next = group.joined_to_next[k], to_before = group.joined_to_next[before];
      const Point after = side(next, to_next), ahead = side(before, to_before);
      add_quarter(n, {point(n), after, centre, ahead}, block);
      if (!to_next) add_wall(n, after, centre, block);
      if (!to_before) add_wall(n, centre, ahead, block);
    }
  }

  /// Fronts and backs between four centres.
  void add_sheet(const std::array<Node, 4>& nodes, Block& block) const {
    // The shorter diagonal follows a crease better.
    const bool first = std::abs(corner(nodes[0]).z - corner(nodes[2]).z) <=
                       std::abs(corner(nodes[1]).z - corner(nodes[3]).z);
    const int order[2][3] = {{0, 1, first ? 2 : 3}, {first ? 0 : 1, 2, 3}};
    bool back = false;
    for (const Node& n : nodes) back |= finite_[n.corner];
    for (const auto& [a, b, c] : order) {
      const std::uint32_t i = nodes[a].corner, j = nodes[b].corner, k = nodes[c].corner;
      block.sheets.push_back({i, j, k});
      if (back) block.sheets.push_back({i + nodes_, k + nodes_, j + nodes_});
    }
  }

  static glm::vec3 front(const Point& p) { return {p.at, p.front}; }
  static glm::vec3 back(const Point& p) { return {p.at, p.back}; }

  void add_quarter(const Node& n, const std::array<Point, 4>& p, Block& block) const {
    add_quad(n, {front(p[0]), front(p[1]), front(p[2]), front(p[3])}, block.cuts);
    if (finite_[n.corner])
      add_quad(n, {back(p[0]), back(p[3]), back(p[2]), back(p[1])}, block.cuts);
  }

  void add_wall(const Node& n, const Point& a, const Point& b, Block& block) const {
    // Endless walls of parallel views are cut; those of perspective are no longer than 1 / depth.
    if (!out_.space.orthographic() ||
        std::min(a.front - a.back, b.front - b.back) <= kExactLengthPx)
      return add_quad(n, {front(a), front(b), back(b), back(a)}, block.cuts);
    const glm::vec3 a_between(a.at, a.front - kExactLengthPx),
        b_between(b.at, b.front - kExactLengthPx);
    add_quad(n, {front(a), front(b), b_between, a_between}, block.cuts);
    add_quad(n, {a_between, b_between, back(b), back(a)}, block.cuts);
  }

  void add_quad(const Node& n, const std::array<glm::vec3, 4>& p, TriangleMesh& mesh) const {
    const auto first = std::uint32_t(mesh.corners.size());
    for (const glm::vec3& corner : p) {
      mesh.corners.push_back(corner);
      mesh.owners.push_back(out_.sheets.owners[n.corner]);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }

  void append(Block& block) {
    std::vector<std::array<std::uint32_t, 3>>& sheets = out_.sheets.triangles;
    sheets.insert(sheets.end(), block.sheets.begin(), block.sheets.end());
    TriangleMesh& cuts = out_.cuts;
    const auto first = std::uint32_t(cuts.corners.size());
    cuts.corners.insert(cuts.corners.end(), block.cuts.corners.begin(), block.cuts.corners.end());
    cuts.owners.insert(cuts.owners.end(), block.cuts.owners.begin(), block.cuts.owners.end());
    for (const auto& [a, b, c] : block.cuts.triangles)
      cuts.triangles.push_back({a + first, b + first, c + first});
    block = {};
  }

  const Geometry& geometry_;
  const Solids& solids_;
  int width_, height_;
  PixelFootprint footprint_;
  std::vector<std::vector<std::uint32_t>>
      behind_;                ///< layers 1, 2, ...: the pixels' nodes; 0: none
  std::vector<float> backs_;  ///< heights of the backs of nodes
  std::vector<bool> finite_;  ///< nodes that are not endless
  std::uint32_t nodes_ = 0;
  HeightField out_;
};

}  // namespace

HeightField build_height_field(const Geometry& geometry, const Solids& solids) {
  return Builder(geometry, solids).build();
}

}  // namespace ssdo
