// SPDX-License-Identifier: Apache-2.0
//
// A row for each tool whose files are known: names, types, parts and attributes as it writes them.
// Names that users give are those of the tool's manuals.
#include "dcc/tool_cases.h"

#include <limits>

namespace ssdo::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

const std::map<std::string, std::string> kBlender = {
    {"BlenderMultiChannel", "Blender V2.55.1 and newer"}};

StoredLayer beauty(const std::string& layer, const std::string& components,
                   const std::string& part = "") {
  std::vector<std::string> names = channels(layer, components);
  if (layer.empty()) names = {"R", "G", "B", "A"};
  return {Role::beauty, names, grey(), Imf::HALF, part};
}

StoredLayer position(const std::string& layer, const std::string& components,
                     const Content& content = world_position()) {
  return {Role::position, channels(layer, components), content};
}

StoredLayer normal(const std::string& layer, const std::string& components,
                   const Content& content = world_normal()) {
  return {Role::normal, channels(layer, components), content};
}

StoredLayer albedo(const std::string& layer, const std::string& components = "RGB") {
  return {Role::albedo, channels(layer, components), grey(), Imf::HALF};
}

StoredLayer depth(const std::vector<std::string>& names, const Content& content) {
  return {Role::depth, names, content};
}

/// What no role takes.
StoredLayer unused(const std::vector<std::string>& names, const Content& content) {
  return {std::nullopt, names, content};
}

/// The layers, each in a part: of that name, or of the name of its channels' layer.
StoredShot in_parts(StoredShot shot) {
  for (StoredLayer& layer : shot.layers) {
    const std::string& first = layer.channels[0];
    if (layer.part.empty()) layer.part = first.substr(0, first.rfind('.'));
  }
  return shot;
}

StoredShot in_half(StoredShot shot) {
  for (StoredLayer& layer : shot.layers) layer.type = Imf::HALF;
  return shot;
}

std::vector<Tool> blender() {
  const StoredShot single = {
      {beauty("ViewLayer.Combined", "RGBA"), position("ViewLayer.Position", "XYZ"),
       normal("ViewLayer.Normal", "XYZ"), albedo("ViewLayer.DiffCol"),
       depth({"ViewLayer.Depth.Z"}, planar_depth(1e10f)),
       unused({"ViewLayer.IndexOB.X"}, planar_depth())},
      kBlender};
  return {
      {.name = "Blender 4 and older", .shot = single},
      {.name = "Blender 5",
       .shot =
           in_parts({{beauty("ViewLayer.Combined", "RGBA"), position("ViewLayer.Position", "XYZ"),
                      normal("ViewLayer.Normal", "XYZ"), albedo("ViewLayer.Diffuse Color"),
                      depth({"ViewLayer.Depth.Z"}, planar_depth(1e10f)),
                      unused({"ViewLayer.Object Index.X"}, planar_depth())},
                     kBlender})},
      {.name = "Blender, File Output node",
       .shot = {{position("Position", "XYZ"), normal("Normal", "XYZ"), albedo("Albedo", "RGBA"),
                 depth({"Depth.V"}, planar_depth(1e10f))},
                kBlender},
       .note = "The slots of the node have these names."},
      {.name = "Blender, denoising data",
       .shot = {{position("ViewLayer.Position", "XYZ"),
                 normal("ViewLayer.Denoising Normal", "XYZ", camera_normal()),
                 albedo("ViewLayer.Denoising Albedo"),
                 depth({"ViewLayer.Depth.Z"}, planar_depth(1e10f))},
                kBlender},
       .found = {.normals = "camera space"}},
  };
}

/// A pass of Cycles without Blender: four channels without a name, in a file of its own.
StoredLayer pass(Role role, const std::string& name, const Content& content) {
  return {role, {"R", "G", "B", "A"}, content, Imf::FLOAT, name};
}

std::vector<Tool> cycles() {
  StoredShot shot = {{pass(Role::position, "position", world_position()),
                      pass(Role::normal, "normal", world_normal()),
                      pass(Role::albedo, "diffuse_color", grey()),
                      pass(Role::depth, "depth", planar_depth(1e10f))}};
  shot.apart = true;
  return {{.name = "Cycles, standalone",
           .shot = shot,
           .flags = {"--aov", "position=rgba", "--aov", "normal=DIR/normal.exr:rgba", "--aov",
                     "albedo=DIR/diffuse_color.exr:rgba", "--aov", "depth=DIR/depth.exr:rgba"},
           .refusal = {"if its one layer is the position, say --aov position=rgba"},
           .note = "A file for each pass; that of the positions is INPUT."}};
}

std::vector<Tool> arnold_and_gaffer() {
  const std::map<std::string, std::string> arnold = {{"arnold/version", "7.2.4.0"}},
                                           gaffer = {{"gaffer:version", "1.4.0.0"}};
  return {
      {.name = "Arnold",
       .shot = {{beauty("", "RGBA"), position("P", "XYZ", world_position(kYUp)),
                 normal("N", "XYZ", world_normal(kYUp)), albedo("diffuse_albedo"),
                 depth({"Z"}, planar_depth(1e30f))},
                arnold}},
      {.name = "Arnold, AOVs of type RGB",
       .shot = {{beauty("", "RGBA"), position("P", "RGB", world_position(kYUp)),
                 normal("N", "RGB", world_normal(kYUp)), albedo("albedo"),
                 depth(channels("Z", "RGB"), planar_depth(1e30f)),
                 unused(channels("N_noice", "RGB"), camera_normal())},
                arnold}},
      {.name = "Gaffer with Arnold",
       .shot = in_parts({{beauty("", "RGBA", "rgba"),
                          position("P", "RGB", world_position(kYUp)),
                          normal("N", "RGB", world_normal(kYUp)),
                          albedo("diffuse_albedo"),
                          {Role::depth, {"Z"}, planar_depth(1e30f), Imf::FLOAT, "depth"}},
                         gaffer})},
      {.name = "Gaffer with Cycles",
       .shot = in_parts({{beauty("", "RGBA", "rgba"),
                          position("position", "RGB", world_position(kYUp)),
                          normal("normal", "RGB", world_normal(kYUp)),
                          albedo("diffuse_color"),
                          {Role::depth, {"depth.Z"}, planar_depth(1e10f), Imf::FLOAT, "depth"}},
                         gaffer})},
  };
}

std::vector<Tool> vray() {
  const std::map<std::string, std::string> header = {{"vrayInfo/vrayversion", "6.10.08"},
                                                     {"vrayInfo/camera", "Camera001"}};
  const std::string sampler =
      "if 'VRaySamplerInfo' was rendered with type Point, say --aov "
      "\"position=VRaySamplerInfo\"";
  StoredShot max = {{beauty("", "RGBA"), position("VRaySamplerInfo", "RGB"),
                     normal("VRayNormals", "RGB", camera_normal()), albedo("VRayDiffuseFilter"),
                     depth(channels("VRayZDepth", "RGBA"), remapped_depth(10, 2))},
                    header};
  max.tiled = true;
  return {
      {.name = "V-Ray, Maya and Standalone",
       .shot = {{beauty("", "RGBA"), position("VRaySamplerInfo", "XYZ", world_position(kYUp)),
                 normal("normals", "XYZ", camera_normal({-1, 1, 1})), albedo("diffuseFilter"),
                 depth({"Z"}, planar_depth())},
                header},
       .found = {.normals = "camera space, axes (-x, y, z)"},
       .flags = {"--aov", "position=VRaySamplerInfo"},
       .refusal = {"has depth but no position", sampler}},
      {.name = "V-Ray, 3ds Max",
       .shot = max,
       .found = {.normals = "camera space", .depth = "left out"},
       .warnings = {"depth contradicts P (it changes by 0.125 per unit of P"},
       .flags = {"--aov", "position=VRaySamplerInfo"},
       .refusal = {"depth 'VRayZDepth' has no known unit: V-Ray maps it from a black to a white",
                   "--depth-kind normalized:NEAR,FAR", sampler}},
      {.name = "V-Ray, without a position",
       .shot = {{beauty("", "RGBA"), normal("VRayNormals", "RGB", camera_normal()),
                 albedo("VRayDiffuseFilter"),
                 depth(channels("VRayZDepth", "RGBA"), remapped_depth(10, 2))},
                header},
       .found = {.space = "", .normals = "camera space", .depth = "planar by --depth-kind"},
       .flags = {"--depth-kind", "normalized:10,2", "--fov", "40"},
       .refusal = {"--depth-kind normalized:NEAR,FAR"},
       .note = "NEAR and FAR are the distances of black and white."},
  };
}

std::vector<Tool> film_renderers() {
  return {
      {.name = "RenderMan",
       .shot = {{beauty("Ci", "rgb"), position("__Pworld", "rgb", world_position(kYUp)),
                 unused(channels("P", "rgb"), camera_position({1, 1, -1})),
                 normal("__Nworld", "rgb", world_normal(kYUp)), albedo("albedo", "rgb"),
                 depth({"Z"}, planar_depth(kInfinity))}}},
      {.name = "3Delight",
       .shot = {{beauty("", "RGBA"), position("P.world", "xyz", world_position(kYUp)),
                 unused(channels("P.camera", "xyz"), camera_position()),
                 normal("N.world", "xyz", world_normal(kYUp)),
                 unused(channels("N.camera", "xyz"), camera_normal()), albedo("albedo", "rgb"),
                 depth({"z"}, planar_depth(1e30f))}}},
      {.name = "3Delight, camera space",
       .shot = {{beauty("", "RGBA"), position("P.camera", "xyz", camera_position()),
                 normal("N.camera", "xyz", camera_normal()), albedo("albedo", "rgb"),
                 depth({"z"}, planar_depth(1e30f))}},
       .found = {.space = "camera"}},
      {.name = "Karma",
       .shot = {{beauty("C", "rgba"), position("P", "xyz", world_position(kYUp)),
                 normal("N", "xyz", world_normal(kYUp)), albedo("albedo", "rgb"),
                 depth({"ray:hitPz"}, planar_depth())}}},
      {.name = "Karma, distance only",
       .shot = {{beauty("C", "rgba"), normal("N", "xyz", camera_normal()), albedo("albedo", "rgb"),
                 depth({"ray:hitdist"}, ray_depth())}},
       .found = {.space = "", .normals = "camera space", .depth = "ray by its name"},
       .flags = {"--fov", "40"},
       .refusal = {"give --fov DEGREES"}},
      {.name = "Mantra",
       .shot = {{beauty("C", "rgba"),
                 position("P", "xyz", world_position(kYUp)),
                 normal("N", "xyz", world_normal(kYUp)),
                 {Role::albedo, channels("diffuse_color_noshading", "rgb"), grey()},
                 depth({"Pz"}, planar_depth())}},
       .flags = {"--aov", "albedo=diffuse_color_noshading"},
       .hints = {"no layer for albedo found by name: no bounce and no composite; if "
                 "'diffuse_color_noshading' is the albedo, "
                 "say --aov \"albedo=diffuse_color_noshading\""}},
      {.name = "MoonRay",
       .shot = in_half({{beauty("", "RGBA"), position("WP", "xyz", world_position(kYUp)),
                         normal("N", "xyz", world_normal(kYUp)), albedo("albedo", "rgb")}}),
       .found = {.depth = ""},
       .warnings = {"position is stored in 16 bits"},
       .bound = 2e-3},
      {.name = "mental ray",
       .shot = {{beauty("", "RGBA"), normal("Normals", "xyz", camera_normal()),
                 depth({"Z"}, planar_depth())}},
       .found = {.space = "", .normals = "camera space", .depth = "planar assumed"},
       .flags = {"--fov", "40"},
       .refusal = {"has depth but no position", "--fov DEGREES"}},
      {.name = "Iray",
       .shot = in_half({{beauty("", "RGBA"), normal("normal", "XYZ", camera_normal())}}),
       .refusal = {"no layer for position or depth found by name", "--aov position=LAYER"}},
  };
}

std::vector<Tool> gpu_renderers() {
  StoredShot redshift = {
      {beauty("", "RGBA"), position("World Position", "RGB"), normal("Normals", "RGB"),
       albedo("Diffuse Filter"), depth({"Z"}, planar_depth())},
      {{"rs/version", "3.5.24"}}};
  redshift.layers[2].type = Imf::HALF;
  redshift.cropped = true;
  return {
      {.name = "Redshift", .shot = redshift, .bound = 2e-2},
      {.name = "Redshift, Z Normalized Inverted",
       .shot = {{beauty("", "RGBA"), normal("Normals", "RGB", camera_normal()),
                 depth({"Z Normalized Inverted"}, remapped_depth(kShotFar, kShotNear))}},
       .found = {.space = "", .normals = "camera space", .depth = "planar by --depth-kind"},
       .flags = {"--depth-kind", "normalized:10,2", "--fov", "40"},
       .refusal = {"depth 'Z Normalized Inverted' has no known unit: Redshift",
                   "--depth-kind normalized:NEAR,FAR"}},
      {.name = "Octane",
       .shot = {{beauty("", "RGBA"),
                 position("Position", "RGB", world_position(kYUp)),
                 {Role::normal, channels("Shading normal", "RGB"), world_normal(kYUp)},
                 depth(channels("Z depth", "RGB"), remapped_depth())}},
       .found = {.depth = "left out"},
       .warnings = {"depth contradicts P (it changes by 0.125 per unit of P"},
       .flags = {"--aov", "normal=Shading normal"},
       .hints = {"depth contradicts P",
                 "no layer for normal found by name: normals are rebuilt from the position; "
                 "if 'Shading normal' is "
                 "the normal, say --aov \"normal=Shading normal\""}},
      {.name = "Corona",
       .shot = {{beauty("", "RGBA"), position("CGeometry_WorldPosition", "RGB"),
                 normal("CGeometry_NormalsShading", "RGB"), albedo("CShading_Albedo"),
                 depth({"CGeometry_ZDepth.R"}, remapped_depth(kShotFar, kShotNear))}},
       .found = {.depth = "left out"},
       .warnings = {"depth contradicts P (it changes by 0.125 per unit of P"}},
      {.name = "Mitsuba 3",
       .shot = in_half({{beauty("", "RGBA"), position("position", "XYZ", world_position(kYUp)),
                         normal("sh_normal", "XYZ", world_normal(kYUp)), albedo("albedo"),
                         depth({"depth.T"}, ray_depth())}}),
       .found = {.depth = "ray by P"},
       .warnings = {"position is stored in 16 bits"},
       .bound = 2e-3},
      {.name = "Mitsuba 3, depth only",
       .shot = {{beauty("", "RGBA"), depth({"depth.T"}, ray_depth())}},
       .found = {.space = "", .normals = "rebuilt from P", .depth = "ray by its name"},
       .flags = {"--fov", "40"},
       .refusal = {"give --fov DEGREES"},
       .bound = 0.02},
      {.name = "pbrt-v4",
       .shot = in_half(
           {{beauty("", "RGBA"), position("P", "XYZ", camera_position({1, 1, -1})),
             normal("N", "XYZ", camera_normal({1, 1, -1})),
             unused(channels("Ns", "XYZ"), camera_normal({1, 1, -1})), albedo("Albedo"),
             unused({"dzdx", "dzdy"}, planar_depth()), unused({"u", "v"}, planar_depth())}}),
       .found = {.space = "camera", .handedness = "left", .depth = ""},
       .warnings = {"position is stored in 16 bits"},
       .bound = 5e-3},
  };
}

std::vector<Tool> engines_and_compositors() {
  const std::map<std::string, std::string> unreal = {{"unreal/frame", "0001"}};
  return {
      {.name = "Unreal, Movie Render Queue",
       .shot = {{beauty("FinalImageBeauty", "RGBA"),
                 position("FinalImageWorldPosition", "RGB", world_position(kLeftHandedCentimetres)),
                 normal("FinalImageWorldNormal", "RGB",
                        as_color(world_normal(kLeftHandedCentimetres))),
                 {Role::albedo, channels("FinalImageBaseColor", "RGB"), grey()},
                 depth({"FinalImageMovieRenderQueue_WorldDepth.R"}, planar_depth(1e10f, 100))},
                unreal},
       .found = {.handedness = "left"},
       .warnings = {"normals are encoded as 0..1"},
       .flags = {"--aov", "position=FinalImageWorldPosition", "--aov",
                 "normal=FinalImageWorldNormal", "--aov", "albedo=FinalImageBaseColor"},
       .refusal = {"has depth but no position",
                   "if 'FinalImageWorldPosition' is the position, say --aov "
                   "\"position=FinalImageWorldPosition\""},
       .note = "Centimetres, z up. The names are those of the materials that render the layers."},
      {.name = "Unity Recorder",
       .shot = in_parts({{beauty("Beauty", "RGBA"),
                          normal("Normal", "RGB", as_color(camera_normal())),
                          albedo("Albedo"),
                          {Role::depth, {"Depth.R"}, remapped_depth(), Imf::FLOAT, "Depth"}}}),
       .found = {.space = "", .normals = "camera space", .depth = "planar by --depth-kind"},
       .warnings = {"normals are encoded as 0..1"},
       .flags = {"--depth-kind", "normalized:2,10", "--fov", "40"},
       .refusal = {"seems to be normalised to 0..1", "--depth-kind normalized:NEAR,FAR"}},
      {.name = "Falcor",
       .shot = {{position("posW", "RGBA", world_position(kYUp)),
                 normal("normW", "RGBA", world_normal(kYUp)), albedo("diffuseOpacity", "RGBA"),
                 unused(channels("depth", "R"), remapped_depth()),
                 depth(channels("linearZ", "RG"), planar_depth())}}},
      {.name = "3ds Max",
       .shot = {{beauty("", "RGBA"),
                 {Role::normal, {"NX", "NY", "NZ"}, camera_normal()},
                 depth({"Z"}, planar_depth(1e30f))}},
       .found = {.space = "", .normals = "camera space", .depth = "planar assumed"},
       .flags = {"--fov", "40"},
       .refusal = {"has depth but no position", "--fov DEGREES"}},
      {.name = "Nuke",
       .shot =
           {{beauty("", "RGBA", "rgba"),
             {Role::position,
              {"P.red", "P.green", "P.blue"},
              world_position(kYUp),
              Imf::FLOAT,
              "P"},
             {Role::normal, {"N.red", "N.green", "N.blue"}, world_normal(kYUp), Imf::FLOAT, "N"},
             {Role::albedo,
              {"albedo.red", "albedo.green", "albedo.blue"},
              grey(),
              Imf::HALF,
              "albedo"},
             {Role::depth, {"Z"}, planar_depth(), Imf::FLOAT, "depth"}},
            {{"nuke/version", "14.0v5"}}}},
      {.name = "Nuke, ScanlineRender",
       .shot = {{beauty("", "RGBA"), depth({"depth.Z"}, inverse_depth())},
                {{"nuke/version", "14.0v5"}}},
       .found = {.space = "", .normals = "rebuilt from P", .depth = "planar by --depth-kind"},
       .flags = {"--depth-kind", "inverse", "--fov", "40"},
       .refusal = {"or 1 / Z", "--depth-kind inverse"},
       .bound = 0.02},
  };
}

}  // namespace

std::vector<std::string> flags_in(const std::string& folder, const Tool& tool) {
  std::vector<std::string> flags = tool.flags;
  for (std::string& flag : flags) {
    const auto place = flag.find("DIR");
    if (place != std::string::npos) flag.replace(place, 3, folder);
  }
  return flags;
}

std::vector<Tool> tools() {
  std::vector<Tool> all;
  for (auto* group : {blender, cycles, arnold_and_gaffer, vray, film_renderers, gpu_renderers,
                      engines_and_compositors}) {
    const std::vector<Tool> rows = group();
    all.insert(all.end(), rows.begin(), rows.end());
  }
  return all;
}

}  // namespace ssdo::test
