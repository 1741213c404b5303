#include "umbra/bench/cli/completion.h"
#include "umbra/bench/cli/streams.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "umbra/bench/cli/command.h"

namespace umbra {

Action completion_command(CLI::App& app, const Common& /*common*/) {
    const auto shell = std::make_shared<std::string>();
    app.add_option("SHELL", *shell, "bash or zsh")->type_name("")->required()->check(CLI::IsMember({"bash", "zsh"}));
    app.footer(
        "bash: source <(umbra completion bash), in ~/.bashrc to keep it.\n"
        "zsh: source <(umbra completion zsh) after compinit, in ~/.zshrc to keep it.");
    return [shell, &app] {
        print_out("{}", completion_script(*app.get_parent(), *shell == "bash" ? Shell::bash : Shell::zsh));
        return int{kDone};
    };
}

}  // namespace umbra
