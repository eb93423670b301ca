// SPDX-License-Identifier: Apache-2.0
#include "io/size_guard.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>

namespace ssdo {
namespace {

constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;

std::atomic<double> limit = 0;  ///< 0: that of the machine

}  // namespace

double physical_memory() { return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE)); }

void check_decoded_size(const std::filesystem::path& file, std::uint64_t file_bytes,
                        double pixel_bytes, double needed_bytes, double largest_ratio) {
  if (pixel_bytes > double(file_bytes) * largest_ratio) {
    throw Error(ExitCode::input,
                fmt::format("{}: is damaged: its header claims {:.1f} GiB of pixels, which a file "
                            "of {} bytes cannot hold; render or copy it again",
                            file.string(), pixel_bytes / kGiB, file_bytes));
  }
  if (needed_bytes > physical_memory()) {
    throw Error(ExitCode::input,
                fmt::format("{}: needs {:.1f} GiB of memory for its pixels, this machine has "
                            "{:.1f} GiB; reduce the image or use a larger machine",
                            file.string(), needed_bytes / kGiB, physical_memory() / kGiB));
  }
}

void limit_memory(double bytes) { limit = bytes; }

double memory_limit() { return limit > 0 ? limit.load() : physical_memory(); }

void check_picture_size(const std::filesystem::path& file, double pixel_bytes,
                        double needed_bytes) {
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(file, unknown);
  check_decoded_size(file, bytes, unknown ? 0 : pixel_bytes, needed_bytes);
  if (needed_bytes <= memory_limit()) return;
  throw Error(
      ExitCode::input,
      fmt::format("{}: needs {:.1f} GiB of memory for its pixels, and the run may use {:.1f} "
                  "GiB; reduce the image or raise --mem-limit ($SSDO_MEM_LIMIT)",
                  file.string(), needed_bytes / kGiB, memory_limit() / kGiB));
}

void check_text_size(const std::filesystem::path& file, std::size_t most, ExitCode code) {
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(file, unknown);
  if (unknown || bytes <= most) return;
  throw Error(code, fmt::format("{}: has {} KiB, and a file of its kind {} KiB at most; is it the "
                                "one that is meant?",
                                file.string(), bytes / 1024, most / 1024));
}

std::string read_text(std::istream& in, const std::filesystem::path& file, std::size_t most,
                      ExitCode code) {
  check_text_size(file, most, code);
  std::string text(most + 1, '\0');
  in.read(text.data(), std::streamsize(text.size()));
  text.resize(std::size_t(in.gcount()));
  if (text.size() <= most) return text;
  throw Error(code, fmt::format("{}: has more than {} KiB, the most of a file of its kind; is it "
                                "the one that is meant?",
                                file.string(), most / 1024));
}

}  // namespace ssdo
