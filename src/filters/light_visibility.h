// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "estimators/estimator.h"
#include "filters/registry.h"
#include "scene/scene.h"

namespace ssdo {

/// The products after a filter that averages what arrives of the light, not the light: shading by
/// the normal of each pixel stays as it is. See light_visibility.cpp. `amend` may change ao and the
/// shares of light between the filter and the light that is made of them.
Products filter_visibility(const Filter& filter, Products noisy, const Scene& scene,
                           int pattern_size, const std::function<void(Products&)>& amend = {});

/// The two halves of filter_visibility(), for frames that share what they find in between. The
/// first ends with the filtered shares; with `as_visibility` they have the form of to_visibility()
/// even without a filter. The second makes light from them.
Products find_visibility(const Filter& filter, Products noisy, const Scene& scene, int pattern_size,
                         const std::function<void(Products&)>& amend, bool as_visibility);
Products light_of_visibility(Products found, const Scene& scene, bool as_visibility);

/// Products as filter_visibility() hands them to the filter: without `direct` where its shares are
/// known, else with the share of all light that arrives in its place; with `bent` turned as the
/// normal is turned to the z axis.
Products to_visibility(Products products, const Scene& scene);

/// The other way: shares times the light of each pixel's normal. What shows no surface gets none.
Products from_visibility(Products products, const Scene& scene);

}  // namespace ssdo
