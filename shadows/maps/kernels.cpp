#include "umbra/shadows/maps/kernels.h"

#include <bit>

#include "umbra/core/base/random_bits.h"

namespace umbra {
namespace {

dvec2 turn_by(double turns) { return {std::cos(2 * kPi * turns), std::sin(2 * kPi * turns)}; }

}  // namespace

std::vector<dvec2> even_disk(int n) {
    constexpr double kGoldenAngle = 2.399963229728653;
    std::vector<dvec2> points;
    for (int k = 0; k < n; ++k) {
        const double radius = std::sqrt((k + 0.5) / n), angle = k * kGoldenAngle;
        points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return points;
}

dvec2 noise_turn(double x, double y) {
    const auto bits = [](double v) { return std::bit_cast<std::uint32_t>(static_cast<float>(v)); };
    return turn_by(static_cast<double>(mixed_bits(std::uint64_t{bits(x)} << 32 | bits(y))) * 0x1p-64);
}

dvec2 gradient_turn(double x, double y) {
    const auto fraction = [](double v) { return v - std::floor(v); };
    return turn_by(fraction(52.9829189 * fraction(0.06711056 * x + 0.00583715 * y)));
}

}  // namespace umbra
