#include "umbra/shadows/maps/depth_lookup.h"

#include <algorithm>
#include <cmath>

#include "umbra/shadows/maps/penumbra.h"

namespace umbra {
namespace {

/// Does the map show anything nearer than the receiver at sample (i, j)?
bool is_blocked(const MapView& view, const Receiver& p, int i, int j, BiasMode mode) {
    if (i < 0 || j < 0 || i >= view.map.width() || j >= view.map.height()) return false;
    const bool halfway  = view.midpoint && !view.midpoint->is_empty(i, j);
    const DepthMap& map = halfway ? *view.midpoint : view.map;
    double r            = p.r;
    if (mode != BiasMode::manual) {
        const double plane = p.r + p.r_x * (i + 0.5 - p.x) + p.r_y * (j + 0.5 - p.y);
        if (mode == BiasMode::receiver_plane)
            r = plane;
        else
            r = plane + (halfway ? p.snapping : std::min(std::max(0.0, p.r - plane) + p.slack, p.most));
    }
    return map.nearness(i, j) > std::max(r + p.bias, 0.0);  // behind all that casts, r is negative
}

}  // namespace

std::optional<Receiver> receive(const MapView& view, const Facet& facet, dvec3 p, const Bias& bias,
                                const Filter& filter) {
    const LightFrame& f = view.frame;
    dvec3 v             = f.light_space(p);
    const dvec3 n{glm::dot(f.x, facet.normal), glm::dot(f.y, facet.normal), glm::dot(f.z, facet.normal)};
    const auto ndc = [&](dvec3 q) { return (dvec2(q) / (f.perspective ? q.z : 1.0) - f.centre) / f.half; };
    if (f.perspective && v.z <= 0) return {};
    if (const dvec2 at = glm::abs(ndc(v)); at.x > f.reach || at.y > f.reach) return {};

    const dvec2 sample = 2.0 * f.half / dvec2(view.map.width(), view.map.height());   // in window units
    const double width = std::max(sample.x, sample.y) * (f.perspective ? v.z : 1.0);  // in world units
    if (bias.normal_offset > 0) {
        // A plane seen head-on needs no offset, a grazing one all of it.
        const double cosine = f.perspective ? glm::dot(n, v) / glm::length(v) : n.z;
        v += bias.normal_offset * width * std::sqrt(std::max(0.0, 1 - cosine * cosine)) * n;
        if (f.perspective && v.z <= 0) return {};
    }

    Receiver receiver;
    // Beyond the window and the widest kernel nothing is looked up, wherever it is; coordinates become ints later.
    const dvec2 at = glm::clamp(ndc(v), -4.0, 4.0);
    receiver.x     = (at.x + 1) * 0.5 * view.map.width();
    receiver.y     = (at.y + 1) * 0.5 * view.map.height();
    receiver.r     = f.nearness(v.z);

    // dot(n, v) = d is, with s = x/z and t = y/z, 1/z = (n.x s + n.y t + n.z) / d, and nearness is affine in 1/z.
    // Orthographic: z = (d - n.x x - n.y y) / n.z.
    const double scale =
        f.perspective ? f.near * f.far / ((f.far - f.near) * glm::dot(n, v)) : 1 / ((f.far - f.near) * n.z);
    receiver.r_x = std::isfinite(scale) ? scale * n.x * sample.x : 0;
    receiver.r_y = std::isfinite(scale) ? scale * n.y * sample.y : 0;

    const double per_width = width * f.nearness_per_depth(v.z);
    const double gradient  = std::max(std::abs(receiver.r_x), std::abs(receiver.r_y));
    const double snapping  = (std::abs(receiver.r_x) + std::abs(receiver.r_y)) / kSnapsPerSample;
    const double samples   = 2 * filter.radius + 1;
    receiver.bias          = bias.constant * per_width + bias.slope * gradient;
    if (bias.mode == BiasMode::manual) return receiver;
    const double largest = glm::length(p) + glm::length(f.origin) + std::abs(v.z);
    receiver.bias += view.map.quantum(receiver.r) + kPositionRounding * largest * f.nearness_per_depth(v.z);
    receiver.slack    = samples * (kAutoWidth * per_width + kAutoGradient * gradient) + snapping;
    receiver.most     = samples * kMostAutomatic * per_width;
    receiver.snapping = snapping;
    if (bias.mode == BiasMode::receiver_plane) receiver.bias += snapping;
    return receiver;
}

std::optional<FoundReceiver> receive(std::span<const MapView> views, const Facet& facet, dvec3 p, const Bias& bias,
                                     const Filter& filter) {
    for (std::size_t v = 0; v < views.size(); ++v)
        if (const auto receiver = receive(views[v], facet, p, bias, filter)) return FoundReceiver{v, *receiver};
    return {};
}

namespace {

/// The weight of the square's samples, all in the map, that are not blocked: is_blocked of each, with what the samples
/// of a column and of a row have alike computed once.
double lit_in_square(const MapView& view, const Receiver& p, BiasMode mode, const SquareKernel& square) {
    double across[SquareKernel::kMostInRow], nearest[SquareKernel::kMostInRow], counts[SquareKernel::kMostInRow];
    for (int k = 0; k < square.side; ++k) across[k] = p.r + p.r_x * (square.x + k + 0.5 - p.x);
    double lit = 0;
    for (int j = 0; j < square.side; ++j) {
        const double down = p.r_y * (square.y + j + 0.5 - p.y);
        for (int k = 0; k < square.side; ++k) nearest[k] = view.map.nearness(square.x + k, square.y + j);
        for (int k = 0; k < square.side; ++k) {
            const double plane = across[k] + down, above = p.r - plane;
            const double eased = (above > 0 ? above : 0.0) + p.slack;
            const double by    = mode == BiasMode::automatic ? (p.most < eased ? p.most : eased) : 0.0;
            const double r     = (mode == BiasMode::manual ? p.r : plane + by) + p.bias;
            counts[k]          = nearest[k] > (r > 0 ? r : 0.0) ? 0 : square.across[k] * square.down[j];
        }
        for (int k = 0; k < square.side; ++k) lit += counts[k];
    }
    return lit;
}

}  // namespace

float lit_share(const MapView& view, const Receiver& p, BiasMode mode, const Filter& filter) {
    if (filter.is_one_sample())
        return is_blocked(view, p, static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)), mode) ? 0.0f
                                                                                                               : 1.0f;
    if (filter.kernel != Kernel::disc && filter.radius <= SquareKernel::kMostRadius && !view.midpoint) {
        const SquareKernel square = square_kernel({p.x, p.y}, filter);
        if (square.x >= 0 && square.y >= 0 && square.x + square.side <= view.map.width() &&
            square.y + square.side <= view.map.height())
            return static_cast<float>(std::clamp(lit_in_square(view, p, mode, square) / square.whole, 0.0, 1.0));
    }
    double lit         = 0;
    const double whole = for_each_sample({p.x, p.y}, p.turn, filter, [&](int i, int j, double weight) {
        if (!is_blocked(view, p, i, j, mode)) lit += weight;
    });
    return static_cast<float>(std::clamp(lit / whole, 0.0, 1.0));
}

float soft_share(const MapView& view, const Receiver& receiver, double depth, BiasMode mode, const SoftFilter& filter) {
    const auto reach   = [&](double z) { return penumbra_reach(view, dvec2(filter.size), z, depth, filter.texels); };
    const auto blocked = [&](dvec2 within, dvec2 point, ivec2& at) {
        const dvec2 offset = within * turned(point, receiver.turn);
        at = {static_cast<int>(std::floor(receiver.x + offset.x)), static_cast<int>(std::floor(receiver.y + offset.y))};
        return is_blocked(view, receiver, at.x, at.y, mode);
    };
    const dvec2 search = reach(view.frame.near);
    double sum         = 0;
    int blockers       = 0;
    ivec2 at{0};
    for (const dvec2 point : filter.points) {
        if (!blocked(search, point, at)) continue;
        sum += view.frame.depth(view.map.nearness(at.x, at.y));
        ++blockers;
    }
    if (blockers == 0) return 1;
    const dvec2 penumbra = reach(sum / blockers);
    int lit              = 0;
    for (const dvec2 point : filter.points) lit += blocked(penumbra, point, at) ? 0 : 1;
    return static_cast<float>(lit) / static_cast<float>(filter.points.size());
}

std::optional<ivec2> blocked_sample(const MapView& view, const Receiver& p, BiasMode mode, const Filter& filter) {
    std::optional<ivec2> nearest;
    double least = std::numeric_limits<double>::infinity();
    for_each_sample({p.x, p.y}, p.turn, filter, [&](int i, int j, double) {
        const double distance = std::hypot(i + 0.5 - p.x, j + 0.5 - p.y);
        if (distance < least && is_blocked(view, p, i, j, mode)) least = distance, nearest = ivec2(i, j);
    });
    return nearest;
}

}  // namespace umbra
