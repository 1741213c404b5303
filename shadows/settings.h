// Parameters of a method: each is a member of its options struct with a name, a range, a unit and the first phase to
// repeat when it changes. Text is parsed once, when a setting is typed; methods read their struct.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace umbra {

/// The phases of a method, in order: what an object that moved makes it repeat (all), a light (aim, visibility), the
/// camera (look, visibility). shadows/method.h says what each one makes.
enum class Phase : std::uint8_t { build, aim, look, visibility };
[[nodiscard]] std::string_view to_string(Phase phase);  ///< "build", "aim", "look", "visibility"

/// One parameter. Made by `parameter<&Options::member>`. Values of all types but text are kept as double: integers as
/// they are, booleans as 0 and 1, choices as the index into `choices`, which is the value of the member's enumerator.
struct Parameter {
    enum class Type : std::uint8_t { integer, real, choice, boolean, text };

    std::string_view name{};
    std::string_view doc{};            ///< one sentence
    std::string_view unit{};           ///< of a number: "texels", "rays a point"; empty for a pure number
    Phase phase = Phase::visibility;   ///< the first phase to repeat when it changes
    double min = 0, max = 0;           ///< integer, real: closed range
    std::string_view choices{};        ///< choice: "a|b|c", in the order of the enumerators from 0
    std::string_view sweep{};          ///< "16|64|256": values that are worth comparing; empty: leave it at its default
    bool area_lights = false;          ///< it changes nothing where no light has an area
    Type type        = Type::real;     ///< from the member
    double fallback  = 0;              ///< the default: the member's initializer
    std::string_view fallback_text{};  ///< text: the same
    void (*store)(double value, void* options)                  = nullptr;  ///< writes the member
    void (*store_text)(const std::string& value, void* options) = nullptr;  ///< of a text, in its place

    /// The value as it is typed: numbers in shortest form. `parse` throws UsageError: what was found, what is expected.
    [[nodiscard]] std::string text(double value) const;
    [[nodiscard]] double parse(std::string_view text) const;
};
[[nodiscard]] std::string_view to_string(Parameter::Type type);  ///< "integer", "real", "choice", "boolean",
                                                                 ///< "text"

namespace settings_detail {
template <class T>
struct MemberOf;
template <class Class, class Value>
struct MemberOf<Value Class::*> {
    using Options = Class;
    using Type    = Value;
};
}  // namespace settings_detail

/// The parameter that sets `member`, a pointer to an int, a double, a bool, an enumeration or a std::string of an
/// options struct whose default constructor gives the defaults. `about` has the unit, the phase, the range or the
/// choices; of a text the default, too. A text has no commas when it is typed. `Options` is a template argument so that
/// a struct of an unnamed namespace makes the function local to its file: GCC 12 derives linkage from types alone, and
/// `parameter<&Options::x>` of two files would become one function.
template <auto member, class Options = typename settings_detail::MemberOf<decltype(member)>::Options>
[[nodiscard]] Parameter parameter(std::string_view name, std::string_view doc, Parameter about = {}) {
    about.name = name, about.doc = doc;
    using Type = typename settings_detail::MemberOf<decltype(member)>::Type;
    static_assert(std::is_same_v<Type, int> || std::is_same_v<Type, double> || std::is_same_v<Type, bool> ||
                  std::is_enum_v<Type> || std::is_same_v<Type, std::string>);
    if constexpr (std::is_same_v<Type, std::string>) {
        about.type       = Parameter::Type::text;
        about.store_text = [](const std::string& value, void* options) {
            static_cast<Options*>(options)->*member = value;
        };
        return about;
    } else {
        about.type     = std::is_same_v<Type, bool>  ? Parameter::Type::boolean
                         : std::is_same_v<Type, int> ? Parameter::Type::integer
                         : std::is_enum_v<Type>      ? Parameter::Type::choice
                                                     : Parameter::Type::real;
        about.fallback = static_cast<double>(Options{}.*member);
        about.store    = [](double value, void* options) {
            static_cast<Options*>(options)->*member = static_cast<Type>(value);
        };
        return about;
    }
}

/// Values for all parameters of one method; those not set have their defaults. Values are checked when set.
class Settings {
public:
    explicit Settings(std::span<const Parameter> parameters);  ///< all defaults; `parameters` must outlive this

    /// Throws UsageError naming the parameter, the value that was found and the expected one.
    void set(std::string_view name, std::string_view value);
    void set(std::string_view name, double value);  ///< for a choice the index; throws as above

    /// Throws UsageError where there is no such parameter; 0 of a text.
    [[nodiscard]] double value(std::string_view name) const;
    [[nodiscard]] std::string text(const Parameter& p) const;  ///< as it is typed; `p` is one of parameters()
    [[nodiscard]] bool is_default(std::string_view name) const;
    [[nodiscard]] std::span<const Parameter> parameters() const { return parameters_; }
    [[nodiscard]] bool operator==(const Settings& other) const {
        return values_ == other.values_ && texts_ == other.texts_;
    }

    /// The method's own struct with every value in its member. `Options` is the struct the parameters were made for.
    template <class Options>
    [[nodiscard]] Options as() const {
        Options options;
        for (std::size_t k = 0; k < parameters_.size(); ++k)
            if (parameters_[k].type == Parameter::Type::text)
                parameters_[k].store_text(texts_[k], &options);
            else
                parameters_[k].store(values_[k], &options);
        return options;
    }

private:
    [[nodiscard]] std::size_t index(std::string_view name) const;
    std::span<const Parameter> parameters_;
    std::vector<double> values_;      ///< one a parameter
    std::vector<std::string> texts_;  ///< one a parameter, empty where it is not a text
};

/// The first phase to repeat when `from` becomes `to`, which are settings of one method; Phase::visibility where they
/// are equal.
[[nodiscard]] Phase first_changed_phase(const Settings& from, const Settings& to);

}  // namespace umbra
