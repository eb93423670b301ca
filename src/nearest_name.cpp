// SPDX-License-Identifier: Apache-2.0
//
// Damerau, A technique for computer detection and correction of spelling errors, 1964: a letter is
// wrong, missing, too many, or exchanged with the next. The distance counts these faults, and takes
// no letter twice ("optimal string alignment").
#include "nearest_name.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

namespace ssdo {
namespace {

constexpr std::size_t kShortestEnd = 3;  ///< fewest letters that may stand for part of a name

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = char(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::size_t distance(const std::string& a, const std::string& b) {
  // rows[i][j]: from the first i letters of a to the first j of b
  std::vector<std::vector<std::size_t>> rows(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        rows[i][j] = i + j;
        continue;
      }
      const bool same = a[i - 1] == b[j - 1];
      rows[i][j] =
          std::min({rows[i - 1][j] + 1, rows[i][j - 1] + 1, rows[i - 1][j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        rows[i][j] = std::min(rows[i][j], rows[i - 2][j - 2] + 1);
    }
  }
  return rows[a.size()][b.size()];
}

/// The distance of `name` from `wrong`; nothing where it is not near. A name that begins or ends
/// with `wrong`, or of which `wrong` misspells the part after the last dot, has its length as
/// distance: it is farther than any that is misspelt, and the shortest such name is the nearest.
std::optional<std::size_t> cost(const std::string& wrong, const std::string& name) {
  const std::size_t most = (wrong.size() + 1) / 3, faults = distance(wrong, name);
  if (faults <= most) return faults;
  const bool is_end = name.starts_with(wrong) || name.ends_with(wrong) ||
                      distance(wrong, name.substr(name.rfind('.') + 1)) <= most;
  return is_end && wrong.size() >= kShortestEnd ? std::optional(name.size()) : std::nullopt;
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view wrong,
                                        const std::vector<std::string>& names) {
  std::optional<std::string> nearest;
  std::size_t least = 0;
  for (const std::string& name : names) {
    const auto found = cost(in_lower_case(wrong), in_lower_case(name));
    if (!found || (nearest && *found >= least)) continue;
    nearest = name;
    least = *found;
  }
  return nearest;
}

std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names) {
  const auto name = nearest_name(wrong, names);
  return name ? fmt::format("did you mean {}? ", *name) : "";
}

std::string some_of(const std::vector<std::string>& names, std::size_t most) {
  const auto end = names.begin() + std::ptrdiff_t(std::min(most, names.size()));
  const std::string text = fmt::format("{}", fmt::join(names.begin(), end, ", "));
  return names.size() > most ? fmt::format("{} and {} more", text, names.size() - most) : text;
}

}  // namespace ssdo
