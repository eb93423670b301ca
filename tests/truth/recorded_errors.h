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
    {"bitmask", {0.0335, 0.0356, 0.1132, 0.2701}, {0.0349, 0.0219, 0.0566, 0.5050}},
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
inline constexpr TruthErrors kRecordedRoomCornerOverscan = {0.0364, 0.0198, 0.0228, 0.1571};

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
    {"the frame alone", "gbuffer.exr", {}, 0.0569, 0.0691, 0.0705, 0.2437, 0.3393, 0.79},
    {"with overscan", "overscan.exr", {}, 0.0540, 0.0487, 0.0506, 0.2672, 0.2843, 0.85},
    {"with a panorama",
     "gbuffer.exr",
     {"also_pano.exr"},
     0.0543,
     0.0501,
     0.0450,
     0.1418,
     0.2262,
     0.83},
    {"with overscan and four views",
     "overscan.exr",
     {"also_left.exr", "also_pano.exr", "also_right.exr", "also_top.exr"},
     0.0490,
     0.0404,
     0.0351,
     0.1261,
     0.2076,
     0.80},
};

/// The same of the small scene of data/truth/corner, which every clone has. Its blocks are too few
/// to rank what is guessed.
inline const std::vector<RecordedKnownGeometry> kRecordedKnownGeometryOfASmallScene = {
    {"the frame alone", "gbuffer.exr", {}, 0.0468, 0.0719, 0.1261, 0.2899, 0.3528},
    {"with overscan", "overscan.exr", {}, 0.0450, 0.0394, 0.0369, 0.0988, 0.3178},
    {"with a panorama", "gbuffer.exr", {"also_pano.exr"}, 0.0457, 0.0403, 0.0385, 0.1233, 0.2417},
    {"with overscan and four views",
     "overscan.exr",
     {"also_left.exr", "also_pano.exr", "also_right.exr", "also_top.exr"},
     0.0451,
     0.0271,
     0.0242,
     0.0941,
     0.2427},
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
    {"point", "gbuffer.exr", {}, 0.1927, 0.3607},
    {"area", "gbuffer.exr", {}, 0.1367, 0.3823},
    {"spot", "gbuffer.exr", {}, 0.1337, 0.3106},
    {"point", "overscan.exr", kFourViews, 0.1527, 0.3632},
    {"area", "overscan.exr", kFourViews, 0.1321, 0.3829},
    {"spot", "overscan.exr", kFourViews, 0.1141, 0.2342},
};

}  // namespace ssdo::test
