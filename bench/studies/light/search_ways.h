// What a ray meets first, found in the ways that the lecture names beside brute force: bounding spheres and boxes,
// cells, an octree, a BSP tree. For comparing what each saves; pictures are traced by Embree's tree.
//
// This work is based on:
// Steven Rubin, Turner Whitted. A 3-Dimensional Representation for Fast Rendering of Complex Scenes. 1980
// Andrew Glassner. Space Subdivision for Fast Ray Tracing. 1984
// Michael Kaplan. Space-Tracing: A Constant Time Ray-Tracer. 1985
// John Amanatides, Andrew Woo. A Fast Voxel Traversal Algorithm for Ray Tracing. 1987
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "umbra/bench/studies/light/ray_tree.h"

namespace umbra {

enum class SearchWay : std::uint8_t {
    spheres,  ///< a binary tree over the triangles, halved by their middles; each node has a bounding sphere
    boxes,    ///< the same with bounding boxes
    cells,    ///< a grid of equal cells, about two a triangle, that the ray steps through
    octree,   ///< boxes halved along all three axes, down to 8 triangles
    bsp       ///< the same, halved along the longest axis alone, where half of the triangles lie on each side
};
inline constexpr std::array kSearchWays{SearchWay::spheres, SearchWay::boxes, SearchWay::cells, SearchWay::octree,
                                        SearchWay::bsp};
[[nodiscard]] constexpr std::string_view to_string(SearchWay way) {
    constexpr std::array<std::string_view, 5> names{"spheres", "boxes", "cells", "octree", "bsp"};
    return names[static_cast<std::size_t>(way)];
}

/// How often a ray was intersected with what.
struct SearchSteps {
    std::uint64_t volumes = 0, triangles = 0;
};

/// The triangles of a scene, arranged for one of the ways.
class SpaceSearch {
public:
    SpaceSearch(SearchWay way, const Scene& scene);  ///< the scene must outlive this object

    /// As first_by_search; nothing nearer than `start` is met (least_distance). Adds to `steps`.
    [[nodiscard]] TriangleId first(const Ray& ray, double start, SearchSteps& steps) const;

private:
    struct Node {
        dvec3 low{0}, high{0};
        double radius           = 0;  ///< of the sphere around the box's middle
        std::uint32_t begin     = 0;  ///< of a leaf: in `listed_`; else its first child in `nodes_`
        std::uint32_t triangles = 0;  ///< of a leaf
        std::uint32_t children  = 0;  ///< neighbours in `nodes_`
    };
    using Triangles = std::vector<TriangleId>;
    struct Hit;

    void build(std::size_t node, Triangles triangles, int depth);
    void build_cells(const Triangles& triangles);
    [[nodiscard]] std::vector<std::pair<Node, Triangles>> parts(const Node& node, const Triangles& triangles) const;
    [[nodiscard]] Node around(const Triangles& triangles) const;
    [[nodiscard]] double entry(const Node& node, const Ray& ray) const;
    void meet_listed(std::uint32_t begin, std::uint32_t count, const Ray& ray, double start, Hit& hit,
                     SearchSteps& steps) const;
    void step_through_cells(const Ray& ray, double start, Hit& hit, SearchSteps& steps) const;

    SearchWay way_;
    const Scene& scene_;
    std::vector<Node> nodes_;  ///< of cells: the whole, then the cells, x first
    Triangles listed_;
    std::array<int, 3> cells_{1, 1, 1};
};

/// The mean factor by which a number grows from one entry to the next: e to the slope of a line through its logarithms,
/// by least squares. Entries are positive; at least two.
[[nodiscard]] double growth_factor(const std::vector<double>& numbers);

}  // namespace umbra
