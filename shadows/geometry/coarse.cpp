#include "umbra/shadows/geometry/coarse.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <set>
#include <unordered_map>

namespace umbra {
namespace {

/// How much of a corner each vertex is: 0 amid a flat part, more on a border, most where few edges leave it one way.
std::vector<float> corner_weights(const Scene& scene) {
    std::vector<dvec3> sum(scene.positions.size(), dvec3(0));
    std::vector<std::uint32_t> edges(scene.positions.size(), 0);
    for (const uvec3 t : scene.triangles)
        for (int k = 0; k < 3; ++k)
            for (const int other : {(k + 1) % 3, (k + 2) % 3}) {
                const dvec3 edge    = dvec3(scene.positions[t[other]]) - dvec3(scene.positions[t[k]]);
                const double length = glm::length(edge);
                if (!(length > 0)) continue;
                sum[t[k]] += edge / length;
                ++edges[t[k]];
            }
    std::vector<float> weights(sum.size(), 0.0f);
    for (std::size_t v = 0; v < sum.size(); ++v)
        if (edges[v] > 0) weights[v] = static_cast<float>(glm::length(sum[v]) / edges[v]);
    return weights;
}

/// Whole numbers, also those that no integer holds.
using Cell = std::array<double, 3>;
struct CellHash {
    std::size_t operator()(const Cell& cell) const {
        std::size_t all = 0;
        for (const double c : cell) all = (all ^ std::hash<double>{}(c)) * 0x9e3779b97f4a7c15u, all ^= all >> 29;
        return all;
    }
};

/// The vertices of one object, joined.
class Joined {
public:
    Joined(const Scene& scene, const std::vector<float>& weights, double cell)
        : scene_(scene), weights_(weights), cell_(cell) {}

    /// First for all corners, then `of` for each.
    void add(std::uint32_t vertex) {
        const auto [at, is_new] = by_cell_.try_emplace(cell_of(vertex), vertex);
        const float most = weights_[at->second], weight = weights_[vertex];
        if (weight > most || (weight == most && vertex < at->second)) at->second = vertex;
    }
    [[nodiscard]] std::uint32_t of(std::uint32_t vertex) const { return by_cell_.at(cell_of(vertex)); }

private:
    [[nodiscard]] Cell cell_of(std::uint32_t vertex) const {
        const dvec3 cell = glm::floor(dvec3(scene_.positions[vertex]) / cell_);
        return {cell.x, cell.y, cell.z};
    }

    const Scene& scene_;
    const std::vector<float>& weights_;
    double cell_;
    std::unordered_map<Cell, std::uint32_t, CellHash> by_cell_;
};

}  // namespace

std::vector<uvec3> coarse_triangles(const Scene& scene, double cell) {
    const std::vector<float> weights = corner_weights(scene);
    std::vector<uvec3> coarse        = scene.triangles;
    for (TriangleId first = 0, end = 0; first < coarse.size(); first = end) {
        while (end < coarse.size() && scene.triangle_object[end] == scene.triangle_object[first]) ++end;
        Joined joined(scene, weights, cell);
        for (TriangleId t = first; t < end; ++t)
            for (int k = 0; k < 3; ++k) joined.add(coarse[t][k]);
        std::set<std::array<std::uint32_t, 3>> seen;
        for (TriangleId t = first; t < end; ++t) {
            const uvec3 v(joined.of(coarse[t].x), joined.of(coarse[t].y), joined.of(coarse[t].z));
            std::array<std::uint32_t, 3> corners{v.x, v.y, v.z};
            std::ranges::sort(corners);
            const bool flat = corners[0] == corners[1] || corners[1] == corners[2];
            coarse[t]       = flat || !seen.insert(corners).second ? uvec3(v.x) : v;
        }
    }
    return coarse;
}

}  // namespace umbra
