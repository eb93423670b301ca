// SPDX-License-Identifier: Apache-2.0
#include "scene/layers/layers.h"

#include <gtest/gtest.h>

#include "support/error_matchers.h"
#include "support/layer_file.h"

namespace ssdo::test::layers_test {
namespace {

using File = LayerFile;
using Parts = std::vector<LayerPart>;

TEST(Layers, FindsBlender) {
  const auto t = File({"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B",
                       "ViewLayer.Combined.A", "ViewLayer.Depth.Z", "ViewLayer.Position.X",
                       "ViewLayer.Position.Y", "ViewLayer.Position.Z", "ViewLayer.Normal.X",
                       "ViewLayer.Normal.Y", "ViewLayer.Normal.Z", "ViewLayer.DiffCol.R",
                       "ViewLayer.DiffCol.G", "ViewLayer.DiffCol.B", "ViewLayer.Mist.Z"})
                     .find();
  EXPECT_EQ(channels_of(t, Role::position),
            (Channels{"ViewLayer.Position.X", "ViewLayer.Position.Y", "ViewLayer.Position.Z"}));
  EXPECT_EQ(channels_of(t, Role::albedo),
            (Channels{"ViewLayer.DiffCol.R", "ViewLayer.DiffCol.G", "ViewLayer.DiffCol.B"}));
  EXPECT_EQ(channels_of(t, Role::depth), Channels{"ViewLayer.Depth.Z"});
  EXPECT_EQ(channels_of(t, Role::alpha), Channels{"ViewLayer.Combined.A"});
}

/// Of these, neither a match nor a hint was found.
TEST(Layers, FindsShortNames) {
  const auto vector = [](const std::string& layer) {
    return Channels{layer + ".R", layer + ".G", layer + ".B"};
  };
  for (const char* name : {"WPos", "wpp", "Pw", "pos", "P_world", "world_P", "position_world"})
    EXPECT_EQ(channels_of(File(vector(name)).find(), Role::position), vector(name)) << name;
  for (const char* name : {"Nw", "normal_world", "nrm"}) {
    Channels both = vector(name), p = vector("P");
    both.insert(both.end(), p.begin(), p.end());
    EXPECT_EQ(channels_of(File(both).find(), Role::normal), vector(name)) << name;
  }
  Channels both = vector("alb"), p = vector("pos"), better = vector("P");
  both.insert(both.end(), p.begin(), p.end());
  EXPECT_EQ(channels_of(File(both).find(), Role::albedo), vector("alb"));
  both.insert(both.end(), better.begin(), better.end());
  EXPECT_EQ(channels_of(File(both).find(), Role::position), better) << "the usual name comes first";
}

TEST(Layers, FindsBlender5InParts) {
  const auto t =
      File(Parts{{"ViewLayer.Combined",
                  {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B",
                   "ViewLayer.Combined.A"}},
                 {"ViewLayer.Position",
                  {"ViewLayer.Position.X", "ViewLayer.Position.Y", "ViewLayer.Position.Z"}},
                 {"ViewLayer.Diffuse Color",
                  {"ViewLayer.Diffuse Color.R", "ViewLayer.Diffuse Color.G",
                   "ViewLayer.Diffuse Color.B"}}})
          .find();
  EXPECT_EQ(t[Role::position]->part, 1);
  EXPECT_EQ(t[Role::albedo]->part, 2);
  EXPECT_EQ(t[Role::albedo]->name, "ViewLayer.Diffuse Color");
}

TEST(Layers, FindsArnold) {
  const auto t = File({"R",
                       "G",
                       "B",
                       "A",
                       "P.X",
                       "P.Y",
                       "P.Z",
                       "N.X",
                       "N.Y",
                       "N.Z",
                       "Z",
                       "Pref.X",
                       "Pref.Y",
                       "Pref.Z",
                       "N_noice.X",
                       "N_noice.Y",
                       "N_noice.Z",
                       "diffuse_albedo.R",
                       "diffuse_albedo.G",
                       "diffuse_albedo.B",
                       "diffuse.R",
                       "diffuse.G",
                       "diffuse.B"})
                     .find();
  EXPECT_EQ(channels_of(t, Role::position), (Channels{"P.X", "P.Y", "P.Z"}));
  EXPECT_EQ(channels_of(t, Role::normal), (Channels{"N.X", "N.Y", "N.Z"}));
  EXPECT_EQ(channels_of(t, Role::albedo)[0], "diffuse_albedo.R");
  EXPECT_EQ(channels_of(t, Role::depth), Channels{"Z"});
  EXPECT_EQ(channels_of(t, Role::beauty), (Channels{"R", "G", "B"}));
  EXPECT_EQ(channels_of(t, Role::alpha), Channels{"A"});
}

TEST(Layers, FindsRenderManWithLowerCaseChannels) {
  const auto t = File({"__Pworld.r", "__Pworld.g", "__Pworld.b", "__Nworld.r", "__Nworld.g",
                       "__Nworld.b", "albedo.r", "albedo.g", "albedo.b", "__depth.r", "__depth.g",
                       "__depth.b", "Ci.r", "Ci.g", "Ci.b"})
                     .find();
  EXPECT_EQ(channels_of(t, Role::position)[2], "__Pworld.b");
  EXPECT_EQ(channels_of(t, Role::normal)[0], "__Nworld.r");
  EXPECT_EQ(channels_of(t, Role::depth), Channels{"__depth.r"});
}

TEST(Layers, FindsNukeSpellings) {
  const auto t =
      File({"position.red", "position.green", "position.blue", "normals.red", "normals.green",
            "normals.blue", "albedo.red", "albedo.green", "albedo.blue", "depth.Z"})
          .find();
  EXPECT_EQ(channels_of(t, Role::position),
            (Channels{"position.red", "position.green", "position.blue"}));
  EXPECT_EQ(channels_of(t, Role::depth), Channels{"depth.Z"});
}

TEST(Layers, FindsNukePartsWhoseChannelsHaveNoLayer) {
  const auto t = File(Parts{{"rgba", {"R", "G", "B", "A"}},
                            {"P", {"X", "Y", "Z"}},
                            {"N", {"X", "Y", "Z"}},
                            {"depth", {"Z"}}})
                     .find();
  EXPECT_EQ(t[Role::position]->part, 1);
  EXPECT_EQ(t[Role::normal]->part, 2);
  EXPECT_EQ(t[Role::depth]->part, 3);
  EXPECT_EQ(t[Role::beauty]->part, 0);
}

TEST(Layers, FindsBareNormalComponentsAndFileOutputDepth) {
  const auto t =
      File({"NX", "NY", "NZ", "Depth.V", "Position.X", "Position.Y", "Position.Z"}).find();
  EXPECT_EQ(channels_of(t, Role::normal), (Channels{"NX", "NY", "NZ"}));
  EXPECT_EQ(channels_of(t, Role::depth), Channels{"Depth.V"});
}

TEST(Layers, PrefersWorldAndTakesDenoiserNormalsLast) {
  const auto t =
      File({"P.X", "P.Y", "P.Z", "Pworld.X", "Pworld.Y", "Pworld.Z", "Denoising Normal.X",
            "Denoising Normal.Y", "Denoising Normal.Z", "Normal.X", "Normal.Y", "Normal.Z"})
          .find();
  EXPECT_EQ(t[Role::position]->name, "Pworld");
  EXPECT_EQ(t[Role::normal]->name, "Normal");
}

TEST(Layers, AnEqualClaimIsAnErrorThatListsTheCandidates) {
  const File file({"A.Position.X", "A.Position.Y", "A.Position.Z", "B.Position.X", "B.Position.Y",
                   "B.Position.Z"});
  const Error error = error_of([&] { file.find(); });
  EXPECT_THAT(error, IsError(ExitCode::layer, "'A.Position', 'B.Position'"));
  EXPECT_THAT(error, IsError(ExitCode::layer, "--aov position=LAYER"));
  EXPECT_EQ(file.find({"position=B.Position"})[Role::position]->name, "B.Position");
  EXPECT_TRUE(file.find({"position=b.position"})[Role::position]->by_request);
}

TEST(Layers, ARequestForWhatIsNotThereNamesWhatIs) {
  const File file({"foo.X", "foo.Y", "foo.Z", "bar.Z"});
  EXPECT_THAT(error_of([&] { file.find({"position=baz"}); }), IsError(ExitCode::layer, "'foo'"));
  EXPECT_EQ(file.find({"depth=bar"})[Role::depth]->channels, Channels{"bar.Z"});
  EXPECT_EQ(file.find({"depth=bar.Z"})[Role::depth]->channels, Channels{"bar.Z"});
}

TEST(Layers, APartRestrictsTheSearch) {
  const File file(Parts{{"left", {"P.X", "P.Y", "P.Z"}}, {"right", {"P.X", "P.Y", "P.Z"}}});
  EXPECT_THAT(error_of([&] { file.find(); }), IsError(ExitCode::layer, "could be position"));
  EXPECT_EQ(file.find({}, "right")[Role::position]->part, 1);
  EXPECT_EQ(file.find({}, "0")[Role::position]->part, 0);
  EXPECT_THAT(error_of([&] { file.find({}, "middle"); }),
              IsError(ExitCode::layer, "part 0 'left', part 1 'right'"));
}

TEST(Layers, FindsMotionOfBlenderAndOfOthersOnRequest) {
  const auto with = [](Channels channels) {
    channels.insert(channels.end(), {"P.X", "P.Y", "P.Z"});
    return File(channels);
  };
  const Channels xy = {"ViewLayer.Vector.X", "ViewLayer.Vector.Y"};
  EXPECT_EQ(channels_of(with({"ViewLayer.Vector.X", "ViewLayer.Vector.Y", "ViewLayer.Vector.Z",
                              "ViewLayer.Vector.W"})
                            .find(),
                        Role::motion),
            xy);
  EXPECT_EQ(channels_of(with(xy).find(), Role::motion), Channels{}) << "not of Blender";
  EXPECT_EQ(channels_of(with(xy).find({"motion=ViewLayer.Vector"}), Role::motion), xy);
  const File others = with({"velocity.R", "velocity.G", "velocity.B", "forward.u", "forward.v"});
  EXPECT_EQ(channels_of(others.find(), Role::motion), Channels{});
  EXPECT_EQ(channels_of(others.find({"motion=velocity"}), Role::motion),
            (Channels{"velocity.R", "velocity.G"}));
  EXPECT_EQ(channels_of(others.find({"motion=forward"}), Role::motion),
            (Channels{"forward.u", "forward.v"}));
}

TEST(Layers, FindsRoughnessWhereItIsUsed) {
  const Channels position = {"P.X", "P.Y", "P.Z"};
  const auto with = [&](Channels more) {
    more.insert(more.end(), position.begin(), position.end());
    return File(more);
  };
  for (const char* name : {"Roughness.Y", "specular_roughness.V", "ViewLayer.Roughness.X",
                           "roughness", "roughness.R"}) {
    EXPECT_EQ(channels_of(with({name}).find(), Role::roughness), Channels{name}) << name;
  }
  EXPECT_EQ(
      channels_of(with({"roughness.R", "roughness.G", "roughness.B"}).find(), Role::roughness),
      Channels{"roughness.R"});
  EXPECT_EQ(channels_of(with({"gloss.Y"}).find(), Role::roughness), Channels{});
  EXPECT_EQ(channels_of(with({"gloss.Y"}).find({"roughness=gloss"}), Role::roughness),
            Channels{"gloss.Y"});

  const File two = with({"base.roughness", "coat.roughness"});
  EXPECT_THAT(error_of([&] { two.find(); }), IsError(ExitCode::layer, "could be roughness"));
  const ExrReader reader(two.path());
  EXPECT_EQ(channels_of(find_layers({&reader}, {}, "", {Role::roughness}), Role::roughness),
            Channels{})
      << "nothing to choose where nobody asks";
}

TEST(Layers, EveryRoleHasARow) {
  ASSERT_EQ(role_names().size(), kRoleCount);
  for (std::size_t i = 0; i < kRoleCount; ++i) {
    const RoleRow& row = row_of(Role(i));
    EXPECT_EQ(role_from_name(row.name), Role(i)) << "no name, or that of another role";
    EXPECT_FALSE(row.outside.empty()) << row.name;
    ASSERT_FALSE(row.components.empty()) << row.name;
    for (const Components& set : row.components)
      EXPECT_EQ(set.size(), row.components[0].size()) << row.name;
  }
  EXPECT_EQ(role_from_name(""), std::nullopt);
}

TEST(Layers, RequestsAreParsed) {
  EXPECT_EQ(parse_layer_request("normal=my:layer").layer, "my:layer")
      << "no such file: the colon is the layer's";
  for (const char* bad : {"normal", "normal=", "colour=x", "=x"}) {
    EXPECT_THAT(error_of([&] { parse_layer_request(bad); }),
                IsError(ExitCode::usage, "ROLE=LAYER"));
  }
  const File file({"P.X", "P.Y", "P.Z"});
  const LayerRequest request = parse_layer_request("position=" + file.path().string() + ":P");
  EXPECT_EQ(request.file, file.path());
  EXPECT_EQ(request.layer, "P");
}

TEST(Layers, ARequestMayStateHowAlphaIsInTheAlbedo) {
  EXPECT_EQ(parse_layer_request("albedo=x").premultiplied, std::nullopt);
  EXPECT_EQ(parse_layer_request("albedo:straight=x").premultiplied, false);
  const LayerRequest request = parse_layer_request("albedo:premultiplied=my:layer");
  EXPECT_EQ(request.role, Role::albedo);
  EXPECT_EQ(request.layer, "my:layer");
  EXPECT_EQ(request.premultiplied, true);
  for (const char* bad : {"albedo:linear=x", "normal:straight=x", "albedo:=x"}) {
    EXPECT_THAT(error_of([&] { parse_layer_request(bad); }),
                IsError(ExitCode::usage, "albedo:premultiplied"));
  }
}

}  // namespace
}  // namespace ssdo::test::layers_test
