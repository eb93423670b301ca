// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// Has Embree use its kernels for AVX2 on every processor with it: rays hit at distances with other
/// last bits by those for AVX-512, which $SSDO_ISA does not turn off.
constexpr char kRayDevice[] = "max_isa=avx2";

}  // namespace ssdo
