#include "umbra/shadows/exact/disk_caps.h"

#include <algorithm>

namespace umbra::exact_visibility {
namespace {

constexpr double kStep = 2 * kPi / DiskCaps::kChords;  ///< radians

/// Radians and radii: far above the rounding in touch(), far below a cap's height of 3e-4.
constexpr double kSlack = 1e-6;

}  // namespace

void DiskCaps::reset() {
    state_.assign(kChords, ChordState::absent);
    open_.assign(kChords, 0);
}

void DiskCaps::touch(double x0, double y0, double x1, double y1) {
    const double inner = std::cos(kPi / kChords) - kSlack, outer = 1 + kSlack;  // the caps lie between these radii
    const double dx = x1 - x0, dy = y1 - y0, dd = dx * dx + dy * dy;
    if (!(dd > 0)) return;
    // (x0, y0) + t (dx, dy) is at distance r from the centre where dd t^2 + 2 b t + c - r^2 = 0.
    const double b = x0 * dx + y0 * dy, nearest = std::abs(x0 * dy - y0 * dx) / std::sqrt(dd);
    if (nearest >= outer) return;
    const auto half_chord = [&](double r) { return std::sqrt(std::max(0.0, r * r - nearest * nearest) / dd); };
    const double foot = -b / dd, out = half_chord(outer), in = nearest < inner ? half_chord(inner) : 0;
    const auto mark = [&](double from, double to) {
        from = std::max(from, 0.0), to = std::min(to, 1.0);
        if (!(from <= to)) return;
        const double first = std::atan2(y0 + from * dy, x0 + from * dx);
        double turn        = std::atan2(y0 + to * dy, x0 + to * dx) - first;
        if (turn > kPi) turn -= 2 * kPi;
        if (turn < -kPi) turn += 2 * kPi;
        const int lowest  = static_cast<int>(std::floor((first + std::min(turn, 0.0) - kSlack) / kStep));
        const int highest = static_cast<int>(std::floor((first + std::max(turn, 0.0) + kSlack) / kStep));
        for (int k = lowest; k <= highest; ++k) open_[static_cast<std::size_t>((k + 2 * kChords) % kChords)] = 1;
    };
    if (in > 0) {
        mark(foot - out, foot - in);
        mark(foot + in, foot + out);
    } else {
        mark(foot - out, foot + out);
    }
}

double DiskCaps::cap_area() {
    static const double area = (kPi - kChords / 2.0 * std::sin(kStep)) / kChords;
    return area;
}

DiskCaps::Area DiskCaps::with_caps(double polygon) const {
    const double cap = cap_area();
    Area area{polygon, 0};
    for (std::size_t k = 0; k < kChords; ++k) {
        // Where the plane of the point's triangle takes a chord away, it takes the cap or has left it open.
        if (open_[k])
            area.open += cap;
        else if (state_[k] == ChordState::visible)
            area.visible += cap;
    }
    return area;
}

}  // namespace umbra::exact_visibility
