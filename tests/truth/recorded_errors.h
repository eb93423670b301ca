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
    {"bitmask", {0.0334, 0.0352, 0.1130, 0.2577}, {0.0341, 0.0211, 0.0440, 0.4800}},
    {"trace", {0.0547, 0.0713, 0.1079, 0.5628}, {0.0434, 0.0552, 0.0553, 0.2280}},
    {"ssdo", {0.1199, 0.2274, 0.2538, 1.1029}, {0.0665, 0.1286, 0.1790, 0.7191}},
    {"ssao", {0.1548, 0.2155, 0.2518}, {0.1028, 0.2074, 0.2023}},
    {"ssao-range", {0.1401, 0.2250, 0.2565}, {0.1111, 0.1599, 0.1752}},
    {"ssao-fade", {0.1115, 0.2012, 0.2633}, {0.0620, 0.1082, 0.1925}},
    {"hbao", {0.0886, 0.1246, 0.2558}, {0.0572, 0.0798, 0.1585}},
    {"gtao", {0.1563, 0.2128, 0.2507}, {0.1126, 0.2379, 0.2524}},
    {"sao", {0.1443, 0.1702, 0.3206}, {0.0897, 0.1647, 0.2606}},
    {"msvo", {0.1885, 0.2130, 0.2584}, {0.4106, 0.2461, 0.3153}},
};

/// Of the default method on the room corner with 25 % of overscan on each side.
inline constexpr TruthErrors kRecordedRoomCornerOverscan = {0.0356, 0.0198, 0.0226, 0.1546};

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
    {"the frame alone", "gbuffer.exr", {}, 0.0563, 0.0664, 0.0701, 0.2381, 0.3279, 0.81},
    {"with overscan", "overscan.exr", {}, 0.0534, 0.0479, 0.0506, 0.2760, 0.2854, 0.86},
    {"with a panorama",
     "gbuffer.exr",
     {"also_pano.exr"},
     0.0540,
     0.0494,
     0.0410,
     0.1392,
     0.2305,
     0.83},
    {"with overscan and four views",
     "overscan.exr",
     {"also_left.exr", "also_pano.exr", "also_right.exr", "also_top.exr"},
     0.0484,
     0.0398,
     0.0352,
     0.1243,
     0.2099,
     0.81},
};

/// The same of the small scene of data/truth/corner, which every clone has. Its blocks are too few
/// to rank what is guessed.
inline const std::vector<RecordedKnownGeometry> kRecordedKnownGeometryOfASmallScene = {
    {"the frame alone", "gbuffer.exr", {}, 0.0464, 0.0690, 0.1299, 0.2482, 0.3556},
    {"with overscan", "overscan.exr", {}, 0.0448, 0.0365, 0.0336, 0.1031, 0.3186},
    {"with a panorama", "gbuffer.exr", {"also_pano.exr"}, 0.0456, 0.0387, 0.0334, 0.1192, 0.2424},
    {"with overscan and four views",
     "overscan.exr",
     {"also_left.exr", "also_pano.exr", "also_right.exr", "also_top.exr"},
     0.0448,
     0.0270,
     0.0229,
     0.0928,
     0.2433},
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
    {"point", "gbuffer.exr", {}, 0.1927, 0.3583},
    {"area", "gbuffer.exr", {}, 0.1367, 0.3857},
    {"spot", "gbuffer.exr", {}, 0.1337, 0.3083},
    {"point", "overscan.exr", kFourViews, 0.1527, 0.3486},
    {"area", "overscan.exr", kFourViews, 0.1321, 0.3891},
    {"spot", "overscan.exr", kFourViews, 0.1141, 0.2390},
};

}  // namespace ssdo::test
