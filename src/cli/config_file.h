// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace ssdo {

/// Gives the options of `app` the values that a TOML file names, once the command line has been
/// read. Keys are the long names of the main job's options, all at the top level. What stands on
/// the command line wins, over an option of the file that excludes it too.
/// Errors: ExitCode::usage, naming file and line: text that is not TOML, a key that is no option,
/// a value that the option does not take.
void read_config_file(const std::string& path, CLI::App& app);

}  // namespace ssdo
