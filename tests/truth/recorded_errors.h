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
    {"bitmask", {0.0345, 0.0370, 0.1133, 0.2621}, {0.0361, 0.0229, 0.0509, 0.4653}},
    {"trace", {0.0547, 0.0713, 0.1079, 0.5628}, {0.0434, 0.0552, 0.0553, 0.2280}},
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
inline constexpr TruthErrors kRecordedRoomCornerOverscan = {0.0375, 0.0239, 0.0226, 0.1495};

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
    {"the frame alone", "gbuffer.exr", {}, 0.0588, 0.0705, 0.0720, 0.2386, 0.3399, 0.80},
    {"with overscan", "overscan.exr", {}, 0.0558, 0.0514, 0.0578, 0.2674, 0.2998, 0.85},
    {"with a panorama",
     "gbuffer.exr",
     {"also_pano.exr"},
     0.0565,
     0.0523,
     0.0416,
     0.1357,
     0.2269,
     0.84},
    {"with overscan and four views",
     "overscan.exr",
     {"also_left.exr", "also_pano.exr", "also_right.exr", "also_top.exr"},
     0.0502,
     0.0424,
     0.0336,
     0.1236,
     0.2079,
     0.81},
};

/// The same of the small scene of data/truth/corner, which every clone has. Its blocks are too few
/// to rank what is guessed.
inline const std::vector<RecordedKnownGeometry> kRecordedKnownGeometryOfASmallScene = {
    {"the frame alone", "gbuffer.exr", {}, 0.0467, 0.0639, 0.1138, 0.2657, 0.3267},
    {"with overscan", "overscan.exr", {}, 0.0452, 0.0339, 0.0519, 0.0961, 0.3408},
    {"with a panorama", "gbuffer.exr", {"also_pano.exr"}, 0.0458, 0.0357, 0.0256, 0.0986, 0.2478},
    {"with overscan and four views",
     "overscan.exr",
     {"also_left.exr", "also_pano.exr", "also_right.exr", "also_top.exr"},
     0.0453,
     0.0297,
     0.0231,
     0.0881,
     0.2458},
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
    {"point", "gbuffer.exr", {}, 0.1927, 0.4371},
    {"area", "gbuffer.exr", {}, 0.1367, 0.4841},
    {"spot", "gbuffer.exr", {}, 0.1337, 0.3047},
    {"point", "overscan.exr", kFourViews, 0.1527, 0.4169},
    {"area", "overscan.exr", kFourViews, 0.1321, 0.4586},
    {"spot", "overscan.exr", kFourViews, 0.1141, 0.2341},
};

}  // namespace ssdo::test
