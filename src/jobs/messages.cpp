// SPDX-License-Identifier: Apache-2.0
#include "jobs/messages.h"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

#include "io/one_line.h"

namespace ssdo {
namespace {

std::string line_of(const std::string& text) { return "ssdo: " + printable(text) + "\n"; }

}  // namespace

std::string warning_of(const std::string& warning, const std::string& view) {
  return fmt::format("{}: warning: {}", view.empty() ? "" : " (" + view + ")", warning);
}

void Messages::add(const std::string& line) { add_text(line_of(line)); }

void Messages::warn(const std::vector<std::string>& warnings, const std::string& view, bool every) {
  for (const std::string& warning : warnings) {
    const std::string text = warning_of(warning, view);
    lines_.push_back(
        {verbosity_->quiet ? "" : line_of(input_ + text), every ? "" : text, verbosity_->verbose});
  }
}

void Messages::note(const std::vector<std::string>& warnings, const std::string& view) {
  for (const std::string& warning : warnings) lines_.push_back({"", warning_of(warning, view)});
}

std::vector<Line> Messages::take() { return std::exchange(lines_, {}); }

void Printer::print(const std::string& line) { print_text(line_of(line)); }

void Printer::print(Messages& messages, std::size_t place, int number) {
  for (const Line& line : messages.take()) {
    const bool is_new = line.warning.empty() || repeated_.add(place, number, line.warning);
    if ((is_new || line.repeats) && !line.text.empty()) print_text(line.text);
  }
}

void Printer::print_text(const std::string& text) {
  progress_.clear();
  std::fputs(text.c_str(), stderr);
}

}  // namespace ssdo
