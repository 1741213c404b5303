// What growth the algorithms should have: exponents of power laws, with the reason.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "umbra/bench/base/statistics.h"

namespace umbra {

/// What is fitted: two phases, what the frame after a camera, a light, an object that moved repeats, and the memory.
enum class Quantity : std::uint8_t { build, aim, camera_frame, light_frame, object_frame, memory };
inline constexpr std::array kQuantities{Quantity::build,       Quantity::aim,          Quantity::camera_frame,
                                        Quantity::light_frame, Quantity::object_frame, Quantity::memory};
[[nodiscard]] std::string_view to_string(Quantity quantity);

/// The exponent lies in this interval for large sizes. A logarithm counts as an exponent of up to 0.15: between 1e3 and
/// 1e6, log x grows like x^0.1, x log x like x^1.1.
struct Theory {
    Interval exponent;
    std::string_view why;
};
/// Of a phase or the memory; nothing where nothing is claimed, as for the frames, which are sums.
[[nodiscard]] std::optional<Theory> growth_theory(std::string_view family, std::string_view method, Quantity quantity);

/// An interval of exponents that is wider decides nothing where it meets theory's.
inline constexpr double kDecisive = 0.5;
/// "agrees", or where the fitted interval lies: "below", "above"; "undecided" where it meets theory's but is too wide.
[[nodiscard]] std::string_view compare_with_theory(const Interval& fitted, const Theory& theory);

}  // namespace umbra
