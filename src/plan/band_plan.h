// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "plan/outputs.h"
#include "plan/plan.h"

namespace ssdo {

/// How a frame that does not fit into memory is cut into bands of rows. Each is read with the rows
/// around it that its light comes from.
struct BandPlan {
  int rows = 0;                        ///< that a band writes; the last may have fewer
  int reach_rows = 0;                  ///< above and below a pixel, that its marches in a band read
  int march_px = 0;                    ///< from a pixel, where its marches in a band end
  int halo_rows = 0;                   ///< that a band reads above and below those that it writes
  bool continues_in_overview = false;  ///< in an overview of the frame, beyond reach_rows
};

/// How many pixels a frame may have that is computed as a whole in so many bytes of memory, lit by
/// an environment and so many lamps.
std::size_t most_pixels_in(std::size_t memory, const OutputOptions& output, int lamps);

/// Bytes that a process takes for a frame of so many pixels in one piece, with a margin. `scene`:
/// light, senders, what casts and blocks.
double bytes_in_one_piece(const Plan& plan, const Scene& scene, std::size_t pixels);

/// The bands of a frame with these data and display windows. `overview` is what was read of it, and
/// `plan` that of the overview.
/// Errors: ExitCode::usage, where what is wanted looks at a whole frame at once, with what to leave
/// out; where `memory` is too little for any bands, with how much would do.
BandPlan plan_bands(const std::string& file, const Window& frame, const Window& display,
                    const Scene& overview, const Plan& plan, const OutputOptions& output,
                    std::size_t memory);

/// The rows to read above and below those of a band, if marches reach so many rows.
int halo_rows(const Plan& plan, int reach_rows);

/// For people.
std::string describe(const BandPlan& bands, const Window& frame);

}  // namespace ssdo
