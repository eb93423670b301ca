// SPDX-License-Identifier: Apache-2.0
#include "plan/explain.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numeric>
#include <string_view>

#include "estimators/guessed.h"
#include "prior/prior.h"

namespace ssdo {
namespace {

/// More than this of a result should not rest on guesses.
constexpr float kMuchGuessed = 0.3f;

}  // namespace

void explain_views(Plan& plan, const std::vector<MergeCounts>& views) {
  for (const MergeCounts& view : views) {
    // Without its folder: the header of outputs holds the plan, and no paths.
    const std::string file = std::filesystem::path(view.file).filename().string();
    if (view.backs > 0) {
      plan.reasons.push_back(fmt::format(
          "{}: back faces from the frame's own camera; they say how thick things are in {} pixels",
          file, view.backs));
      continue;
    }
    plan.reasons.push_back(fmt::format(
        "{}: {} pixels show what the frame does not, {} what it shows as well, {} contradict it "
        "and are left out{}",
        file, view.added, view.seen, view.contradictory,
        view.has_albedo ? "" : "; it has no albedo, so that it sends no light"));
  }
}

void use_prior(Plan& plan, const LearnedPrior& prior) {
  plan.prior = prior;
  plan.reasons.push_back(describe_prior(prior.up.has_value()));
}

std::string GuessedShare::advice() const {
  if (remedy.empty()) return {};
  return fmt::format("{:.2f} of all directions are guessed; {}", *share, remedy);
}

GuessedShare explain_guessed(Plan& plan, const Scene& scene) {
  if (!plan.method->products.guessed) return {};
  const GuessedMean guessed = mean_guessed(scene, plan.request.radius);
  std::array<std::size_t, kUnseenPlaces.size()> most_first;
  std::iota(most_first.begin(), most_first.end(), std::size_t(0));
  std::stable_sort(most_first.begin(), most_first.end(),
                   [&](std::size_t a, std::size_t b) { return guessed.at[a] > guessed.at[b]; });
  std::vector<std::string> parts;
  std::vector<std::string_view> remedies;
  for (const std::size_t i : most_first) {
    // Parts that are less than a tenth of all help nobody decide what to render.
    if (guessed.at[i] < 0.1f * guessed.all || guessed.at[i] < 0.005f) break;
    parts.push_back(fmt::format("{} {:.2f}", kUnseenPlaces[i].name, guessed.at[i]));
    const std::string_view remedy = kUnseenPlaces[i].remedy;
    if (std::find(remedies.begin(), remedies.end(), remedy) == remedies.end())
      remedies.push_back(remedy);
  }
  const std::string share = fmt::format("{:.2f} of all directions", guessed.all),
                    where = parts.empty() ? "" : fmt::format(" ({})", fmt::join(parts, ", ")),
                    remedy =
                        remedies.empty() ? "" : fmt::format("render {}", fmt::join(remedies, ", "));
  plan.reasons.push_back(fmt::format("guessed: {} lead past what no picture shows{}{}{}", share,
                                     where, remedy.empty() ? "" : "; ", remedy));
  return {guessed.all, guessed.all > kMuchGuessed ? remedy : ""};
}

}  // namespace ssdo
