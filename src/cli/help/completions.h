// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace ssdo {

/// The shells that completions() knows, as the help shows them.
inline constexpr const char* kShells = "{bash,zsh}";

/// A script that completes the command line of `app` in a shell: its commands and options, the
/// names that their values may have, and files. Errors: ExitCode::usage for another shell.
std::string completions(const CLI::App& app, const std::string& shell);

}  // namespace ssdo
