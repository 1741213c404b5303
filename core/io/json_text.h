// JSON values with their offsets in the file, so that a message about any of them can point there. Internal to core.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "umbra/core/base/math.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/io/source_text.h"
#include "umbra/core/scene/names.h"

namespace umbra {

struct JsonValue;
struct JsonMember;
using JsonArray  = std::vector<JsonValue>;
using JsonObject = std::vector<JsonMember>;  ///< in the order of the file

struct JsonValue {
    std::size_t offset = 0;  ///< of its first character
    std::variant<std::nullptr_t, bool, double, std::string, JsonArray, JsonObject> data;
};
struct JsonMember {
    std::size_t offset = 0;  ///< of its key
    std::string key;
    JsonValue value;
};

/// A file that was parsed, and checked access to its values. Every member throws InputError with line and column.
class JsonText {
public:
    explicit JsonText(SourceText source);

    [[nodiscard]] const JsonValue& root() const { return root_; }
    [[nodiscard]] const SourceText& source() const { return source_; }
    [[noreturn]] void fail(const JsonValue& at, std::string_view message) const { source_.fail(at.offset, message); }

    /// `what` is the name of the value in messages: "WHAT is FOUND, expected EXPECTED".
    [[noreturn]] void wrong_type(const JsonValue& v, std::string_view what, std::string_view expected) const;
    [[nodiscard]] const JsonObject& object(const JsonValue& v, std::string_view what) const;
    [[nodiscard]] const JsonArray& array(const JsonValue& v, std::string_view what, std::string_view expected) const;
    [[nodiscard]] const std::string& string(const JsonValue& v, std::string_view what) const;
    [[nodiscard]] bool boolean(const JsonValue& v, std::string_view what) const;
    [[nodiscard]] double number(const JsonValue& v, std::string_view what, const Range& range) const;
    [[nodiscard]] int integer(const JsonValue& v, std::string_view what, int min, int max) const;
    [[nodiscard]] dvec3 vector(const JsonValue& v, std::string_view what, const Range& range) const;  ///< [x, y, z]
    /// Index into `choices`.
    [[nodiscard]] std::size_t choice(const JsonValue& v, std::string_view what,
                                     const std::vector<std::string_view>& choices) const;
    /// The value of an enum by its name (scene/names.h).
    template <class Enum>
    [[nodiscard]] Enum choice(const JsonValue& v, std::string_view what,
                              const std::vector<Enum>& choices = values_of<Enum>()) const {
        std::vector<std::string_view> names;
        for (const Enum choice : choices) names.push_back(name_of(choice));
        return choices[choice(v, what, names)];
    }
    /// "unknown WHAT "FOUND" (did you mean ...? known: ...)"
    [[noreturn]] void unknown(std::size_t offset, std::string_view what, std::string_view found,
                              const std::vector<std::string_view>& known) const;

private:
    SourceText source_;
    JsonValue root_;
};

/// The members of one object by name. Refuses keys that are not known as soon as it is made; "note" always is.
class JsonFields {
public:
    JsonFields(const JsonText& text, const JsonValue& value, std::string_view what,
               const std::vector<std::string_view>& known);

    [[nodiscard]] const JsonValue* find(std::string_view key) const;     ///< null where it is not given
    [[nodiscard]] const JsonValue& require(std::string_view key) const;  ///< throws where it is not given
    [[nodiscard]] const JsonValue& value() const { return value_; }

    // The value of a key, or `fallback`.
    [[nodiscard]] double number(std::string_view key, const Range& range, double fallback) const;
    [[nodiscard]] int integer(std::string_view key, int min, int max, int fallback) const;
    [[nodiscard]] bool boolean(std::string_view key, bool fallback) const;
    [[nodiscard]] std::string string(std::string_view key, std::string_view fallback) const;

    /// Fails where both are given: they say the same thing in two ways.
    void exclude(std::string_view key, std::string_view other) const;

private:
    const JsonText& text_;
    const JsonValue& value_;
    const JsonObject& members_;
    std::string what_;
};

}  // namespace umbra
