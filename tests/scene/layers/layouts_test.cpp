// SPDX-License-Identifier: Apache-2.0
//
// Files whose parts, views and names are laid out as Nuke, Gaffer, V-Ray and Unreal write them.
#include <gtest/gtest.h>

#include "support/error_matchers.h"
#include "support/layer_file.h"

namespace ssdo::test::layouts_test {
namespace {

using Parts = std::vector<LayerPart>;

const Channels kColor = {"R", "G", "B", "A"}, kVector = {"x", "y", "z"},
               kRed = {"red", "green", "blue"};

/// A layer's components behind its name.
Channels layer(const std::string& name, const Channels& components) {
  Channels channels;
  for (const std::string& component : components) channels.push_back(name + "." + component);
  return channels;
}

Channels joined(const std::vector<Channels>& lists) {
  Channels all;
  for (const Channels& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// rgba, P, N, albedo and depth of one view, a part for each, named layer + `end`.
void add_view(Parts& parts, const std::string& end, const std::string& view) {
  parts.push_back({"rgba" + end, kColor, view});
  parts.push_back({"P" + end, kVector, view});
  parts.push_back({"N" + end, kVector, view});
  parts.push_back({"albedo" + end, kRed, view});
  parts.push_back({"depth" + end, {"Z"}, view});
}

/// The parts of all roles, in the order of add_view.
void expect_parts_from(const LayerTable& t, int first) {
  EXPECT_EQ(part_of(t, Role::beauty), first);
  EXPECT_EQ(part_of(t, Role::alpha), first);
  EXPECT_EQ(part_of(t, Role::position), first + 1);
  EXPECT_EQ(part_of(t, Role::normal), first + 2);
  EXPECT_EQ(part_of(t, Role::albedo), first + 3);
  EXPECT_EQ(part_of(t, Role::depth), first + 4);
}

// Issue 12, number 17: the part's name carries layer and view, the channels only components.
TEST(Layouts, PartsThatNameLayerAndView) {
  for (const std::string end : {"", ".main", "_main", "-main", ".left", "_left"}) {
    for (const std::string view : {"", "main", "left"}) {
      SCOPED_TRACE(end + " " + view);
      Parts parts;
      add_view(parts, end, view);
      const LayerTable t = LayerFile(parts).find();
      expect_parts_from(t, 0);
      EXPECT_EQ(channels_of(t, Role::position), kVector);
      EXPECT_EQ(name_of(t, Role::position), "P" + end) << "as the file spells it";
    }
  }
}

TEST(Layouts, NukeInterleavesChannelsAndLayers) {
  const LayerTable t = LayerFile(Parts{{"main",
                                        joined({kColor,
                                                layer("P", kRed),
                                                layer("N", kRed),
                                                layer("albedo", kRed),
                                                {"depth.Z"}}),
                                        "main"},
                                       {"cryptomatte", kColor, "main"}})
                           .find();
  EXPECT_EQ(name_of(t, Role::position), "main.P");
  EXPECT_EQ(name_of(t, Role::beauty), "main");
  EXPECT_EQ(part_of(t, Role::alpha), 0);
  EXPECT_EQ(channels_of(t, Role::depth), Channels{"depth.Z"});
}

/// Every way to store two views; `right` is the first part of the right one.
struct Stereo {
  std::string name;
  Parts parts;
};

std::vector<Stereo> stereo_layouts() {
  const auto layers = [](const std::string& before, const std::string& after) {
    return joined({layer(before + "P" + after, kRed), layer(before + "N" + after, kRed),
                   layer(before + "albedo" + after, kRed)});
  };
  const Channels left_old = joined({layer("left", kColor), layers("left.", "")}),
                 right_old = joined({layer("right", kColor), layers("right.", "")});
  std::vector<Stereo> all = {
      {"part per view",
       {{"left", joined({kColor, layers("", "")}), "left"},
        {"right", joined({kColor, layers("", "")}), "right"}}},
      {"part per view, by name",
       {{"left", joined({kColor, layers("", "")})}, {"right", joined({kColor, layers("", "")})}}},
      {"one part, view before the component",
       {{"",
         joined({kColor, layer("right", kColor), layers("", ".left"), layers("", ".right")}),
         "",
         {"left", "right"}}}},
      {"one part, the default view without its name",
       {{"",
         joined({kColor, layer("right", kColor), layers("", ""), layers("", ".right")}),
         "",
         {"left", "right"}}}},
      {"one part, view in front", {{"", joined({left_old, right_old}), "", {"left", "right"}}}},
      {"one part, view in front, by name", {{"", joined({left_old, right_old})}}}};
  for (const std::string separator : {".", "_"}) {
    for (const bool attribute : {true, false}) {
      Parts parts, mixed;
      add_view(parts, separator + "left", attribute ? "left" : "");
      add_view(parts, separator + "right", attribute ? "right" : "");
      all.push_back({"part per layer and view " + separator, parts});
      for (std::size_t i = 0; i < 5; ++i) mixed.insert(mixed.end(), {parts[i], parts[5 + i]});
      all.push_back({"the same, layer by layer", mixed});
    }
  }
  return all;
}

/// Which view a layer is of, by its channels or its part.
std::string view_of(const Stereo& stereo, const LayerTable& t, Role role) {
  const LayerPart& part = stereo.parts[std::size_t(part_of(t, role))];
  const std::string text = part.name + part.view + channels_of(t, role)[0];
  const bool left = text.find("left") != std::string::npos || part.multi_view.size() > 0;
  return text.find("right") != std::string::npos ? "right" : left ? "left" : "none";
}

// Issue 12, number 17: two views are an error that lists them; a view, or a part of one, chooses
// every role from that view.
TEST(Layouts, StereoIsOneViewOrAnError) {
  for (const Stereo& stereo : stereo_layouts()) {
    SCOPED_TRACE(stereo.name);
    const LayerFile file(stereo.parts);
    const Error error = error_of([&] { file.find(); });
    EXPECT_THAT(error, IsError(ExitCode::layer, "2 layers could be position"));
    EXPECT_THAT(error, IsError(ExitCode::layer, "choose --stereo left, right or all"));
    for (const std::string view : {"left", "right"}) {
      const LayerTable t = file.find({}, view);
      for (const Role role : {Role::position, Role::normal, Role::albedo, Role::alpha})
        EXPECT_EQ(view_of(stereo, t, role), view) << role_name(role);
    }
    for (const LayerPart& part : stereo.parts) {
      if (stereo.parts.size() == 1 || part.name[0] == 'd') continue;
      const std::string view = part.name.ends_with("left") ? "left" : "right";
      const LayerTable t = file.find({}, part.name);
      for (const Role role : {Role::position, Role::normal, Role::albedo, Role::alpha})
        EXPECT_EQ(view_of(stereo, t, role), view) << role_name(role) << " of " << part.name;
    }
  }
}

TEST(Layouts, ARequestedPositionBringsItsView) {
  Parts parts;
  add_view(parts, ".left", "left");
  add_view(parts, ".right", "right");
  expect_parts_from(LayerFile(parts).find({"position=P.right"}), 5);
  const LayerTable t = LayerFile(parts).find({"position=P.right", "albedo=albedo.left"});
  EXPECT_EQ(part_of(t, Role::albedo), 3) << "as asked for";
  EXPECT_EQ(part_of(LayerFile(parts).find({"normal=N"}, "right"), Role::normal), 7);
}

TEST(Layouts, NoFrameIsMadeOfTwoViews) {
  const Parts parts = {{"P.left", kVector},
                       {"N.left", kVector},
                       {"P.right", kVector},
                       {"N.right", kVector},
                       {"albedo.right", kRed}};
  EXPECT_EQ(part_of(LayerFile(parts).find({}, "left"), Role::albedo), -1);
  EXPECT_EQ(part_of(LayerFile(parts).find({}, "right"), Role::albedo), 4);
}

TEST(Layouts, LightsCalledLeftAndRightAreNoViews) {
  const Channels color = {"R", "G", "B"};
  const LayerTable t =
      LayerFile(joined({kColor, layer("P", kVector), layer("N", kVector), layer("left", kColor),
                        layer("right", kColor), layer("main", kColor)}))
          .find();
  EXPECT_EQ(channels_of(t, Role::beauty), color);
  EXPECT_EQ(channels_of(t, Role::alpha), Channels{"A"});
  EXPECT_EQ(name_of(t, Role::normal), "N");
}

// Issue 12, number 17: --part does not drop the roles that other parts of the picture hold.
TEST(Layouts, OtherPartsCompleteAPart) {
  const Parts parts = {{"Combined", kColor},
                       {"Position", kVector},
                       {"Normal", kVector},
                       {"DiffCol", kRed},
                       {"Depth", {"Z"}}};
  for (const std::string part : {"Position", "1", "Combined", "Normal"})
    expect_parts_from(LayerFile(parts).find({}, part), 0);
  EXPECT_EQ(part_of(LayerFile(parts).find({}, "Depth"), Role::position), -1)
      << "the depth was asked for";
}

TEST(Layouts, PartsOfAnotherElementDoNot) {
  const Channels both = joined({layer("P", kVector), layer("N", kVector)});
  const Parts parts = {{"fg", both}, {"bg", joined({both, layer("albedo", kRed)})}};
  EXPECT_EQ(part_of(LayerFile(parts).find({}, "fg"), Role::albedo), -1);
  EXPECT_EQ(part_of(LayerFile(parts).find({}, "bg"), Role::albedo), 1);
}

// Issue 12, number 17.
TEST(Layouts, NamesOfVRayAndUnreal) {
  const Channels color = {"R", "G", "B"};
  const LayerTable vray =
      LayerFile(joined({kColor, layer("VRayExtraTex_Pworld", color),
                        layer("VRayExtraTex_SuperAmbient", color), layer("VRayNormals", color),
                        layer("VRayDiffuseFilter", color), layer("VRayZDepth", color)}))
          .find();
  EXPECT_EQ(name_of(vray, Role::position), "VRayExtraTex_Pworld");
  EXPECT_EQ(name_of(vray, Role::albedo), "VRayDiffuseFilter");
  for (const std::string prefix : {"FinalImage", "", "ActorLayer_"}) {
    const std::string name = prefix + "MovieRenderQueue_WorldPosition";
    const LayerTable unreal =
        LayerFile(joined({kColor, layer(name, kColor),
                          layer(prefix + "MovieRenderQueue_WorldDepth", kColor)}))
            .find();
    EXPECT_EQ(channels_of(unreal, Role::position), layer(name, color));
    EXPECT_EQ(channels_of(unreal, Role::depth).size(), 1u);
  }
}

// Issue 12, number 17: what SamplerInfo holds depends on its type, so it is used on request.
TEST(Layouts, SamplerInfoIsUsedOnRequest) {
  for (const std::string name : {"V-Ray SamplerInfo", "VRaySamplerInfo"}) {
    const LayerFile file(joined({kColor, layer(name, {"R", "G", "B"})}));
    const LayerTable t = file.find();
    EXPECT_EQ(name_of(t, Role::position), "none");
    const ExrReader reader(file.path());
    EXPECT_THAT(error_of([&] { require_position(t, reader, "", ""); }),
                IsError(ExitCode::layer, "--aov \"position=" + name + "\""));
    EXPECT_EQ(name_of(file.find({"position=" + name}), Role::position), name);
  }
}

// Issue 12, number 17: Pz beside Px and Py is a coordinate.
TEST(Layouts, BareCoordinatesAreAPosition) {
  const Channels p = {"Px", "Py", "Pz"}, n = {"Nx", "Ny", "Nz"};
  const LayerTable t = LayerFile(joined({kColor, p, n})).find();
  EXPECT_EQ(channels_of(t, Role::position), p);
  EXPECT_EQ(channels_of(t, Role::normal), n);
  EXPECT_EQ(channels_of(t, Role::depth), Channels{});
  EXPECT_EQ(channels_of(LayerFile(joined({p, {"Z"}})).find(), Role::depth), Channels{"Z"});
  EXPECT_EQ(channels_of(LayerFile({"Pz"}).find(), Role::depth), Channels{"Pz"}) << "of Mantra";
  EXPECT_EQ(channels_of(LayerFile({"Px", "Py", "Pz", "Pworld.x", "Pworld.y", "Pworld.z"}).find(),
                        Role::position),
            layer("Pworld", kVector));
}

}  // namespace
}  // namespace ssdo::test::layouts_test
