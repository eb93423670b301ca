// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/selected_coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <set>

#include "error.h"
#include "io/exr/file/exr_parts.h"
#include "io/one_line.h"
#include "nearest_name.h"
#include "parallel/tiles.h"
#include "scene/layers/candidates.h"
#include "scene/layers/groups.h"
#include "scene/layers/names.h"
#include "scene/objects/cryptomatte.h"
#include "scene/objects/object_hash.h"

namespace ssdo {
namespace {

using Kind = SelectionTerm::Kind;

/// Names of layers of ids, as normalise() leaves their last segment.
constexpr std::array<std::string_view, 8> kIdLayers = {
    "indexob", "indexma", "objectindex", "materialindex", "objectid", "materialid", "id", "objid"};

/// Most values that a layer of ids may have: more are no ids.
constexpr std::size_t kMostIds = 4096;

/// Coverage over the data window of a part, 0..1.
struct Covered {
  int part = 0;
  Plane<float> coverage;
  std::set<std::uint32_t> ids = {};  ///< that pixels have
};

float share_of(float value) { return value > 0 ? std::min(value, 1.0f) : 0.0f; }

/// What the ranks of a Cryptomatte say of some ids.
Covered coverage_of_ids(const ExrReader& file, const Cryptomatte& matte,
                        const std::set<std::uint32_t>& ids, const PixelGrid& grid) {
  Covered sum{matte.ranks.front().part, {}, {}};
  for (const Cryptomatte::Rank& rank : matte.ranks) {
    const auto window = [&](int part) { return file.parts()[std::size_t(part)].data_window; };
    if (window(rank.part) != window(sum.part)) {
      throw Error(ExitCode::layer,
                  fmt::format("{}: the ranks of Cryptomatte '{}' lie in parts with different data "
                              "windows; write them alike",
                              printable(file.path().string()), printable(matte.name)));
    }
    const std::vector<std::string> channels = {rank.id, rank.coverage};
    const std::vector<Plane<float>> read = file.read(rank.part, channels, grid);
    for (std::size_t i = 0; !matte.has_manifest && i < read[0].size(); ++i) {
      const auto id = std::bit_cast<std::uint32_t>(read[0][i]);
      if (read[1][i] > 0 && ids.contains(id)) sum.ids.insert(id);
    }
    if (sum.coverage.empty()) sum.coverage = Plane<float>(read[0].width, read[0].height, 0.0f);
    for_each_row(sum.coverage.height, [&](int y) {
      for (std::size_t i = sum.coverage.index(0, y); i < sum.coverage.index(0, y + 1); ++i) {
        const auto id = std::bit_cast<std::uint32_t>(read[0][i]);
        const float more = share_of(read[1][i]);
        if (ids.contains(id)) sum.coverage[i] = share_of(sum.coverage[i] + more);
      }
    });
  }
  return sum;
}

class Selector {
 public:
  Selector(const Selection& selection, const SelectionFiles& in, const Window& window,
           const PixelGrid& grid)
      : selection_(selection), in_(in), window_(window), grid_(grid) {}

  Plane<float> select() {
    Plane<float> all(window_.width(), window_.height(), 0.0f);
    for (std::size_t i = 0; i < selection_.terms.size();) {
      const SelectionTerm& term = selection_.terms[i];
      if (term.kind != Kind::cryptomatte) {
        join(all, coverage_of(term), term.adds);
        ++i;
        continue;
      }
      std::size_t end = i + 1;
      while (end < selection_.terms.size() && is_joined(term, selection_.terms[end])) ++end;
      join(all, coverage_of_names(i, end), term.adds);
      i = end;
    }
    return all;
  }

 private:
  /// What is taken from an earlier plane is no set of ids.
  static bool is_joined(const SelectionTerm& first, const SelectionTerm& term) {
    return term.kind == Kind::cryptomatte && first.adds && term.file == first.file;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ExitCode::layer,
                fmt::format("{} {}: {}", selection_.option, printable(selection_.text), what));
  }

  static void join(Plane<float>& all, const Plane<float>& term, bool adds) {
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i] = share_of(all[i] + (adds ? term[i] : -term[i]));
  }

  static void join_most(Plane<float>& all, const Plane<float>& one) {
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = std::max(all[i], one[i]);
  }

  std::vector<const ExrReader*> files_of(const SelectionTerm& term) const {
    std::vector<const ExrReader*> files;
    for (const ExrReader& file : in_.files)
      if (term.file.empty() || file.path() == term.file) files.push_back(&file);
    return files;
  }

  /// Lays the coverage of a part onto the window.
  Plane<float> over_window(const ExrReader& file, const Covered& covered) const {
    const ExrPart& part = file.parts()[std::size_t(covered.part)];
    const Window own = grid_.of(part.data_window);
    const Window& display = in_.files.front().parts().front().display_window;
    if (part.display_window != display) {
      refuse(fmt::format("{} of {} has the display window {}, and the frame {}; render both alike",
                         label(part), printable(file.path().string()), text_of(part.display_window),
                         text_of(display)));
    }
    Plane<float> out(window_.width(), window_.height(), 0.0f);
    const Window both = intersection(window_, own);
    for (int y = both.y0; y < both.y1; ++y) {
      for (int x = both.x0; x < both.x1; ++x)
        out(x - window_.x0, y - window_.y0) = covered.coverage(x - own.x0, y - own.y0);
    }
    return out;
  }

  /// Terms `first` to `end`, which are names for Cryptomattes of the same files.
  Plane<float> coverage_of_names(std::size_t first, std::size_t end) {
    Plane<float> all(window_.width(), window_.height(), 0.0f);
    std::vector<bool> known(end - first, false), shown = known;
    std::vector<std::string> names;
    bool has_any = false;
    for (const ExrReader* file : files_of(selection_.terms[first])) {
      for (const Cryptomatte& matte : find_cryptomattes(*file, in_.view)) {
        has_any = true;
        for (const auto& [name, id] : matte.ids) names.push_back(name);
        std::set<std::uint32_t> ids;
        for (std::size_t i = first; i < end; ++i) {
          const SelectionTerm& term = selection_.terms[i];
          const std::set<std::uint32_t> own = matte.ids_of(term.name);
          if (!own.empty()) known[i - first] = true;
          if (term.adds || i == first)
            ids.insert(own.begin(), own.end());
          else
            for (const std::uint32_t id : own) ids.erase(id);
        }
        if (ids.empty()) continue;
        const Covered covered = coverage_of_ids(*file, matte, ids, grid_);
        for (std::size_t i = first; i < end; ++i)
          shown[i - first] = shown[i - first] || matte.has_manifest ||
                             covered.ids.contains(cryptomatte_id(selection_.terms[i].name));
        join_most(all, over_window(*file, covered));
      }
      if (std::ranges::find(known, false) == known.end()) break;
    }
    for (std::size_t i = first; i < end; ++i)
      if (!known[i - first]) refuse_name(selection_.terms[i], names, has_any);
    for (std::size_t i = first; in_.warnings && i < end; ++i)
      if (selection_.terms[i].adds && !shown[i - first]) warn_of(selection_.terms[i].name);
    return all;
  }

  /// A frame of a shot may well lack an object, so that this is no error.
  void warn_of(const std::string& name) const {
    in_.warnings->push_back(fmt::format(
        "{} {}: no pixel has '{}', whose hash is {:08x}; the Cryptomatte has no manifest to check "
        "the name with",
        selection_.option, printable(selection_.text), printable(name), cryptomatte_id(name)));
  }

  [[noreturn]] void refuse_name(const SelectionTerm& term, const std::vector<std::string>& names,
                                bool has_any) const {
    if (!has_any) {
      refuse(fmt::format("{} has no Cryptomatte; render one, or select by id:LAYER=N or a matte",
                         printable(in_.files.front().path().string())));
    }
    if (names.empty()) {
      refuse(
          fmt::format("the Cryptomattes of the frame have no manifest of the names that '{}' may "
                      "match; give a name in full",
                      printable(term.name)));
    }
    refuse(fmt::format("no Cryptomatte of the frame has the name '{}'; {}there are {}",
                       printable(term.name), printable(did_you_mean(term.name, names)),
                       printable(some_of(names, 10))));
  }

  Plane<float> coverage_of(const SelectionTerm& term) const {
    std::vector<std::string> names;
    for (const ExrReader* file : files_of(term)) {
      const std::vector<LayerGroup> groups = group_channels(*file, 0, in_.view);
      const std::optional<Layer> layer = layer_of(term, groups);
      for (const LayerGroup& group : groups) names.push_back(name_for_request(group));
      if (!layer) continue;
      Covered covered{layer->part, {}, {}};
      covered.coverage = std::move(file->read(layer->part, layer->channels, grid_)[0]);
      for (float& value : covered.coverage.pixels)
        value = term.kind == Kind::matte ? share_of(value) : is_selected(term, value);
      return over_window(*file, covered);
    }
    refuse(fmt::format("no layer '{}' of one channel in {}; {}there are {}", printable(term.layer),
                       printable(term.file.empty() ? in_.files.front().path().string() : term.file),
                       printable(did_you_mean(term.layer, names)), printable(some_of(names))));
  }

  std::optional<Layer> layer_of(const SelectionTerm& term,
                                const std::vector<LayerGroup>& groups) const {
    // Depth takes the names of all single channels but alpha.
    for (const Role role : {Role::roughness, Role::alpha, Role::depth}) {
      const std::vector<Layer> layers = layers_named(term.layer, role, groups);
      if (layers.size() > 1)
        refuse(fmt::format("'{}' may be {} layers; give one of their full names",
                           printable(term.layer), layers.size()));
      if (!layers.empty()) return layers[0];
    }
    return std::nullopt;
  }

  static float is_selected(const SelectionTerm& term, float value) {
    // Antialiased ids belong to no object.
    if (!(std::abs(value) < 1e9f) || value != std::floor(value)) return 0;
    const auto is_in = [&](const SelectionTerm::Range& range) {
      return range.first <= std::int64_t(value) && std::int64_t(value) <= range.last;
    };
    return std::ranges::any_of(term.ids, is_in) ? 1.0f : 0.0f;
  }

  const Selection& selection_;
  const SelectionFiles& in_;
  const Window& window_;
  const PixelGrid& grid_;
};

/// Counts what the pixels of a frame show.
class Census {
 public:
  Census(const ExrReader& file, std::string view) : file_(file), view_(std::move(view)) {}

  void add(const Cryptomatte& matte) {
    std::map<std::uint32_t, double> sums;
    for (const Cryptomatte::Rank& rank : matte.ranks) {
      const std::vector<std::string> channels = {rank.id, rank.coverage};
      const std::vector<Plane<float>> read = file_.read(rank.part, channels);
      for (std::size_t i = 0; i < read[0].size(); ++i)
        if (read[1][i] > 0) sums[std::bit_cast<std::uint32_t>(read[0][i])] += share_of(read[1][i]);
    }
    std::vector<ObjectShare> own;
    for (const auto& [name, id] : matte.ids) {
      if (const auto sum = sums.find(id); sum != sums.end())
        own.push_back({matte.name, name, sum->second / pixels(matte.ranks[0].part)});
    }
    take(std::move(own));
  }

  void add_ids(const LayerGroup& group) {
    const std::string key = split_channel(normalise(group.path)).second;
    if (std::ranges::find(kIdLayers, key) == kIdLayers.end()) return;
    const auto layer = as_layer(group, Role::roughness);
    if (!layer) return;
    std::map<float, double> counts;
    const std::vector<Plane<float>> read = file_.read(layer->part, layer->channels);
    for (const float id : read[0].pixels) {
      if (std::isfinite(id) && id == std::floor(id)) counts[id] += 1;
      if (counts.size() > kMostIds) return;
    }
    std::vector<ObjectShare> own;
    for (const auto& [id, count] : counts)
      own.push_back({group.name, fmt::format("{:.0f}", id), count / pixels(layer->part)});
    take(std::move(own));
  }

  std::vector<ObjectShare> result() { return std::move(all_); }

 private:
  double pixels(int part) const {
    return double(file_.parts()[std::size_t(part)].display_window.area());
  }

  void take(std::vector<ObjectShare> own) {
    std::ranges::stable_sort(own, std::greater<>(), &ObjectShare::share);
    all_.insert(all_.end(), own.begin(), own.end());
  }

  const ExrReader& file_;
  std::string view_;
  std::vector<ObjectShare> all_;
};

}  // namespace

Plane<float> selected_coverage(const Selection& selection, const SelectionFiles& in,
                               const Window& window, const PixelGrid& grid) {
  return Selector(selection, in, window, grid).select();
}

std::vector<ObjectShare> objects_of(const ExrReader& file, const std::string& view,
                                    std::vector<std::string>& warnings) {
  Census census(file, view);
  try {
    for (const Cryptomatte& matte : find_cryptomattes(file, view)) census.add(matte);
  } catch (const Error& error) {
    warnings.push_back(error.what());
  }
  for (const LayerGroup& group : group_channels(file, 0, view)) census.add_ids(group);
  return census.result();
}

}  // namespace ssdo
