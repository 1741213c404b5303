// Checked access to the members of a glTF document's objects. Internal to core.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/io/json_text.h"

namespace umbra {

inline constexpr double kMaxWhole = 9007199254740992.0;  ///< 2^53: beyond it JSON's numbers skip some

/// The member of an object by its name; null where there is none (or `object` is not an object).
[[nodiscard]] const JsonValue* find_member(const JsonValue& object, std::string_view key);
/// The elements of a top-level list, or an empty one.
[[nodiscard]] const JsonArray& list_of(const JsonText& json, const JsonValue& object, std::string_view key);
/// An index into a list of `size` things.
[[nodiscard]] std::size_t index_into(const JsonText& json, const JsonValue& v, std::string_view what, std::size_t size);
/// A whole number from `min` to `max` <= 2^53.
[[nodiscard]] std::uint64_t whole(const JsonText& json, const JsonValue& v, std::string_view what, double min,
                                  double max);

// The value of a member, or `fallback` where the object is null or lacks it.
[[nodiscard]] double number_or(const JsonText& json, const JsonValue* object, std::string_view key, const Range& range,
                               double fallback);
[[nodiscard]] dvec3 vector_or(const JsonText& json, const JsonValue* object, std::string_view key, const Range& range,
                              dvec3 fallback);
/// The object in "scenes" that the file shows: "scene", or the first; null where there are no scenes.
[[nodiscard]] const JsonValue* shown_scene(const JsonText& json);

/// A list of exactly `n` numbers.
[[nodiscard]] std::vector<double> numbers(const JsonText& json, const JsonValue& v, std::string_view what,
                                          std::size_t n, const Range& range);
/// The object extensions.NAME, or null.
[[nodiscard]] const JsonValue* extension(const JsonText& json, const JsonValue& object, std::string_view name);
/// The member "name", at most 200 bytes of it; `fallback` where it is missing or empty.
[[nodiscard]] std::string name_or(const JsonText& json, const JsonValue& object, std::string_view fallback);

}  // namespace umbra
