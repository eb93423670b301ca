// SPDX-License-Identifier: Apache-2.0
#include "color/color.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <strings.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <glm/common.hpp>
#include <sstream>
#include <system_error>
#include <vector>

#include "color/color_space.h"
#include "error.h"
#include "io/one_line.h"
#include "io/size_guard.h"
#include "math/half_color.h"
#include "nearest_name.h"

namespace ssdo {
namespace {

namespace OCIO = OCIO_NAMESPACE;
using Names = std::vector<std::string>;

/// data/color/config.ocio, as a string literal that the build makes.
constexpr const char* kBuiltInConfig =
#include "builtin_config.inc"
    ;

constexpr int kFirstVersionWithUris = 0x02020000;

/// The largest half float. The ACES transforms turn values far beyond it into black, and infinite
/// ones into NaN.
constexpr float kLargest = HalfColor::kMost;

/// Largest file of an OpenColorIO config, in bytes; that of ACES has 0.3 MiB.
constexpr std::size_t kMostConfigBytes = 4 << 20;

struct LabelledConfig {
  OCIO::ConstConfigRcPtr config;
  std::string label;  ///< for messages
};

struct View {
  std::string display, view, look;
};

/// `source` is what named the file: an option or a variable.
LabelledConfig load_config(const std::string& file, const std::string& source) {
  const std::string label = fmt::format("{} {}", source, file);
  const bool is_uri = file.starts_with("ocio://");
  if (is_uri && OCIO::GetVersionHex() < kFirstVersionWithUris) {
    throw Error(ExitCode::input,
                fmt::format("{}: OpenColorIO {} has no configs of its own (2.2 and later do); pass "
                            "--ocio FILE, or unset OCIO for the built-in config",
                            label, OCIO::GetVersion()));
  }
  std::error_code ignored;
  if (!is_uri && std::filesystem::is_directory(file, ignored)) {
    throw Error(ExitCode::input, label + ": is a folder; name the config.ocio in it");
  }
  if (!is_uri) check_text_size(file, kMostConfigBytes, ExitCode::input);
  try {
    return {OCIO::Config::CreateFromFile(file.c_str()), label};
  } catch (const OCIO::Exception& error) {
    throw Error(ExitCode::input,
                fmt::format("{}: not a config that OpenColorIO can read: {}; pass another "
                            "with --ocio FILE",
                            label, one_line(error.what())));
  }
}

LabelledConfig select_config(const std::string& option) {
  if (!option.empty()) return load_config(option, "--ocio");
  const char* variable = std::getenv("OCIO");
  if (variable && *variable) return load_config(variable, "$OCIO");
  std::istringstream text(kBuiltInConfig);
  return {OCIO::Config::CreateFromStream(text), "the built-in config"};
}

Names displays_of(const OCIO::Config& config) {
  Names names;
  for (int i = 0; i < config.getNumDisplays(); ++i) names.emplace_back(config.getDisplay(i));
  return names;
}

Names views_of(const OCIO::Config& config, const std::string& display) {
  Names names;
  for (int i = 0; i < config.getNumViews(display.c_str()); ++i) {
    names.emplace_back(config.getView(display.c_str(), i));
  }
  return names;
}

Names looks_of(const OCIO::Config& config) {
  Names names;
  for (int i = 0; i < config.getNumLooks(); ++i) names.emplace_back(config.getLookNameByIndex(i));
  return names;
}

/// The one of `names` that the option asks for, as the config spells it: case does not matter to
/// OpenColorIO. `owner` is what has the names.
std::string pick(const std::string& option, const std::string& wanted, const Names& names,
                 const std::string& owner) {
  const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return strcasecmp(name.c_str(), wanted.c_str()) == 0;
  });
  if (found != names.end()) return *found;
  throw Error(ExitCode::usage,
              fmt::format("{} {}: not in {}; {}it has: {}", option, wanted, owner,
                          did_you_mean(wanted, names),
                          names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

View choose_view(const LabelledConfig& from, const ColorOptions& options) {
  const OCIO::Config& config = *from.config;
  View v{config.getDefaultDisplay(), "", ""};
  if (!options.display.empty()) {
    v.display = pick("--display", options.display, displays_of(config), from.label);
  }
  v.view = config.getDefaultView(v.display.c_str());
  if (!options.view.empty()) {
    v.view = pick("--view", options.view, views_of(config, v.display),
                  fmt::format("display {} of {}", v.display, from.label));
  }
  if (!options.look.empty()) v.look = pick("--look", options.look, looks_of(config), from.label);
  return v;
}

OCIO::TransformRcPtr matrix_transform(const glm::mat3& m) {
  double rows[16] = {};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rows[4 * row + column] = m[column][row];
  }
  rows[15] = 1;
  const auto transform = OCIO::MatrixTransform::Create();
  transform->setMatrix(rows);
  return transform;
}

/// Whether the view shows the values as they are.
bool shows_data(const OCIO::Config& config, const View& v) {
  const auto space =
      config.getColorSpace(config.getDisplayViewColorSpaceName(v.display.c_str(), v.view.c_str()));
  return space && space->isData();
}

/// A look that the user names takes the place of those that the view brings along.
OCIO::ConstCPUProcessorRcPtr make_processor(const LabelledConfig& from, const InputSpace& input,
                                            const View& v) try {
  const auto transform = OCIO::DisplayViewTransform::Create();
  transform->setSrc(input.name.c_str());
  transform->setDisplay(v.display.c_str());
  transform->setView(v.view.c_str());
  const auto pipeline = OCIO::LegacyViewingPipeline::Create();
  pipeline->setDisplayViewTransform(transform);
  pipeline->setLooksOverrideEnabled(!v.look.empty());
  pipeline->setLooksOverride(v.look.c_str());
  const auto processor = pipeline->getProcessor(from.config);
  if (!input.conversion || shows_data(*from.config, v)) return processor->getDefaultCPUProcessor();
  const auto group = OCIO::GroupTransform::Create();
  group->appendTransform(matrix_transform(*input.conversion));
  group->appendTransform(processor->createGroupTransform());
  return from.config->getProcessor(group)->getDefaultCPUProcessor();
} catch (const OCIO::Exception& error) {
  throw Error(ExitCode::input,
              fmt::format("{}: cannot go from {} to display {}, view {}: {}; mend the "
                          "config or choose others with --display and --view",
                          from.label, input.name, v.display, v.view, one_line(error.what())));
}

std::string describe(const std::string& config_label, const InputSpace& input, const View& v) {
  std::string line =
      fmt::format("colour by {}: {} ({}{}) to display {}, view {}", config_label, input.name,
                  input.chosen_by, input.conversion ? ", converted" : "", v.display, v.view);
  if (!v.look.empty()) line += ", look " + v.look;
  if (!input.passed_over.empty()) {
    line += fmt::format("; passed over: {}", fmt::join(input.passed_over, ", "));
  }
  return line;
}

}  // namespace

struct DisplayTransform::Processor {
  OCIO::ConstCPUProcessorRcPtr cpu;
};

DisplayTransform::DisplayTransform(const ColorOptions& options, const ColorTags& tags) {
  OCIO::SetLoggingLevel(OCIO::LOGGING_LEVEL_NONE);  // errors are thrown, and printed once
  const LabelledConfig from = select_config(options.ocio);
  const InputSpace input = choose_input_space(*from.config, from.label, options.colorspace, tags);
  const View view = choose_view(from, options);
  processor_ = std::make_unique<Processor>(Processor{make_processor(from, input, view)});
  description_ = describe(from.label, input, view);
  warning_ = input.warning;
}

DisplayTransform::~DisplayTransform() = default;
DisplayTransform::DisplayTransform(DisplayTransform&&) noexcept = default;
DisplayTransform& DisplayTransform::operator=(DisplayTransform&&) noexcept = default;

void DisplayTransform::apply(std::span<glm::vec3> colors) const {
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float), "colours are packed RGB");
  if (colors.empty()) return;
  for (glm::vec3& color : colors) color = glm::clamp(color, -kLargest, kLargest);
  OCIO::PackedImageDesc image(colors.data(), long(colors.size()), 1, 3);
  processor_->cpu->apply(image);
}

}  // namespace ssdo
