// SPDX-License-Identifier: Apache-2.0
#include "jobs/statistics.h"

#include <sys/resource.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/files/checked_file.h"
#include "io/json_text.h"

namespace ssdo {
namespace {

std::size_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::size_t(usage.ru_maxrss) * 1024;
}

}  // namespace

nlohmann::json statistics_of(const Frame& frame, const Job& job, const Resources& resources,
                             const Relit& relit) {
  const StageTimes& t = relit.times;
  const Plan& plan = relit.plan;
  nlohmann::json outputs = nlohmann::json::array();
  for (const Target& target : job.targets) outputs.push_back(target.path);
  std::vector<std::string> warnings = frame.warnings();
  warnings.insert(warnings.end(), relit.warnings.begin(), relit.warnings.end());
  nlohmann::json out = {
      {"frame", job.frame ? nlohmann::json(*job.frame) : nlohmann::json()},
      {"input", frame.input},
      {"view", frame.view},
      {"output", outputs.size() == 1 ? outputs[0] : outputs},
      {"width", frame.gbuffer.file_window.width()},
      {"height", frame.gbuffer.file_window.height()},
      {"threads", resources.threads()},
      {"isa", resources.isa()},
      {"method", plan.method->name},
      {"samples_per_pixel", plan.samples_per_pixel()},
      {"bounces", plan.request.bounces},
      {"stages_ms",
       {{"read", t.read},
        {"known", t.known},
        {"prepare", t.prepare},
        {"estimate", t.estimate},
        {"filter", t.filter},
        {"compose", t.compose},
        {"write", t.write},
        {"total", t.read + t.known + t.prepare + t.estimate + t.filter + t.compose + t.write}}},
      {"peak_rss_bytes", peak_rss_bytes()},
      {"mem_limit_bytes", resources.memory()},
      {"pixels", frame.gbuffer.file_window.area()},
      {"background_pixels", frame.gbuffer.background_pixels},
      {"bad_pixels", frame.gbuffer.bad_pixels},
      {"warnings", warnings},
      {"missing", frame.losses()},
      {"plan", to_json(plan, frame.history)},
  };
  if (const auto& error = relit.error)
    out["error"] = {{"rms", error->all}, {"noise", error->noise}, {"steps", error->steps}};
  return out;
}

OutputPolicy policy_of_statistics(OutputPolicy of_images) {
  of_images.overwrite = true;
  return of_images;
}

void write_statistics(const std::string& path, const OutputPolicy& policy,
                      const nlohmann::json& frames) {
  SafeFile file(path, policy);
  const std::string text = json_text(frames, 2) + "\n";
  CheckedFile checked(file);
  checked.write(text.data(), text.size());
  checked.close();
  file.commit();
}

}  // namespace ssdo
