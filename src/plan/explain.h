// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "plan/plan.h"
#include "scene/other_views/merge.h"
#include "scene/scene.h"

namespace ssdo {

/// Adds what other views contribute to the reasons.
void explain_views(Plan& plan, const std::vector<MergeCounts>& views);

/// Adds how much of the result is guessed, and what would help, to the reasons. Where it is much,
/// it gives a warning for who asks before rendering; nothing is wrong with the frame.
std::string explain_guessed(Plan& plan, const Scene& scene);

/// Has a plan use the learned prior, and says what it does.
void use_prior(Plan& plan, const LearnedPrior& prior);

}  // namespace ssdo
