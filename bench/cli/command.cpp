#include "umbra/bench/cli/command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>

#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/contenders/contender.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/memory.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/suggest.h"

namespace umbra {
namespace {

/// The first word that is no option, empty where that is for CLI11 to say. Throws UsageError where it names no command.
std::string check_command(int argc, const char* const* argv, std::span<const Command> commands) {
    const std::vector<std::string> known = names_of_entries(commands);
    for (int i = 1; i < argc; ++i) {
        std::string word = argv[i];
        if (word == "--help" || word == "-h" || word == "--version") return "";
        if (word == "--threads" || word == "--plugin") ++i;
        if (word.starts_with("-")) continue;
        if (std::find(known.begin(), known.end(), word) != known.end()) return word;
        throw UsageError(fmt::format("unknown command \"{}\"{}", word, did_you_mean(word, known)));
    }
    throw UsageError("no command given");
}

/// What CLI11 says about a wrong command line, with names for mistyped options.
std::string explain(const CLI::App& app, const CLI::App& command, const CLI::ParseError& error) {
    std::string text = error.what();
    if (const std::size_t end = text.find('\n'); end != std::string::npos) text.resize(end);
    std::vector<std::string> options;
    for (const CLI::App* of : {&command, &app})
        for (const CLI::Option* option : of->get_options()) {
            if (option->get_group().empty()) continue;  // not in the help either
            for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
        }
    for (const std::string& word : app.remaining(true))
        if (word.starts_with("--")) text += did_you_mean(word.substr(0, word.find('=')), options);
    return text;
}

/// A value that is given and empty is a script's unset variable.
void refuse_empty_values(const CLI::App& app) {
    for (const CLI::Option* option : app.get_options())
        if (option->get_expected_min() > 0)
            for (const std::string& value : option->results())
                if (value.empty()) throw UsageError(fmt::format("{}: the value is empty", option->get_name()));
}

/// Whether its words may name methods: no other command reads the files of contenders, or warns of them.
bool names_methods(const CLI::App& app, const std::string& command) {
    constexpr std::array kOthers{"list", "inspect", "contender", "completion"};
    const auto has = [&](const char* option) {
        return app.get_subcommand(command)->get_option_no_throw(option) != nullptr;
    };
    return !command.empty() &&
           (has("--methods") || has("--with") || std::ranges::find(kOthers, command) != kOthers.end());
}

/// Defines the whole command line on an empty `app`; returns the action of each command, in their order.
std::vector<Action> define_commands(CLI::App& app, Common& common, std::span<const Command> commands) {
    app.description(
        "Umbra compares shadow algorithms: one scene, many methods, one question: which fraction of each light does "
        "each surface point see?");
    app.name("umbra");
    app.require_subcommand(1);
    app.set_version_flag("--version", std::string(version()));
    app.fallthrough();
    app.add_option("--threads", common.threads, "Threads to use (default: all)")
        ->check(CLI::Range(1, 1024))
        ->type_name("N");
    app.add_flag("--quiet", common.quiet, "Print results and errors only");
    app.add_option_function<std::vector<std::string>>(
           "--plugin",
           [](const std::vector<std::string>& files) {
               for (const std::string& file : files) add_library_method(file);
           },
           "A shared library with a method (docs/contenders.md), whose code runs in this program")
        ->type_name("FILE.so")
        ->allow_extra_args(false)
        ->trigger_on_parse();
    std::vector<Action> actions;
    for (const Command& command : commands)
        actions.push_back(
            command.define(*app.add_subcommand(std::string(command.name), std::string(command.about)), common));
    for (CLI::App* command : app.get_subcommands(nullptr))
        if (command->get_option_no_throw("SCENE") != nullptr)
            command->add_option("--up", common.up, "Which axis of mesh files points up: y, z or =-y (also: FILE@z)")
                ->check(CLI::IsMember({"y", "z", "-y"}))
                ->type_name("AXIS");
    // After the commands were added, which would inherit it.
    app.footer(
        "SCENE is a file or the name of a canonical scene; METHOD is NAME or NAME:setting=value,setting=value (see "
        "umbra list).\n"
        "Exit codes: 0 done, 1 the answer is no, 4 input unreadable, 5 a method failed or was cut short, or internal error, 64 wrong "
        "usage; diff: 0 same, 1 close, 2 differs, 3 size or channels differ, 4 unreadable.\n"
        "The script ./umbra also has: setup, test, bench, oracle, mutants, faults, check, fuzz.");
    return actions;
}

int parse_and_run(int argc, const char* const* argv, std::span<const Command> commands, std::string& help) {
    CLI::App app;
    Common common;
    const std::vector<Action> actions = define_commands(app, common, commands);
    common.command                    = "umbra";
    for (int i = 1; i < argc; ++i) common.command += fmt::format(" {}", argv[i]);

    const std::string command = check_command(argc, argv, commands);
    if (names_methods(app, command))
        for (const std::string& problem : add_contenders()) print_error("warning: {}\n", problem);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        const auto parsed = app.get_subcommands();
        if (!parsed.empty()) help = parsed.front()->get_name() + " --help";
        throw UsageError(explain(app, parsed.empty() ? app : *parsed.front(), error));
    }
    const ThreadLimit limit(common.threads);
    const std::string name = app.get_subcommands().front()->get_name();
    help                   = name + " --help";
    refuse_empty_values(*app.get_subcommands().front());
    for (std::size_t i = 0; i < commands.size(); ++i)
        if (commands[i].name == name) return actions[i]();
    return kInternal;
}

}  // namespace

int run_command_line(int argc, const char* const* argv, std::span<const Command> known) {
    keep_freed_memory();
    prepare_streams();
    std::string help = "--help";
    try {
        const int code = parse_and_run(argc, argv, known, help);
        flush_out();
        return code;
    } catch (const OutputClosed&) {
        end_like_closed_pipe();
    } catch (const UsageError& e) {
        print_error("umbra: {}\nTry: umbra {}\n", e.what(), help);
        return kUsage;
    } catch (const InputError& e) {
        print_error("{}\n", e.what());
        return kUnreadable;
    } catch (const std::filesystem::filesystem_error& e) {  // a name that is too long, a folder that is not ours
        print_error("{}\n", e.what());
        return kUnreadable;
    } catch (const MethodError& e) {
        print_error("umbra: {}\n", e.what());
        return kInternal;
    } catch (...) {
        print_error("umbra: internal error: {}\n", current_message());
        return kInternal;
    }
}

}  // namespace umbra
