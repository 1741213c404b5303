#include "umbra/core/scene/photometry.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/scene/names.h"

namespace umbra {
namespace {

constexpr double kWhole = 360, kHalf = 180, kQuarter = 90;  // degrees

/// Two neighbours in a list of angles, and how far between them an angle lies, [0, 1].
struct Between {
    std::size_t low = 0, high = 0;
    double t = 0;
};

/// `angle` is not beyond the list's ends, except for rounding.
Between between(const std::vector<float>& angles, double angle) {
    const auto above = std::upper_bound(angles.begin(), angles.end(), angle,
                                        [](double a, float listed) { return a < static_cast<double>(listed); });
    const auto high  = std::min(static_cast<std::size_t>(above - angles.begin()), angles.size() - 1);
    const auto low   = high > 0 ? high - 1 : 0;
    if (low == high) return {low, high, 0};
    const double a = angles[low], b = angles[high];
    return {low, high, std::clamp((angle - a) / (b - a), 0.0, 1.0)};
}

/// The horizontal angle that the table has in the place of `angle`, by its symmetry.
double folded(const Photometry& table, double angle) {
    if (table.type != PhotometricType::C) return table.horizontal.front() < 0 ? angle : std::abs(angle);
    const double first = table.horizontal.front(), last = table.horizontal.back();
    double h = std::fmod(angle, kWhole);
    if (h < 0) h += kWhole;
    if (first > 0) {  // from 90 to 270: symmetric about the plane through both
        if (h < kQuarter) return kHalf - h;
        return h > kWhole - kQuarter ? kWhole + kHalf - h : h;
    }
    if (last <= kHalf && h > kHalf) h = kWhole - h;
    if (last <= kQuarter && h > kQuarter) h = kHalf - h;
    return h;
}

std::string fault_of_angles(const std::vector<float>& angles, std::string_view what, double min, double max) {
    if (angles.empty()) return fmt::format("there are no {} angles, expected at least one", what);
    for (std::size_t k = 0; k < angles.size(); ++k) {
        if (!(angles[k] >= min && angles[k] <= max))
            return fmt::format("a {} angle of {:g} degrees, expected {:g} to {:g}", what, angles[k], min, max);
        if (k > 0 && !(angles[k] > angles[k - 1]))
            return fmt::format("the {} angle {:g} follows {:g}, expected increasing angles", what, angles[k],
                               angles[k - 1]);
    }
    return "";
}

std::string fault_of_symmetry(const Photometry& table) {
    const double first = table.horizontal.front(), last = table.horizontal.back();
    if (table.type != PhotometricType::C) {
        if (last == kQuarter && (first == 0 || first == -kQuarter)) return "";
        return fmt::format(
            "the horizontal angles go from {:g} to {:g} degrees, expected 0 to 90 or -90 to 90 of type {}", first, last,
            name_of(table.type));
    }
    if (first == 0 && (last == 0 || last == kQuarter || last == kHalf || last == kWhole)) return "";
    if (first == kQuarter && last == kWhole - kQuarter) return "";
    return fmt::format(
        "the horizontal angles go from {:g} to {:g} degrees, expected 0 alone, 0 to 90, 0 to 180, 0 to 360 or 90 to "
        "270 of type C",
        first, last);
}

/// The intensity in direction of a latitude and a meridian of the table: where the meridians meet is the axis of its
/// type.
double on_meridian(const Photometry& table, std::size_t meridian, std::size_t latitude) {
    const bool about_along     = table.type == PhotometricType::B;
    const std::size_t vertical = about_along ? meridian : latitude;
    return table.candela[(about_along ? latitude : meridian) * table.vertical.size() + vertical];
}

/// The integral along one meridian, of a function that is linear in the angle g from the pole, times sin g.
double along_meridian(const Photometry& table, std::size_t meridian) {
    const bool from_pole               = table.type == PhotometricType::C;
    const std::vector<float>& latitude = table.type == PhotometricType::B ? table.horizontal : table.vertical;
    double sum                         = 0;
    for (std::size_t k = 1; k < latitude.size(); ++k) {
        const auto angle = [&](std::size_t i) {
            return glm::radians(static_cast<double>(latitude[i]) + (from_pole ? 0 : kQuarter));
        };
        const double a = angle(k - 1), b = angle(k);
        const double at_a = on_meridian(table, meridian, k - 1), at_b = on_meridian(table, meridian, k);
        sum += at_a * std::cos(a) - at_b * std::cos(b) + (at_b - at_a) / (b - a) * (std::sin(b) - std::sin(a));
    }
    return sum;
}

}  // namespace

std::string fault_of(const Photometry& table) {
    const bool from_pole = table.type == PhotometricType::C;
    std::string fault =
        fault_of_angles(table.vertical, "vertical", from_pole ? 0 : -kQuarter, from_pole ? kHalf : kQuarter);
    if (fault.empty())
        fault =
            fault_of_angles(table.horizontal, "horizontal", from_pole ? 0 : -kQuarter, from_pole ? kWhole : kQuarter);
    if (fault.empty()) fault = fault_of_symmetry(table);
    if (fault.empty() && !from_pole && table.vertical.front() == 0)
        fault = fmt::format("the vertical angles begin at 0 degrees, expected negative ones, too, of type {}",
                            name_of(table.type));
    if (!fault.empty()) return fault;
    if (table.candela.size() != table.vertical.size() * table.horizontal.size())
        return fmt::format("{} intensities at {} vertical and {} horizontal angles, expected {}", table.candela.size(),
                           table.vertical.size(), table.horizontal.size(),
                           table.vertical.size() * table.horizontal.size());
    for (const float value : table.candela)
        if (!(value >= 0 && std::isfinite(value)))
            return fmt::format("an intensity of {:g}, expected a finite number that is at least 0", value);
    return "";
}

double intensity_at(const Photometry& table, double vertical, double horizontal) {
    if (vertical < static_cast<double>(table.vertical.front()) || vertical > static_cast<double>(table.vertical.back()))
        return 0;
    const Between v  = between(table.vertical, vertical);
    const Between h  = between(table.horizontal, folded(table, horizontal));
    const auto plane = [&](std::size_t index) {
        const float* const values = &table.candela[index * table.vertical.size()];
        return (1 - v.t) * static_cast<double>(values[v.low]) + v.t * static_cast<double>(values[v.high]);
    };
    return (1 - h.t) * plane(h.low) + h.t * plane(h.high);
}

double intensity_towards(const Photometry& table, dvec3 direction, dvec3 along, dvec3 to) {
    const dvec3 f        = glm::normalize(direction);
    const dvec3 s        = glm::normalize(along - glm::dot(along, f) * f);
    const dvec3 u        = glm::cross(s, f);
    const dvec3 d        = glm::normalize(to);
    const double forward = glm::dot(d, f), sideways = glm::dot(d, s), upwards = glm::dot(d, u);
    const auto degrees = [](double y, double x) { return glm::degrees(std::atan2(y, x)); };
    if (table.type == PhotometricType::C)
        return intensity_at(table, degrees(std::hypot(sideways, upwards), forward), degrees(upwards, sideways));
    if (forward < 0) return 0;
    if (table.type == PhotometricType::B)
        return intensity_at(table, degrees(upwards, forward), degrees(sideways, std::hypot(forward, upwards)));
    return intensity_at(table, degrees(upwards, std::hypot(forward, sideways)), degrees(sideways, forward));
}

double flux(const Photometry& table) {
    const bool about_along              = table.type == PhotometricType::B;
    const std::vector<float>& meridians = about_along ? table.vertical : table.horizontal;
    if (meridians.size() == 1 && table.type == PhotometricType::C) return 2 * kPi * along_meridian(table, 0);
    double sum = 0;
    for (std::size_t k = 1; k < meridians.size(); ++k) {
        const double step = glm::radians(static_cast<double>(meridians[k]) - static_cast<double>(meridians[k - 1]));
        sum += step * (along_meridian(table, k - 1) + along_meridian(table, k)) / 2;
    }
    const double covered = static_cast<double>(table.horizontal.back()) - static_cast<double>(table.horizontal.front());
    return sum * (table.type == PhotometricType::C ? kWhole : kHalf) / covered;
}

float peak(const Photometry& table) { return *std::max_element(table.candela.begin(), table.candela.end()); }

}  // namespace umbra
