// SPDX-License-Identifier: Apache-2.0
#include "scene/layers/layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>

#include "error.h"
#include "io/exr/file/exr_parts.h"
#include "io/sequence.h"
#include "nearest_name.h"
#include "scene/layers/advice.h"
#include "scene/layers/candidates.h"
#include "scene/layers/groups.h"
#include "scene/layers/names.h"

namespace ssdo {
namespace {

/// Where layers are looked for, best first: a role is taken from the first set that has it.
using Tiers = std::vector<std::vector<LayerGroup>>;

template <class Keep>
std::vector<LayerGroup> those_of(const std::vector<LayerGroup>& groups, const Keep& keep) {
  std::vector<LayerGroup> kept;
  std::copy_if(groups.begin(), groups.end(), std::back_inserter(kept), keep);
  return kept;
}

std::string quoted(const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (const std::string& name : names) all.push_back("'" + name + "'");
  return some_of(all);
}

/// The other parts of the view of `part`, which complete it. Where `part` has a position, parts
/// with a position of their own are left out, since they show something else. Where it has only a
/// depth, parts with a position or a depth of their own are left out.
std::vector<LayerGroup> parts_beside(const std::vector<LayerGroup>& part,
                                     const std::vector<LayerGroup>& all) {
  const bool position = !best_candidates(Role::position, part).empty();
  const bool depth = !best_candidates(Role::depth, part).empty();
  const auto is_beside = [&](const LayerGroup& group) {
    if (group.part == part[0].part || !same_view(group.view, part[0].view)) return false;
    const auto own = those_of(all, [&](const LayerGroup& g) { return g.part == group.part; });
    if (!position && !depth) return true;
    return best_candidates(Role::position, own).empty() &&
           (position || best_candidates(Role::depth, own).empty());
  };
  return those_of(all, is_beside);
}

/// How one of several views is chosen.
std::string choice_of(const std::vector<std::string>& views) {
  std::vector<std::string> names;
  for (const std::string& view : views) names.push_back(lower(view));
  const bool stereo = std::ranges::is_permutation(names, kEyes);
  return stereo ? "--stereo left, right or all"
                : fmt::format("a view with --part {}", fmt::join(views, " or --part "));
}

/// No layer has the requested name. The request was meant as FILE:LAYER if the text before the last
/// colon can only be a file.
void refuse_missing_file(const LayerRequest& request) {
  const std::string file = request.layer.substr(0, request.layer.rfind(':'));
  const bool is_name = lower(file).ends_with(".exr") || file.find('/') != file.npos;
  if (!request.file.empty() || file == request.layer || !is_name) return;
  throw Error(ExitCode::input, fmt::format("{}: does not exist; check --aov {}={}", file,
                                           role_name(request.role), request.layer));
}

[[noreturn]] void throw_no_part(const ExrReader& frame, const std::string& wanted) {
  std::vector<std::string> names, forms;
  for (const ExrPart& part : frame.parts()) {
    names.insert(names.end(), {part.name, part.view});
    forms.push_back(label(part) + (part.deep ? " (deep)" : ""));
  }
  throw Error(ExitCode::layer,
              fmt::format("{}: no part or view '{}'; {}the file has {}", frame.path().string(),
                          wanted, did_you_mean(wanted, names), some_of(forms)));
}

[[noreturn]] void throw_no_view(const ExrReader& frame, const std::vector<LayerGroup>& groups,
                                const std::string& wanted) {
  std::set<std::string> views;
  for (const LayerGroup& group : groups)
    if (!same_view(group.view, "")) views.insert(group.view);
  throw Error(ExitCode::layer,
              views.empty()
                  ? fmt::format("{}: shows one view; leave --stereo out", frame.path().string())
                  : fmt::format("{}: no view '{}'; it has '{}': choose one with --part",
                                frame.path().string(), wanted, fmt::join(views, "', '")));
}

/// The groups of one eye of the frame, then those of no view.
Tiers select_view(const ExrReader& frame, const std::string& wanted) {
  const std::vector<LayerGroup> groups = group_channels(frame, 0);
  const auto own =
      those_of(groups, [&](const LayerGroup& group) { return lower(group.view) == wanted; });
  const bool deep = std::ranges::any_of(
      frame.parts(), [&](const ExrPart& p) { return p.deep && lower(p.view) == wanted; });
  if (own.empty() && !deep) throw_no_view(frame, groups, wanted);
  return {own, those_of(groups, [](const LayerGroup& g) { return same_view(g.view, ""); })};
}

/// The groups of the frame that --part selects: a part by name or number, completed by the other
/// parts of its view, or else a view.
Tiers select_part(const ExrReader& frame, const std::vector<LayerGroup>& groups,
                  const std::string& wanted) {
  if (wanted.empty()) return {groups};
  const auto part = those_of(groups, [&](const LayerGroup& group) {
    return frame.parts()[std::size_t(group.part)].name == wanted ||
           std::to_string(group.part) == wanted;
  });
  if (!part.empty()) return {part, parts_beside(part, groups)};
  const auto view =
      those_of(groups, [&](const LayerGroup& group) { return lower(group.view) == lower(wanted); });
  if (view.empty()) {
    const auto& parts = frame.parts();
    const bool deep = std::any_of(parts.begin(), parts.end(), [&](const ExrPart& p) {
      return p.deep && (p.name == wanted || std::to_string(p.index) == wanted ||
                        lower(p.view) == lower(wanted));
    });
    if (!deep) throw_no_part(frame, wanted);
    return {groups};  // they complete the deep part
  }
  return {view};
}

/// Finds the layers of one frame.
class LayerFinder {
 public:
  LayerFinder(const std::vector<const ExrReader*>& files, const std::vector<LayerRequest>& requests,
              const std::string& only_part, const std::string& view)
      : files_(files), requests_(requests), of_view_(!view.empty()) {
    for (std::size_t f = 0; f < files.size(); ++f)
      groups_.push_back(group_channels(*files[f], int(f), view));
    tiers_ =
        of_view_ ? select_view(*files[0], view) : select_part(*files[0], groups_[0], only_part);
  }

  /// The layer that is requested for the role, or else, if `by_name`, the one with the best name.
  std::optional<Layer> find(Role role, bool by_name) const {
    std::optional<Layer> found;
    for (const LayerRequest& request : requests_) {
      if (request.role == role && role != Role::light) found = find_requested(request);
    }
    return found || !by_name ? found : find_by_name(role);
  }

  std::map<std::string, Layer> find_lights() const {
    std::map<std::string, Layer> found;
    for (const LayerRequest& request : requests_)
      if (request.role == Role::light) found[request.light] = find_requested(request);
    return found;
  }

  /// From here on, layers beside `lead` win over others with an equal claim:
  /// "ViewLayer.Combined" beside "ViewLayer.Position", not "Composite.Combined".
  void prefer_beside(const Layer& lead) { prefix_ = split_channel(lead.name).first; }

  /// Restricts the search to the view of this layer, so that no frame is made of two.
  void keep_view_of(const Layer& lead) {
    if (lead.file != 0 || views_of(groups_[0]).empty()) return;
    const auto own = std::find_if(groups_[0].begin(), groups_[0].end(), [&](const LayerGroup& g) {
      return g.part == lead.part && g.layer == split_channel(lead.channels[0]).first;
    });
    const std::string view = own->view;
    for (auto& groups : tiers_)
      groups = those_of(groups, [&](const LayerGroup& g) { return same_view(g.view, view); });
  }

 private:
  std::string frame() const { return files_[0]->path().string(); }

  std::optional<Layer> find_by_name(Role role) const {
    // Position and depth are of one eye alone.
    const bool own = of_view_ && (role == Role::position || role == Role::depth);
    for (const auto& groups : own ? Tiers{tiers_[0]} : tiers_) {
      std::vector<Candidate> best = best_candidates(role, groups);
      if (best.size() > 1) keep_those_beside_lead(best);
      if (best.size() > 1) throw_ambiguous(role, best);
      if (!best.empty()) return best[0].layer;
    }
    return std::nullopt;
  }

  void keep_those_beside_lead(std::vector<Candidate>& best) const {
    const auto is_elsewhere = [&](const Candidate& c) {
      return split_channel(c.layer.name).first != prefix_;
    };
    if (prefix_.empty() || std::all_of(best.begin(), best.end(), is_elsewhere)) return;
    std::erase_if(best, is_elsewhere);
  }

  [[noreturn]] void throw_ambiguous(Role role, const std::vector<Candidate>& best) const {
    std::vector<std::string> names, views;
    for (const Candidate& c : best) {
      names.push_back(c.layer.name);
      if (std::find(views.begin(), views.end(), c.view) == views.end()) views.push_back(c.view);
    }
    const bool of_views = views.size() == best.size() && !views_of(groups_[0]).empty() &&
                          std::find(views.begin(), views.end(), "") == views.end();
    const std::string by_view = of_views ? choice_of(views) + ", or " : "";
    throw Error(
        ExitCode::layer,
        fmt::format("{}: {} layers could be {}: {}; choose {}one with --aov {}=LAYER", frame(),
                    best.size(), role_name(role), quoted(names), by_view, role_name(role)));
  }

  Layer find_requested(const LayerRequest& request) const {
    std::size_t file = 0;
    for (std::size_t f = 1; f < files_.size() && !request.file.empty(); ++f) {
      if (files_[f]->path() == request.file) file = f;
    }
    std::vector<Layer> found;
    for (const auto& groups : file == 0 ? tiers_ : Tiers()) {
      if (found.empty()) found = layers_named(request.layer, request.role, groups);
    }
    if (found.empty()) found = layers_named(request.layer, request.role, groups_[file]);
    if (found.size() == 1) {
      found[0].by_request = true;
      found[0].premultiplied = request.premultiplied;
      return found[0];
    }
    if (found.empty()) refuse_missing_file(request);
    std::vector<std::string> names;
    for (const LayerGroup& group : groups_[file]) {
      if (as_layer(group, request.role)) names.push_back(name_for_request(group));
    }
    throw Error(ExitCode::layer,
                fmt::format("{}: {} layer '{}' with channels for {}; {}the file has {}",
                            files_[file]->path().string(), found.empty() ? "no" : "more than one",
                            request.layer, role_name(request.role),
                            found.empty() ? did_you_mean(request.layer, names) : "",
                            names.empty() ? "none that fits" : quoted(names)));
  }

  const std::vector<const ExrReader*>& files_;
  const std::vector<LayerRequest>& requests_;
  std::vector<std::vector<LayerGroup>> groups_;  ///< by file
  Tiers tiers_;                                  ///< of the frame
  bool of_view_;                                 ///< whether these are of one eye
  std::string prefix_;                           ///< of layers that are preferred; may be empty
};

/// Takes what follows a colon off the end of a role: `:straight` or `:premultiplied`, which state
/// how alpha is in the albedo, or the name of a light.
void take_detail(std::string& role, const std::string& text, LayerRequest& request) {
  const auto colon = role.find(':');
  const std::string detail = colon == std::string::npos ? "" : role.substr(colon + 1);
  role.resize(std::min(colon, role.size()));
  if (role == role_name(Role::light)) {
    request.light = detail;
    if (!detail.empty()) return;
    throw Error(ExitCode::usage,
                fmt::format("--aov {}: expected light:NAME=LAYER with the name of a lamp", text));
  }
  if (colon == std::string::npos) return;
  if (role == role_name(Role::albedo) && (detail == "straight" || detail == "premultiplied")) {
    request.premultiplied = detail == "premultiplied";
    return;
  }
  throw Error(ExitCode::usage,
              fmt::format("--aov {}: '{}:{}' is no role; with a colon there are albedo:straight, "
                          "albedo:premultiplied and light:NAME",
                          text, role, detail));
}

}  // namespace

LayerRequest parse_layer_request(const std::string& text) {
  const auto equals = text.find('=');
  std::string name = text.substr(0, equals);
  LayerRequest request;
  take_detail(name, text, request);
  const auto role = role_from_name(name);
  if (equals == std::string::npos || !role || equals + 1 == text.size()) {
    const auto roles = role_names();
    throw Error(
        ExitCode::usage,
        fmt::format("--aov {}: {}expected ROLE=LAYER or ROLE=FILE:LAYER with ROLE one of {}", text,
                    role ? "" : did_you_mean(name, {roles.begin(), roles.end()}),
                    fmt::join(roles, ", ")));
  }
  request.role = *role;
  request.layer = text.substr(equals + 1);
  // A layer name may contain a colon: it separates a file only where that file or sequence exists.
  const auto colon = request.layer.rfind(':');
  if (colon == std::string::npos) return request;
  const std::string file = request.layer.substr(0, colon);
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if ((exists(status) && !is_directory(status)) || is_pattern(file)) {
    request.file = file;
    request.layer = request.layer.substr(colon + 1);
  }
  return request;
}

void require_position(const LayerTable& table, const ExrReader& frame, const std::string& view,
                      const std::string& advice) {
  if (table[Role::position] || table[Role::depth]) return;
  throw Error(
      ExitCode::layer,
      fmt::format("{}: no layer for position or depth found by name; {}{}", frame.path().string(),
                  advice_on_position(group_channels(frame, 0, view)), advice));
}

LayerTable find_layers(const std::vector<const ExrReader*>& files,
                       const std::vector<LayerRequest>& requests, const std::string& only_part,
                       const std::vector<Role>& unused, const std::string& view) {
  LayerFinder finder(files, requests, only_part, view);
  LayerTable table;
  const auto find = [&](Role role) {
    const bool used = std::find(unused.begin(), unused.end(), role) == unused.end();
    if (!table[role]) table[role] = finder.find(role, used);
  };
  for (const Role role : {Role::position, Role::depth}) {
    find(role);
    if (!table[role]) continue;
    finder.keep_view_of(*table[role]);
    finder.prefer_beside(*table[role]);
    break;
  }
  for (std::size_t i = 0; i < kRoleCount; ++i) find(Role(i));
  table.lights = finder.find_lights();
  return table;
}

std::vector<std::string> files_of_frame(const std::string& input,
                                        const std::vector<LayerRequest>& aovs) {
  std::vector<std::string> files = {input};
  for (const LayerRequest& request : aovs) {
    const bool known =
        request.file.empty() || std::find(files.begin(), files.end(), request.file) != files.end();
    if (!known) files.push_back(request.file);
  }
  return files;
}

}  // namespace ssdo
