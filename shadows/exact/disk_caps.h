// A round light between its inscribed polygon and the circle.
//
//         _.-"""-._        The polygon has kChords corners. Chord k and the circle enclose cap k.
//       .'_-------_'.      Where no edge comes near a cap, all of it is visible or hidden, as the light is just within
//      / /         \ \     its chord. A cap that an edge may touch is left open: its area goes into the bracket.
//     | |  polygon  | |
//      \ \         / /
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "umbra/core/base/math.h"
#include "umbra/shadows/exact/covering.h"

namespace umbra::exact_visibility {

class DiskCaps {
public:
    /// Chosen: all caps are 4e-4 of the disk, and an edge that crosses it leaves about 6e-6 of it open.
    static constexpr int kChords = 128;

    DiskCaps() { reset(); }
    void reset();

    /// Leaves open the caps that the segment from (x0, y0) to (x1, y1) may touch.
    void touch(double x0, double y0, double x1, double y1);

    /// The light just within each chord, for the sweep to write; `absent` where it does not meet the chord.
    [[nodiscard]] std::span<ChordState> within_chords() { return state_; }

    /// The area of one cap, in a unit disk.
    [[nodiscard]] static double cap_area();
    [[nodiscard]] bool is_open(int k) const { return open_[static_cast<std::size_t>(k)] != 0; }
    /// Visible in whole.
    [[nodiscard]] bool is_visible(int k) const {
        return !is_open(k) && state_[static_cast<std::size_t>(k)] == ChordState::visible;
    }

    struct Area {
        double visible, open;
    };
    /// Adds the caps to the visible area of the polygon.
    [[nodiscard]] Area with_caps(double polygon) const;

    /// Its corners, anticlockwise, inside the unit circle.
    template <class T>
    static std::vector<LightCorner<T>> polygon() {
        constexpr double kInside = 1 - 0x1p-50;  // more than the rounding of a corner
        std::vector<LightCorner<T>> corners;
        for (int k = 0; k < kChords; ++k) {
            const double angle = 2 * kPi * k / kChords;
            corners.push_back({T(kInside * std::cos(angle)), T(kInside * std::sin(angle)), k});
        }
        return corners;
    }

private:
    std::vector<ChordState> state_;
    std::vector<std::uint8_t> open_;
};

}  // namespace umbra::exact_visibility
