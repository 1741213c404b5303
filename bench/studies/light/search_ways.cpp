#include "umbra/bench/studies/light/search_ways.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "umbra/bench/studies/light/formula_bodies.h"

namespace umbra {
namespace {

constexpr std::size_t kFewTriangles = 8;
constexpr int kDeepest = 16, kDeepestOctree = 8;
constexpr double kNever = std::numeric_limits<double>::infinity();

dvec3 middle_of(const Scene& scene, TriangleId t) {
    return (dvec3(scene.vertex(t, 0)) + dvec3(scene.vertex(t, 1)) + dvec3(scene.vertex(t, 2))) / 3.0;
}

int longest_axis(dvec3 extent) {
    return extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
}

/// Where the ray enters the box, from 0 on; kNever where it passes by.
double enters_box(dvec3 low, dvec3 high, const Ray& ray) {
    const std::optional<Passage> inside = through_box(ray.origin, ray.direction, low, high);
    return inside && inside->leave >= 0 ? std::max(0.0, inside->enter) : kNever;
}

double enters_sphere(dvec3 centre, double radius, const Ray& ray) {
    const dvec3 to     = centre - ray.origin;
    const double along = glm::dot(to, ray.direction), square = radius * radius - (glm::dot(to, to) - along * along);
    if (square < 0 || along + std::sqrt(square) < 0) return kNever;
    return std::max(0.0, along - std::sqrt(square));
}

std::pair<dvec3, dvec3> box_of(const Scene& scene, TriangleId t) {
    const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
    return {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
}

}  // namespace

struct SpaceSearch::Hit {
    TriangleId triangle = kNoTriangle;
    double distance     = 0;
};

SpaceSearch::SpaceSearch(SearchWay way, const Scene& scene) : way_(way), scene_(scene) {
    Triangles all(scene.triangles.size());
    std::iota(all.begin(), all.end(), TriangleId{0});
    nodes_.push_back(around(all));
    if (way == SearchWay::cells)
        build_cells(all);
    else
        build(0, std::move(all), 0);
}

SpaceSearch::Node SpaceSearch::around(const Triangles& triangles) const {
    Node node;
    node.low = dvec3(kNever), node.high = dvec3(-kNever);
    for (const TriangleId t : triangles) {
        const auto [low, high] = box_of(scene_, t);
        node.low = glm::min(node.low, low), node.high = glm::max(node.high, high);
    }
    const dvec3 centre = 0.5 * (node.low + node.high);
    for (const TriangleId t : triangles)
        for (int k = 0; k < 3; ++k)
            node.radius = std::max(node.radius, glm::length(dvec3(scene_.vertex(t, k)) - centre));
    node.radius *= 1 + 1e-12;
    return node;
}

/// The children of a node with the triangles in each; of bounding volumes each triangle is in one, of space in all that
/// it touches.
std::vector<std::pair<SpaceSearch::Node, SpaceSearch::Triangles>> SpaceSearch::parts(const Node& node,
                                                                                     const Triangles& triangles) const {
    std::vector<std::pair<Node, Triangles>> children;
    const int axis       = longest_axis(node.high - node.low);
    Triangles by_middle  = triangles;
    const auto half      = by_middle.begin() + static_cast<std::ptrdiff_t>(by_middle.size() / 2);
    const auto is_before = [&](TriangleId a, TriangleId b) {
        return middle_of(scene_, a)[axis] < middle_of(scene_, b)[axis];
    };
    std::ranges::nth_element(by_middle, half, is_before);
    if (way_ == SearchWay::spheres || way_ == SearchWay::boxes) {
        for (const auto& [begin, end] : {std::pair{by_middle.begin(), half}, {half, by_middle.end()}}) {
            Triangles own(begin, end);
            Node child = around(own);
            children.emplace_back(child, std::move(own));
        }
        return children;
    }
    const double cut   = middle_of(scene_, *half)[axis];
    const dvec3 centre = 0.5 * (node.low + node.high);
    for (int k = 0; k < (way_ == SearchWay::octree ? 8 : 2); ++k) {
        Node child{.low = node.low, .high = node.high};
        for (int a = 0; a < 3; ++a) {
            if (way_ == SearchWay::bsp && a != axis) continue;
            const bool upper                    = way_ == SearchWay::bsp ? k == 1 : (k >> a & 1) == 1;
            (upper ? child.low : child.high)[a] = way_ == SearchWay::bsp ? cut : centre[a];
        }
        Triangles own;
        std::ranges::copy_if(triangles, std::back_inserter(own), [&](TriangleId t) {
            const std::pair<dvec3, dvec3> box = box_of(scene_, t);
            return glm::all(glm::lessThanEqual(child.low, box.second)) &&
                   glm::all(glm::lessThanEqual(box.first, child.high));
        });
        if (!own.empty()) children.emplace_back(child, std::move(own));
    }
    return children;
}

void SpaceSearch::build(std::size_t node, Triangles triangles, int depth) {
    std::vector<std::pair<Node, Triangles>> children;
    if (triangles.size() > kFewTriangles && depth < (way_ == SearchWay::octree ? kDeepestOctree : kDeepest))
        children = parts(nodes_[node], triangles);
    std::size_t below = 0;
    for (const auto& child : children) below += child.second.size();
    // Triangles that lie in several parts are tested in each: more parts must gain more than that.
    const auto most = (way_ == SearchWay::octree ? 3.0 : 1.5) * static_cast<double>(triangles.size());
    if (children.empty() || static_cast<double>(below) > most) {
        nodes_[node].begin     = static_cast<std::uint32_t>(listed_.size());
        nodes_[node].triangles = static_cast<std::uint32_t>(triangles.size());
        listed_.insert(listed_.end(), triangles.begin(), triangles.end());
        return;
    }
    const std::size_t first = nodes_.size();
    nodes_[node].begin      = static_cast<std::uint32_t>(first);
    nodes_[node].children   = static_cast<std::uint32_t>(children.size());
    for (const auto& child : children) nodes_.push_back(child.first);
    for (std::size_t k = 0; k < children.size(); ++k) build(first + k, std::move(children[k].second), depth + 1);
}

void SpaceSearch::build_cells(const Triangles& triangles) {
    Node& whole        = nodes_[0];
    const double thick = 1e-9 * glm::length(whole.high - whole.low);  // flat scenes, and what lies on the faces
    whole.low -= dvec3(thick), whole.high += dvec3(thick);
    const dvec3 extent = whole.high - whole.low;
    const double edge  = std::cbrt(extent.x * extent.y * extent.z / (2.0 * static_cast<double>(triangles.size())));
    for (int a = 0; a < 3; ++a)
        cells_[static_cast<std::size_t>(a)] = std::clamp(static_cast<int>(extent[a] / edge), 1, 128);
    const dvec3 size = extent / dvec3(cells_[0], cells_[1], cells_[2]);
    const dvec3 low  = whole.low;
    std::vector<Triangles> inside(static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) *
                                  static_cast<std::size_t>(cells_[2]));
    const auto cell = [&](double at, int a) {
        return std::clamp(static_cast<int>((at - low[a]) / size[a]), 0, cells_[static_cast<std::size_t>(a)] - 1);
    };
    for (const TriangleId t : triangles) {
        const std::pair<dvec3, dvec3> box = box_of(scene_, t);
        for (int z = cell(box.first.z, 2); z <= cell(box.second.z, 2); ++z)
            for (int y = cell(box.first.y, 1); y <= cell(box.second.y, 1); ++y)
                for (int x = cell(box.first.x, 0); x <= cell(box.second.x, 0); ++x)
                    inside[static_cast<std::size_t>((z * cells_[1] + y) * cells_[0] + x)].push_back(t);
    }
    for (const Triangles& own : inside) {
        nodes_.push_back(
            {.begin = static_cast<std::uint32_t>(listed_.size()), .triangles = static_cast<std::uint32_t>(own.size())});
        listed_.insert(listed_.end(), own.begin(), own.end());
    }
}

double SpaceSearch::entry(const Node& node, const Ray& ray) const {
    return way_ == SearchWay::spheres ? enters_sphere(0.5 * (node.low + node.high), node.radius, ray)
                                      : enters_box(node.low, node.high, ray);
}

void SpaceSearch::meet_listed(std::uint32_t begin, std::uint32_t count, const Ray& ray, double start, Hit& hit,
                              SearchSteps& steps) const {
    for (std::uint32_t k = begin; k < begin + count; ++k) {
        const TriangleId t = listed_[k];
        if (t == ray.from || (ray.is_of_eye && !scene_.switches(t).seen_by_camera)) continue;
        ++steps.triangles;
        // p = a + s (b - a) + u (c - a), inside where s, u >= 0 and s + u <= 1.
        const dvec3 a(scene_.vertex(t, 0)), ab = dvec3(scene_.vertex(t, 1)) - a, ac = dvec3(scene_.vertex(t, 2)) - a;
        const dvec3 across = glm::cross(ray.direction, ac), from = ray.origin - a, turned = glm::cross(from, ab);
        const double determinant = glm::dot(ab, across);
        const double s = glm::dot(from, across) / determinant, u = glm::dot(ray.direction, turned) / determinant,
                     distance = glm::dot(ac, turned) / determinant;
        if (s >= 0 && u >= 0 && s + u <= 1 && distance > start && distance < hit.distance) hit = {t, distance};
    }
}

void SpaceSearch::step_through_cells(const Ray& ray, double start, Hit& hit, SearchSteps& steps) const {
    ++steps.volumes;
    const Node& whole = nodes_[0];
    double at         = enters_box(whole.low, whole.high, ray);
    if (at == kNever) return;
    const dvec3 size = (whole.high - whole.low) / dvec3(cells_[0], cells_[1], cells_[2]);
    const dvec3 p    = ray.origin + at * ray.direction;
    int cell[3], way[3];
    double next[3], step[3];  // distance to the next face across each axis, and from one to the next
    for (int a = 0; a < 3; ++a) {
        cell[a] =
            std::clamp(static_cast<int>((p[a] - whole.low[a]) / size[a]), 0, cells_[static_cast<std::size_t>(a)] - 1);
        const double d = ray.direction[a];
        way[a]         = d > 0 ? 1 : -1;
        step[a]        = d == 0 ? kNever : size[a] / std::abs(d);
        next[a]        = d == 0 ? kNever : (whole.low[a] + (cell[a] + (d > 0 ? 1 : 0)) * size[a] - ray.origin[a]) / d;
    }
    for (;;) {
        ++steps.volumes;
        const Node& inside =
            nodes_[1 + static_cast<std::size_t>((cell[2] * cells_[1] + cell[1]) * cells_[0] + cell[0])];
        meet_listed(inside.begin, inside.triangles, ray, start, hit, steps);
        const int a = next[0] <= next[1] && next[0] <= next[2] ? 0 : next[1] <= next[2] ? 1 : 2;
        if (hit.distance <= next[a]) return;
        cell[a] += way[a];
        if (cell[a] < 0 || cell[a] >= cells_[static_cast<std::size_t>(a)]) return;
        next[a] += step[a];
    }
}

TriangleId SpaceSearch::first(const Ray& ray, double start, SearchSteps& steps) const {
    Hit hit{kNoTriangle, ray.reach};
    if (way_ == SearchWay::cells) {
        step_through_cells(ray, start, hit, steps);
        return hit.triangle;
    }
    std::vector<std::pair<double, std::uint32_t>> open;  // by entry, the nearest last
    const auto look_at = [&](std::uint32_t node) {
        ++steps.volumes;
        if (const double at = entry(nodes_[node], ray); at < hit.distance) open.emplace_back(at, node);
    };
    look_at(0);
    while (!open.empty()) {
        const auto [at, number] = open.back();
        open.pop_back();
        if (at >= hit.distance) continue;
        const Node& node = nodes_[number];
        meet_listed(node.begin, node.triangles, ray, start, hit, steps);
        const auto below = static_cast<std::ptrdiff_t>(open.size());
        for (std::uint32_t k = 0; k < node.children; ++k) look_at(node.begin + k);
        std::sort(open.begin() + below, open.end(), std::greater<>());
    }
    return hit.triangle;
}

double growth_factor(const std::vector<double>& numbers) {
    const auto n        = static_cast<double>(numbers.size());
    const double middle = (n - 1) / 2;
    double slope = 0, square = 0;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        const double from = static_cast<double>(k) - middle;
        slope += from * std::log(numbers[k]);
        square += from * from;
    }
    return std::exp(slope / square);
}

}  // namespace umbra
