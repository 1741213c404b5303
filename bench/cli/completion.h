// Completion scripts for shells, generated from the command line's definition.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace umbra {

enum class Shell : std::uint8_t { bash, zsh };

/// A script to be sourced (bash), or sourced or put on $fpath as _umbra (zsh). It completes commands, options, methods
/// with their settings and choices, ladders, scenes and files, for `umbra` in any folder, and calls no
/// program. `app` is the whole command line (define_commands).
[[nodiscard]] std::string completion_script(const CLI::App& app, Shell shell);

}  // namespace umbra
