// Options that several commands have, each with one name, one form and one meaning; and what commands do alike around
// their work: progress, the record or the text.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/cli/terminal.h"
#include "umbra/bench/lab/budget.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/core/base/parallel.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// Checks that an option's value is a finite number in [low, high]; `expected` says so in words.
[[nodiscard]] CLI::Validator number_in(double low, double high, const std::string& expected);

/// A number from `low` to `high`, called `unit` in the help, which shows `value` as the default.
template <class Number>
void add_number(CLI::App& app, const std::string& name, Number& value, const std::string& about,
                std::type_identity_t<Number> low, std::type_identity_t<Number> high, const std::string& unit = "N") {
    const char* kind = std::is_integral_v<Number> ? "an integer" : "a number";
    app.add_option(name, value, about)
        ->check(number_in(static_cast<double>(low), static_cast<double>(high),
                          fmt::format("{} from {} to {}", kind, low, high)))
        ->capture_default_str()
        ->type_name(unit);
}

/// SCENE, one or several.
CLI::Option* add_scene(CLI::App& app, std::string& scene);
CLI::Option* add_scenes(CLI::App& app, std::vector<std::string>& scenes,
                        const std::string& about = "Scenes: files or names of scenes (required)");

/// --size WIDTHxHEIGHT.
void add_size(CLI::App& app, Size& size, const std::string& by_default = "the scene's");

/// --pixel-samples N, kPictureSamples where it is not given.
void add_pixel_samples(CLI::App& app, int& samples, const std::string& about);

/// --methods METHOD..., for which --method may be typed too.
void add_methods(CLI::App& app, std::vector<std::string>& methods,
                 const std::string& about = "Methods, with settings (default: all)");

/// --method METHOD, for which --methods may be typed too.
void add_method(CLI::App& app, std::string& method, const std::string& about);

/// --answers NAME=FILE, several times: adds each as a method (add_answers) and its choice to `choices`.
void add_answer_files(CLI::App& app, std::vector<MethodChoice>& choices);

/// The method of S_j in a command that is about something else.
struct ShadowMethod {
    std::string text = "ray_traced";
    bool none        = false;

    /// Nothing: every light reaches every point that faces it. Throws UsageError.
    [[nodiscard]] std::optional<MethodChoice> choice() const;
};
/// --method METHOD or none, and --no-shadows.
void add_shadow_method(CLI::App& app, ShadowMethod& method);

/// --reference METHOD, refused where there is no such method, and --reference-points N.
void add_reference(CLI::App& app, std::optional<std::string>& reference, std::optional<std::uint64_t>& points,
                   const std::string& by_default = "as for compare");

/// --budget S and --memory-budget MIB.
void add_budget(CLI::App& app, Budget& budget);

/// -o DIR, which is required, and --json.
void add_output(CLI::App& app, std::filesystem::path& out, const std::string& about = "Folder to write to");
void add_json(CLI::App& app, bool& as_json, const std::string& instead_of = "the table");

/// work(progress), with its progress on the terminal. Returns what `work` returns.
template <class Work>
auto on_terminal(const Common& common, const Work& work) {
    const Terminal terminal(common.quiet);
    return work([&](const std::string& what) { terminal.progress(what); });
}

/// work() with `options` that know the command line and the number of threads, and put progress and warnings on the
/// terminal, as far as they have members for that. Returns what `work` returns.
template <class Options, class Work>
auto on_terminal(const Common& common, Options& options, const Work& work) {
    const Terminal terminal(common.quiet);
    if constexpr (requires { options.command; }) options.command = common.command;
    if constexpr (requires { options.threads; }) options.threads = thread_count();
    if constexpr (requires { options.progress; })
        options.progress = [&](const std::string& what) { terminal.progress(what); };
    if constexpr (requires { options.warn; }) options.warn = [&](const std::string& what) { terminal.warn(what); };
    return work();
}

/// Prints texts of JSON as one: one of them as it is, several as a list.
void print_records(const std::vector<std::string>& texts);

/// The record where it is asked for, otherwise text(), which is not called where --quiet leaves it out.
template <class Text>
void print_record(bool as_json, const Common& common, const Json& record, const Text& text) {
    if (as_json)
        print_out("{}", json_text(record));
    else if (!common.quiet)
        print_out("{}", without_controls(text()));
}

}  // namespace umbra
