// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/options.h"

namespace CLI {
class App;
}

namespace ssdo {

/// Declares the options of the main job, group by group as the help shows them. Values are parsed
/// when the option is set, so that an error can name the line of a config file.
void add_main_options(CLI::App& app, Options& options);

}  // namespace ssdo
