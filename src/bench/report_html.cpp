// SPDX-License-Identifier: Apache-2.0
//
// page/page.html, or page/shot.html of a sequence, with its style, its scripts, Chart.js and the
// data in it. Pictures are PNG in data URIs.
#include <OpenImageIO/strutil.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "bench/report.h"
#include "bench/shot/shot_report.h"
#include "io/json_text.h"

namespace ssdo {
namespace {

constexpr std::string_view kPage =
#include "bench_page.inc"
    ;
constexpr std::string_view kStyle =
#include "bench_style.inc"
    ;
constexpr std::string_view kShotPage =
#include "bench_shot_page.inc"
    ;
constexpr std::string_view kBasis =
#include "bench_basis.inc"
    ;
constexpr std::string_view kShot =
#include "bench_shot.inc"
    ;
constexpr std::string_view kSpeed =
#include "bench_speed.inc"
    ;
constexpr std::string_view kMaps =
#include "bench_maps.inc"
    ;
constexpr std::string_view kFigures =
#include "bench_figures.inc"
    ;
constexpr std::string_view kChart =
#include "bench_chart.inc"
    ;

std::string data_uri(const std::string& png) {
  return "data:image/png;base64," + OIIO::Strutil::base64_encode(png);
}

nlohmann::json pictures_json(const BenchReport& report) {
  nlohmann::json all = nlohmann::json::array();
  for (const BenchReference& reference : report.references) {
    nlohmann::json pictures = nlohmann::json::object();
    for (const auto& [product, png] : reference.pictures)
      pictures[product] = {{"picture", data_uri(png)}};
    all.push_back({{"name", reference.name}, {"pictures", pictures}});
  }
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    if (report.rows[i].pictures.empty()) continue;
    nlohmann::json pictures = nlohmann::json::object();
    for (const auto& [product, made] : report.rows[i].pictures)
      pictures[product] = {{"picture", data_uri(made.picture)}, {"error", data_uri(made.error)}};
    all.push_back({{"name", report.rows[i].setting.name()}, {"row", i}, {"pictures", pictures}});
  }
  return all;
}

/// Text of a script element may not hold the end of one.
std::string escaped(const std::string& json) {
  std::string out;
  for (std::size_t i = 0; i < json.size(); ++i) {
    out += json[i];
    if (json[i] == '<' && i + 1 < json.size() && (json[i + 1] == '/' || json[i + 1] == '!'))
      out.replace(out.size() - 1, 1, "\\u003c");
  }
  return out;
}

/// The page with each {{name}} replaced.
std::string filled(std::string_view page,
                   const std::map<std::string_view, std::string_view>& texts) {
  std::string out;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t open = page.find("{{", at);
    out += page.substr(at, open - at);
    if (open == std::string_view::npos) break;
    const std::size_t close = page.find("}}", open);
    out += texts.at(page.substr(open + 2, close - open - 2));
    at = close + 2;
  }
  return out;
}

}  // namespace

std::string to_html(const BenchReport& report) {
  nlohmann::json data = to_json(report);
  data["pictures"] = pictures_json(report);
  data["error_scale"] = report.error_scale;
  const std::string text = escaped(json_text(data));
  return filled(kPage, {{"style", kStyle},
                        {"chart", kChart},
                        {"data", text},
                        {"basis", kBasis},
                        {"speed", kSpeed},
                        {"maps", kMaps},
                        {"figures", kFigures}});
}

std::string to_html(const ShotBenchReport& report) {
  const std::string text = escaped(json_text(to_json(report)));
  return filled(
      kShotPage,
      {{"style", kStyle}, {"chart", kChart}, {"data", text}, {"basis", kBasis}, {"shot", kShot}});
}

}  // namespace ssdo
