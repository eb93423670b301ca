// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "filters/shot/findings.h"
#include "filters/shot/moved.h"

namespace ssdo {

/// Another frame of the shot, and what moved between it and the frame that takes the mean.
struct OtherFindings {
  const Findings* findings;
  int away;                                    ///< its number less that of the frame
  const std::vector<MovedPiece>* disappeared;  ///< find_pieces(frame, other)
  const std::vector<MovedPiece>* appeared;     ///< find_pieces(other, frame)
};

}  // namespace ssdo
