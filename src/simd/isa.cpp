// SPDX-License-Identifier: Apache-2.0
#include "simd/isa.h"

#include <fmt/format.h>
#include <hwy/targets.h>

#include "error.h"

namespace ssdo {

std::string choose_isa(std::string_view wanted) {
  struct Choice {
    std::string_view name;
    std::int64_t targets;
  };
  static constexpr Choice choices[] = {
      {"avx512", HWY_AVX3}, {"avx2", HWY_AVX2}, {"neon", HWY_NEON}, {"scalar", HWY_SCALAR}};
  const std::int64_t supported = (hwy::SupportedTargets() | HWY_SCALAR) & HWY_TARGETS;
  for (const Choice& choice : choices) {
    if (!wanted.empty() && choice.name != wanted) continue;
    const std::int64_t usable = choice.targets & supported;
    if (usable != 0) {
      hwy::GetChosenTarget().Update(usable);
      return std::string(choice.name);
    }
    if (!wanted.empty()) {
      throw Error(
          ExitCode::usage,
          fmt::format("$SSDO_ISA is '{}', which this processor or this build lacks", wanted));
    }
  }
  throw Error(ExitCode::usage,
              fmt::format("$SSDO_ISA is '{}'; expected scalar, neon, avx2 or avx512", wanted));
}

}  // namespace ssdo
