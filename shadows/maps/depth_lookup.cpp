#include "umbra/shadows/maps/depth_lookup.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace umbra {
namespace {

// The automatic bias of a nearest sample; a kernel of n by n samples, whose outermost lie n times as far off, has n
// times as much.
constexpr double kAutoWidth    = 1;     // widths of a sample: what a hollow that turns by 45 degrees rises at its rim
constexpr double kAutoGradient = 0.25;  // depth gradients a sample: enough for nearly all points of scanned meshes

/// Positions and their distances from the light are rounded to this share of the coordinates and the distance.
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();

/// Does the map show anything nearer than the receiver at sample (i, j)?
bool is_blocked(const DepthMap& map, const Receiver& p, int i, int j, BiasMode mode) {
    if (i < 0 || j < 0 || i >= map.width() || j >= map.height()) return false;
    double r = p.r;
    if (mode != BiasMode::manual) {
        const double plane = p.r + p.r_x * (i + 0.5 - p.x) + p.r_y * (j + 0.5 - p.y);
        r = mode == BiasMode::automatic ? plane + std::min(std::max(0.0, p.r - plane) + p.slack, p.most) : plane;
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
    const double snapping  = (std::abs(receiver.r_x) + std::abs(receiver.r_y)) / DepthMap::kSnap;
    const double samples   = 2 * filter.radius + 1;
    receiver.bias          = bias.constant * per_width + bias.slope * gradient;
    if (bias.mode == BiasMode::manual) return receiver;
    const double largest = glm::length(p) + glm::length(f.origin) + std::abs(v.z);
    receiver.bias += view.map.quantum(receiver.r) + kRounding * largest * f.nearness_per_depth(v.z);
    receiver.slack = samples * (kAutoWidth * per_width + kAutoGradient * gradient) + snapping;
    receiver.most  = samples * kMostAutomatic * per_width;
    if (bias.mode == BiasMode::receiver_plane) receiver.bias += snapping;
    return receiver;
}

float lit_share(const DepthMap& map, const Receiver& p, BiasMode mode, const Filter& filter) {
    const int radius = filter.radius;
    if (!filter.bilinear) {
        const int x = static_cast<int>(std::floor(p.x));
        const int y = static_cast<int>(std::floor(p.y));
        if (radius == 0) return is_blocked(map, p, x, y, mode) ? 0.0f : 1.0f;
        int lit = 0;
        for (int j = -radius; j <= radius; ++j)
            for (int i = -radius; i <= radius; ++i) lit += !is_blocked(map, p, x + i, y + j, mode);
        return static_cast<float>(lit) / static_cast<float>((2 * radius + 1) * (2 * radius + 1));
    }
    // A box of 2 radius + 1 samples that moves with the point: its border samples count by how much of them it covers.
    const int x     = static_cast<int>(std::floor(p.x - 0.5));
    const int y     = static_cast<int>(std::floor(p.y - 0.5));
    const double fx = p.x - 0.5 - x;
    const double fy = p.y - 0.5 - y;
    double lit      = 0;
    for (int j = -radius; j <= radius + 1; ++j)
        for (int i = -radius; i <= radius + 1; ++i) {
            if (is_blocked(map, p, x + i, y + j, mode)) continue;
            const double wx = i == -radius ? 1 - fx : i == radius + 1 ? fx : 1;
            const double wy = j == -radius ? 1 - fy : j == radius + 1 ? fy : 1;
            lit += wx * wy;
        }
    return static_cast<float>(std::clamp(lit / ((2 * radius + 1) * (2 * radius + 1)), 0.0, 1.0));
}

namespace {

/// Point k of n, evenly over the unit disk.
/// [Helmut Vogel, A Better Way to Construct the Sunflower Head, 1979]
dvec2 on_disk(int k, int n) {
    const double radius = std::sqrt((k + 0.5) / n), angle = k * 2.399963229728653;
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace

float soft_share(const MapView& view, const Receiver& receiver, double depth, BiasMode mode, const SoftFilter& filter) {
    const LightFrame& f    = view.frame;
    const dvec2 per_window = dvec2(view.map.width(), view.map.height()) / (2.0 * f.half);
    // The lines from the point to the light's rim are that far apart where they pass the depth z, in samples.
    const auto reach = [&](double z) {
        const dvec2 wide = filter.size * (1 / std::max(z, f.near) - 1 / depth) * per_window;
        return glm::clamp(wide, dvec2(0.5), dvec2(std::max(0.5, filter.texels)));
    };
    const auto blocked = [&](dvec2 within, int k, ivec2& at) {
        const dvec2 offset = within * on_disk(k, filter.samples);
        at = {static_cast<int>(std::floor(receiver.x + offset.x)), static_cast<int>(std::floor(receiver.y + offset.y))};
        return is_blocked(view.map, receiver, at.x, at.y, mode);
    };
    const dvec2 search = reach(f.near);
    double sum         = 0;
    int blockers       = 0;
    ivec2 at{0};
    for (int k = 0; k < filter.samples; ++k) {
        if (!blocked(search, k, at)) continue;
        sum += f.depth(view.map.nearness(at.x, at.y));
        ++blockers;
    }
    if (blockers == 0) return 1;
    const dvec2 penumbra = reach(sum / blockers);
    int lit              = 0;
    for (int k = 0; k < filter.samples; ++k) lit += blocked(penumbra, k, at) ? 0 : 1;
    return static_cast<float>(lit) / static_cast<float>(filter.samples);
}

std::optional<ivec2> blocked_sample(const DepthMap& map, const Receiver& p, BiasMode mode, const Filter& filter) {
    const double shift = filter.bilinear ? 0.5 : 0.0;  // as in lit_share
    const int x        = static_cast<int>(std::floor(p.x - shift));
    const int y        = static_cast<int>(std::floor(p.y - shift));
    const int last     = filter.radius + (filter.bilinear ? 1 : 0);
    std::optional<ivec2> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (int j = y - filter.radius; j <= y + last; ++j)
        for (int i = x - filter.radius; i <= x + last; ++i) {
            const double distance = std::hypot(i + 0.5 - p.x, j + 0.5 - p.y);
            if (distance < least && is_blocked(map, p, i, j, mode)) least = distance, nearest = ivec2(i, j);
        }
    return nearest;
}

}  // namespace umbra
