// The list of methods, and finding one by name.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "umbra/core/base/error.h"
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

}  // namespace

std::string_view to_string(How how) {
    switch (how) {
        case How::not_at_all: return "not";
        case How::approximately: return "approximately";
        case How::exactly: return "exactly";
    }
    return "";
}

std::span<const MethodInfo* const> methods() { return kMethods; }

const MethodInfo& find_method(std::string_view name) {
    std::vector<std::string_view> known;
    for (const MethodInfo* m : kMethods) {
        if (m->name == name) return *m;
        known.push_back(m->name);
    }
    throw UsageError(fmt::format("unknown method \"{}\" (known: {})", name, fmt::join(known, ", ")));
}

std::string MethodChoice::text() const {
    std::string text(info->name);
    char separator = ':';
    for (const Parameter& p : info->parameters) {
        if (settings.is_default(p.name)) continue;
        text += fmt::format("{}{}={}", separator, p.name, settings.values().at(std::string(p.name)));
        separator = ',';
    }
    return text;
}

MethodChoice parse_method(std::string_view text) {
    const std::size_t colon = text.find(':');
    const MethodInfo& info  = find_method(text.substr(0, colon));
    MethodChoice choice{&info, Settings(info.parameters)};
    if (colon == std::string_view::npos) return choice;
    std::string_view rest = text.substr(colon + 1);
    while (true) {
        const std::size_t comma = rest.find(',');
        const auto pair         = rest.substr(0, comma);
        const std::size_t eq    = pair.find('=');
        if (eq == std::string_view::npos)
            throw UsageError(
                fmt::format("{}: \"{}\" is no setting (write {}:name=value,name=value)", text, pair, info.name));
        try {
            choice.settings.set(pair.substr(0, eq), pair.substr(eq + 1));
        } catch (const UsageError& e) {
            throw UsageError(fmt::format("{}: {}", info.name, e.what()));
        }
        if (comma == std::string_view::npos) return choice;
        rest = rest.substr(comma + 1);
    }
}

}  // namespace umbra
