#include "umbra/bench/base/pareto.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace umbra {

std::vector<std::size_t> pareto_front(std::span<const CostError> points) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (std::isfinite(points[i].cost) && std::isfinite(points[i].error)) order.push_back(i);
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::tie(points[a].cost, points[a].error, a) < std::tie(points[b].cost, points[b].error, b);
    });
    std::vector<std::size_t> front;
    for (const std::size_t i : order) {
        if (!front.empty()) {
            const CostError& last = points[front.back()];
            const bool equal      = points[i].cost == last.cost && points[i].error == last.error;
            if (!equal && points[i].error >= last.error) continue;
        }
        front.push_back(i);
    }
    return front;
}

}  // namespace umbra
