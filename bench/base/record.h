// A record is a struct whose members are named once: that one list writes it, reads it and describes it (JSON Schema).
//
//     struct Timing {
//         double median = kUnknown;
//         std::uint64_t runs = 0;
//         std::vector<double> samples;
//     };
//     DESCRIBE(Timing) {
//         of.name("timing", "milliseconds");
//         of(MEMBER(median), "of all runs but the cold one");
//         MEMBERS(runs);
//         of.may(MEMBER(samples), "in the order of the rounds");
//     }
//
// MEMBER is a member and its name as the key; a key that is no name in C++ stands as of("class", &R::member), where R is
// the record. MEMBERS are members without words. of(...) is always written; of.must(...) must also be there when it is
// read, and not be empty; of.may(...) is written where it holds something, of.where(&R::flag, ...) where the flag is
// set; of.all(&R::part) writes the members of a part as if they were the record's own.
//
// Types of members, and what JSON has for them:
//
//     double               a number; null where it is not finite, and then NaN is read
//     bool, integers, std::string, Json (anything)
//     Scalar               true, false, a number or a text
//     FileName             a text
//     std::optional<T>     null where there is none
//     std::vector<T>       an array
//     Members<T>           an object with keys of its own, in their order
//     a record             an object
//
// What JSON lacks, or has as null, is read as T{}: records of earlier versions have fewer members. A member of the wrong
// type throws InputError with the file and the position as a JSON pointer.
#pragma once

#include <fmt/format.h>

#include <boost/preprocessor/seq/for_each.hpp>
#include <boost/preprocessor/variadic/to_seq.hpp>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "umbra/bench/base/field.h"

namespace umbra {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
/// Nothing where the value is not known, or infinite, which JSON cannot tell from that.
[[nodiscard]] inline std::optional<double> known(double value) {
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

[[nodiscard]] std::string text_of(const Scalar& value);  ///< a text as it is, the others as JSON writes them

/// A file that a record names, relative to the record's folder, and its place in the file that it was read from, for
/// errors.
struct FileName {
    std::string name{};
    Field at{};
    [[nodiscard]] explicit operator bool() const { return !name.empty(); }
};

/// An object whose keys are data: names of lights, of parameters.
template <class T>
struct Members : std::vector<std::pair<std::string, T>> {
    using std::vector<std::pair<std::string, T>>::vector;
    /// Null where there is none.
    [[nodiscard]] const T* find(std::string_view key) const {
        for (const auto& [name, value] : *this)
            if (name == key) return &value;
        return nullptr;
    }
    T& operator()(std::string_view key) {
        for (auto& [name, value] : *this)
            if (name == key) return value;
        return this->emplace_back(key, T{}).second;
    }
};

/// Selects `describe` of a type.
template <class T>
struct Is {};

#define DESCRIBE(T)                      \
    template <class Fields, class R = T> \
    void describe(Fields& of, Is<T>)
#define MEMBER(member) #member, &R::member
#define MEMBERS(...) \
    BOOST_PP_SEQ_FOR_EACH(UMBRA_PLAIN_MEMBER, , BOOST_PP_VARIADIC_TO_SEQ(__VA_ARGS__)) static_assert(true)
#define UMBRA_PLAIN_MEMBER(repetition, data, member) of(MEMBER(member));

/// What a member may hold, beyond its type; anything by default. Of Members it says what each may hold.
struct Allowed {
    std::vector<std::string_view> words{};  ///< one of these
    std::optional<double> least{}, most{};
    std::optional<bool> only{};          ///< of true and false
    std::optional<std::size_t> items{};  ///< so many
};
[[nodiscard]] inline Allowed only(bool value) { return {.only = value}; }
inline const Allowed kTwoNumbers{.items = 2}, kThreeNumbers{.items = 3}, kFraction{.least = 0, .most = 1};
[[nodiscard]] inline Allowed at_least(double least) { return {.least = least}; }
[[nodiscard]] inline Allowed one_of(std::initializer_list<std::string_view> words) { return {.words = words}; }

namespace record_parts {

enum class Kind { plain, may, where, must };  ///< of a member: as called

/// What a description calls, but for `all`, which Self has: each leads to `Self::take`.
template <class Self>
class Fields {
public:
    void name(std::string_view, std::string_view = {}) {}
    template <class M>
    void operator()(std::string_view key, M member, std::string_view about = {}, const Allowed& allowed = {}) {
        self().take(Kind::plain, key, member, about, allowed);
    }
    template <class M>
    void may(std::string_view key, M member, std::string_view about = {}, const Allowed& allowed = {}) {
        self().take(Kind::may, key, member, about, allowed);
    }
    template <class M>
    void must(std::string_view key, M member, std::string_view about = {}, const Allowed& allowed = {}) {
        self().take(Kind::must, key, member, about, allowed);
    }
    template <class F, class M>
    void where(F flag, std::string_view key, M member, std::string_view about = {}, const Allowed& allowed = {}) {
        if (self().is_set(flag, key)) self().take(Kind::where, key, member, about, allowed);
    }
    /// Whether a member that depends on a flag is taken.
    template <class F>
    bool is_set(F, std::string_view) {
        return true;
    }

private:
    Self& self() { return static_cast<Self&>(*this); }
};

struct Nothing {};

/// Whether a type has a description.
template <class T>
concept Record = requires(Nothing& of) {
    describe(of, Is<T>{});
};

/// Whether a type is one of a template.
template <class T, template <class...> class Template>
inline constexpr bool is_a = false;
template <template <class...> class Template, class... Of>
inline constexpr bool is_a<Template<Of...>, Template> = true;

template <class T>
bool is_nothing(const T& value) {
    if constexpr (is_a<T, std::optional>)
        return !value.has_value();
    else if constexpr (is_a<T, std::vector> || is_a<T, Members> || std::is_same_v<T, std::string>)
        return value.empty();
    else if constexpr (std::is_same_v<T, FileName>)
        return value.name.empty();
    else if constexpr (std::is_same_v<T, Json>)
        return value.is_null();
    else if constexpr (std::is_floating_point_v<T>)
        return std::isnan(value);
    else if constexpr (std::is_arithmetic_v<T>)
        return value == T{};
    else
        return false;
}

template <class T>
Json write(const T& value);

/// Writes the members of a record.
template <class T>
class Writer : public Fields<Writer<T>> {
public:
    Writer(const T& record, Json& json) : record_(record), json_(json) {}
    template <class V, class C>
    void take(Kind kind, std::string_view key, V C::*member, std::string_view, const Allowed&) {
        if (kind != Kind::may || !is_nothing(record_.*member)) json_[std::string(key)] = write(record_.*member);
    }
    template <class C>
    bool is_set(bool C::*flag, std::string_view) {
        return record_.*flag;
    }
    template <class V, class C>
    void all(V C::*member) {
        Writer<V> writer(record_.*member, json_);
        describe(writer, Is<V>{});
    }

private:
    const T& record_;
    Json& json_;
};

template <class T>
Json write(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
        return number(value);
    } else if constexpr (std::is_same_v<T, FileName>) {
        return value.name;
    } else if constexpr (std::is_same_v<T, Scalar>) {
        return std::visit([](const auto& v) { return write(v); }, value);
    } else if constexpr (is_a<T, std::optional>) {
        return value ? write(*value) : Json();
    } else if constexpr (is_a<T, std::vector>) {
        Json all = Json::array();
        for (const auto& each : value) all.push_back(write<typename T::value_type>(each));
        return all;
    } else if constexpr (is_a<T, Members>) {
        Json all = Json::object();
        for (const auto& [key, each] : value) all[key] = write(each);
        return all;
    } else if constexpr (Record<T>) {
        Json json = Json::object();
        Writer<T> writer(value, json);
        describe(writer, Is<T>{});
        return json;
    } else {
        return Json(value);
    }
}

template <class T>
void read(const Field& field, T& value);

void refuse_unless(const Allowed& allowed, const Field& field);

/// Reads the members of a record.
template <class T>
class Reader : public Fields<Reader<T>> {
public:
    Reader(const Field& field, T& record) : field_(field), record_(record) {}
    template <class V, class C>
    void take(Kind kind, std::string_view key, V C::*member, std::string_view, const Allowed& allowed) {
        const Field field = field_[key];
        if constexpr (is_a<V, Members>)
            for (const auto& [name, item] : field.members()) refuse_unless(allowed, item);
        else
            refuse_unless(allowed, field);
        read(field, record_.*member);
        if (kind != Kind::must) return;
        constexpr bool is_text = std::is_same_v<V, std::string>;
        if (!field.present() || (is_text && is_nothing(record_.*member)))
            field.refuse(is_text ? "a non-empty string" : "a value");
    }
    template <class C>
    bool is_set(bool C::*flag, std::string_view key) {
        if (field_.has(key)) record_.*flag = true;
        return true;
    }
    template <class V, class C>
    void all(V C::*member) {
        Reader<V> reader(field_, record_.*member);
        describe(reader, Is<V>{});
    }

private:
    const Field& field_;
    T& record_;
};

template <class T>
void read(const Field& field, T& value) {
    if (!field.present()) {
        if constexpr (std::is_floating_point_v<T>)
            value = kUnknown;
        else
            value = T{};
        return;
    }
    if constexpr (std::is_same_v<T, Json>) {
        value = field.json();
    } else if constexpr (std::is_same_v<T, std::string>) {
        value = field.text();
    } else if constexpr (std::is_same_v<T, FileName>) {
        value = {field.text(), field};
    } else if constexpr (std::is_same_v<T, bool>) {
        value = field.flag();
    } else if constexpr (std::is_same_v<T, Scalar>) {
        value = field.scalar_value();
    } else if constexpr (std::is_floating_point_v<T>) {
        value = T(*field.number());
    } else if constexpr (std::is_integral_v<T>) {
        const double number = *field.number();
        if (number != std::floor(number) || number < double(std::numeric_limits<T>::lowest()) ||
            number > double(std::numeric_limits<T>::max()))
            field.refuse(std::is_unsigned_v<T> ? "a whole number, 0 or more" : "a whole number");
        value = T(number);
    } else if constexpr (is_a<T, std::optional>) {
        read(field, value.emplace());
    } else if constexpr (is_a<T, std::vector>) {
        value.clear();
        for (const Field& item : field.items()) {
            typename T::value_type each{};
            read(item, each);
            value.push_back(std::move(each));
        }
    } else if constexpr (is_a<T, Members>) {
        value.clear();
        for (const auto& [key, item] : field.members())
            read(item, value.emplace_back(key, typename T::value_type::second_type{}).second);
    } else {
        static_assert(Record<T>, "a member of a record has a type of the list above");
        if (!field.is_object()) field.refuse("an object");
        Reader<T> reader(field, value);
        describe(reader, Is<T>{});
    }
}

/// Refuses the first member of an object that is none of `known`.
void require_members_among(const Field& field, const std::vector<std::string>& known);

template <class T>
void refuse_unknown(const Field& field);

/// Gathers the names of the members of a record, and looks into those that are there.
template <class T>
class Knower : public Fields<Knower<T>> {
public:
    explicit Knower(const Field& field) : field_(field) {}
    template <class V, class C>
    void take(Kind, std::string_view key, V C::*, std::string_view, const Allowed&) {
        known.emplace_back(key);
        refuse_unknown<V>(field_[key]);
    }
    template <class V, class C>
    void all(V C::*) {
        Knower<V> part(field_);
        describe(part, Is<V>{});
        known.insert(known.end(), part.known.begin(), part.known.end());
    }
    std::vector<std::string> known;

private:
    const Field& field_;
};

/// What has the wrong type is left to `read`.
template <class T>
void refuse_unknown(const Field& field) {
    if constexpr (is_a<T, std::optional>) {
        refuse_unknown<typename T::value_type>(field);
    } else if constexpr (is_a<T, std::vector>) {
        if (field.is_array())
            for (const Field& item : field.items()) refuse_unknown<typename T::value_type>(item);
    } else if constexpr (is_a<T, Members>) {
        if (field.is_object())
            for (const auto& [key, item] : field.members()) refuse_unknown<typename T::value_type::second_type>(item);
    } else if constexpr (Record<T>) {
        if (!field.is_object()) return;
        Knower<T> knower(field);
        describe(knower, Is<T>{});
        require_members_among(field, knower.known);
    }
}

/// The definitions of a schema: of each record that has a name, once.
struct Definitions {
    Json named = Json::object();
    std::set<std::string, std::less<>> begun;
};

template <class T>
Json schema(Definitions& definitions);

/// Gathers the schema of a record.
template <class T>
class Describer : public Fields<Describer<T>> {
public:
    Describer(Json& json, Definitions& definitions) : json_(json), definitions_(definitions) {}
    void name(std::string_view name, std::string_view about = {}) {
        name_ = name;
        if (!about.empty()) json_["description"] = about;
    }
    template <class V, class C>
    void take(Kind kind, std::string_view key, V C::*, std::string_view about, const Allowed& allowed) {
        if (kind == Kind::plain || kind == Kind::must) json_["required"].push_back(key);
        Json& whole = json_["properties"][std::string(key)] = schema<V>(definitions_);
        if (!about.empty()) whole["description"] = about;
        Json& property = is_a<V, Members> ? whole["additionalProperties"] : whole;
        for (const std::string_view word : allowed.words) property["enum"].push_back(word);
        if (!allowed.words.empty() && is_a<V, std::optional>) property["enum"].push_back(nullptr);
        if (allowed.least) property["minimum"] = *allowed.least;
        if (allowed.most) property["maximum"] = *allowed.most;
        if (allowed.only) property["enum"] = Json::array({*allowed.only});
        if (allowed.items) property["minItems"] = property["maxItems"] = *allowed.items;
        if (kind == Kind::must && std::is_same_v<V, std::string>) whole["minLength"] = 1;
    }
    template <class V, class C>
    void all(V C::*) {
        Describer<V> part(json_, definitions_);
        describe(part, Is<V>{});
    }
    [[nodiscard]] const std::string& given_name() const { return name_; }

private:
    Json& json_;
    Definitions& definitions_;
    std::string name_;
};

[[nodiscard]] Json or_null(Json schema);

template <class T>
Json schema(Definitions& definitions) {
    if constexpr (std::is_same_v<T, Json>) {
        return Json::object();
    } else if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, FileName>) {
        return {{"type", "string"}};
    } else if constexpr (std::is_same_v<T, bool>) {
        return {{"type", "boolean"}};
    } else if constexpr (std::is_same_v<T, Scalar>) {
        return {{"type", {"boolean", "number", "string", "null"}}};
    } else if constexpr (std::is_floating_point_v<T>) {
        return {{"type", {"number", "null"}}};
    } else if constexpr (std::is_integral_v<T>) {
        Json json = {{"type", "integer"}};
        if (std::is_unsigned_v<T>) json["minimum"] = 0;
        return json;
    } else if constexpr (is_a<T, std::optional>) {
        return or_null(schema<typename T::value_type>(definitions));
    } else if constexpr (is_a<T, std::vector>) {
        return {{"type", "array"}, {"items", schema<typename T::value_type>(definitions)}};
    } else if constexpr (is_a<T, Members>) {
        return {{"type", "object"}, {"additionalProperties", schema<typename T::value_type::second_type>(definitions)}};
    } else {
        static_assert(Record<T>, "a member of a record has a type of the list above");
        Json json = {{"type", "object"}, {"required", Json::array()}, {"properties", Json::object()}};
        Describer<T> describer(json, definitions);
        describe(describer, Is<T>{});
        json["additionalProperties"] = false;
        if (json["required"].empty()) json.erase("required");
        if (describer.given_name().empty()) return json;
        if (definitions.begun.insert(describer.given_name()).second) definitions.named[describer.given_name()] = json;
        return {{"$ref", "#/definitions/" + describer.given_name()}};
    }
}

/// The root of a schema out of its parts.
[[nodiscard]] Json rooted(std::string_view title, Json root, Definitions definitions);

}  // namespace record_parts

/// The record as JSON, its members in the order of its description.
template <class T>
[[nodiscard]] Json to_record(const T& value) {
    return record_parts::write(value);
}

/// Throws InputError: "FILE:/POINTER: found WHAT, expected WHAT".
template <class T>
[[nodiscard]] T from_record(const Field& field) {
    T value{};
    record_parts::read(field, value);
    return value;
}

/// As from_record, for files that people write: a member that the description lacks is refused, as mistyped.
template <class T>
[[nodiscard]] T from_strict_record(const Field& field) {
    record_parts::refuse_unknown<T>(field);
    return from_record<T>(field);
}

/// JSON Schema, draft 4, of records of this type.
template <class T>
[[nodiscard]] Json schema_of(std::string_view title) {
    record_parts::Definitions definitions;
    Json root = record_parts::schema<T>(definitions);
    return record_parts::rooted(title, std::move(root), std::move(definitions));
}

}  // namespace umbra
