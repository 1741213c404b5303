// Bodies as triangle meshes. Rings run from +z towards +x, which is anticlockwise seen from +y; all bands are cut
// along the same diagonal. Where a body has an edge to be seen (the rim of a cylinder), positions are given twice,
// bit-equal, with one normal for each side: welded they close the body.
#include "umbra/core/scene/primitives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <tuple>

#include "umbra/core/base/disjoint_sets.h"

namespace umbra {
namespace {

void require(bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(what);
}

/// The unit vector at `i` of `n` steps around the y axis.
dvec3 around_y(int i, int n) {
    const double angle = 2 * kPi * i / n;
    return {std::sin(angle), 0, std::cos(angle)};
}

std::uint32_t add(Mesh& mesh, dvec3 position, dvec3 normal) {
    mesh.positions.emplace_back(position);
    mesh.normals.emplace_back(normal);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

/// One band between an upper and a lower ring of n positions each, which start at these indices; seen from outside.
void add_band(Mesh& mesh, std::uint32_t upper, std::uint32_t lower, std::uint32_t n) {
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t next = (i + 1) % n;
        mesh.triangles.push_back({upper + i, lower + i, lower + next});
        mesh.triangles.push_back({upper + i, lower + next, upper + next});
    }
}

/// A flat cap at height y, facing up or down.
void add_cap(Mesh& mesh, double radius, double y, int segments, bool up) {
    const dvec3 normal{0, up ? 1 : -1, 0};
    const std::uint32_t centre = add(mesh, {0, y, 0}, normal);
    for (int i = 0; i < segments; ++i) add(mesh, radius * around_y(i, segments) + dvec3(0, y, 0), normal);
    const auto n = static_cast<std::uint32_t>(segments);
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = centre + 1 + i, b = centre + 1 + (i + 1) % n;
        mesh.triangles.push_back(up ? uvec3(centre, a, b) : uvec3(centre, b, a));
    }
}

}  // namespace

Mesh make_plane(float size_x, float size_z, int divisions) {
    require(divisions >= 1, "make_plane: at least 1 division");
    Mesh mesh;
    const auto n = static_cast<std::uint32_t>(divisions);
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i)
            mesh.positions.emplace_back((double(i) / n - 0.5) * size_x, 0, (double(j) / n - 0.5) * size_z);
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + n + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    return mesh;
}

Mesh make_box(vec3 size) {
    Mesh mesh;
    for (unsigned i = 0; i < 8; ++i)  // bits of i: which end along x, y, z
        mesh.positions.push_back(size * (vec3(i & 1, (i >> 1) & 1, i >> 2) - 0.5f));
    constexpr std::array<std::array<std::uint32_t, 4>, 6> sides{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (const auto& s : sides) {
        mesh.triangles.push_back({s[0], s[1], s[2]});
        mesh.triangles.push_back({s[0], s[2], s[3]});
    }
    return mesh;
}

Mesh make_sphere(float radius, int longitudes, int latitudes) {
    require(longitudes >= 3 && latitudes >= 2, "make_sphere: at least 3 longitudes and 2 latitudes");
    Mesh mesh;
    const auto n              = static_cast<std::uint32_t>(longitudes);
    const std::uint32_t north = add(mesh, {0, radius, 0}, {0, 1, 0});
    for (int j = 1; j < latitudes; ++j) {
        const double polar = kPi * j / latitudes;
        for (int i = 0; i < longitudes; ++i) {
            const dvec3 normal = std::sin(polar) * around_y(i, longitudes) + dvec3(0, std::cos(polar), 0);
            add(mesh, double(radius) * normal, normal);
        }
    }
    const std::uint32_t south = add(mesh, {0, -radius, 0}, {0, -1, 0});
    const std::uint32_t first = north + 1, last = south - n;
    for (std::uint32_t i = 0; i < n; ++i) mesh.triangles.push_back({north, first + i, first + (i + 1) % n});
    for (std::uint32_t ring = first; ring < last; ring += n) add_band(mesh, ring, ring + n, n);
    for (std::uint32_t i = 0; i < n; ++i) mesh.triangles.push_back({south, last + (i + 1) % n, last + i});
    return mesh;
}

Mesh make_cylinder(float radius, float height, int segments) {
    require(segments >= 3, "make_cylinder: at least 3 segments");
    Mesh mesh;
    for (const double y : {0.5 * height, -0.5 * height})
        for (int i = 0; i < segments; ++i) {
            const dvec3 normal = around_y(i, segments);
            add(mesh, double(radius) * normal + dvec3(0, y, 0), normal);
        }
    const auto n = static_cast<std::uint32_t>(segments);
    add_band(mesh, 0, n, n);
    add_cap(mesh, radius, 0.5 * height, segments, true);
    add_cap(mesh, radius, -0.5 * height, segments, false);
    return mesh;
}

Mesh make_cone(float radius, float height, int segments) {
    require(segments >= 3, "make_cone: at least 3 segments");
    Mesh mesh;
    // The normal leans upwards by as much as the side leans inwards. The tip has one normal a segment.
    const auto slanted = [&](dvec3 outwards) {
        return glm::normalize(double(height) * outwards + dvec3(0, radius, 0));
    };
    const auto n = static_cast<std::uint32_t>(segments);
    for (int i = 0; i < segments; ++i) add(mesh, {0, 0.5 * height, 0}, slanted(around_y(2 * i + 1, 2 * segments)));
    for (int i = 0; i < segments; ++i) {
        const dvec3 outwards = around_y(i, segments);
        add(mesh, double(radius) * outwards - dvec3(0, 0.5 * height, 0), slanted(outwards));
    }
    for (std::uint32_t i = 0; i < n; ++i) mesh.triangles.push_back({i, n + i, n + (i + 1) % n});
    add_cap(mesh, radius, -0.5 * height, segments, false);
    return mesh;
}

Mesh make_torus(float major, float minor, int around, int tube) {
    require(around >= 3 && tube >= 3, "make_torus: at least 3 steps around and 3 along the tube");
    Mesh mesh;
    for (int j = 0; j < tube; ++j) {  // rings from the outer equator downwards, inwards, up again
        const double angle = 2 * kPi * j / tube;
        for (int i = 0; i < around; ++i) {
            const dvec3 outwards = around_y(i, around);
            const dvec3 normal   = std::cos(angle) * outwards - dvec3(0, std::sin(angle), 0);
            add(mesh, double(major) * outwards + double(minor) * normal, normal);
        }
    }
    const auto n = static_cast<std::uint32_t>(around), rings = static_cast<std::uint32_t>(tube);
    for (std::uint32_t j = 0; j < rings; ++j) add_band(mesh, j * n, (j + 1) % rings * n, n);
    return mesh;
}

Mesh make_disk(float radius, int segments) {
    require(segments >= 3, "make_disk: at least 3 segments");
    Mesh mesh;
    add_cap(mesh, radius, 0, segments, true);
    return mesh;
}

Mesh transformed(Mesh mesh, const mat4& m) {
    const dmat4 full(m);
    const dmat3 a(full);
    // Cofactors are the inverse transpose times the determinant: they serve also where there is no inverse.
    const double sign = glm::determinant(a) < 0 ? -1 : 1;
    const dmat3 cofactors(glm::cross(a[1], a[2]), glm::cross(a[2], a[0]), glm::cross(a[0], a[1]));
    for (vec3& p : mesh.positions) p = vec3(full * dvec4(dvec3(p), 1));
    for (vec3& n : mesh.normals) {
        const dvec3 turned  = sign * (cofactors * dvec3(n));
        const double length = glm::length(turned);
        n                   = length > 0 ? vec3(turned / length) : vec3(0);
    }
    if (sign < 0)
        for (uvec3& t : mesh.triangles) std::swap(t.y, t.z);
    return mesh;
}

namespace {

/// For each position the lowest index of one that is equal to it.
std::vector<std::uint32_t> weld(const std::vector<vec3>& positions) {
    std::vector<std::uint32_t> order(positions.size()), welded(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](std::uint32_t i) {
        return std::array<float, 3>{positions[i].x, positions[i].y, positions[i].z};
    };
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t i, std::uint32_t j) { return key(i) != key(j) ? key(i) < key(j) : i < j; });
    for (std::size_t i = 0; i < order.size(); ++i)
        welded[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? welded[order[i - 1]] : order[i];
    return welded;
}

}  // namespace

// Corners that meet at a position share a normal where one can walk from face to face around it over edges that are not
// creases. So two bodies that touch in one position keep apart, and a crease may end inside a surface.
Mesh with_averaged_normals(const Mesh& mesh, float crease_degrees, NormalWeights weights) {
    const auto welded       = weld(mesh.positions);
    const auto corner_of    = [&](std::size_t corner) { return welded[mesh.triangles[corner / 3][int(corner % 3)]]; };
    const std::size_t faces = mesh.triangles.size();

    // Face normals (zero where degenerate) and the weight of each corner.
    std::vector<dvec3> face_normal(faces);
    std::vector<double> weight(3 * faces);
    for (std::size_t f = 0; f < faces; ++f) {
        std::array<dvec3, 3> p;
        for (unsigned k = 0; k < 3; ++k) p[k] = dvec3(mesh.positions[corner_of(3 * f + k)]);
        const dvec3 n       = glm::cross(p[1] - p[0], p[2] - p[0]);
        const double length = glm::length(n);
        if (!(length > 0)) continue;
        face_normal[f] = n / length;
        for (unsigned k = 0; k < 3; ++k)
            weight[3 * f + k] = weights == NormalWeights::area ? length
                                : weights == NormalWeights::equal
                                    ? 1
                                    : std::atan2(length, glm::dot(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]));
    }

    // Faces that share an edge lie next to each other once sorted by its two ends; a smooth edge joins their corners.
    struct Side {
        std::uint32_t low, high, low_corner, high_corner;
    };
    std::vector<Side> sides;
    sides.reserve(3 * faces);
    for (std::uint32_t f = 0; f < faces; ++f)
        for (std::uint32_t k = 0; k < 3; ++k) {
            std::uint32_t i = 3 * f + k, j = 3 * f + (k + 1) % 3;
            if (corner_of(i) > corner_of(j)) std::swap(i, j);
            sides.push_back({corner_of(i), corner_of(j), i, j});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.low, a.high, a.low_corner) < std::tie(b.low, b.high, b.low_corner);
    });
    const double cos_crease = crease_degrees >= 180 ? -2 : std::cos(glm::radians(double(crease_degrees)));
    DisjointSets sets(3 * faces);
    for (std::size_t s = 1; s < sides.size(); ++s) {
        const Side &a = sides[s - 1], &b = sides[s];
        if (a.low != b.low || a.high != b.high) continue;
        const dvec3 na = face_normal[a.low_corner / 3], nb = face_normal[b.low_corner / 3];
        const bool degenerate = na == dvec3(0) || nb == dvec3(0);  // has no direction: creases nothing
        if (!degenerate && glm::dot(na, nb) < cos_crease - 1e-9) continue;
        sets.unite(a.low_corner, b.low_corner);
        sets.unite(a.high_corner, b.high_corner);
    }

    // One vertex a set, in order of first use.
    std::vector<dvec3> sum(3 * faces, dvec3(0));
    for (std::uint32_t c = 0; c < 3 * faces; ++c) sum[sets.root(c)] += weight[c] * face_normal[c / 3];
    Mesh result;
    std::vector<std::uint32_t> vertex(3 * faces);
    for (std::uint32_t c = 0; c < 3 * faces; ++c) {
        if (const std::uint32_t set = sets.root(c); set == c) {
            vertex[c]           = static_cast<std::uint32_t>(result.positions.size());
            const double length = glm::length(sum[c]);
            result.positions.push_back(mesh.positions[corner_of(c)]);
            // Faces that cancel each other out have no common normal; zero means each face's own.
            result.normals.push_back(length > 1e-6 ? vec3(sum[c] / length) : vec3(0));
        } else {
            vertex[c] = vertex[set];
        }
        if (c % 3 == 2) result.triangles.emplace_back(vertex[c - 2], vertex[c - 1], vertex[c]);
    }
    return result;
}

}  // namespace umbra
