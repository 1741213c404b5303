// exact against brute force over all triangles in whole numbers, on scenes made to be degenerate.
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>

#include <array>
#include <random>
#include <string_view>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/asked.h"

namespace umbra {
namespace {

using Int  = boost::multiprecision::int256_t;
using Int3 = std::array<Int, 3>;

/// All coordinates are eighths: times this they are whole numbers, and so is every determinant below. A light that is
/// moved by a few units meets what it met, but for edges and corners.
constexpr double kWhole = 0x1p20;
Int3 whole(dvec3 v) { return {Int(v.x * kWhole), Int(v.y * kWhole), Int(v.z * kWhole)}; }
Int3 operator-(const Int3& a, const Int3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Int dot(const Int3& a, const Int3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Int3 cross(const Int3& a, const Int3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// 0 lit, 1 touched, 2 blocked, by a way of its own: the crossing point as a fraction of the segment, then its
/// barycentrics; in the plane of a triangle, the interval of the segment that lies inside (Cyrus and Beck 1978).
/// `front`: the normal of the point's own triangle, to the side of the light. What does not rise over its plane is not
/// counted, nor what is met at the light alone.
int meeting(const Int3& p, const Int3& d, bool infinite, const Int3& front, const Int3& a, const Int3& b,
            const Int3& c) {
    const Int3 n = cross(b - a, c - a);
    if (dot(n, n) == 0) return 0;  // no area: no surface
    if (dot(front, a - p) <= 0 && dot(front, b - p) <= 0 && dot(front, c - p) <= 0) return 0;
    const Int top = dot(n, a - p), bottom = dot(n, d);  // crossing at s = top / bottom
    const auto corner = [&](int k) { return k % 3 == 0 ? a : k % 3 == 1 ? b : c; };
    if (bottom == 0) {
        if (top != 0) return 0;
        Int lo_n = 0, lo_d = 1, hi_n = 1, hi_d = infinite ? 0 : 1;  // 1/0 is infinity
        for (int k = 0; k < 3; ++k) {
            const Int3 inward = cross(n, corner(k + 1) - corner(k));
            const Int value = dot(inward, p - corner(k)), slope = dot(inward, d);  // inside where value + s slope >= 0
            if (slope == 0) {
                if (value < 0) return 0;
                continue;
            }
            const Int s_n = slope > 0 ? -value : value, s_d = slope > 0 ? slope : -slope;
            if (slope > 0 && s_n * lo_d > lo_n * s_d) lo_n = s_n, lo_d = s_d;
            if (slope < 0 && s_n * hi_d < hi_n * s_d) hi_n = s_n, hi_d = s_d;
        }
        const bool at_the_light = !infinite && lo_n == lo_d;
        return lo_n * hi_d <= hi_n * lo_d && !at_the_light ? 1 : 0;
    }
    const Int s_n = bottom > 0 ? top : -top, s_d = bottom > 0 ? bottom : -bottom;
    if (s_n < 0 || (!infinite && s_n >= s_d)) return 0;
    Int3 hit;  // times s_d
    for (std::size_t k = 0; k < 3; ++k) hit[k] = p[k] * s_d + d[k] * s_n;
    int on_edge = 0;
    for (int k = 0; k < 3; ++k) {
        Int3 from_corner;
        for (std::size_t j = 0; j < 3; ++j) from_corner[j] = hit[j] - corner(k)[j] * s_d;
        const Int inside = dot(n, cross(corner(k + 1) - corner(k), from_corner));
        if (inside < 0) return 0;
        on_edge += inside == 0;
    }
    return on_edge > 0 || s_n == 0 ? 1 : 2;
}

struct Counts {
    int points = 0, blocked = 0, touched = 0, at_seams = 0;
};

/// How many of some lights beside this one are lit.
int lit_beside(const Scene& scene, TriangleId own, const Int3& p, const Int3& d, bool infinite, const Int3& front) {
    int lit = 0;
    for (int way = 0; way < 27; ++way) {
        if (way == 13) continue;
        // Not along axes and diagonals, where edges lie.
        const Int3 moved{d[0] + 5 * (way % 3 - 1) + 2, d[1] + 7 * (way / 3 % 3 - 1) + 1, d[2] + 11 * (way / 9 - 1) - 3};
        int met = 0;
        for (TriangleId t = 0; t < scene.triangles.size(); ++t)
            if (t != own)
                met = std::max(met, meeting(p, moved, infinite, front, whole(dvec3(scene.vertex(t, 0))),
                                            whole(dvec3(scene.vertex(t, 1))), whole(dvec3(scene.vertex(t, 2)))));
        lit += met == 0;
    }
    return lit;
}

/// Random points on a small lattice scene against exact; every light is placed where it meets vertices, edges and
/// planes.
Counts compare_with_brute_force(unsigned seed, std::string_view choice) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> lattice(-3, 3), eighth(0, 8), pick(0, 99);
    const auto lattice_point = [&] {
        return vec3(static_cast<float>(lattice(random)), static_cast<float>(lattice(random)),
                    static_cast<float>(lattice(random)));
    };
    Scene scene;
    scene.materials.emplace_back();
    const Mesh box = make_box(vec3(2, 2, 2));
    add_object(scene, "box", box.positions, {}, box.triangles, 0);
    std::vector<vec3> soup;
    std::vector<uvec3> triangles;
    while (triangles.size() < 12) {
        const vec3 a = lattice_point(), b = lattice_point(), c = lattice_point();
        if (glm::length(glm::cross(b - a, c - a)) == 0) continue;
        const auto k = static_cast<std::uint32_t>(soup.size());
        soup.insert(soup.end(), {a, b, c});
        triangles.emplace_back(k, k + 1, k + 2);
    }
    triangles.push_back(triangles.back());  // a duplicate
    triangles.emplace_back(0, 0, 1);        // no area at all
    add_object(scene, "soup", soup, {}, triangles, 0);
    for (int k = 0; k < 6; ++k) {
        Light& light    = scene.lights.emplace_back();
        light.kind      = k % 3 == 0 ? LightKind::directional : k % 3 == 1 ? LightKind::point : LightKind::spot;
        light.position  = lattice_point();
        light.direction = lattice_point();
        while (light.direction == vec3(0)) light.direction = lattice_point();
    }

    PointBatch batch;
    batch.eye = vec3(1, 7, 2);
    batch.resize(400);
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const auto t = static_cast<TriangleId>(static_cast<std::size_t>(pick(random)) % scene.triangles.size());
        const int u = eighth(random), v = std::min(eighth(random), 8 - u);
        set_point(batch, i, scene, t, static_cast<float>(u) / 8, static_cast<float>(v) / 8);
    }
    face_lights(batch, scene);

    Asked method(choice);
    const SceneFacts facts = find_facts(scene);
    EXPECT_EQ(method.serves(facts).how, How::exactly);
    method.build(scene, facts);
    Counts counts;
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        const Light& light = scene.lights[j];
        method.aim(j);
        const VisibilityPlane plane = method.visibility(batch, j);
        const std::vector<float>& s = plane.s;
        const bool infinite         = light.kind == LightKind::directional;
        for (std::size_t i = 0; i < batch.size(); ++i) {
            if (batch.facing[j][i] != Facing::front) {
                EXPECT_EQ(s[i], 0.0f);
                continue;
            }
            const TriangleId own = batch.triangle[i];
            const dvec3 a(scene.vertex(own, 0)), b(scene.vertex(own, 1)), c(scene.vertex(own, 2));
            const Int3 p = whole(a + double(batch.u[i]) * (b - a) + double(batch.v[i]) * (c - a));
            const Int3 d = infinite ? whole(-dvec3(light.direction)) : whole(dvec3(light.position)) - p;
            const Int3 n = cross(whole(b) - whole(a), whole(c) - whole(a));
            Int3 front   = n;
            if (dot(n, d) < 0)
                for (Int& x : front) x = -x;
            int met = 0;
            for (TriangleId t = 0; t < scene.triangles.size(); ++t)
                if (t != own)
                    met = std::max(met, meeting(p, d, infinite, front, whole(dvec3(scene.vertex(t, 0))),
                                                whole(dvec3(scene.vertex(t, 1))), whole(dvec3(scene.vertex(t, 2)))));
            const bool at_seam = met == 1 && plane.answer[i] == Answer::given;
            if (met != 1) {
                EXPECT_EQ(s[i], met == 2 ? 0.0f : 1.0f) << "seed " << seed << " light " << j << " point " << i;
                EXPECT_EQ(plane.answer[i], Answer::given) << "seed " << seed << " light " << j << " point " << i;
            }
            if (at_seam) {
                EXPECT_EQ(s[i], 0) << "seed " << seed << " light " << j << " point " << i;
                EXPECT_EQ(lit_beside(scene, own, p, d, infinite, front), 0)
                    << "seed " << seed << " light " << j << " point " << i;
            }
            counts.at_seams += at_seam;
            ++counts.points;
            counts.blocked += met == 2;
            counts.touched += met == 1;
        }
    }
    return counts;
}

TEST(Exact, AgreesWithBruteForceInWholeNumbers) {
    for (const char* choice : {"exact:hard_lights=segments", "exact:hard_lights=bins"}) {
        Counts all;
        for (unsigned seed = 1; seed <= 60; ++seed) {
            const Counts counts = compare_with_brute_force(seed, choice);
            all.points += counts.points;
            all.blocked += counts.blocked;
            all.touched += counts.touched;
            all.at_seams += counts.at_seams;
        }
        // The scenes must be as nasty as they are meant to be, or the agreement says little.
        EXPECT_GT(all.points, 40000) << choice;
        EXPECT_GT(all.blocked, 8000) << choice;
        EXPECT_GT(all.points - all.blocked - all.touched, 4000) << choice;
        EXPECT_GT(all.touched, 2000) << choice;
        EXPECT_GT(all.at_seams, 100) << choice;
    }
}

TEST(Exact, MovesWithTheSceneByPowersOfTwo) {
    // Everything times 2^k, and everything far away on the same lattice: not a bit may change.
    const auto plane = [](float scale, vec3 shift) {
        Scene scene;
        scene.materials.emplace_back();
        Mesh sphere      = make_sphere(1, 24, 12);
        const Mesh floor = make_plane(8, 8);
        for (const auto& [mesh, lift] : {std::pair<const Mesh&, float>{sphere, 1.5f}, {floor, 0.0f}}) {
            std::vector<vec3> positions = mesh.positions;
            for (vec3& p : positions) {
                p = glm::round((p + vec3(0, lift, 0)) * 256.0f) / 256.0f;  // coarse, so that the shift is exact
                p = p * scale + shift;
            }
            add_object(scene, "body", positions, {}, mesh.triangles, 0);
        }
        scene.lights.emplace_back().position = vec3(2, 5, 1) * scale + shift;
        PointBatch batch;
        batch.eye = vec3(0, 9, 0) * scale + shift;
        batch.resize(4000);
        std::mt19937 random(5);
        std::uniform_real_distribution<float> u(0, 1);
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const auto t = static_cast<TriangleId>(i % 3 == 0 ? random() % scene.triangles.size()
                                                              : scene.triangles.size() - 1 - i % 2);
            set_point(batch, i, scene, t, u(random), u(random));
        }
        face_lights(batch, scene);
        Asked method("exact");
        method.build(scene);
        method.aim(0);
        return method.visibility(batch, 0).s;
    };
    const std::vector<float> here = plane(1, vec3(0));
    EXPECT_EQ(here, plane(0x1p-60f, vec3(0)));
    EXPECT_EQ(here, plane(0x1p+40f, vec3(0)));
    EXPECT_EQ(here, plane(1, vec3(16384, -8192, 4096)));
    EXPECT_GT(std::count(here.begin(), here.end(), 0.0f), 200);
    EXPECT_GT(std::count(here.begin(), here.end(), 1.0f), 200);
}

}  // namespace
}  // namespace umbra
