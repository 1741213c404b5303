#include "umbra/bench/cli/options.h"
#include "umbra/bench/contenders/contender.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "umbra/bench/lab/antialias.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/number_from.h"

namespace umbra {
namespace {

/// A value that is checked while the line is parsed; one that is empty is refused with all others.
template <class Take>
std::function<void(const std::string&)> checked_value(const Take& take) {
    return [take](const std::string& text) {
        try {
            if (!text.empty()) take(text);
        } catch (const UsageError& e) {
            throw CLI::ValidationError(e.what());
        }
    };
}

/// Checks that it is a number of samples a pixel: a square from 1 to 64.
CLI::Validator pixel_samples() {
    const auto check = [](const std::string& text) -> std::string {
        try {
            static_cast<void>(samples_along_side(number_from<int>(text).value_or(0)));
        } catch (const UsageError&) {
            return fmt::format("\"{}\" is not 1, 4, 9, 16, 25, 36, 49 or 64", text);
        }
        return "";
    };
    return {check, "", "samples"};
}

}  // namespace

CLI::Validator number_in(double low, double high, const std::string& expected) {
    const auto check = [low, high, expected](const std::string& text) -> std::string {
        const auto value = number_from<double>(text);
        if (value && std::isfinite(*value) && *value >= low && *value <= high) return "";
        return fmt::format("\"{}\" is not {}", text, expected);
    };
    return {check, "", "number"};
}

CLI::Option* add_scene(CLI::App& app, std::string& scene) {
    return app.add_option("SCENE", scene, "Scene: a file or a scene's name")->type_name("");
}

CLI::Option* add_scenes(CLI::App& app, std::vector<std::string>& scenes, const std::string& about) {
    return app.add_option("SCENE", scenes, about)->type_name("");
}

void add_size(CLI::App& app, Size& size, const std::string& by_default) {
    app.add_option_function<std::string>("--size",
                                         checked_value([&size](const std::string& t) { size = parse_size(t); }),
                                         fmt::format("Size of the pictures (default: {})", by_default))
        ->type_name("WIDTHxHEIGHT");
}

void add_pixel_samples(CLI::App& app, int& samples, const std::string& about) {
    samples = kPictureSamples;
    app.add_option("--pixel-samples", samples, about)->check(pixel_samples())->capture_default_str()->type_name("N");
}

void add_methods(CLI::App& app, std::vector<std::string>& methods, const std::string& about) {
    app.add_option("--methods", methods, about)->type_name("METHOD");
    app.add_option("--method", methods, about)->type_name("METHOD")->group("");  // not in the help
}

void add_answer_files(CLI::App& app, std::vector<MethodChoice>& choices) {
    app.add_option_function<std::vector<std::string>>(
           "--answers",
           [&choices](const std::vector<std::string>& files) {
               for (const std::string& file : files) choices.push_back(add_answers(file));
           },
           "S_j that was made elsewhere, as a method of that name (.npy, .exr; FILE:measure=irradiance); may be repeated")
        ->type_name("NAME=FILE")
        ->allow_extra_args(false)
        ->take_all();
}

void add_method(CLI::App& app, std::string& method, const std::string& about) {
    app.add_option("--method", method, about)->capture_default_str()->type_name("METHOD");
    app.add_option("--methods", method, about)->type_name("METHOD")->group("");
}

std::optional<MethodChoice> ShadowMethod::choice() const {
    if (none || text == "none") return std::nullopt;
    return parse_method(text);
}

void add_shadow_method(CLI::App& app, ShadowMethod& method) {
    add_method(app, method.text, "Method of the shadows, with settings; none: as --no-shadows");
    app.add_flag("--no-shadows", method.none, "Every light reaches every point that faces it");
}

void add_reference(CLI::App& app, std::optional<std::string>& reference, std::optional<std::uint64_t>& points,
                   const std::string& by_default) {
    const auto take = [&reference](const std::string& text) {
        static_cast<void>(parse_method(text).make());
        reference = text;
    };
    app.add_option_function<std::string>("--reference", checked_value(take),
                                         fmt::format("Reference method (default: {})", by_default))
        ->type_name("METHOD");
    app.add_option("--reference-points", points,
                   "Score area lights at about N stratified points (default: all points, if affordable)")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 30))
        ->type_name("N");
}

void add_budget(CLI::App& app, Budget& budget) {
    const CLI::Validator amount = number_in(1e-6, 1e9, "a number from 0.000001 to 1000000000");
    app.add_option("--budget", budget.seconds,
                   "Seconds that a method may take on a scene; then it is cut short where it can be, and has failed" +
                       (std::isfinite(budget.seconds) ? fmt::format(" (default: {:g})", budget.seconds) : ""))
        ->check(amount)
        ->type_name("S");
    app.add_option_function<double>(
           "--memory-budget", [&budget](double mib) { budget.bytes = mib * (1 << 20); },
           "MiB that a method's values may hold on a scene, likewise")
        ->check(amount)
        ->type_name("MIB");
}

void add_output(CLI::App& app, std::filesystem::path& out, const std::string& about) {
    app.add_option("-o,--output", out, about)->type_name("DIR")->required();
}

void print_records(const std::vector<std::string>& texts) {
    if (texts.size() == 1)
        print_out("{}", texts[0]);
    else
        print_out("[\n{}]\n", fmt::join(texts, ",\n"));
}

void add_json(CLI::App& app, bool& as_json, const std::string& instead_of) {
    app.add_flag("--json", as_json, fmt::format("Print results.json instead of {}", instead_of));
}

}  // namespace umbra
