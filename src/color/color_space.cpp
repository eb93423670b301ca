// SPDX-License-Identifier: Apache-2.0
#include "color/color_space.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "error.h"
#include "io/one_line.h"
#include "nearest_name.h"

namespace ssdo {
namespace {

namespace OCIO = OCIO_NAMESPACE;
using Names = std::vector<std::string>;

/// A linear space that files can name by id or by chromaticities.
struct KnownSpace {
  const char* interop_id;  ///< of the Color Interop Forum
  const char* primaries;   ///< for messages
  Chromaticities chromaticities;
  Names names;  ///< what the configs in use call it
};

/// Chromaticities: ITU-R BT.709, Academy S-2014-004 (AP1), SMPTE ST 2065-1 (AP0) and EG 432-1 (P3),
/// ITU-R BT.2020. Names: of the ACES 1, CG, Studio and Blender configs.
const std::vector<KnownSpace>& known_spaces() {
  static const std::vector<KnownSpace> spaces = {
      {"lin_rec709_scene",
       "Rec.709",
       kRec709,
       {"lin_rec709_scene", "lin_rec709", "lin_rec709_srgb", "Linear Rec.709 (sRGB)",
        "Linear Rec.709", "Utility - Linear - sRGB", "Utility - Linear - Rec.709", "lin_srgb",
        "Linear BT.709"}},
      {"lin_ap1_scene",
       "AP1 (ACEScg)",
       {.713f, .293f, .165f, .830f, .128f, .044f, .32168f, .33767f},
       {"lin_ap1_scene", "ACEScg", "lin_ap1", "ACES - ACEScg", "Linear ACEScg"}},
      {"lin_ap0_scene",
       "AP0 (ACES2065-1)",
       {.7347f, .2653f, 0, 1, .0001f, -.0770f, .32168f, .33767f},
       {"lin_ap0_scene", "ACES2065-1", "aces2065_1", "lin_ap0", "ACES - ACES2065-1", "Linear ACES",
        "aces_interchange"}},
      {"lin_p3d65_scene",
       "P3-D65",
       {.680f, .320f, .265f, .690f, .150f, .060f, .3127f, .3290f},
       {"lin_p3d65_scene", "lin_p3d65", "Linear P3-D65", "Utility - Linear - P3-D65",
        "Linear DCI-P3 D65"}},
      {"lin_rec2020_scene",
       "Rec.2020",
       {.708f, .292f, .170f, .797f, .131f, .046f, .3127f, .3290f},
       {"lin_rec2020_scene", "lin_rec2020", "Linear Rec.2020", "Utility - Linear - Rec.2020",
        "Linear BT.2020"}},
  };
  return spaces;
}

/// A source that says which space the colours have, and the names that space may have.
struct Claim {
  std::string source;
  Names names;
  std::optional<Chromaticities> primaries{};  ///< of linear colours
};

Claim claim_of_interop_id(const std::string& id) {
  Claim claim{"colorInteropID " + one_line(id), {id}};
  for (const KnownSpace& space : known_spaces()) {
    if (id != space.interop_id) continue;
    claim.names = space.names;
    claim.primaries = space.chromaticities;
  }
  return claim;
}

Claim claim_of_aces_container() {
  Claim ap0 = claim_of_interop_id("lin_ap0_scene");
  ap0.source = "acesImageContainerFlag";
  return ap0;
}

const KnownSpace* find_known(const Chromaticities& chromaticities) {
  for (const KnownSpace& space : known_spaces()) {
    if (same_chromaticities(chromaticities, space.chromaticities)) return &space;
  }
  return nullptr;
}

Claim claim_of_chromaticities(const Chromaticities& chromaticities) {
  const KnownSpace* known = find_known(chromaticities);
  return {"chromaticities of " + describe_primaries(chromaticities), known ? known->names : Names(),
          chromaticities};
}

/// The default rule says nothing about this file, so it claims nothing. A version 1 config has no
/// rules: OpenColorIO would look for its spaces' names all over the path, "log" in catalog/ too.
std::vector<Claim> claims_of_file_rules(const OCIO::Config& config, const std::string& path) {
  if (config.getMajorVersion() < 2) return {};
  if (config.filepathOnlyMatchesDefaultRule(path.c_str())) return {};
  std::size_t rule = 0;
  const std::string name = config.getColorSpaceFromFilepath(path.c_str(), rule);
  return {{fmt::format("file rule {}", config.getFileRules()->getName(rule)), {name}, {}}};
}

/// All claims, the most trusted first.
std::vector<Claim> claims(const OCIO::Config& config, const ColorTags& tags) {
  std::vector<Claim> all;
  if (!tags.interop_id.empty()) all.push_back(claim_of_interop_id(tags.interop_id));
  if (tags.aces_container) all.push_back(claim_of_aces_container());
  if (tags.chromaticities) all.push_back(claim_of_chromaticities(*tags.chromaticities));
  for (Claim& claim : claims_of_file_rules(config, tags.path.string())) {
    all.push_back(std::move(claim));
  }
  return all;
}

/// By name, alias or role; null if the config has none of these.
OCIO::ConstColorSpaceRcPtr find_space(const OCIO::Config& config, const Names& names) {
  for (const std::string& name : names) {
    if (const auto space = config.getColorSpace(name.c_str())) return space;
  }
  return nullptr;
}

/// A linear space that the config has, and the conversion to it; nothing where it has none.
std::optional<InputSpace> convert(const OCIO::Config& config, const Claim& claim) {
  if (!claim.primaries) return std::nullopt;
  for (const KnownSpace& known : known_spaces()) {
    const auto space = find_space(config, known.names);
    if (!space || space->isData()) continue;
    const auto conversion = conversion_of_primaries(*claim.primaries, known.chromaticities);
    if (conversion) return InputSpace{space->getName(), claim.source, {}, conversion};
  }
  return std::nullopt;
}

Names spaces_of(const OCIO::Config& config) {
  Names names;
  for (int i = 0; i < config.getNumColorSpaces(); ++i) {
    names.emplace_back(config.getColorSpaceNameByIndex(i));
  }
  return names;
}

}  // namespace

std::string describe_primaries(const Chromaticities& chromaticities) {
  const KnownSpace* known = find_known(chromaticities);
  return known ? known->primaries
               : fmt::format("no known space ({:g})", fmt::join(chromaticities, " "));
}

InputSpace choose_input_space(const OCIO::Config& config, const std::string& config_label,
                              const std::string& colorspace, const ColorTags& tags) {
  if (!colorspace.empty()) {
    if (const auto space = find_space(config, {colorspace})) {
      return {space->getName(), "--colorspace", {}};
    }
    const Names names = spaces_of(config);
    throw Error(
        ExitCode::usage,
        fmt::format("--colorspace {}: {} has no such colour space; {}it has: {}", colorspace,
                    config_label, did_you_mean(colorspace, names), fmt::join(names, ", ")));
  }
  Names passed_over;
  bool claims_colors = false;
  for (const Claim& claim : claims(config, tags)) {
    const auto space = find_space(config, claim.names);
    if (space && !space->isData()) return {space->getName(), claim.source, passed_over};
    if (auto converted = space ? std::nullopt : convert(config, claim)) {
      converted->passed_over = passed_over;
      return *converted;
    }
    passed_over.push_back(claim.source + (space ? " (data, no colours)" : " (not in the config)"));
    claims_colors |= !space;
  }
  if (const auto space = config.getColorSpace(OCIO::ROLE_SCENE_LINEAR)) {
    InputSpace input{space->getName(), "role scene_linear", passed_over};
    if (claims_colors) {
      input.warning = fmt::format(
          "{}: its colours are taken as {}, the role scene_linear of {}; name their space with "
          "--colorspace",
          fmt::join(passed_over, ", "), input.name, config_label);
    }
    return input;
  }
  throw Error(
      ExitCode::usage,
      fmt::format("{} has no role scene_linear to take the input's colours by; name their space "
                  "with --colorspace, one of: {}",
                  config_label, fmt::join(spaces_of(config), ", ")));
}

}  // namespace ssdo
