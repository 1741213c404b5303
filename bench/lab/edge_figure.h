// Edge displacement of a record, as figures that speak of the whole edge.
#pragma once

#include <cmath>
#include <optional>

#include "umbra/bench/lab/results.h"
#include "umbra/core/errors/shadow_edges.h"

namespace umbra {

/// One of mean, p95 and max, pixels.
struct EdgeFigure {
    double value  = 0;
    bool at_least = false;  ///< it counts a piece that lies beyond the reach, at an unknown distance, as the reach
};

/// The edges of one light, whose record must outlive it; mean, p95 and max of a record are of the matched pieces, NaN if
/// there are none.
class WholeEdge {
public:
    explicit WholeEdge(const DisplacementRecord& edges)
        : edges_(edges), reach_(std::isnan(edges.reach) ? kFarthest : edges.reach) {}

    [[nodiscard]] std::optional<EdgeFigure> mean() const {
        if (edges_.unmatched == 0) return measured(edges_.mean);
        const double unmatched = double(edges_.unmatched), pieces = double(edges_.pieces);
        return EdgeFigure{(known(edges_.mean).value_or(0) * (pieces - unmatched) + reach_ * unmatched) / pieces, true};
    }
    /// Between that of the matched pieces and their maximum, where unmatched ones are too few to be it: the maximum.
    [[nodiscard]] std::optional<EdgeFigure> p95() const {
        if (edges_.unmatched == 0) return measured(edges_.p95);
        const double pieces = double(edges_.pieces);
        const bool beyond   = std::floor((pieces - 1) * 95 / 100) >= pieces - double(edges_.unmatched);
        return beyond || std::isnan(edges_.max) ? EdgeFigure{reach_, true} : EdgeFigure{edges_.max, false};
    }
    [[nodiscard]] std::optional<EdgeFigure> max() const {
        if (edges_.unmatched == 0) return measured(edges_.max);
        return EdgeFigure{reach_, true};
    }

private:
    [[nodiscard]] static std::optional<EdgeFigure> measured(double value) {
        return std::isnan(value) ? std::nullopt : std::optional(EdgeFigure{value, false});
    }

    const DisplacementRecord& edges_;
    double reach_;
};

}  // namespace umbra
