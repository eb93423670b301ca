// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace ssdo {

/// How a size of memory is written, for help and messages.
inline constexpr std::string_view kSizeForm =
    "a size such as 8G or 500M, with K, M, G or T, from 64M to 1024T";

/// What is said where an allocation fails.
inline constexpr const char* kNoMemory =
    "not enough memory for this frame; give it more (ulimit -v, control groups) or a smaller "
    "--mem-limit, which takes it in bands";

/// The bytes of a size in that form: a number and a power of 1024, "1.5G", "1.5GB" or "1.5gib".
/// Nothing for any other text, among them a number without a unit.
std::optional<std::size_t> parse_size(std::string_view text);

/// How many bytes of memory to use: `requested` if given, else $SSDO_MEM_LIMIT, else three quarters
/// of the least of the machine's memory, the address space that the process may have (ulimit -v),
/// the limits of the control groups, and $SLURM_MEM_PER_NODE or $SLURM_MEM_PER_CPU times
/// $SLURM_CPUS_PER_TASK. A variable of Slurm that is not a positive number is ignored, since the
/// user does not set it. `root` is where /proc and /sys are.
/// Errors: ExitCode::usage for an $SSDO_MEM_LIMIT that is no size.
std::size_t choose_memory(std::optional<std::size_t> requested,
                          const std::filesystem::path& root = "/");

}  // namespace ssdo
