#include "umbra/core/errors/visibility_error.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace umbra {
namespace {

/// Adds one point that both planes define to the count that its class means. `dark`: S is below the reference.
void count_wrong(ErrorClass c, bool dark, std::uint64_t& level, VisibilityError& e) {
    const auto interior = [&](VisibilityError::Kind& kind, std::uint64_t& cause) {
        ++kind.interior;
        ++cause;
        ++level;
    };
    const auto either_way = [&](VisibilityError::Direction& cause) {
        if (dark)
            interior(e.false_shadow, cause.false_shadow);
        else
            interior(e.false_light, cause.false_light);
    };
    std::uint64_t other = 0;
    switch (c) {
        case ErrorClass::terminator: ++e.terminator.normal_away; break;
        case ErrorClass::terminator_wrong: ++e.terminator.normal_away, ++e.terminator.wrong; break;
        case ErrorClass::false_shadow_edge: ++e.false_shadow.edge; break;
        case ErrorClass::false_shadow: interior(e.false_shadow, other); break;
        case ErrorClass::acne: interior(e.false_shadow, e.acne); break;
        case ErrorClass::false_light_edge: ++e.false_light.edge; break;
        case ErrorClass::false_light: interior(e.false_light, e.unnamed); break;
        case ErrorClass::detachment: interior(e.false_light, e.detachment); break;
        case ErrorClass::leak: interior(e.false_light, e.leak); break;
        case ErrorClass::penumbra: either_way(e.penumbra_error); break;
        case ErrorClass::noise: either_way(e.noise_error); break;
        default: break;
    }
}

}  // namespace

VisibilityError count_errors(const PointBatch& points, const ClassPlane& classes, const VisibilityPlane& s,
                             const VisibilityPlane& reference) {
    if (classes.size() != points.size() || s.s.size() != points.size() || reference.s.size() != points.size())
        throw std::logic_error("visibility error: a plane is not of the batch's size");
    VisibilityError e;
    double absolute = 0, squared = 0, difference = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        switch (classes[i]) {
            case ErrorClass::no_surface: continue;
            case ErrorClass::away: ++e.away; continue;
            case ErrorClass::terminator_away: ++e.away, ++e.terminator.facet_away; continue;
            case ErrorClass::unshadowed: ++e.unshadowed; continue;
            case ErrorClass::not_judged: ++e.not_judged; continue;
            case ErrorClass::undefined: ++e.undefined; continue;
            case ErrorClass::on_boundary: ++e.on_boundary; continue;
            default: break;
        }
        ++e.points;
        const float r = reference.s[i];
        const auto at = [&](auto& levels) -> std::uint64_t& {
            return is_penumbra(r) ? levels.penumbra : r < kFullOrNone ? levels.umbra : levels.lit;
        };
        ++at(e);
        count_wrong(classes[i], s.s[i] < r, at(e.interior), e);

        const double d = static_cast<double>(s.s[i]) - static_cast<double>(r);
        absolute += std::abs(d);
        squared += d * d;
        difference += d;
        e.max            = std::max(e.max, std::abs(d));
        e.max_half_width = std::max(e.max_half_width, static_cast<double>(reference.half_width[i]));
    }
    if (e.points > 0) {
        const auto n = static_cast<double>(e.points);
        e.mae        = absolute / n;
        e.rmse       = std::sqrt(squared / n);
        e.bias       = difference / n;
    }
    return e;
}

VisibilityError visibility_error(const PointBatch& points, LightId light, const VisibilityPlane& s,
                                 const VisibilityPlane& reference, float tolerance,
                                 std::span<const std::uint8_t> judged) {
    return count_errors(points, error_classes(points, light, s, reference, tolerance, judged), s, reference);
}

}  // namespace umbra
