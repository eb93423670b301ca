// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plan/plan.h"
#include "scene/other_views/merge.h"
#include "scene/scene.h"

namespace ssdo {

/// Adds what other views contribute to the reasons.
void explain_views(Plan& plan, const std::vector<MergeCounts>& views);

/// How much of a result is guessed.
struct GuessedShare {
  std::optional<float> share;  ///< of all directions; empty: the method does not know
  std::string remedy;          ///< "render ..."; empty: it is not much

  /// A line for who asks before rendering; nothing is wrong with the frame. Empty: it is not much.
  std::string advice() const;
};

/// Adds how much of the result is guessed, and what would help, to the reasons.
GuessedShare explain_guessed(Plan& plan, const Scene& scene);

/// Has a plan use the learned prior, and says what it does.
void use_prior(Plan& plan, const LearnedPrior& prior);

}  // namespace ssdo
