// Edge displacement as records hold it (`edge_displacement_px`), read as figures that speak of the whole edge.
#pragma once

#include <cmath>
#include <optional>

namespace umbra {

/// One of mean, p95 and max, pixels.
struct EdgeFigure {
    double value  = 0;
    bool at_least = false;  ///< it counts a piece that lies beyond the reach, at an unknown distance, as the reach
};

/// What a record says of the edges of one light: mean, p95 and max are of the matched pieces, absent if there are none.
struct EdgeRecord {
    std::optional<double> mean, p95, max;
    double pieces = 0, unmatched = 0, reach = 0;

    [[nodiscard]] std::optional<EdgeFigure> whole_mean() const {
        if (unmatched <= 0) return measured(mean);
        return EdgeFigure{(mean.value_or(0) * (pieces - unmatched) + reach * unmatched) / pieces, true};
    }
    /// Between that of the matched pieces and their maximum, where unmatched ones are too few to be it: the maximum.
    [[nodiscard]] std::optional<EdgeFigure> whole_p95() const {
        if (unmatched <= 0) return measured(p95);
        const bool beyond = std::floor((pieces - 1) * 95 / 100) >= pieces - unmatched;
        return beyond || !max ? EdgeFigure{reach, true} : EdgeFigure{*max, false};
    }
    [[nodiscard]] std::optional<EdgeFigure> whole_max() const {
        if (unmatched <= 0) return measured(max);
        return EdgeFigure{reach, true};
    }

private:
    [[nodiscard]] static std::optional<EdgeFigure> measured(const std::optional<double>& value) {
        return value ? std::optional(EdgeFigure{*value, false}) : std::nullopt;
    }
};

}  // namespace umbra
