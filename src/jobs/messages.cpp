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

void Messages::add(const std::string& line) { add_text(line_of(line)); }

void Messages::warn(const std::vector<std::string>& warnings, const std::string& view, bool every) {
  if (verbosity_->quiet) return;
  const std::string of_view = view.empty() ? "" : " (" + view + ")";
  for (const std::string& warning : warnings) {
    const std::string text = fmt::format("{}: warning: {}", of_view, warning);
    lines_.push_back({line_of(input_ + text), every || verbosity_->verbose ? "" : text});
  }
}

std::vector<Line> Messages::take() { return std::exchange(lines_, {}); }

void Printer::print(const std::string& line) { print_text(line_of(line)); }

void Printer::print(Messages& messages, std::size_t place, int number) {
  for (const Line& line : messages.take())
    if (line.warning.empty() || repeated_.add(place, number, line.warning)) print_text(line.text);
}

void Printer::print_summary(const std::string& input) {
  for (const std::string& line : repeated_.summary()) print(input + line);
}

void Printer::print_text(const std::string& text) {
  progress_.clear();
  std::fputs(text.c_str(), stderr);
}

}  // namespace ssdo
