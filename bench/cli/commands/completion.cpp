// Both shells share POSIX functions that print candidates, one a line; what each shell needs beside them is short.
// Kinds of values are the option's type name and the positional's name: SCENE, METHOD, LADDER, FILE, DIR, ...
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/studies/motion/growth_family.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

/// Of kinds without a list of values, and of file names among others, the line //files.
constexpr std::string_view kFunctions = R"sh(
# METHOD[:setting=value,...] as typed so far
_umbra_methods() {
    local method rest head name value
    case $1 in
        *:*) ;;
        *) _umbra_list METHODS; return ;;
    esac
    method=${1%%:*} rest=${1#*:}
    case $rest in
        *,*) head=$method:${rest%,*}, name=${rest##*,} ;;
        *) head=$method: name=$rest ;;
    esac
    case $name in
        *=*)
            name=${name%%=*}
            _umbra_choices "$method:$name" | while IFS= read -r value; do printf '%s\n' "$head$name=$value"; done ;;
        *) _umbra_settings "$method" | while IFS= read -r value; do printf '%s\n' "$head$value="; done ;;
    esac
}

# KIND CURRENT
_umbra_values() {
    case $1 in
        METHOD) _umbra_methods "$2" ;;
        SCENE) _umbra_list SCENES; echo //files ;;
        LADDER) _umbra_list LADDERS ;;
        SIZE) _umbra_list SIZES ;;
        GOLDEN) _umbra_list SCENES; _umbra_list METHODS ;;
        NAME) _umbra_list METHODS; _umbra_list LADDERS; _umbra_list SCENES ;;
        SHELL) printf '%s\n' bash zsh ;;
        AXIS) printf '%s\n' y z -y ;;
        FILE | DIR | A) echo //files ;;
    esac
}

# All words after the program's name, the last one as typed so far
_umbra_complete() {
    local command= kind= word
    while [ $# -gt 1 ]; do
        word=$1
        shift
        case $word in
            -*) kind=$(_umbra_kind "$command $word") ;;
            *)
                case $kind in
                    '') [ -n "$command" ] || command=$word ;;
                    *+) ;;
                    *) kind= ;;
                esac ;;
        esac
    done
    case $1 in
        -*) _umbra_options "$command" ;;
        *)
            if [ -n "$kind" ]; then _umbra_values "${kind%+}" "$1"
            elif [ -z "$command" ]; then _umbra_list COMMANDS
            else _umbra_values "$(_umbra_positional "$command")" "$1"
            fi ;;
    esac
}
)sh";

constexpr std::string_view kBash = R"sh(
_umbra() {
    local line=${COMP_LINE:0:COMP_POINT} words current candidate files= prefix breaks=
    read -ra words <<<"$line"
    case $line in *[[:space:]]) words+=("") ;; esac
    current=${words[${#words[@]} - 1]}
    COMPREPLY=()
    while IFS= read -r candidate; do
        if [ "$candidate" = //files ]; then files=1
        elif [[ $candidate == "$current"* ]]; then COMPREPLY+=("$candidate")
        fi
    done < <(_umbra_complete "${words[@]:1}")
    case ${COMPREPLY[0]:-} in *=) compopt -o nospace 2>/dev/null ;; esac
    if [ -n "$files" ]; then
        while IFS= read -r candidate; do COMPREPLY+=("$candidate"); done < <(compgen -f -- "$current")
        compopt -o filenames 2>/dev/null
    fi
    # Readline breaks words at : and = and replaces what follows the last of them.
    case $COMP_WORDBREAKS in *:*) breaks=: ;; esac
    case $COMP_WORDBREAKS in *=*) breaks+== ;; esac
    if [[ -n $breaks && $current == *[$breaks]* ]]; then
        prefix=${current%"${current##*[$breaks]}"}
        COMPREPLY=("${COMPREPLY[@]#"$prefix"}")
    fi
}
complete -F _umbra umbra
)sh";

constexpr std::string_view kZsh = R"sh(
_umbra() {
    local candidate files=
    local -a whole open
    while IFS= read -r candidate; do
        case $candidate in
            //files) files=1 ;;
            *=) open+=("$candidate") ;;
            *) whole+=("$candidate") ;;
        esac
    done < <(_umbra_complete "${(@)words[2,CURRENT]}")
    compadd -a whole
    compadd -S '' -a open
    [[ -z $files ]] || _files
}
if [ "${funcstack[1]}" = _umbra ]; then _umbra "$@"; else compdef _umbra umbra; fi
)sh";

using Names = std::vector<std::string>;

std::string print_line(const std::string& pattern, const Names& words) {
    if (words.empty()) return "";
    return fmt::format("        {}) printf '%s\\n' {} ;;\n", pattern, fmt::join(words, " "));
}

std::string function(const std::string& name, const std::string& cases) {
    return fmt::format("{}() {{\n    case $1 in\n{}    esac\n}}\n", name, cases);
}

Names option_names(const CLI::App& app) {
    Names names;
    for (const CLI::Option* option : app.get_options())
        if (!option->get_group().empty())  // other spellings have none
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

/// "'COMMAND --option') echo KIND", with a + where the option takes several values; "*" as command for all.
std::string kinds(const CLI::App& app, const std::string& command) {
    std::string cases;
    for (const CLI::Option* option : app.get_options()) {
        if (option->get_positional() || option->get_items_expected_max() == 0) continue;
        const std::string type = option->get_type_name();  // with limits behind a colon
        const std::string kind = type.substr(0, type.find(':')) +
                                 (option->get_items_expected_max() > 1 && !option->get_delimiter() ? "+" : "");
        for (const std::string& name : option->get_lnames())
            cases += fmt::format("        {}' --{}') echo '{}' ;;\n", command, name, kind);
        for (const std::string& name : option->get_snames())
            cases += fmt::format("        {}' -{}') echo '{}' ;;\n", command, name, kind);
    }
    return cases;
}

std::string method_functions() {
    std::string settings, choices;
    for (const MethodInfo* info : methods()) {
        settings += print_line(std::string(info->name), names_of_entries(info->parameters));
        for (const Parameter& p : info->parameters) {
            const std::string key = fmt::format("{}:{}", info->name, p.name);
            std::string words     = p.type == Parameter::Type::boolean ? "true|false" : std::string(p.choices);
            std::ranges::replace(words, '|', ' ');
            if (!words.empty()) choices += print_line(key, {words});
        }
    }
    return function("_umbra_settings", settings) + function("_umbra_choices", choices);
}

std::string app_functions(const CLI::App& app) {
    std::string options, kind_cases, positionals;
    Names names;
    for (const Command& command : commands()) {
        const std::string name(command.name);
        const CLI::App* sub = app.get_subcommand(name);
        names.push_back(name);
        Names all = option_names(*sub);
        for (const std::string& common : option_names(app))
            if (common != "--version" && common != "--help") all.push_back(common);
        options += print_line(name, all);
        kind_cases += kinds(*sub, name);
        for (const CLI::Option* option : sub->get_options())
            if (option->get_positional()) {
                positionals += fmt::format("        {}) echo {} ;;\n", name, option->get_single_name());
                break;
            }
    }
    options += print_line("''", option_names(app));
    kind_cases += kinds(app, "*");
    return function("_umbra_list", print_line("COMMANDS", names) + print_line("METHODS", names_of_entries(methods())) +
                                       print_line("LADDERS", names_of_entries(ladders())) +
                                       print_line("SIZES", names_of_entries(growth_families())) +
                                       print_line("SCENES", scene_names())) +
           function("_umbra_options", options) + function("_umbra_kind", kind_cases) +
           function("_umbra_positional", positionals);
}

/// A script to be sourced (bash), or sourced or put on $fpath as _umbra (zsh). It completes commands, options, methods
/// with their settings and choices, ladders, scenes and files, for `umbra` in any folder, and calls no program. `app` is
/// the whole command line (define_commands).
std::string completion_script(const CLI::App& app, const std::string& shell) {
    const bool bash = shell == "bash";
    return fmt::format("{}\n# Completion of umbra, printed by: umbra completion {}\n{}{}{}{}",
                       bash ? "# bash" : "#compdef umbra", shell, app_functions(app), method_functions(), kFunctions,
                       bash ? kBash : kZsh);
}

}  // namespace

Action completion_command(CLI::App& app, const Common& /*common*/) {
    const auto shell = std::make_shared<std::string>();
    app.add_option("SHELL", *shell, "bash or zsh")->type_name("")->required()->check(CLI::IsMember({"bash", "zsh"}));
    app.footer(
        "bash: source <(umbra completion bash), in ~/.bashrc to keep it.\n"
        "zsh: source <(umbra completion zsh) after compinit, in ~/.zshrc to keep it.");
    return [shell, &app] {
        print_out("{}", completion_script(*app.get_parent(), *shell));
        return kDone;
    };
}

}  // namespace umbra
