// SPDX-License-Identifier: Apache-2.0
#include "jobs/describe.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/exr/file/exr_parts.h"
#include "io/one_line.h"
#include "jobs/listing.h"

namespace ssdo {
namespace {

using nlohmann::json;

/// Before a frame is rendered, what to render with it is worth a warning too.
std::vector<std::string> warnings_of(const Frame& frame) {
  std::vector<std::string> all = frame.warnings();
  if (std::string advice = frame.guessed.advice(); !advice.empty())
    all.push_back(std::move(advice));
  return all;
}

std::string describe_camera(const Frame& frame) {
  const Camera& c = frame.report.placement.camera;
  const int width = frame.part().display_window.width();
  std::string text = frame.report.camera_source;
  if (frame.scene.geometry.median_depth <= 0) return text;
  text += c.panorama ? ": lat-long panorama"
          : c.orthographic
              ? fmt::format(": orthographic, {:.4g} wide", width / c.fx)
              : fmt::format(": {:.3f} degrees, f {:.2f} px", c.hfov_degrees(width), c.fx);
  if (std::abs(c.fy - c.fx) > 1e-3 * c.fx) text += fmt::format(" x {:.2f} px", c.fy);
  text += fmt::format(", centre {:.2f} {:.2f}", c.cx, c.cy);
  if (const auto& r = frame.report.residual) {
    text += fmt::format("; P lands {:.2g} px from its pixel (median), {:.2g} px (99 %)",
                        r->median_px, r->p99_px);
  }
  return text;
}

/// What proves the camera of the header, for people and for programs.
struct ProofRow {
  HeaderProof proof;
  std::string_view text, name;
};
constexpr std::array<ProofRow, 5> kProofs = {{
    {HeaderProof::nothing, "nothing proves it", "nothing"},
    {HeaderProof::consistency, "it agrees with itself", "consistency"},
    {HeaderProof::lens, "proved by the lens of P", "lens"},
    {HeaderProof::normals, "proved by N, which is of its world", "normals"},
    {HeaderProof::positions, "proved by P", "positions"},
}};

std::string describe(const HeaderFinding& found) {
  std::string text = found.source;
  if (!found.reading.empty()) text += fmt::format(" ({})", found.reading);
  text += fmt::format("; {}", kProofs[std::size_t(found.proof)].text);
  if (found.miss_px) text += fmt::format(", which lands {:.2g} px from its pixel", *found.miss_px);
  return text;
}

/// The channels of a layer, with their part or file where the names do not tell it.
std::string describe_layer(const Frame& frame, const Layer& layer) {
  const ExrReader& file = frame.files[std::size_t(layer.file)];
  std::string text =
      fmt::format("{} ({}{})", fmt::join(layer.channels, ", "), layer.half ? "half" : "float",
                  layer.by_request ? ", by --aov" : "");
  if (file.parts().size() > 1) text += " in " + label(file.parts()[std::size_t(layer.part)]);
  if (layer.file != 0) text += " of " + file.path().string();
  return text;
}

/// Whether P is in camera space: as --space says, or as its own camera stands.
bool is_in_camera_space(const Frame& frame) {
  if (frame.gbuffer.space) return *frame.gbuffer.space == Space::camera;
  const Placement& placement = frame.report.placement;
  return placement.position_camera.is_camera_space(placement.median_depth);
}

std::string_view space_of_positions(const Frame& frame) {
  return is_in_camera_space(frame) ? "camera" : "world";
}

std::string_view handedness(const Frame& frame) {
  return glm::determinant(frame.report.placement.position_camera.rotation) < 0 ? "left" : "right";
}

std::string describe_positions(const Frame& frame) {
  std::string text = describe_layer(frame, *frame.layers[Role::position]);
  if (frame.report.placement.median_depth <= 0) return text;
  return text + fmt::format("; {} space{}, {}-handed", space_of_positions(frame),
                            frame.gbuffer.space ? ", by --space" : "", handedness(frame));
}

std::string_view kind_of_depth(const Frame& frame) {
  return frame.gbuffer.depth_kind == DepthKind::ray ? "ray" : "planar";
}

/// "by P", "by its name"; "assumed" where nothing tells.
std::string source_of_depth_kind(const Frame& frame) {
  const std::string& source = frame.gbuffer.depth_source;
  return source.empty() ? "assumed" : "by " + source;
}

std::string describe_depth(const Frame& frame) {
  const std::string text = describe_layer(frame, *frame.layers[Role::depth]);
  if (frame.gbuffer.encodings.depth_is_wrong) return text + "; left out: it contradicts P";
  return text + fmt::format("; {}, {}", kind_of_depth(frame), source_of_depth_kind(frame));
}

std::string describe_normals(const Frame& frame) {
  const GeometryReport& report = frame.report;
  const auto& layer = frame.layers[Role::normal];
  std::string text = layer ? describe_layer(frame, *layer) : "no layer";
  if (!report.normal_space.empty()) text += "; " + report.normal_space;
  if (layer) text += fmt::format(", {:.1f} % agree with P", 100 * report.normal_agreement);
  if (layer && report.normals_rebuilt > 0)
    text += fmt::format("; {} rebuilt from P", report.normals_rebuilt);
  if (report.normals_turned > 0)
    text += fmt::format("; {} turned to the viewer", report.normals_turned);
  return text;
}

json camera_json(const Frame& frame) {
  const Camera& c = frame.report.placement.camera;
  json rows = json::array();
  const glm::dvec3 translation = -(c.rotation * c.origin);
  for (int row = 0; row < 3; ++row) {
    rows.push_back({c.rotation[0][row], c.rotation[1][row], c.rotation[2][row], translation[row]});
  }
  rows.push_back({0.0, 0.0, 0.0, 1.0});
  json j = {{"source", frame.report.camera_source},
            {"type", c.orthographic ? "ortho" : "persp"},
            {"fx", c.fx},
            {"fy", c.fy},
            {"cx", c.cx},
            {"cy", c.cy},
            {"hfov_deg", c.hfov_degrees(frame.part().display_window.width())},
            {"world_to_camera", rows},
            {"world_handedness", glm::determinant(c.rotation) < 0 ? "left" : "right"}};
  if (const auto& found = frame.report.header) {
    j["header"] = {{"source", found->source},
                   {"reading", found->reading},
                   {"proved_by", kProofs[std::size_t(found->proof)].name}};
    if (found->miss_px) j["header"]["miss_px"] = *found->miss_px;
  }
  if (const auto& r = frame.report.residual) {
    j["residual_px"] = {{"median", r->median_px}, {"p99", r->p99_px}, {"max", r->max_px}};
  }
  return j;
}

std::size_t surface_pixels(const Frame& frame) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < frame.scene.geometry.surfaces.size(); ++i)
    count += frame.scene.geometry.is_surface(i);
  return count;
}

json position_json(const Frame& frame) {
  if (!frame.layers[Role::position]) return nullptr;
  return {{"space", space_of_positions(frame)}, {"handedness", handedness(frame)}};
}

json depth_json(const Frame& frame) {
  if (!frame.layers[Role::depth]) return nullptr;
  return {{"kind", kind_of_depth(frame)},
          {"source", source_of_depth_kind(frame)},
          {"used", !frame.gbuffer.encodings.depth_is_wrong}};
}

json layers_json(const Frame& frame) {
  json layers = json::object();
  const auto add = [&](const std::string& role, const Layer& layer) {
    layers[role] = {
        {"layer", layer.name}, {"channels", layer.channels},
        {"part", layer.part},  {"file", frame.files[std::size_t(layer.file)].path().string()},
        {"half", layer.half},  {"by_request", layer.by_request}};
  };
  for (std::size_t i = 0; i < kRoleCount; ++i)
    if (const auto& layer = frame.layers.layers[i]) add(std::string(role_name(Role(i))), *layer);
  for (const auto& [name, layer] : frame.layers.lights) add("light:" + name, layer);
  return layers;
}

}  // namespace

std::string describe(const Frame& frame) {
  const Window &display = frame.part().display_window, &data = frame.gbuffer.file_window;
  std::string text =
      fmt::format("{}: {} x {}\n", printable(frame.input), display.width(), display.height());
  const auto line = [&](std::string_view key, const std::string& value) {
    text += fmt::format("  {:<10}{}\n", key, printable(value));
  };
  if (!frame.view.empty()) line("view", frame.view);
  if (!(data == display)) line("window", "data " + text_of(data));
  for (std::size_t i = 0; i < kRoleCount; ++i) {
    const auto& layer = frame.layers.layers[i];
    if (Role(i) == Role::normal)
      line("normal", describe_normals(frame));
    else if (layer)
      line(role_name(Role(i)), Role(i) == Role::position ? describe_positions(frame)
                               : Role(i) == Role::depth  ? describe_depth(frame)
                                                         : describe_layer(frame, *layer));
  }
  for (const auto& [name, layer] : frame.layers.lights)
    line("light:" + name, describe_layer(frame, layer));
  line("camera", describe_camera(frame));
  if (frame.report.header) line("header", describe(*frame.report.header));
  line("surfaces", fmt::format("{} of {} pixels ({} background, {} broken), median depth {:.4g}",
                               surface_pixels(frame), frame.scene.geometry.surfaces.size(),
                               frame.gbuffer.background_pixels, frame.gbuffer.bad_pixels,
                               frame.scene.geometry.median_depth));
  line("light", frame.light);
  line("plan", fmt::format("{}: {} ({} samples per pixel, {} bounce(s), filter {}{})",
                           fmt::join(frame.plan.make, ", "), frame.plan.method->name,
                           frame.plan.samples_per_pixel(), frame.plan.request.bounces,
                           frame.plan.filter_name(), frame.plan.temporal ? " and temporal" : ""));
  for (const std::string& reason : frame.plan.reasons) line("", reason);
  for (const std::string& line_of_history : frame.history) line("", line_of_history);
  for (const std::string& warning : warnings_of(frame)) line("warning", warning);
  for (const std::string& loss : frame.losses()) line("missing", loss);
  return text;
}

nlohmann::json to_json(const Frame& frame) {
  const Geometry& g = frame.scene.geometry;
  const ExrPart& part = frame.part();
  return {{"file", frame.input},
          {"view", frame.view},
          {"width", part.display_window.width()},
          {"height", part.display_window.height()},
          {"data_window", window_json(frame.gbuffer.file_window)},
          {"display_window", window_json(part.display_window)},
          {"parts", parts_json(frame.files.front())},
          {"layers", layers_json(frame)},
          {"camera", camera_json(frame)},
          {"position", position_json(frame)},
          {"depth", depth_json(frame)},
          {"normals",
           {{"space", frame.report.normal_space},
            {"agreement", frame.report.normal_agreement},
            {"rebuilt", frame.report.normals_rebuilt},
            {"turned", frame.report.normals_turned}}},
          {"pixels", g.surfaces.size()},
          {"surface_pixels", surface_pixels(frame)},
          {"background_pixels", frame.gbuffer.background_pixels},
          {"bad_pixels", frame.gbuffer.bad_pixels},
          {"median_depth", g.median_depth},
          {"light", frame.light},
          {"plan", to_json(frame.plan, frame.history)},
          {"warnings", warnings_of(frame)},
          {"missing", frame.losses()}};
}

}  // namespace ssdo
