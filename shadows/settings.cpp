// Parameters: parsing, ranges, canonical text.
#include "umbra/shadows/settings.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <stdexcept>

#include "umbra/core/base/error.h"

namespace umbra {
namespace {

bool read_number(std::string_view text, double& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

bool is_choice(std::string_view choices, std::string_view value) {
    while (true) {
        const std::size_t bar = choices.find('|');
        if (choices.substr(0, bar) == value) return true;
        if (bar == std::string_view::npos) return false;
        choices.remove_prefix(bar + 1);
    }
}

/// The value as it is kept: numbers in shortest form, so that 1, 1.0 and 1e0 are the same setting.
std::string canonical(const Parameter& p, std::string_view value) {
    double number = 0;
    switch (p.type) {
        case Parameter::Type::boolean:
            if (value == "true" || value == "false") return std::string(value);
            throw UsageError(fmt::format("{}={} is neither true nor false", p.name, value));
        case Parameter::Type::choice:
            if (is_choice(p.choices, value)) return std::string(value);
            throw UsageError(fmt::format("{}={} is no choice (known: {})", p.name, value, p.choices));
        case Parameter::Type::integer:
            if (!read_number(value, number) || number != std::floor(number))
                throw UsageError(fmt::format("{}={} is no whole number", p.name, value));
            break;
        case Parameter::Type::real:
            if (!read_number(value, number)) throw UsageError(fmt::format("{}={} is no finite number", p.name, value));
            break;
    }
    if (number < p.min || number > p.max)
        throw UsageError(fmt::format("{}={} is out of range ({} to {})", p.name, value, p.min, p.max));
    return fmt::format("{}", number);
}

}  // namespace

Settings::Settings(std::span<const Parameter> parameters) : parameters_(parameters) {
    for (const Parameter& p : parameters_) values_[std::string(p.name)] = canonical(p, p.fallback);
}

const Parameter& Settings::find(std::string_view name) const {
    std::string known;
    for (const Parameter& p : parameters_) {
        if (p.name == name) return p;
        known += fmt::format("{}{}", known.empty() ? "" : ", ", p.name);
    }
    throw UsageError(fmt::format("unknown setting \"{}\" (known: {})", name, known));
}

void Settings::set(std::string_view name, std::string_view value) {
    const Parameter& p           = find(name);
    values_[std::string(p.name)] = canonical(p, value);
}

int Settings::integer(std::string_view name) const { return static_cast<int>(std::lround(real(name))); }

double Settings::real(std::string_view name) const {
    double value = 0;
    if (!read_number(values_.at(std::string(name)), value)) throw std::logic_error("setting is no number");
    return value;
}

const std::string& Settings::choice(std::string_view name) const { return values_.at(std::string(name)); }
bool Settings::boolean(std::string_view name) const { return values_.at(std::string(name)) == "true"; }

bool Settings::is_default(std::string_view name) const {
    const Parameter& p = find(name);
    return values_.at(std::string(name)) == canonical(p, p.fallback);
}

}  // namespace umbra
