#include <array>

#include "umbra/bench/cli/command.h"

namespace umbra {

std::span<const Command> commands() {
    static constexpr std::array kCommands = {
#define COMMAND(name, about) name##_line,
#include "umbra/bench/cli/commands.def"
#undef COMMAND
    };
    return kCommands;
}

}  // namespace umbra
