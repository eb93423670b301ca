// SPDX-License-Identifier: Apache-2.0
//
// Files of two views, by the tool: every layout in which they come, and what each eye adds to the
// other.
#include <ImfMultiView.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/boxes.h"
#include "support/frame_file.h"
#include "support/header_camera.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::stereo_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const Window kWindow{0, 0, 80, 60};

/// A box before a wall on the ground: each eye sees some of the wall that the box hides from the
/// other.
Picture eye_at(double x) {
  const Surface scene = all_of({plane({}, {0, 0, 1}), plane({0, 3, 0}, {0, -1, 0}),
                                Box{{-0.5, 0, 0}, {0.5, 1, 2.4}}.surface()});
  Camera camera = look_at(camera_from_fov(50, kWindow, 1), {0, -4, 1.5}, {0, 1, 1}, {0, 0, 1});
  camera.origin.x += x;
  return take_picture(scene, camera, kWindow);
}

FramePart left_frame() { return frame_of(eye_at(-0.4), ""); }
FramePart right_frame() { return frame_of(eye_at(0.4), ""); }

/// A part whose channels have other names.
template <class Rename>
FramePart renamed(const FramePart& part, const Rename& rename) {
  FramePart out = part;
  out.channels.clear();
  for (const auto& [name, plane] : part.channels) out.channels[rename(name)] = plane;
  return out;
}

/// "Position.X" to "Position.right.X".
std::string before_component(const std::string& name, const std::string& view) {
  const auto dot = name.rfind('.');
  return name.substr(0, dot) + "." + view + name.substr(dot);
}

FramePart joined(FramePart a, const FramePart& b) {
  a.channels.insert(b.channels.begin(), b.channels.end());
  return a;
}

/// A part for each layer of a view: "Position.right" with X, Y and Z.
std::vector<FramePart> parts_of(const FramePart& frame, const std::string& view) {
  std::map<std::string, FramePart> parts;
  for (const auto& [name, plane] : frame.channels) {
    const auto dot = name.rfind('.');
    const auto [at, is_new] = parts.try_emplace(name.substr(0, dot), frame);
    FramePart& part = at->second;
    if (is_new) part.channels.clear();
    part.name = name.substr(0, dot) + "." + view;
    part.extra.setView(view);
    part.channels[name.substr(dot + 1)] = plane;
  }
  std::vector<FramePart> list;
  for (auto& [layer, part] : parts) list.push_back(std::move(part));
  return list;
}

/// A file of two views, and where and under which names its outputs stand.
struct Layout {
  std::string name;
  std::vector<FramePart> parts;
  int left_part = 0, right_part = 0;
  std::string left_ao, left_red, right_ao, right_red;
};

std::vector<Layout> layouts() {
  const auto standard = [](const FramePart& part, const std::string& view) {
    return renamed(part, [&](const std::string& name) { return before_component(name, view); });
  };
  const auto in_front = [](const FramePart& part, const std::string& view) {
    return renamed(part, [&](const std::string& name) { return view + "." + name; });
  };
  FramePart left = left_frame(), right = right_frame();
  left.name = "left", right.name = "right";
  left.extra.setView("left"), right.extra.setView("right");
  FramePart both = joined(standard(left_frame(), "left"), standard(right_frame(), "right")),
            unnamed = joined(left_frame(), standard(right_frame(), "right")),
            prefixed = joined(in_front(left_frame(), "left"), in_front(right_frame(), "right"));
  for (FramePart* part : {&both, &unnamed}) Imf::addMultiView(part->extra, {"left", "right"});
  std::vector<FramePart> layers = parts_of(left_frame(), "left");
  for (FramePart& part : parts_of(right_frame(), "right")) layers.push_back(std::move(part));
  const auto in_one = [](const std::string& name, const FramePart& part, const std::string& left_ao,
                         const std::string& left_red, const std::string& right_ao) {
    return Layout{name, {part}, 0, 0, left_ao, left_red, right_ao, "right.R"};
  };
  return {{"a part for each view", {left, right}, 0, 1, "ao.Y", "R", "ao.Y", "R"},
          in_one("multiView, as Blender writes it", both, "ao.left.Y", "R", "ao.right.Y"),
          in_one("multiView, the default view without name", unnamed, "ao.Y", "R", "ao.right.Y"),
          in_one("names alone, in front", prefixed, "left.ao.Y", "left.R", "right.ao.Y"),
          {"a part for each layer and view", layers, 3, 7, "ao.Y", "R", "ao.Y", "R"}};
}

class Stereo : public testing::Test {
 protected:
  Finished run(std::vector<std::string> arguments, int code = 0) {
    const Finished done = run_tool(arguments, {.folder = folder.path()});
    EXPECT_EQ(done.code, code) << done.err;
    return done;
  }

  TempDir folder;
};

TEST_F(Stereo, BothViewsGoIntoTheStructureOfTheFile) {
  for (const Layout& layout : layouts()) {
    SCOPED_TRACE(layout.name);
    write_frame(folder / "in.exr", layout.parts);
    for (const std::string view : {"left", "right", "all"}) {
      run({"in.exr", "--stereo", view, "-o", view + ".exr", "--keep-channels", "--overwrite"});
      run({"in.exr", "--stereo", view, "-o", view + "_alone.exr", "--overwrite"});
    }
    const auto same = [&](const std::string& name, int part, const std::string& one) {
      EXPECT_EQ(channel(folder / "all.exr", name, part).pixels,
                channel(folder / (one + ".exr"), name, part).pixels)
          << name;
    };
    const auto out = [&](const std::string& file) {
      const ExrReader reader(folder / (file + ".exr"));
      std::vector<std::string> names;
      for (const ExrPart& part : reader.parts())
        for (const ExrChannel& c : part.channels) names.push_back(part.view + "/" + c.name);
      return names;
    };
    for (const std::string& name : {layout.left_ao, layout.left_red}) {
      same(name, layout.left_part, "left");
      EXPECT_THAT(channel_names(folder / "left_alone.exr"), Contains(name));
    }
    for (const std::string& name : {layout.right_ao, layout.right_red}) {
      same(name, layout.right_part, "right");
      EXPECT_THAT(channel_names(folder / "right_alone.exr"), Contains(name));
    }
    const std::size_t products = out("left_alone").size();
    EXPECT_EQ(products, 11u) << "R G B A, ao, direct, bounce";
    EXPECT_EQ(out("all_alone").size(), 2 * products);
    for (const FramePart& part : layout.parts) {
      const int index = int(&part - layout.parts.data());
      for (const auto& [name, plane] : part.channels)
        EXPECT_EQ(channel(folder / "all.exr", name, index).pixels, plane.pixels) << name;
    }
  }
}

TEST_F(Stereo, HeadersKeepTheirViews) {
  const std::vector<Layout> all = layouts();
  write_frame(folder / "parts.exr", all[0].parts);
  write_frame(folder / "names.exr", all[1].parts);
  run({"parts.exr", "--stereo", "all", "-o", "out_parts.exr"});
  run({"names.exr", "--stereo", "right", "-o", "out_names.exr"});
  const ExrReader parts(folder / "out_parts.exr"), names(folder / "out_names.exr");
  ASSERT_EQ(parts.parts().size(), 2u);
  EXPECT_EQ(parts.parts()[0].view, "left");
  EXPECT_EQ(parts.parts()[1].view, "right");
  EXPECT_EQ(parts.parts()[1].name, "right");
  EXPECT_THAT(views_of(names.parts()[0].header), ElementsAre("left", "right"));
  EXPECT_NE(string_attribute(names.parts()[0].header, "ssdo/right.plan"), "");
}

TEST_F(Stereo, AnEyeAddsWhatTheOtherDoesNotSee) {
  write_frame(folder / "in.exr", layouts()[0].parts);
  const Finished with = run({"in.exr", "--stereo", "left", "-o", "with.exr", "-v"});
  EXPECT_THAT(with.err, HasSubstr("in.exr (right): "));
  run({"in.exr", "--part", "left", "-o", "without.exr"});
  write_frame(folder / "right.exr", right_frame());
  run({"in.exr", "--part", "left", "--also", "right.exr", "-o", "also.exr"});
  const auto ao = [&](const std::string& name) { return channel(folder / name, "ao.Y").pixels; };
  EXPECT_NE(ao("with.exr"), ao("without.exr"));
  EXPECT_EQ(ao("with.exr"), ao("also.exr"));
}

TEST_F(Stereo, OtherMethodsDoNotLookAtTheOtherEye) {
  write_frame(folder / "in.exr", layouts()[0].parts);
  const Finished done = run({"in.exr", "--stereo", "left", "--method", "gtao", "-o", "a.exr"});
  EXPECT_EQ(done.err, "") << "nobody has asked for it";
}

/// The parts of a file of two views with P in camera space, with their cameras in the headers or
/// not.
std::vector<FramePart> parts_in_camera_space(bool with_headers) {
  std::vector<FramePart> parts = layouts()[0].parts;
  const std::vector<Picture> pictures = {eye_at(-0.4), eye_at(0.4)};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Camera& camera = pictures[i].camera;
    Plane<glm::vec3> p = pictures[i].position;
    for (glm::vec3& v : p.pixels) v = glm::vec3(camera.to_camera(glm::dvec3(v)));
    parts[i].add("Position", p);
    if (with_headers) add_attributes(parts[i].extra, standard_header(camera, kWindow));
  }
  return parts;
}

TEST_F(Stereo, AWorldPlacesTheOtherEye) {
  const auto lines_of = [&](const std::vector<FramePart>& parts) {
    write_frame(folder / "in.exr", parts);
    return run({"in.exr", "--stereo", "all", "-o", "out.exr", "--overwrite", "-v"}).err;
  };
  const auto both = AllOf(HasSubstr("in.exr (left): "), HasSubstr("in.exr (right): "));
  const std::string reason = "no world space is known";
  EXPECT_THAT(lines_of(layouts()[0].parts), AllOf(both, Not(HasSubstr(reason))));
  EXPECT_THAT(lines_of(parts_in_camera_space(false)),
              AllOf(HasSubstr(reason), Not(HasSubstr("in.exr (left)"))));
  EXPECT_THAT(lines_of(parts_in_camera_space(true)), AllOf(both, Not(HasSubstr(reason))));
}

TEST_F(Stereo, PicturesShowOneViewEach) {
  write_frame(folder / "in.exr", layouts()[1].parts);
  run({"in.exr", "--stereo", "all", "-o", "%V.png", "-o", "%v.exr", "--save", "ao=ao_%v.tif"});
  EXPECT_THAT(listing(folder.path()), ElementsAre("ao_l.tif", "ao_r.tif", "in.exr", "l.exr",
                                                  "left.png", "r.exr", "right.png"));
  EXPECT_THAT(channel_names(folder / "r.exr"),
              AllOf(Contains("ao.right.Y"), Not(Contains("ao.left.Y"))));
  run({"in.exr", "--stereo", "right", "-o", "%V_alone.png"});
  EXPECT_EQ(read_file(folder / "right.png"), read_file(folder / "right_alone.png"));
  EXPECT_NE(read_file(folder / "right.png"), read_file(folder / "left.png"));
  EXPECT_THAT(run({"in.exr", "--stereo", "all", "-o", "a.png"}, 2).error_line(),
              AllOf(HasSubstr("a.png: shows one view"), HasSubstr("%V")));
}

TEST_F(Stereo, ASequenceHasBothViewsOfEveryFrame) {
  for (const std::string number : {"1", "2", "4"})
    write_frame(folder / ("in." + number + ".exr"), layouts()[0].parts);
  const std::vector<std::string> arguments = {"in.@.exr",  "--stereo",   "all",      "-o",
                                              "out.@.exr", "--frames",   "1-4",      "--stats",
                                              "s.json",    "--on-error", "continue", "--temporal"};
  const Finished done = run(arguments, 3);
  EXPECT_THAT(done.err, HasSubstr("frame 3 of the range is missing"));
  EXPECT_EQ(done.err.find("frame 3"), done.err.rfind("frame 3")) << "said once";
  const auto stats = parse_json(read_file(folder / "s.json"));
  ASSERT_EQ(stats.size(), 6u);
  EXPECT_EQ(stats[0]["view"], "left");
  EXPECT_EQ(stats[1]["view"], "right");
  EXPECT_EQ(stats[5]["frame"], 4);
  for (const std::string view : {"left", "right"}) {
    run({"in.@.exr", "--stereo", view, "-o", view + ".@.exr", "--frames", "1-2", "--temporal"});
    const int part = view == "right";
    EXPECT_EQ(channel(folder / "out.2.exr", "ao.Y", part).pixels,
              channel(folder / (view + ".2.exr"), "ao.Y").pixels)
        << "each view has a history of its own";
  }
  fs::remove(folder / "out.2.exr");
  std::vector<std::string> again = arguments;
  again.insert(again.end(), {"--skip-existing", "-v"});
  EXPECT_THAT(run(again, 3).err,
              AllOf(HasSubstr("in.1.exr: skipped"), HasSubstr("in.4.exr: skipped"),
                    Not(HasSubstr("in.2.exr: skipped"))));
  EXPECT_TRUE(fs::exists(folder / "out.2.exr"));
}

/// Both eyes of a shot at once are each of them alone.
TEST_F(Stereo, FramesOfAShotTellTheSameView) {
  for (const std::string number : {"1", "2"})
    write_frame(folder / ("in." + number + ".exr"), layouts()[1].parts);
  const std::vector<std::string> shot = {"in.@.exr", "--shot", "1", "--products", "ao"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = shot;
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(run(words).code, 0);
  };
  with({"--stereo", "all", "-o", "both.@.exr"});
  with({"--stereo", "right", "--frames", "2", "-o", "right.@.exr"});
  EXPECT_EQ(channel(folder / "both.2.exr", "ao.right.Y").pixels,
            channel(folder / "right.2.exr", "ao.right.Y").pixels);
}

TEST_F(Stereo, InfoTellsOfEachView) {
  write_frame(folder / "in.exr", layouts()[1].parts);
  const auto info = parse_json(run({"info", "in.exr", "--stereo", "all", "--json"}).out);
  ASSERT_EQ(info.size(), 2u);
  EXPECT_EQ(info[0]["view"], "left");
  EXPECT_EQ(info[1]["view"], "right");
  EXPECT_EQ(info[1]["layers"]["position"]["layer"], "Position.right");
  EXPECT_TRUE(info[1].contains("parts"));
  EXPECT_THAT(run({"info", "in.exr", "--stereo", "right"}).out, HasSubstr("view      right"));
}

// Blender 3.4 marks a file of several views with the attributes of Cycles alone.
TEST_F(Stereo, BlendersWorldHasZUp) {
  FramePart part = layouts()[1].parts[0];
  const std::string sky = data("environments/sky.exr");
  const auto light = [&] {
    write_frame(folder / "in.exr", part);
    return run({"info", "in.exr", "--stereo", "left", "--env", sky}).out;
  };
  EXPECT_THAT(light(), HasSubstr("z up; up by the camera"));
  part.extra.insert("cycles.ViewLayer.samples", Imf::StringAttribute("1"));
  EXPECT_THAT(light(), HasSubstr("z up; up by the header"));
}

TEST_F(Stereo, SaysWhatIsWrong) {
  write_frame(folder / "mono.exr", left_frame());
  write_frame(folder / "in.exr", layouts()[0].parts);
  const auto error = [&](const std::vector<std::string>& arguments, int code) {
    return run(arguments, code).error_line();
  };
  EXPECT_THAT(error({"mono.exr", "--stereo", "left", "-o", "a.exr"}, 4),
              HasSubstr("mono.exr: shows one view; leave --stereo out"));
  EXPECT_THAT(error({"in.exr", "--stereo", "both", "-o", "a.exr"}, 2),
              HasSubstr("--stereo both: expected one of left, right, all"));
  EXPECT_THAT(error({"in.exr", "-o", "a.exr"}, 4), HasSubstr("--stereo"));
  EXPECT_THAT(error({"in.exr", "--stereo", "left", "--part", "left", "-o", "a.exr"}, 2),
              HasSubstr("--part"));
  EXPECT_THAT(error({"bench", "in.exr", "--stereo", "all"}, 2),
              HasSubstr("--stereo left or right"));
  EXPECT_THAT(error({"in.exr", "--stereo", "all", "--camera", "c.json", "-o", "a.exr"}, 2),
              HasSubstr("c.json: has the pose of one eye"));
  FramePart other = left_frame(), another = right_frame();
  other.name = "eyeL", another.name = "eyeR";
  other.extra.setView("eyeL"), another.extra.setView("eyeR");
  write_frame(folder / "named.exr", {other, another});
  EXPECT_THAT(error({"named.exr", "--stereo", "all", "-o", "a.exr"}, 4),
              HasSubstr("no view 'left'; it has 'eyeL', 'eyeR': choose one with --part"));
  EXPECT_FALSE(fs::exists(folder / "a.exr"));
}

TEST_F(Stereo, RequestedLayersAreOfTheViewThatIsRelit) {
  write_frame(folder / "in.exr", layouts()[1].parts);
  write_frame(folder / "mono.exr", left_frame());
  EXPECT_THAT(
      run({"in.exr", "--stereo", "all", "--aov", "position=Position.right", "-o", "a.exr"}, 4)
          .error_line(),
      HasSubstr("no layer 'Position.right'"));
  const auto albedo_of = [&](const std::string& request) {
    const auto info = parse_json(
        run({"info", "in.exr", "--stereo", "all", "--aov", "albedo=" + request, "--json"}).out);
    return std::vector<std::string>{info[0]["layers"]["albedo"]["layer"],
                                    info[1]["layers"]["albedo"]["layer"]};
  };
  EXPECT_THAT(albedo_of("DiffCol"), ElementsAre("DiffCol.left", "DiffCol.right"));
  EXPECT_THAT(albedo_of("in.exr:DiffCol"), ElementsAre("DiffCol.left", "DiffCol.right"));
  EXPECT_THAT(albedo_of("mono.exr:DiffCol"), ElementsAre("DiffCol", "DiffCol"));
}

TEST_F(Stereo, RgbaIsThatOfTheView) {
  FramePart part = layouts()[1].parts[0];
  const Plane<float> gray(kWindow.width(), kWindow.height(), 0.5f);
  for (const std::string view : {"", "right."})
    for (const std::string c : {"R", "G", "B"}) part.channels[view + c] = gray;
  write_frame(folder / "in.exr", part);
  const auto info =
      parse_json(run({"info", "in.exr", "--stereo", "all", "--aov", "ambient=rgba", "--json"}).out);
  EXPECT_EQ(info[0]["layers"]["ambient"]["channels"][0], "R");
  EXPECT_EQ(info[1]["layers"]["ambient"]["channels"][0], "right.R");
}

TEST_F(Stereo, LayersOfNoViewAreThoseOfBoth) {
  std::vector<FramePart> parts = layouts()[0].parts;
  FramePart shared = parts[0];
  shared.extra = Imf::Header();
  shared.name = "shared";
  std::erase_if(shared.channels, [](const auto& c) { return !c.first.starts_with("DiffCol"); });
  for (FramePart& part : parts)
    std::erase_if(part.channels, [](const auto& c) { return c.first.starts_with("DiffCol"); });
  write_frame(folder / "in.exr", {parts[0], parts[1], shared});
  run({"in.exr", "--stereo", "all", "-o", "a.exr"});
  for (const int part : {0, 1}) EXPECT_THAT(channel_names(folder / "a.exr", part), Contains("R"));
  // P is of one eye alone.
  shared.channels = left_frame().channels;
  const Plane<float> gray(kWindow.width(), kWindow.height(), 0.5f);
  for (FramePart& part : parts) part.channels = {{"R", gray}};
  write_frame(folder / "in.exr", {parts[0], parts[1], shared});
  EXPECT_THAT(run({"in.exr", "--stereo", "all", "-o", "b.exr"}, 4).error_line(),
              HasSubstr("no layer for position"));
  EXPECT_THAT(
      run({"in.exr", "--stereo", "all", "--aov", "position=shared.Position", "-o", "b.exr"}, 4)
          .error_line(),
      HasSubstr("both views would be made from 'shared.Position'"));
}

TEST_F(Stereo, TheAttributeGoesBeforeTheNameOfAPart) {
  std::vector<FramePart> parts = layouts()[0].parts;
  std::swap(parts[0].name, parts[1].name);
  write_frame(folder / "in.exr", parts);
  run({"in.exr", "--stereo", "left", "-o", "a.exr"});
  EXPECT_EQ(ExrReader(folder / "a.exr").parts()[0].view, "left");
}

TEST_F(Stereo, AnEyeInAnotherUnitIsLeftOut) {
  std::vector<FramePart> parts = layouts()[0].parts;
  for (auto& [name, plane] : parts[1].channels)
    if (name.starts_with("Position") || name.starts_with("Depth"))
      for (float& v : plane.pixels) v = v < 1e9f ? 100 * v : v;
  write_frame(folder / "in.exr", parts);
  run({"in.exr", "--part", "left", "-o", "alone.exr"});
  EXPECT_THAT(run({"in.exr", "--stereo", "left", "-o", "a.exr"}).err,
              HasSubstr("in.exr (right): left out: "));
  EXPECT_EQ(channel(folder / "a.exr", "ao.Y").pixels, channel(folder / "alone.exr", "ao.Y").pixels);
}

TEST_F(Stereo, TheHeaderOfAPartOfBothIsThatOfTheDefaultView) {
  FramePart part = layouts()[1].parts[0];
  add_attributes(part.extra, standard_header(eye_at(-0.4).camera, kWindow));
  write_frame(folder / "in.exr", part);
  const Finished done = run({"in.exr", "--stereo", "all", "-o", "a.exr", "-v"});
  EXPECT_THAT(done.err, AllOf(HasSubstr("proved by P"), Not(HasSubstr("is not used"))));
}

TEST_F(Stereo, DifferentProductsOfTheViewsAreWarnedOf) {
  std::vector<FramePart> parts = layouts()[0].parts;
  std::erase_if(parts[1].channels, [](const auto& c) { return c.first.starts_with("DiffCol"); });
  write_frame(folder / "in.exr", parts);
  EXPECT_THAT(run({"in.exr", "--stereo", "all", "-o", "a.exr"}).err,
              HasSubstr("the views have different products, as their layers differ: left ao, "));
}

TEST_F(Stereo, TwoViewsAreNotMadeInBands) {
  std::vector<FramePart> parts = layouts()[0].parts;
  const Window tall{0, 0, 320, 1600};
  for (FramePart& part : parts) {
    part.data = part.display = tall;
    part.channels = frame_of(small_picture(tall, tall), "").channels;
  }
  write_frame(folder / "in.exr", parts);
  const auto with = [](const std::string& view) {
    return std::vector<std::string>{"in.exr", "--stereo",    view,  "-o",
                                    "a.exr",  "--mem-limit", "236M"};
  };
  EXPECT_THAT(run(with("all"), 2).error_line(), HasSubstr("give --stereo left, then right"));
  EXPECT_THAT(listing(folder.path()), ElementsAre("in.exr"));
  run(with("left"));
}

TEST_F(Stereo, MessagesNameTheView) {
  std::vector<FramePart> parts = layouts()[0].parts;
  std::erase_if(parts[1].channels, [](const auto& c) { return c.first.starts_with("Position"); });
  write_frame(folder / "in.exr", parts);
  EXPECT_THAT(run({"in.exr", "--stereo", "all", "-o", "a.exr"}, 4).error_line(),
              testing::EndsWith("(view right)"));
  EXPECT_THAT(run({"in.exr", "--stereo", "left", "-o", "a.exr"}).err,
              HasSubstr("in.exr (left): warning: left out as the other eye: in.exr"));
}

TEST_F(Stereo, TheSameBitsForAnyNumberOfThreads) {
  write_frame(folder / "in.exr", layouts()[0].parts);
  for (const std::string threads : {"1", "3"})
    run({"in.exr", "--stereo", "all", "-o", threads + ".exr", "--threads", threads});
  EXPECT_EQ(read_file(folder / "1.exr"), read_file(folder / "3.exr"));
}

}  // namespace
}  // namespace ssdo::test::stereo_test
