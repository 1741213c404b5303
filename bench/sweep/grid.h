// The settings of a sweep: what is typed with alternatives, and what a method is worth trying with.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/scene/facts.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// "METHOD[@PRESET][:k=a|b|c,l=d|e]": every combination, the last parameter fastest. Throws UsageError: what was found,
/// what is expected; also where there are more than `kMostSettings`.
inline constexpr std::size_t kMostSettings = 100000;
[[nodiscard]] std::vector<MethodChoice> expand_settings(std::string_view text);

/// The lines of a file of such texts; empty lines and what follows # are left out. Throws InputError naming the line.
[[nodiscard]] std::vector<MethodChoice> settings_in_file(const std::string& file);

/// The method's own sweep: its presets, and every combination of the values that its parameters propose.
[[nodiscard]] std::vector<MethodChoice> default_sweep(const MethodInfo& method);

/// A part of that, for an overview: the presets, and one line of settings along `line_of`.
[[nodiscard]] std::vector<MethodChoice> line_sweep(const MethodInfo& method);

/// The number that errors mostly depend on: the first parameter whose sweep is of numbers; null where there is none.
[[nodiscard]] const Parameter* line_of(const MethodInfo& method);

/// The first of those that are the same method with the same effect on a scene: parameters of area lights
/// (Parameter::area_lights) tell no two settings apart where there are none, and are at their defaults then.
[[nodiscard]] std::vector<MethodChoice> distinct(std::span<const MethodChoice> choices, const SceneFacts& facts);

/// The preset that has these settings, "default" among them; empty where none has.
[[nodiscard]] std::string_view preset_of(const MethodChoice& choice);

}  // namespace umbra
