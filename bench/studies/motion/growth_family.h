// Families of generated scenes in which one size grows and all else stays: what `umbra growth` measures over.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/lab/prepare.h"
#include "umbra/shadows/method.h"

namespace umbra {

struct GrowthFamily {
    std::string_view name;                   ///< as typed: "triangles"
    std::string_view title;                  ///< "Triangles of one body"
    std::string_view about;                  ///< one or two sentences: what grows, and what stays
    std::string_view unit;                   ///< of x
    double least, most;                      ///< of x where nobody says otherwise
    double limit;                            ///< beyond which no --max goes
    double factor;                           ///< from one x to the next
    Scene (*scene)(double x);                ///< with lights, camera and picture size; the same bits each time
    double (*size)(const Scene&, double x);  ///< the x that the scene has: what was asked for, or the nearest it can be
    /// Names of the parameters of methods that are set to x, of which a method has at most one; empty: the scene grows.
    std::vector<std::string_view> parameters{};

    /// The family's x up to `most`: `least` times powers of `factor`.
    [[nodiscard]] std::vector<double> sizes(double up_to) const;
    /// The choice at x; nothing for a method without the parameter that grows.
    [[nodiscard]] std::vector<MethodChoice> at(const MethodChoice& choice, double x) const;
};

[[nodiscard]] std::span<const GrowthFamily> growth_families();
/// Throws UsageError, naming the families that there are.
[[nodiscard]] const GrowthFamily& find_growth_family(const std::string& name);

/// Its scene at x, made ready for methods.
[[nodiscard]] PreparedScene prepare_growth(const GrowthFamily& family, double x);

}  // namespace umbra
