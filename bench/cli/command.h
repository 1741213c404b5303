// What the files of the command line share: exit codes, options of all commands, the table of commands.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace umbra {

/// `diff` exits with its verdict (bench/gate/diff.h), 0 to 4.
enum Exit : int { kDone = 0, kNo = 1, kUnreadable = 4, kInternal = 5, kUsage = 64 };

/// Options of all commands.
struct Common {
    int threads    = 0;  ///< 0: all
    bool quiet     = false;
    std::string up = "y";  ///< which axis of mesh files points up, of commands that take scenes
    std::string command;   ///< the whole command line, for the records
};

/// Runs a command after its command line was parsed; returns the exit code. Throws UsageError, InputError.
using Action = std::function<int()>;

/// One line of commands.def. `define` adds the command's options to `app` and returns its action; `app` and `common`
/// must outlive it.
struct Command {
    std::string_view name, about;
    Action (*define)(CLI::App& app, const Common& common);
};
[[nodiscard]] std::span<const Command> commands();  ///< all of commands.def

#define COMMAND(name, about)                                    \
    Action name##_command(CLI::App& app, const Common& common); \
    inline constexpr Command name##_line{#name, about, name##_command};
#include "umbra/bench/cli/commands.def"
#undef COMMAND

/// Parses and runs one of `known`. Prints errors to standard error and returns the exit code; does not throw.
int run_command_line(int argc, const char* const* argv, std::span<const Command> known);

}  // namespace umbra
