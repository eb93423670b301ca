// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ssdo {

/// The one of `names` that `wrong` may be a misspelling of: at most a third of its letters are
/// wrong, missing, too many or exchanged with the next, or it is the beginning or the end of the
/// name. Case does not matter. Nothing where no name is near.
std::optional<std::string> nearest_name(std::string_view wrong,
                                        const std::vector<std::string>& names);

/// "did you mean NAME? ", for a message; "" where no name is near.
std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names);

/// "a, b, c and 7 more": at most `most` of the names, for a message that stays readable.
std::string some_of(const std::vector<std::string>& names, std::size_t most = 30);

}  // namespace ssdo
