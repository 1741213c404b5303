// Named, typed, documented, ranged parameters of a method, and a set of values for them.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace umbra {

/// One parameter: `fallback` is its default, as it would be typed.
struct Parameter {
    enum class Type : std::uint8_t { integer, real, choice, boolean };
    std::string_view name;
    Type type = Type::real;
    std::string_view fallback;
    std::string_view doc;  ///< one sentence, with the unit
    double min = 0;        ///< integer, real: closed range
    double max = 0;
    std::string_view choices{};  ///< choice: "a|b|c"
};

/// Values for all parameters of one method; those not given have their defaults. Values are checked when set.
class Settings {
public:
    explicit Settings(std::span<const Parameter> parameters);  ///< all defaults; `parameters` must outlive this

    /// Throws UsageError naming the parameter, what was found and what would be right.
    void set(std::string_view name, std::string_view value);

    [[nodiscard]] int integer(std::string_view name) const;
    [[nodiscard]] double real(std::string_view name) const;
    [[nodiscard]] const std::string& choice(std::string_view name) const;
    [[nodiscard]] bool boolean(std::string_view name) const;

    [[nodiscard]] std::span<const Parameter> parameters() const { return parameters_; }
    [[nodiscard]] const std::map<std::string, std::string>& values() const { return values_; }
    [[nodiscard]] bool is_default(std::string_view name) const;

private:
    const Parameter& find(std::string_view name) const;
    std::span<const Parameter> parameters_;
    std::map<std::string, std::string> values_;  ///< every parameter, canonical text
};

}  // namespace umbra
