// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace ssdo {

/// `value` as JSON text, on one line or indented. JSON is UTF-8, and a path, a layer's name or a
/// text of a header may be any bytes: each byte that is no UTF-8 stands as \xHH, so that a person
/// can tell the file and a program can undo it. The only way of this tool to JSON text: the
/// library's own throws on such a byte.
std::string json_text(const nlohmann::json& value, int indent = -1);

}  // namespace ssdo
