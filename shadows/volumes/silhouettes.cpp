#include "umbra/shadows/volumes/silhouettes.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/helpers.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"

namespace umbra {
namespace {

using Point       = CGAL::Simple_cartesian<float>::Point_3;  // CGAL keeps who neighbours whom; predicates.h decides
using SurfaceMesh = CGAL::Surface_mesh<Point>;

/// The object as a CGAL mesh; false where it has a border, or an edge or vertex that no 2-manifold has: CGAL refuses
/// the triangle that would make it.
bool build_closed_mesh(const Topology& topology, SurfaceMesh& mesh) {
    const std::size_t triangles = topology.triangles.size();
    if (triangles == 0 || 2 * topology.edges.size() != 3 * triangles) return false;
    mesh.reserve(static_cast<SurfaceMesh::size_type>(topology.position.size()),
                 static_cast<SurfaceMesh::size_type>(topology.edges.size()),
                 static_cast<SurfaceMesh::size_type>(triangles));
    mesh.resize(static_cast<SurfaceMesh::size_type>(topology.position.size()), 0, 0);  // connectivity alone matters
    using Vertex = SurfaceMesh::Vertex_index;
    for (std::uint32_t t = 0; t < triangles; ++t) {
        const uvec3 v = topology.triangles[t];
        if (topology.repeats_a_corner(t)) return false;
        if (mesh.add_face(Vertex(v[0]), Vertex(v[1]), Vertex(v[2])) == SurfaceMesh::null_face()) return false;
    }
    return CGAL::is_closed(mesh);
}

std::vector<SilhouetteMeshes::ClosedEdge> edges_of(const SurfaceMesh& mesh, std::uint32_t first_vertex,
                                                   TriangleId first_triangle) {
    std::vector<SilhouetteMeshes::ClosedEdge> edges;
    edges.reserve(mesh.number_of_edges());
    for (const auto e : mesh.edges()) {
        auto h = mesh.halfedge(e);
        if (mesh.source(h) > mesh.target(h)) h = mesh.opposite(h);
        edges.push_back({first_vertex + mesh.source(h), first_vertex + mesh.target(h), first_triangle + mesh.face(h),
                         first_triangle + mesh.face(mesh.opposite(h))});
    }
    std::sort(edges.begin(), edges.end(),
              [](const auto& l, const auto& r) { return l.a != r.a ? l.a < r.a : l.b < r.b; });
    return edges;
}

/// Whether every connected part of a closed mesh has a volume that is positive beyond doubt, by the divergence theorem.
bool bounds_solids(const Scene& scene, const Topology& topology) {
    std::vector<std::uint32_t> parent(topology.position.size());
    for (std::uint32_t v = 0; v < parent.size(); ++v) parent[v] = v;
    const auto root = [&](std::uint32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (const Edge& e : topology.edges) parent[root(e.a)] = root(e.b);

    std::vector<double> volume(parent.size(), 0), doubt(parent.size(), 0);
    for (const uvec3 t : topology.triangles) {
        const std::uint32_t part = root(t[0]);
        const dvec3 base(scene.positions[topology.position[part]]);
        const auto corner = [&](int k) { return dvec3(scene.positions[topology.position[t[k]]]) - base; };
        const dvec3 a = corner(0), b = corner(1), c = corner(2);
        volume[part] += glm::dot(a, glm::cross(b, c));
        doubt[part] += 0x1p-30 * glm::length(a) * glm::length(b) * glm::length(c);  // far above the sum's rounding
    }
    for (std::uint32_t v = 0; v < parent.size(); ++v)
        if (parent[v] == v && !(volume[v] > doubt[v])) return false;
    return true;
}

}  // namespace

std::vector<std::int8_t> facing_triangles(const Scene& scene, const Light& light) {
    std::vector<std::int8_t> facing(scene.triangles.size());
    parallel_ranges(facing.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto t = static_cast<TriangleId>(i);
            const vec3 a = scene.vertex(t, 0), b = scene.vertex(t, 1), c = scene.vertex(t, 2);
            facing[i] = static_cast<std::int8_t>(light.kind == LightKind::directional
                                                     ? side_of_direction(a, b, c, -light.direction)
                                                     : side_of_plane(a, b, c, light.position));
        }
    });
    return facing;
}

// ---- meshes and their silhouettes -----------------------------------------------------------------------------------

SilhouetteMeshes::SilhouetteMeshes(const Scene& scene) {
    triangles_.reserve(scene.triangles.size());
    for (const Object& object : scene.objects) {
        Topology topology       = find_topology(scene, object.first_triangle, object.triangle_count);
        const auto first_vertex = static_cast<std::uint32_t>(vertices_.size());
        for (const std::uint32_t p : topology.position) vertices_.push_back(scene.positions[p]);
        for (const uvec3 t : topology.triangles) triangles_.push_back(t + first_vertex);

        ObjectMesh& mesh = meshes_.emplace_back();
        SurfaceMesh closed;
        mesh.closed = build_closed_mesh(topology, closed);
        if (mesh.closed) {
            mesh.solid        = bounds_solids(scene, topology);
            mesh.closed_edges = edges_of(closed, first_vertex, object.first_triangle);
            continue;
        }
        for (Edge& e : topology.edges) e.a += first_vertex, e.b += first_vertex;
        for (EdgeUse& use : topology.uses) use.triangle += object.first_triangle;
        mesh.soup_edges = std::move(topology.edges);
        mesh.soup_uses  = std::move(topology.uses);
    }
}

std::vector<SilhouetteEdge> SilhouetteMeshes::edges(std::span<const std::int8_t> turn) const {
    std::vector<SilhouetteEdge> silhouette;
    for (const ObjectMesh& mesh : meshes_) {
        for (const ClosedEdge& e : mesh.closed_edges)
            if (turn[e.left] != turn[e.right]) silhouette.push_back({e.a, e.b, turn[e.left] - turn[e.right]});
        for (const Edge& e : mesh.soup_edges) {
            std::int32_t weight = 0;
            for (std::uint32_t k = e.first; k < e.first + e.count; ++k)
                weight +=
                    mesh.soup_uses[k].forward ? turn[mesh.soup_uses[k].triangle] : -turn[mesh.soup_uses[k].triangle];
            if (weight != 0) silhouette.push_back({e.a, e.b, weight});
        }
    }
    return silhouette;
}

std::size_t SilhouetteMeshes::memory_bytes() const {
    std::size_t bytes = triangles_.capacity() * sizeof(uvec3) + vertices_.capacity() * sizeof(vec3);
    for (const ObjectMesh& m : meshes_)
        bytes += m.closed_edges.capacity() * sizeof(ClosedEdge) + m.soup_edges.capacity() * sizeof(Edge) +
                 m.soup_uses.capacity() * sizeof(EdgeUse);
    return bytes;
}

// ---- statistics over random directions ------------------------------------------------------------------------------

namespace {

constexpr std::size_t kBlock = 64;  // directions that are taken at once, one a bit

/// The finaliser of splitmix64: a counter in, 64 random bits out. [Guy Steele, Doug Lea, Christine Flood, Fast
/// Splittable Pseudorandom Number Generators, 2014]
std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}
double unit_real(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

/// Towards the i-th light: uniform over the sphere, then rounded to float; what follows is exact for the rounded one.
vec3 random_direction(std::uint64_t seed, std::uint64_t i) {
    const std::uint64_t key = mix(mix(seed) ^ i);
    const double z          = 2 * unit_real(key) - 1;
    const double phi        = 2 * kPi * unit_real(mix(key));
    const double r          = std::sqrt(std::max(0.0, 1 - z * z));
    return vec3(dvec3(r * std::cos(phi), r * std::sin(phi), z));
}

struct DirectionBlock {
    std::array<vec3, kBlock> towards;
    alignas(64) std::array<double, kBlock> x, y, z;
};

/// Bit k: the triangle faces direction k. Decided by the normal in double where that is certain: an entry of the normal
/// carries at most five roundings and the sum of products three more, relative to the same expression over magnitudes,
/// and no direction has an entry above 1; 16 u has room to spare. Exactly where it is not.
std::uint64_t facing_bits(vec3 a, vec3 b, vec3 c, const DirectionBlock& block) {
    const dvec3 p = dvec3(b) - dvec3(a), q = dvec3(c) - dvec3(a);
    const dvec3 n = glm::cross(p, q);
    const dvec3 P = glm::abs(p), Q = glm::abs(q);
    const double bound = 16 * 0x1p-53 * (P.y * Q.z + P.z * Q.y + P.z * Q.x + P.x * Q.z + P.x * Q.y + P.y * Q.x);
    alignas(64) std::array<double, kBlock> side;
    for (std::size_t k = 0; k < kBlock; ++k) side[k] = n.x * block.x[k] + n.y * block.y[k] + n.z * block.z[k];
    std::uint64_t facing = 0, certain = 0;
    for (std::size_t k = 0; k < kBlock; ++k) facing |= std::uint64_t(side[k] > bound) << k;
    for (std::size_t k = 0; k < kBlock; ++k) certain |= std::uint64_t(std::abs(side[k]) > bound) << k;
    for (std::uint64_t doubt = ~certain; doubt != 0; doubt &= doubt - 1) {
        const int k = std::countr_zero(doubt);
        if (side_of_direction(a, b, c, block.towards[k]) > 0) facing |= std::uint64_t(1) << k;
    }
    return facing;
}

/// Sixty-four counters, one a bit of the words that are added: binary digits lie across words until they are read.
class BitCounters {
public:
    void add(std::uint64_t word) {
        for (int digit = 0; word != 0; ++digit) {
            const std::uint64_t carry = digits_[digit] & word;
            digits_[digit] ^= word;
            word = carry;
        }
    }
    [[nodiscard]] std::uint64_t count(std::size_t bit) const {
        std::uint64_t n = 0;
        for (std::size_t digit = 0; digit < digits_.size(); ++digit) n |= (digits_[digit] >> bit & 1) << digit;
        return n;
    }

private:
    std::array<std::uint64_t, 40> digits_{};
};

/// Bit k: with every triangle turned to face direction k, those at the edge do not cancel.
std::uint64_t silhouette_bits(const SilhouetteMeshes::ObjectMesh& mesh, const Edge& e,
                              std::span<const std::uint64_t> facing) {
    const EdgeUse* use = &mesh.soup_uses[e.first];
    const auto runs    = [&](std::uint32_t i) {
        return use[i].forward ? facing[use[i].triangle] : ~facing[use[i].triangle];
    };
    if (e.count % 2 == 1) return ~std::uint64_t(0);
    if (e.count == 2) return ~(runs(0) ^ runs(1));
    std::uint64_t silhouette = 0;
    for (std::size_t k = 0; k < kBlock; ++k) {
        std::uint64_t forward = 0;
        for (std::uint32_t i = 0; i < e.count; ++i) forward += runs(i) >> k & 1;
        silhouette |= std::uint64_t(2 * forward != e.count) << k;
    }
    return silhouette;
}

}  // namespace

std::vector<SilhouetteStatistics> silhouette_statistics(const Scene& scene, std::uint64_t directions,
                                                        std::uint64_t seed) {
    const SilhouetteMeshes meshes(scene);
    const std::size_t objects = scene.objects.size();
    std::vector<SilhouetteStatistics> statistics(objects);
    std::vector<double> squares(objects, 0);  // sum of squared deviations from the running mean

    constexpr std::uint64_t kRound = 16 * 1024;  // bounds the memory for any number of directions
    for (std::uint64_t first = 0; first < directions; first += kRound) {
        const std::uint64_t in_round = std::min(kRound, directions - first);
        const std::size_t blocks     = (in_round + kBlock - 1) / kBlock;
        std::vector<std::uint64_t> counts(objects * blocks * kBlock);
        parallel_ranges(blocks, 1, [&](std::size_t begin, std::size_t end) {
            std::vector<std::uint64_t> facing(scene.triangles.size());
            for (std::size_t b = begin; b < end; ++b) {
                DirectionBlock block;
                for (std::size_t k = 0; k < kBlock; ++k) {
                    block.towards[k] = random_direction(seed, first + b * kBlock + k);
                    block.x[k] = block.towards[k].x, block.y[k] = block.towards[k].y, block.z[k] = block.towards[k].z;
                }
                for (std::size_t t = 0; t < facing.size(); ++t) {
                    const auto id = static_cast<TriangleId>(t);
                    facing[t]     = facing_bits(scene.vertex(id, 0), scene.vertex(id, 1), scene.vertex(id, 2), block);
                }
                for (std::size_t o = 0; o < objects; ++o) {
                    const auto& mesh = meshes.meshes()[o];
                    BitCounters counters;
                    for (const auto& e : mesh.closed_edges) counters.add(facing[e.left] ^ facing[e.right]);
                    for (const Edge& e : mesh.soup_edges) counters.add(silhouette_bits(mesh, e, facing));
                    for (std::size_t k = 0; k < kBlock; ++k) counts[(o * blocks + b) * kBlock + k] = counters.count(k);
                }
            }
        });
        for (std::size_t o = 0; o < objects; ++o) {
            SilhouetteStatistics& s = statistics[o];
            for (std::size_t k = 0; k < in_round; ++k) {
                const auto n       = static_cast<double>(counts[o * blocks * kBlock + k]);
                const double delta = n - s.mean;
                s.mean += delta / static_cast<double>(++s.directions);
                squares[o] += delta * (n - s.mean);
            }
        }
    }
    for (std::size_t o = 0; o < objects; ++o) {
        statistics[o].object = scene.objects[o].name;
        if (directions > 1)
            statistics[o].standard_error =
                std::sqrt(squares[o] / static_cast<double>(directions - 1) / static_cast<double>(directions));
    }
    return statistics;
}

}  // namespace umbra
