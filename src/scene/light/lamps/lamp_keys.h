// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "error.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo {

/// Where a lamp is described, for errors: "FILE: light 2".
struct LampOption {
  ExitCode code;
  std::string text;
};

/// The lamp that an object with the keys of `man ssdo`, LIGHTS, describes. Errors: the code of
/// `given_by`, for unknown and missing keys, and for values that mean no lamp.
Lamp read_lamp(const nlohmann::json& object, const LampOption& given_by);

}  // namespace ssdo
