// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// Shares of the rays to a source, 0..1: of those that leave the frame and that nothing hides which
/// goes on beyond it, and of those that something does.
struct PassBeyond {
  float past = 1, through = 0;
};

}  // namespace ssdo
