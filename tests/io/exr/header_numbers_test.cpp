// SPDX-License-Identifier: Apache-2.0
#include "io/exr/header_numbers.h"

#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>
#include <gmock/gmock.h>

#include <cmath>

#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::header_numbers_test {
namespace {

using testing::ElementsAre;
using Numbers = std::vector<double>;

const Imath::Box2i kWindow({0, 0}, {3, 3});

Imf::Header part_with(const std::string& name, const std::string& view = "") {
  Imf::Header header = named(test_header(kWindow, {{"Z"}}), name);
  header.setType(Imf::SCANLINEIMAGE);
  if (!view.empty()) header.setView(view);
  return header;
}

std::map<std::string, Numbers> numbers_of(const std::vector<Imf::Header>& headers) {
  const TempDir dir;
  write_test_exr(dir / "f.exr", headers);
  return header_numbers(ExrReader(dir / "f.exr"), 0);
}

TEST(HeaderNumbers, AreThoseOfEveryTypeAndOfTexts) {
  Imf::Header header = part_with("a");
  const Imath::M44f matrix(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
  header.insert("int", Imf::IntAttribute(3));
  header.insert("float", Imf::FloatAttribute(0.5f));
  header.insert("double", Imf::DoubleAttribute(0.1));
  header.insert("v2", Imf::V2fAttribute({1, 2}));
  header.insert("v3", Imf::V3fAttribute({1, 2, 3}));
  header.insert("matrix", Imf::M44fAttribute(matrix));
  header.insert("text", Imf::StringAttribute("-12.5"));
  header.insert("list", Imf::StringAttribute("[1, 0, 0, 0], [0 1 0 0], (0,0,1,0), {4;5;6;1}"));
  header.insert("words", Imf::StringAttribute("12 angry"));
  header.insert("pair", Imf::StringAttribute("1 2"));
  header.insert("empty", Imf::StringAttribute(""));
  header.insert("broken", Imf::FloatAttribute(NAN));
  const auto all = numbers_of({header});
  EXPECT_THAT(all.at("int"), ElementsAre(3));
  EXPECT_THAT(all.at("float"), ElementsAre(0.5));
  EXPECT_THAT(all.at("double"), ElementsAre(0.1));
  EXPECT_THAT(all.at("v2"), ElementsAre(1, 2));
  EXPECT_THAT(all.at("v3"), ElementsAre(1, 2, 3));
  EXPECT_THAT(all.at("matrix"), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16));
  EXPECT_THAT(all.at("text"), ElementsAre(-12.5));
  EXPECT_THAT(all.at("list"), ElementsAre(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1));
  for (const char* none : {"words", "pair", "empty", "broken"}) EXPECT_FALSE(all.contains(none));
}

TEST(HeaderNumbers, StandBehindThePrefixesOfNuke) {
  Imf::Header header = part_with("a");
  header.insert("exr/fov", Imf::FloatAttribute(1));
  header.insert("fov", Imf::FloatAttribute(2));
  header.insert("nuke/exr/near", Imf::FloatAttribute(3));
  header.insert("nuke/far", Imf::FloatAttribute(4));
  const auto all = numbers_of({header});
  EXPECT_THAT(all.at("fov"), ElementsAre(2)) << "what has no prefix goes first";
  EXPECT_THAT(all.at("near"), ElementsAre(3));
  EXPECT_THAT(all.at("far"), ElementsAre(4));
}

TEST(HeaderNumbers, OfOtherPartsAreThoseOfTheSameViewThatThePartLacks) {
  Imf::Header left = part_with("a", "left"), right = part_with("b", "right"),
              more = part_with("c", "left");
  left.insert("fov", Imf::FloatAttribute(1));
  right.insert("near", Imf::FloatAttribute(2));
  more.insert("fov", Imf::FloatAttribute(3));
  more.insert("far", Imf::FloatAttribute(4));
  const auto all = numbers_of({left, right, more});
  EXPECT_THAT(all.at("fov"), ElementsAre(1));
  EXPECT_THAT(all.at("far"), ElementsAre(4));
  EXPECT_FALSE(all.contains("near"));
}

}  // namespace
}  // namespace ssdo::test::header_numbers_test
