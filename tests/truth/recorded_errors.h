// SPDX-License-Identifier: Apache-2.0
//
// How far every method is from the path tracer on the frames of data/, as recorded: truth_test
// measures it anew, and readme_test holds the tables of README.md to it.
#pragma once

#include <string>
#include <vector>

namespace ssdo::test {

/// RMSE over the surfaces: of ao at the two radii of the truth; of light relative to its mean.
struct TruthErrors {
  double ao_small, ao_large, direct;
  double bounce = 0;  ///< 0: the method has none
};

struct RecordedErrors {
  std::string method;
  TruthErrors still_life, room_corner;
};

inline const std::vector<RecordedErrors> kRecordedErrors = {
    {"bitmask", {0.0401, 0.0387, 0.1207, 0.2701}, {0.0321, 0.0283, 0.0517, 0.4622}},
    {"trace", {0.0572, 0.0755, 0.1255, 0.5806}, {0.0372, 0.0555, 0.0560, 0.2103}},
    {"ssdo", {0.1199, 0.2273, 0.2538, 1.1029}, {0.0665, 0.1286, 0.1787, 0.7191}},
    {"ssao", {0.1547, 0.2154, 0.2518}, {0.1028, 0.2074, 0.2021}},
    {"ssao-range", {0.1401, 0.2250, 0.2565}, {0.1111, 0.1599, 0.1751}},
    {"ssao-fade", {0.1116, 0.2009, 0.2633}, {0.0624, 0.1081, 0.1926}},
    {"hbao", {0.0887, 0.1246, 0.2558}, {0.0572, 0.0798, 0.1585}},
    {"gtao", {0.1562, 0.2127, 0.2507}, {0.1126, 0.2379, 0.2524}},
    {"sao", {0.1445, 0.1703, 0.3206}, {0.0897, 0.1647, 0.2605}},
    {"msvo", {0.1885, 0.2130, 0.2584}, {0.4106, 0.2461, 0.3154}},
};

/// Of the default method on the room corner with 25 % of overscan on each side.
inline constexpr TruthErrors kRecordedRoomCornerOverscan = {0.0321, 0.0252, 0.0233, 0.1431};

/// Means over five further scenes of what the default method is wrong by when it knows this much,
/// in the units of TruthErrors; `white` is ao without a radius. `rank_guessed`: rank correlation of
/// what is guessed and the error of ao.
struct RecordedKnownGeometry {
  std::string known;              ///< as the README says it
  std::string file;               ///< of a scene
  std::vector<std::string> also;  ///< further files of it
  double ao_small, ao_large, white, direct, bounce;
  double rank_guessed = 0;
};

inline const std::vector<RecordedKnownGeometry> kRecordedKnownGeometry = {
    {"the frame alone", "gbuffer.exr", {}, 0.0635, 0.0751, 0.0736, 0.2431, 0.3416, 0.79},
    {"with overscan", "overscan.exr", {}, 0.0608, 0.0555, 0.0579, 0.2671, 0.2958, 0.85},
    {"with a panorama",
     "gbuffer.exr",
     {"also_pano.exr"},
     0.0614,
     0.0558,
     0.0426,
     0.1397,
     0.2247,
     0.83},
    {"with overscan and four views",
     "overscan.exr",
     {"also_left.exr", "also_pano.exr", "also_right.exr", "also_top.exr"},
     0.0535,
     0.0449,
     0.0341,
     0.1252,
     0.2111,
     0.80},
};

/// The same of the small scene of data/truth/corner, which every clone has. Its blocks are too few
/// to rank what is guessed.
inline const std::vector<RecordedKnownGeometry> kRecordedKnownGeometryOfASmallScene = {
    {"the frame alone", "gbuffer.exr", {}, 0.0496, 0.0705, 0.1170, 0.2746, 0.3362},
    {"with overscan", "overscan.exr", {}, 0.0475, 0.0359, 0.0495, 0.0907, 0.3267},
    {"with a panorama", "gbuffer.exr", {"also_pano.exr"}, 0.0487, 0.0387, 0.0271, 0.1148, 0.2307},
    {"with overscan and four views",
     "overscan.exr",
     {"also_left.exr", "also_pano.exr", "also_right.exr", "also_top.exr"},
     0.0479,
     0.0333,
     0.0222,
     0.0879,
     0.2455},
};

/// Of one lamp of data/truth/corner in a black world, relative to the mean of its light.
struct RecordedLamp {
  std::string lamp;
  std::string file;               ///< of the scene
  std::vector<std::string> also;  ///< further files of it
  double direct, bounce;
};

inline const std::vector<std::string> kFourViews = {"also_left.exr", "also_pano.exr",
                                                    "also_right.exr", "also_top.exr"};
inline const std::vector<RecordedLamp> kRecordedLamps = {
    {"point", "gbuffer.exr", {}, 0.2038, 0.4681},
    {"area", "gbuffer.exr", {}, 0.1565, 0.5031},
    {"spot", "gbuffer.exr", {}, 0.1426, 0.2709},
    {"point", "overscan.exr", kFourViews, 0.1709, 0.4456},
    {"area", "overscan.exr", kFourViews, 0.1468, 0.4752},
    {"spot", "overscan.exr", kFourViews, 0.1224, 0.1985},
};

}  // namespace ssdo::test
