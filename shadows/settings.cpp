// Parameters: parsing, ranges, canonical text.
#include "umbra/shadows/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/core/base/number_from.h"
#include "umbra/core/base/suggest.h"
#include "umbra/core/base/trimmed.h"

namespace umbra {
namespace {

std::optional<double> finite(std::string_view text) {
    const auto value = number_from<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

}  // namespace

std::string_view to_string(Phase phase) {
    constexpr std::string_view kNames[]{"build", "aim", "look", "visibility"};
    return kNames[static_cast<std::size_t>(phase)];
}

std::string_view to_string(Parameter::Type type) {
    constexpr std::string_view kNames[]{"integer", "real", "choice", "boolean", "text"};
    return kNames[static_cast<std::size_t>(type)];
}

std::string Parameter::text(double value) const {
    if (type == Type::boolean) return value != 0 ? "true" : "false";
    if (type == Type::choice) return std::string(split(choices, '|').at(static_cast<std::size_t>(value)));
    return fmt::format("{}", value);
}

double Parameter::parse(std::string_view given) const {
    std::optional<double> number;
    switch (type) {
        case Type::boolean:
            if (given == "true") return 1;
            if (given == "false") return 0;
            throw UsageError(fmt::format("{}={}: expected true or false", name, given));
        case Type::choice: {
            const auto words = split(choices, '|');
            const auto found = std::ranges::find(words, given);
            if (found != words.end()) return static_cast<double>(found - words.begin());
            throw UsageError(fmt::format("{}={}: expected one of {}", name, given, choices));
        }
        case Type::integer:
            number = finite(given);
            if (!number || *number != std::floor(*number))
                throw UsageError(fmt::format("{}={}: expected an integer", name, given));
            break;
        case Type::real:
            number = finite(given);
            if (!number) throw UsageError(fmt::format("{}={}: expected a finite number", name, given));
            break;
        case Type::text: return 0;
    }
    if (*number < min || *number > max)
        throw UsageError(fmt::format("{}={}: expected {} to {}", name, given, min, max));
    return *number;
}

Settings::Settings(std::span<const Parameter> parameters) : parameters_(parameters) {
    for (const Parameter& p : parameters_) values_.push_back(p.fallback), texts_.emplace_back(p.fallback_text);
}

std::size_t Settings::index(std::string_view name) const {
    const Parameter& found = entry_named("unknown setting", name, parameters_, &Parameter::name);
    return static_cast<std::size_t>(&found - parameters_.data());
}

void Settings::set(std::string_view name, std::string_view value) {
    const std::size_t k = index(name);
    values_[k]          = parameters_[k].parse(value);
    if (parameters_[k].type == Parameter::Type::text) texts_[k] = value;
}

void Settings::set(std::string_view name, double value) {
    const std::size_t k  = index(name);
    const Parameter& p   = parameters_[k];
    const bool is_number = p.type == Parameter::Type::integer || p.type == Parameter::Type::real;
    values_[k]           = p.parse(is_number ? fmt::format("{}", value) : p.text(value));
}

double Settings::value(std::string_view name) const { return values_[index(name)]; }

std::string Settings::text(const Parameter& p) const {
    const std::size_t k = index(p.name);
    return p.type == Parameter::Type::text ? texts_[k] : p.text(values_[k]);
}

bool Settings::is_default(std::string_view name) const {
    const std::size_t k = index(name);
    return values_[k] == parameters_[k].fallback && texts_[k] == parameters_[k].fallback_text;
}

Phase first_changed_phase(const Settings& from, const Settings& to) {
    Phase first = Phase::visibility;
    for (const Parameter& p : from.parameters())
        if (from.value(p.name) != to.value(p.name) || from.text(p) != to.text(p)) first = std::min(first, p.phase);
    return first;
}

}  // namespace umbra
