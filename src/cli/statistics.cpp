// SPDX-License-Identifier: Apache-2.0
#include "cli/statistics.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <fstream>

#include "error.h"
#include "io/json_text.h"
#include "io/safe_file.h"

namespace ssdo {
namespace {

std::size_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::size_t(usage.ru_maxrss) * 1024;
}

}  // namespace

void Statistics::add(const Frame& frame, std::optional<int> number,
                     const std::vector<Target>& targets, const Resources& resources,
                     const Relit& relit) {
  const StageTimes& t = relit.times;
  const Plan& plan = relit.plan;
  nlohmann::json outputs = nlohmann::json::array();
  for (const Target& target : targets) outputs.push_back(target.path);
  frames_.push_back({
      {"frame", number ? nlohmann::json(*number) : nlohmann::json()},
      {"input", frame.input},
      {"output", targets.size() == 1 ? outputs[0] : outputs},
      {"width", frame.scene.geometry.window.width()},
      {"height", frame.scene.geometry.window.height()},
      {"threads", resources.threads()},
      {"isa", resources.isa()},
      {"method", plan.method->name},
      {"samples_per_pixel", plan.samples_per_pixel()},
      {"bounces", plan.request.bounces},
      {"stages_ms",
       {{"read", t.read},
        {"prepare", t.prepare},
        {"estimate", t.estimate},
        {"filter", t.filter},
        {"compose", t.compose},
        {"write", t.write},
        {"total", t.read + t.prepare + t.estimate + t.filter + t.compose + t.write}}},
      {"peak_rss_bytes", peak_rss_bytes()},
      {"pixels", frame.scene.geometry.surfel.size()},
      {"background_pixels", frame.gbuffer.background_pixels},
      {"bad_pixels", frame.gbuffer.bad_pixels},
      {"plan", to_json(plan)},
      {"history", frame.history},
  });
  if (const auto& error = relit.error)
    frames_.back()["error"] = {
        {"rms", error->all}, {"noise", error->noise}, {"steps", error->steps}};
}

void Statistics::write(const std::string& path, const OutputPolicy& policy) const {
  SafeFile file(path, policy);
  std::ofstream out(file.temporary());
  out << json_text(frames_, 2) << '\n';
  out.close();
  if (!out)
    throw Error(ExitCode::output, fmt::format("{}: the statistics could not be written", path));
  file.commit();
}

}  // namespace ssdo
