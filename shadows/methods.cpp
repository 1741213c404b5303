// The list of methods, and finding one by what is typed.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "umbra/core/base/error.h"
#include "umbra/core/base/suggest.h"
#include "umbra/shadows/method.h"

namespace umbra {

// Each is defined in its method's file.
#define METHOD(name) extern const MethodInfo name;
#include "umbra/shadows/methods.def"
#undef METHOD

namespace {

const std::vector<const MethodInfo*> kMethods = {
#define METHOD(name) &name,
#include "umbra/shadows/methods.def"
#undef METHOD
};

/// Sets "k=v,k=v". No name may come twice.
void apply(std::string_view list, Settings& settings) {
    std::set<std::string_view> seen;
    while (true) {
        const std::size_t comma = list.find(',');
        const auto pair         = list.substr(0, comma);
        const std::size_t eq    = pair.find('=');
        if (eq == std::string_view::npos)
            throw UsageError(fmt::format("\"{}\": expected name=value, or several with commas between", pair));
        const auto name = pair.substr(0, eq);
        settings.set(name, pair.substr(eq + 1));
        if (!seen.insert(name).second) throw UsageError(fmt::format("{} is set twice", name));
        if (comma == std::string_view::npos) return;
        list = list.substr(comma + 1);
    }
}

const Preset* find_preset(const MethodInfo& info, std::string_view name) {
    static constexpr Preset kDefault{"default", "", "All parameters at their defaults."};
    if (name == kDefault.name) return &kDefault;
    std::vector<std::string> known{std::string(kDefault.name)};
    for (const Preset& p : info.presets) {
        if (p.name == name) return &p;
        known.emplace_back(p.name);
    }
    throw UsageError(
        fmt::format("unknown preset \"{}\" (known: {}){}", name, fmt::join(known, ", "), did_you_mean(name, known)));
}

}  // namespace

Service verdict(const Method& method, const SceneFacts& facts) {
    Service service = method.serves(facts);
    if (service && facts.has_filters && !method.multiplies())
        return {How::not_at_all,
                "It knows lit and blocked alone, and here occluders let a part of the light through "
                "(\"transparent_occluders\": \"multiply\")."};
    return service;
}

std::string_view to_string(How how) {
    switch (how) {
        case How::not_at_all: return "not";
        case How::approximately: return "approximately";
        case How::to_rounding: return "to_rounding";
        case How::exactly: return "exactly";
    }
    return "";
}

std::span<const MethodInfo* const> methods() { return kMethods; }

const MethodInfo& find_method(std::string_view name) {
    std::vector<std::string> known;
    for (const MethodInfo* m : kMethods) {
        if (m->name == name) return *m;
        known.emplace_back(m->name);
    }
    throw UsageError(
        fmt::format("unknown method \"{}\" (known: {}){}", name, fmt::join(known, ", "), did_you_mean(name, known)));
}

std::unique_ptr<Method> MethodInfo::make(const Settings& settings) const {
    std::unique_ptr<Method> method = create();
    method->configure(settings);
    return method;
}

std::string MethodChoice::text() const {
    std::string text(info->name);
    char separator = ':';
    for (const Parameter& p : info->parameters) {
        if (settings.is_default(p.name)) continue;
        text += fmt::format("{}{}={}", separator, p.name, settings.text(p));
        separator = ',';
    }
    return text;
}

MethodChoice parse_method(std::string_view text) {
    const std::size_t colon = text.find(':');
    const auto head         = text.substr(0, colon);
    const std::size_t at    = head.find('@');
    MethodChoice choice(find_method(head.substr(0, at)));
    try {
        if (at != std::string_view::npos) {
            const Preset* preset = find_preset(*choice.info, head.substr(at + 1));
            if (!preset->settings.empty()) apply(preset->settings, choice.settings);
        }
        if (colon != std::string_view::npos) apply(text.substr(colon + 1), choice.settings);
    } catch (const UsageError& e) {
        throw UsageError(fmt::format("{}: {}", choice.info->name, e.what()));
    }
    return choice;
}

}  // namespace umbra
