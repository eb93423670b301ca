// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace ssdo {

/// `value` as JSON text, on one line or indented. JSON is UTF-8, and a path, a layer's name or a
/// text of a header may be any bytes: each byte that is not UTF-8 becomes \xHH, which a person can
/// read and a program can undo. All JSON text is made here: the library's own function throws on
/// such a byte.
std::string json_text(const nlohmann::json& value, int indent = -1);

}  // namespace ssdo
