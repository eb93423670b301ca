// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace ssdo {

/// Sets options of `app` from a TOML file, after the command line has been parsed. Keys are the
/// long names of the main job's options, all at the top level. The command line wins, also over an
/// option of the file that excludes one on the command line. Errors: ExitCode::usage, naming file
/// and line: text that is not TOML, a key that is no option, a value that the option does not take.
void read_config_file(const std::string& path, CLI::App& app);

}  // namespace ssdo
