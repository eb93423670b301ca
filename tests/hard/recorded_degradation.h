// SPDX-License-Identifier: Apache-2.0
//
// How much poor files change ao, as recorded: degradation_test measures it anew, and readme_test
// holds the table of README.md to it.
#pragma once

#include <array>
#include <map>
#include <string_view>
#include <vector>

namespace ssdo::test {

inline constexpr std::array<std::string_view, 12> kDegradationColumns = {
    "clean, against rays",
    "half P",
    "half P, origin 90 away",
    "origin 1.7e6 away",
    "averaged edges",
    "beside them",
    "plane at 50",
    "plane, half P, origin 90 away",
    "plane, origin 1.7e6 away",
    "plane at 85",
    "plane at 89",
    "plane at 89.9"};

/// RMSE of ao in the order of the columns.
inline const std::map<std::string_view, std::vector<double>> kRecordedDegradation = {
    {"bitmask",
     {0.0646, 0.0009, 0.0195, 0.0357, 0.0772, 0.0166, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000,
      0.0000}},
    {"trace",
     {0.0636, 0.0031, 0.0800, 0.1485, 0.0972, 0.0279, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000,
      0.0000}},
    {"ssdo",
     {0.0689, 0.0006, 0.0172, 0.0326, 0.0186, 0.0059, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000,
      0.0000}},
    {"ssao",
     {0.1438, 0.0002, 0.0046, 0.0078, 0.0328, 0.0045, 0.0005, 0.0000, 0.0000, 0.0642, 0.0196,
      0.0011}},
    {"ssao-range",
     {0.1035, 0.0037, 0.0346, 0.0603, 0.0108, 0.0038, 0.0695, 0.0413, 0.0372, 0.0114, 0.0030,
      0.0006}},
    {"ssao-fade",
     {0.0563, 0.0024, 0.0147, 0.0229, 0.0051, 0.0082, 0.0037, 0.0030, 0.0044, 0.0003, 0.0001,
      0.0000}},
    {"hbao",
     {0.0873, 0.0003, 0.0182, 0.0360, 0.0193, 0.0089, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000,
      0.0000}},
    {"gtao",
     {0.1740, 0.0001, 0.0061, 0.0059, 0.0386, 0.0077, 0.0090, 0.0090, 0.0090, 0.0313, 0.0279,
      0.0276}},
    {"sao",
     {0.1391, 0.0008, 0.0463, 0.0775, 0.0658, 0.0135, 0.0000, 0.0000, 0.0000, 0.0006, 0.0005,
      0.0000}},
    {"msvo",
     {0.2614, 0.0011, 0.0131, 0.0229, 0.0050, 0.0035, 0.2313, 0.2324, 0.2319, 0.0000, 0.0000,
      0.0000}}};

}  // namespace ssdo::test
