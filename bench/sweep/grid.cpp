#include "umbra/bench/sweep/grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "umbra/core/base/error.h"
#include "umbra/core/base/trimmed.h"

namespace umbra {
namespace {

/// One parameter and the values that it takes.
struct Axis {
    std::string_view name;
    std::vector<std::string_view> values;
};

std::vector<MethodChoice> combinations(const MethodChoice& base, const std::vector<Axis>& axes) {
    std::size_t count = 1;
    for (const Axis& axis : axes) {
        count *= axis.values.size();
        if (count > kMostSettings)
            throw UsageError(
                fmt::format("{}: more than {} combinations, expected fewer", base.info->name, kMostSettings));
    }
    std::vector<MethodChoice> all{base};
    for (const Axis& axis : axes) {
        std::vector<MethodChoice> next;
        for (const MethodChoice& choice : all)
            for (const std::string_view value : axis.values) {
                next.push_back(choice);
                next.back().settings.set(axis.name, value);
            }
        all = std::move(next);
    }
    return all;
}

/// The default settings and all presets.
std::vector<MethodChoice> presets_of(const MethodInfo& method) {
    std::vector<MethodChoice> all{MethodChoice(method)};
    for (const Preset& preset : method.presets)
        all.push_back(parse_method(fmt::format("{}@{}", method.name, preset.name)));
    return all;
}

/// Settings may contradict one another, as a filter wider than its map.
bool can_be_made(const MethodChoice& choice) {
    try {
        static_cast<void>(choice.make());
    } catch (const UsageError&) {
        return false;
    }
    return true;
}

}  // namespace

std::vector<MethodChoice> expand_settings(std::string_view text) {
    const std::size_t colon = text.find(':');
    const MethodChoice base = parse_method(text.substr(0, colon));
    if (colon == std::string_view::npos) return {base};
    std::vector<Axis> axes;
    for (const std::string_view pair : split(text.substr(colon + 1), ',')) {
        const std::size_t eq = pair.find('=');
        if (eq == std::string_view::npos)
            throw UsageError(fmt::format("{}: \"{}\": expected name=value, or name=value|value, with commas between",
                                         base.info->name, pair));
        axes.push_back({pair.substr(0, eq), split(pair.substr(eq + 1), '|')});
        for (std::size_t k = 0; k + 1 < axes.size(); ++k)
            if (axes[k].name == axes.back().name)
                throw UsageError(fmt::format("{}: {} is set twice", base.info->name, axes.back().name));
    }
    try {
        std::vector<MethodChoice> all = combinations(base, axes);
        for (const MethodChoice& choice : all) static_cast<void>(choice.make());
        return all;
    } catch (const UsageError& e) {
        const std::string message = e.what();
        throw UsageError(message.starts_with(base.info->name) ? message
                                                              : fmt::format("{}: {}", base.info->name, message));
    }
}

std::vector<MethodChoice> settings_in_file(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw InputError(fmt::format("{}: cannot be opened, expected a file of METHOD:k=a|b lines", file));
    std::vector<MethodChoice> all;
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        line.resize(std::min(line.find('#'), line.size()));
        const std::string_view setting = trimmed(line);
        if (setting.empty()) continue;
        try {
            for (MethodChoice& choice : expand_settings(setting)) all.push_back(std::move(choice));
        } catch (const UsageError& e) {
            throw InputError(fmt::format("{}:{}: {}", file, number, e.what()));
        }
    }
    if (all.empty()) throw InputError(fmt::format("{}: holds no setting, expected METHOD:k=a|b, one a line", file));
    return all;
}

const Parameter* line_of(const MethodInfo& method) {
    for (const Parameter& p : method.parameters)
        if (!p.sweep.empty() && (p.type == Parameter::Type::integer || p.type == Parameter::Type::real)) return &p;
    return nullptr;
}

std::vector<MethodChoice> line_sweep(const MethodInfo& method) {
    std::vector<MethodChoice> all = presets_of(method);
    if (const Parameter* line = line_of(method))
        for (MethodChoice& choice : combinations(MethodChoice(method), {{line->name, split(line->sweep, '|')}}))
            if (can_be_made(choice)) all.push_back(std::move(choice));
    return all;
}

std::vector<MethodChoice> default_sweep(const MethodInfo& method) {
    std::vector<MethodChoice> all = presets_of(method);
    std::vector<Axis> axes;
    for (const Parameter& p : method.parameters)
        if (!p.sweep.empty()) axes.push_back({p.name, split(p.sweep, '|')});
    for (MethodChoice& choice : combinations(MethodChoice(method), axes))
        if (can_be_made(choice)) all.push_back(std::move(choice));
    return all;
}

std::vector<MethodChoice> distinct(std::span<const MethodChoice> choices, const SceneFacts& facts) {
    std::vector<MethodChoice> kept;
    for (MethodChoice choice : choices) {
        if (facts.hard_lights_only)
            for (const Parameter& p : choice.settings.parameters())
                if (p.area_lights) choice.settings.set(p.name, p.fallback);
        const bool seen = std::ranges::any_of(kept, [&](const MethodChoice& other) {
            return other.info == choice.info && other.settings == choice.settings;
        });
        if (!seen) kept.push_back(std::move(choice));
    }
    return kept;
}

std::string_view preset_of(const MethodChoice& choice) {
    if (choice.settings == Settings(choice.info->parameters)) return "default";
    for (const Preset& preset : choice.info->presets)
        if (parse_method(fmt::format("{}@{}", choice.info->name, preset.name)).settings == choice.settings)
            return preset.name;
    return {};
}

}  // namespace umbra
