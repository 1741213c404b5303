#include "umbra/bench/studies/light/bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Dense>

#include "umbra/bench/studies/light/body_tree.h"
#include "umbra/core/base/disjoint_sets.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/scene/topology.h"

namespace umbra {
namespace {

constexpr std::size_t kFewestOfARoundBody = 20, kTrianglesOfABox = 12;
constexpr double kNormalCosine = 1 - 1e-5;  ///< of a vertex normal and the surface's own, at least

/// The largest distance of a vertex from a surface of this size: some roundings to float of its coordinates.
double rounding(double size, double farthest_coordinate) { return 2e-6 * size + 0x1p-22 * farthest_coordinate; }

/// Some triangles of one object.
class Component {
public:
    Component(const Scene& scene, std::vector<TriangleId> triangles)
        : scene_(scene), triangles_(std::move(triangles)) {}

    [[nodiscard]] const std::vector<TriangleId>& triangles() const { return triangles_; }

    [[nodiscard]] std::optional<Body> as_body() const {
        if (triangles_.size() == kTrianglesOfABox) return as_box();
        if (triangles_.size() < kFewestOfARoundBody || scene_.normals.empty()) return std::nullopt;
        if (auto sphere = as_sphere()) return sphere;
        return as_turned();
    }

private:
    [[nodiscard]] dvec3 corner(TriangleId t, int k) const { return {scene_.vertex(t, k)}; }

    /// Twice the area, by the winding.
    [[nodiscard]] dvec3 area(TriangleId t) const {
        return glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
    }

    template <class Visit>
    void each_corner(const Visit& visit) const {
        for (const TriangleId t : triangles_)
            for (int k = 0; k < 3; ++k) visit(t, k);
    }

    [[nodiscard]] dvec3 mean_corner() const {
        dvec3 sum(0);
        each_corner([&](TriangleId t, int k) { sum += corner(t, k); });
        return sum / (3.0 * static_cast<double>(triangles_.size()));
    }

    [[nodiscard]] double farthest_coordinate() const {
        double farthest = 0;
        each_corner([&](TriangleId t, int k) {
            for (int d = 0; d < 3; ++d) farthest = std::max(farthest, std::abs(corner(t, k)[d]));
        });
        return farthest;
    }

    /// Signed: positive where the winding faces outwards.
    [[nodiscard]] double volume(dvec3 centre) const {
        double sum = 0;
        for (const TriangleId t : triangles_) sum += glm::dot(corner(t, 0) - centre, area(t)) / 6;
        return sum;
    }

    [[nodiscard]] Body body(BodyKind kind, dvec3 centre, bool inside_out) const {
        Body found;
        found.kind       = kind;
        found.inside_out = inside_out;
        found.object     = scene_.triangle_object[triangles_.front()];
        found.holder     = triangles_.front();
        found.centre     = centre;
        return found;
    }

    // The centre c and the radius r that make sum (|p - c|^2 - r^2)^2 least over all corners p. From their mean, which
    // is then 0: 2 (sum p p^T) c = sum |p|^2 p, and r^2 = |c|^2 + mean |p|^2.
    [[nodiscard]] std::optional<Body> as_sphere() const {
        const dvec3 mean = mean_corner();
        dmat3 squares(0);
        dvec3 cubes(0);
        double square = 0;
        each_corner([&](TriangleId t, int k) {
            const dvec3 p = corner(t, k) - mean;
            squares += glm::outerProduct(p, p);
            cubes += glm::dot(p, p) * p;
            square += glm::dot(p, p);
        });
        if (!(std::abs(glm::determinant(squares)) > 1e-3 * square * square * square / 27)) return std::nullopt;  // flat
        const dvec3 off     = 0.5 * (glm::inverse(squares) * cubes);
        const double radius = std::sqrt(glm::dot(off, off) + square / (3.0 * static_cast<double>(triangles_.size())));
        const dvec3 centre  = mean + off;
        if (!lies_on_sphere(centre, radius)) return std::nullopt;
        const double filled = volume(centre) / (4 * kPi / 3 * radius * radius * radius);
        if (!(std::abs(filled) > 0.4 && std::abs(filled) < 1.001)) return std::nullopt;
        if (!faces_away_from(centre, radius, filled < 0)) return std::nullopt;
        Body found   = body(BodyKind::sphere, centre, filled < 0);
        found.radius = radius;
        return found;
    }

    [[nodiscard]] bool lies_on_sphere(dvec3 centre, double radius) const {
        const double allowed = rounding(radius, farthest_coordinate());
        bool lies            = true;
        each_corner([&](TriangleId t, int k) {
            const dvec3 out     = corner(t, k) - centre, normal(scene_.normals[scene_.triangles[t][k]]);
            const double length = glm::length(out);
            lies                = lies && std::abs(length - radius) <= allowed &&
                   std::abs(glm::dot(normal, out)) >= kNormalCosine * length * glm::length(normal) &&
                   normal != dvec3(0);
        });
        return lies;
    }

    /// Whether no triangle cuts deep into the sphere, or is wound otherwise than the rest.
    [[nodiscard]] bool faces_away_from(dvec3 centre, double radius, bool inside_out) const {
        return std::ranges::all_of(triangles_, [&](TriangleId t) {
            const dvec3 normal = area(t);
            const double out   = glm::dot(normal, corner(t, 0) - centre) * (inside_out ? -1 : 1);
            return normal == dvec3(0) || out >= 0.4 * radius * glm::length(normal);
        });
    }

    /// A body around one of the principal axes of its vertices, whose moments across it are equal.
    [[nodiscard]] std::optional<Body> as_turned() const {
        const dvec3 mean        = mean_corner();
        Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
        each_corner([&](TriangleId t, int k) {
            const dvec3 p = corner(t, k) - mean;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) squares(i, j) += p[i] * p[j];
        });
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> moments(squares);
        const Eigen::Vector3d& size = moments.eigenvalues();  // ascending
        for (const int odd : {0, 2}) {
            if (!(size[2] - size[0] > 1e-3 * size[2]) || !(std::abs(size[1] - size[2 - odd]) < 1e-4 * size[2]))
                continue;
            const auto axis = [&](int k) {
                const Eigen::Vector3d v = moments.eigenvectors().col(k);
                return dvec3(v.x(), v.y(), v.z());
            };
            const dvec3 z = axis(odd), x = axis(1);
            for (const double way : {1.0, -1.0}) {
                const dmat3 axes(x, glm::cross(way * z, x), way * z);
                for (const BodyKind kind : {BodyKind::cylinder, BodyKind::cone, BodyKind::torus})
                    if (const auto found = turned(kind, mean, axes)) return found;
            }
        }
        return std::nullopt;
    }

    /// Sizes from the vertices; then all vertices, normals and triangles have to fit.
    [[nodiscard]] std::optional<Body> turned(BodyKind kind, dvec3 mean, const dmat3& axes) const {
        double low = HUGE_VAL, high = -HUGE_VAL, widest = 0;
        double n = 0, r = 0, rr = 0, s = 0, rs = 0;  // sums over corners of 1, r, r^2, s = r^2 + z^2, r s
        each_corner([&](TriangleId t, int k) {
            const dvec3 p    = glm::transpose(axes) * (corner(t, k) - mean);
            const double far = std::hypot(p.x, p.y), square = far * far + p.z * p.z;
            low = std::min(low, p.z), high = std::max(high, p.z), widest = std::max(widest, far);
            n += 1, r += far, rr += far * far, s += square, rs += far * square;
        });
        const double volume_at = volume(mean);
        Body found             = body(kind, mean, volume_at < 0);
        found.axes             = axes;
        double whole           = 0;
        if (kind == BodyKind::torus) {
            // The circle s = 2 major r + minor^2 - major^2 around which the vertices lie, by least squares.
            const double major        = 0.5 * (n * rs - r * s) / (n * rr - r * r),
                         minor_square = (s - 2 * major * r) / n + major * major;
            if (!(major > 0 && minor_square > 0 && minor_square < major * major)) return std::nullopt;
            const double minor = std::sqrt(minor_square);
            found.radius       = major;
            found.half_size    = {major + minor, major + minor, minor};
            whole              = 2 * kPi * kPi * major * minor_square;
        } else {
            const double half = 0.5 * (high - low);
            if (!(half > 0 && widest > 0)) return std::nullopt;
            found.centre += 0.5 * (low + high) * axes[2];
            found.radius    = widest;
            found.half_size = {widest, widest, half};
            whole           = 2 * kPi * widest * widest * half / (kind == BodyKind::cone ? 3 : 1);
        }
        const double filled = std::abs(volume_at) / whole;
        if (!(filled > 0.4 && filled < 1.001) || !lies_on(found)) return std::nullopt;
        return found;
    }

    /// Whether all vertices lie on the body's surface with its normals, and all triangles face along it.
    [[nodiscard]] bool lies_on(const Body& found) const {
        const double allowed = rounding(glm::length(found.half_size), farthest_coordinate());
        return std::ranges::all_of(triangles_, [&](TriangleId t) {
            const dvec3 facet  = area(t) * (found.inside_out ? -1.0 : 1.0),
                        middle = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0;
            if (facet != dvec3(0) && !(glm::dot(facet, onto_surface(found, middle).normal) >= 0.4 * glm::length(facet)))
                return false;
            for (int k = 0; k < 3; ++k) {
                const dvec3 p = corner(t, k), normal(scene_.normals[scene_.triangles[t][k]]);
                // From a little towards the middle, where an edge has one normal of two.
                const OnSurface on = onto_surface(found, p + 1e-3 * (middle - p));
                if (!(glm::length(onto_surface(found, p).position - p) <= allowed) || normal == dvec3(0) ||
                    !(std::abs(glm::dot(normal, on.normal)) >= kNormalCosine * glm::length(normal)))
                    return false;
            }
            return true;
        });
    }

    /// Each position once.
    [[nodiscard]] std::vector<dvec3> positions() const {
        std::vector<dvec3> once;
        each_corner([&](TriangleId t, int k) {
            if (std::find(once.begin(), once.end(), corner(t, k)) == once.end()) once.push_back(corner(t, k));
        });
        return once;
    }

    /// Two faces' normals and their cross product: near to the axes of a box.
    [[nodiscard]] std::optional<dmat3> normals_of_box() const {
        const dvec3 first  = glm::normalize(area(triangles_.front()));
        const auto another = std::ranges::find_if(
            triangles_, [&](TriangleId t) { return std::abs(glm::dot(first, area(t))) < 0.5 * glm::length(area(t)); });
        if (another == triangles_.end()) return std::nullopt;
        const dvec3 second = glm::normalize(area(*another));
        if (!(std::abs(glm::dot(first, second)) < 1e-4)) return std::nullopt;
        return dmat3(first, second, glm::normalize(glm::cross(first, second)));
    }

    /// Which corner of a box p is: bit k is its end of axis k.
    static unsigned end_of(const Body& box, dvec3 p) {
        const dvec3 local = glm::transpose(box.axes) * (p - box.centre);
        return (local.x > 0 ? 1u : 0u) | (local.y > 0 ? 2u : 0u) | (local.z > 0 ? 4u : 0u);
    }

    [[nodiscard]] std::optional<Body> as_box() const {
        const std::vector<dvec3> corners = positions();
        const auto normals               = corners.size() == 8 ? normals_of_box() : std::nullopt;
        if (!normals) return std::nullopt;
        dvec3 centre(0);
        for (const dvec3& p : corners) centre += p / 8.0;
        Body box = body(BodyKind::box, centre, volume(centre) < 0);
        box.axes = *normals;
        // Axes and sizes are means of the four edges each, so that they are closer than one edge's rounding.
        unsigned ends = 0;
        dmat3 edges(0);
        for (const dvec3& p : corners) {
            const unsigned end = end_of(box, p);
            ends |= 1u << end;
            for (unsigned k = 0; k < 3; ++k) edges[static_cast<int>(k)] += (end >> k & 1u ? 0.125 : -0.125) * p;
        }
        if (ends != 0xffu) return std::nullopt;
        for (int k = 0; k < 3; ++k) box.half_size[k] = glm::length(edges[k]), box.axes[k] = glm::normalize(edges[k]);
        if (!fits_box(box, corners)) return std::nullopt;
        return box;
    }

    [[nodiscard]] bool fits_box(const Body& box, const std::vector<dvec3>& corners) const {
        const double allowed = rounding(glm::length(box.half_size), farthest_coordinate());
        for (int k = 0; k < 3; ++k)
            if (!(box.half_size[k] > 10 * allowed)) return false;
        for (const dvec3& p : corners) {
            const unsigned end = end_of(box, p);
            dvec3 expected     = box.centre;
            for (unsigned k = 0; k < 3; ++k) {
                const int d = static_cast<int>(k);
                expected += (end >> k & 1u ? 1.0 : -1.0) * box.half_size[d] * box.axes[d];
            }
            if (!(glm::length(p - expected) <= allowed)) return false;
        }
        const double whole = 8 * box.half_size.x * box.half_size.y * box.half_size.z;
        return std::abs(std::abs(volume(box.centre)) / whole - 1) < 1e-3 &&
               std::ranges::all_of(triangles_, [&](TriangleId t) { return lies_on_face(box, t); });
    }

    /// Whether all corners are on one face, and their normals are its.
    [[nodiscard]] bool lies_on_face(const Body& box, TriangleId t) const {
        const std::array ends{end_of(box, corner(t, 0)), end_of(box, corner(t, 1)), end_of(box, corner(t, 2))};
        const unsigned same = ~((ends[0] ^ ends[1]) | (ends[0] ^ ends[2])) & 7u;
        if (same != 1 && same != 2 && same != 4) return false;
        const dvec3 face = box.axes[same == 1 ? 0 : same == 2 ? 1 : 2];
        for (int k = 0; k < 3 && !scene_.normals.empty(); ++k) {
            const dvec3 normal(scene_.normals[scene_.triangles[t][k]]);
            if (normal != dvec3(0) && std::abs(glm::dot(normal, face)) < kNormalCosine * glm::length(normal))
                return false;
        }
        return true;
    }

    const Scene& scene_;
    std::vector<TriangleId> triangles_;
};

/// A body, and the triangles that stand for it.
struct FoundBody {
    Body body;
    std::vector<TriangleId> triangles;
};

/// One object's mesh, from which bodies are taken away as they are found.
class ObjectMesh {
public:
    ObjectMesh(const Scene& scene, const Object& object)
        : scene_(scene),
          topology_(find_topology(scene, object.first_triangle, object.triangle_count)),
          component_(object.triangle_count, kLeft) {}

    /// Those among the triangles that are connected by the vertices `vertices_of(t)` has, each below `count`.
    template <class VerticesOf>
    void find(std::uint32_t count, const VerticesOf& vertices_of, std::vector<FoundBody>& found) {
        std::vector<std::vector<TriangleId>> parts = connect(count, vertices_of);
        const std::vector<bool> closed             = closed_ones(parts.size());
        std::vector<std::optional<Body>> bodies(parts.size());
        std::vector<Component> components;
        components.reserve(parts.size());
        for (std::vector<TriangleId>& part : parts) components.emplace_back(scene_, std::move(part));
        parallel_ranges(parts.size(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t c = begin; c < end; ++c)
                if (closed[c]) bodies[c] = components[c].as_body();
        });
        for (std::size_t c = 0; c < parts.size(); ++c) {
            if (bodies[c]) found.push_back({*bodies[c], components[c].triangles()});
            const std::uint32_t now = bodies[c] ? kTaken : kLeft;
            for (const TriangleId t : components[c].triangles()) component_[t - topology_.first_triangle] = now;
        }
    }

    [[nodiscard]] const Topology& topology() const { return topology_; }

private:
    static constexpr std::uint32_t kLeft = 0xffffffffu, kTaken = 0xfffffffeu;

    /// Numbers what is left by component, in order of their first triangles.
    template <class VerticesOf>
    std::vector<std::vector<TriangleId>> connect(std::uint32_t count, const VerticesOf& vertices_of) {
        const auto triangles = static_cast<std::uint32_t>(component_.size());
        DisjointSets sets(count);
        for (std::uint32_t t = 0; t < triangles; ++t) {
            if (component_[t] == kTaken) continue;
            const uvec3 v = vertices_of(t);
            sets.unite(v.x, v.y), sets.unite(v.x, v.z);
        }
        std::vector<std::uint32_t> number(count, kLeft);
        std::vector<std::vector<TriangleId>> parts;
        for (std::uint32_t t = 0; t < triangles; ++t) {
            if (component_[t] == kTaken) continue;
            std::uint32_t& c = number[sets.root(vertices_of(t).x)];
            if (c == kLeft) c = static_cast<std::uint32_t>(parts.size()), parts.emplace_back();
            component_[t] = c;
            parts[c].push_back(topology_.first_triangle + t);
        }
        return parts;
    }

    /// Components of whose triangles exactly two meet at each edge, and run it in opposite directions.
    [[nodiscard]] std::vector<bool> closed_ones(std::size_t components) const {
        std::vector<bool> closed(components, true);
        std::vector<std::pair<std::uint32_t, int>> runs;  // component and direction of the triangles at an edge
        for (const Edge& edge : topology_.edges) {
            runs.clear();
            for (std::uint32_t k = edge.first; k < edge.first + edge.count; ++k)
                if (const std::uint32_t c = component_[topology_.uses[k].triangle]; c != kTaken)
                    runs.emplace_back(c, topology_.uses[k].forward ? 1 : -1);
            std::ranges::sort(runs);
            for (std::size_t k = 0; k < runs.size();) {
                std::size_t end = k;
                int sum         = 0;
                for (; end < runs.size() && runs[end].first == runs[k].first; ++end) sum += runs[end].second;
                if (end - k != 2 || sum != 0) closed[runs[k].first] = false;
                k = end;
            }
        }
        return closed;
    }

    const Scene& scene_;
    Topology topology_;
    std::vector<std::uint32_t> component_;  ///< one a triangle: its component's number, kLeft or kTaken
};

void find_in_object(const Scene& scene, const Object& object, Bodies& bodies) {
    if (object.triangle_count < kTrianglesOfABox) return;
    ObjectMesh mesh(scene, object);
    std::vector<FoundBody> found;
    std::uint32_t low = 0xffffffffu, high = 0;
    for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
        for (int k = 0; k < 3; ++k) {
            low  = std::min(low, scene.triangles[t][k]);
            high = std::max(high, scene.triangles[t][k]);
        }
    mesh.find(
        high - low + 1, [&](std::uint32_t t) { return scene.triangles[object.first_triangle + t] - low; }, found);
    mesh.find(
        static_cast<std::uint32_t>(mesh.topology().position.size()),
        [&](std::uint32_t t) { return mesh.topology().triangles[t]; }, found);
    std::ranges::sort(found, {}, [](const FoundBody& f) { return f.body.holder; });
    for (const auto& [body, triangles] : found) {
        for (const TriangleId t : triangles) bodies.of_mesh[t] = static_cast<std::uint32_t>(bodies.list.size());
        bodies.list.push_back(body);
    }
}

}  // namespace

std::size_t Bodies::count(BodyKind kind) const {
    return static_cast<std::size_t>(std::ranges::count(list, kind, &Body::kind));
}

std::size_t Bodies::triangles() const {
    return of_mesh.size() - static_cast<std::size_t>(std::ranges::count(of_mesh, kNoBody));
}

Bodies find_bodies(const Scene& scene) {
    Bodies bodies;
    bodies.of_mesh.assign(scene.triangles.size(), kNoBody);
    for (const Object& object : scene.objects) find_in_object(scene, object, bodies);
    return bodies;
}

}  // namespace umbra
