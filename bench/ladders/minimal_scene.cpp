#include "umbra/bench/ladders/ladder_break.h"

#include <algorithm>
#include <numeric>

namespace umbra {
namespace {

/// The scene with these triangles alone, in their objects; objects without any are gone, and so are unused positions.
Scene with_triangles(const Scene& whole, const std::vector<TriangleId>& kept) {
    Scene part = whole;
    part.positions.clear(), part.normals.clear(), part.triangles.clear(), part.triangle_object.clear();
    part.objects.clear();
    for (auto first = kept.begin(); first != kept.end();) {
        const std::uint32_t o = whole.triangle_object[*first];
        const auto last = std::find_if(first, kept.end(), [&](TriangleId t) { return whole.triangle_object[t] != o; });
        std::vector<std::uint32_t> used;  // in order, so that the parts of a part are the same as of the whole
        for (auto t = first; t != last; ++t)
            for (int k = 0; k < 3; ++k) used.push_back(whole.triangles[*t][k]);
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
        std::vector<vec3> positions, normals;
        for (const std::uint32_t p : used) {
            positions.push_back(whole.positions[p]);
            normals.push_back(whole.normals[p]);
        }
        std::vector<uvec3> triangles;
        for (auto t = first; t != last; ++t) {
            uvec3 corners;
            for (int k = 0; k < 3; ++k)
                corners[k] = static_cast<std::uint32_t>(
                    std::lower_bound(used.begin(), used.end(), whole.triangles[*t][k]) - used.begin());
            triangles.push_back(corners);
        }
        const auto added =
            add_object(part, whole.objects[o].name, positions, normals, triangles, whole.objects[o].material);
        part.objects[added].switches = whole.objects[o].switches;
        first                        = last;
    }
    return part;
}

std::vector<TriangleId> all_triangles(const Scene& scene) {
    std::vector<TriangleId> all(scene.triangles.size());
    std::iota(all.begin(), all.end(), TriangleId{0});
    return all;
}

}  // namespace

Scene minimal_scene(Scene scene, const std::function<bool(const Scene&)>& still, int trials) {
    const auto take = [&](Scene&& smaller) {
        if (trials <= 0) return false;
        --trials;
        if (!still(smaller)) return false;
        scene = std::move(smaller);
        return true;
    };
    for (std::size_t j = 0; j < scene.lights.size() && scene.lights.size() > 1;) {
        Scene without = scene;
        without.lights.erase(without.lights.begin() + std::ptrdiff_t(j));
        if (!take(std::move(without))) ++j;
    }
    for (std::uint32_t o = 0; o < scene.objects.size() && scene.objects.size() > 1;) {
        std::vector<TriangleId> kept;
        for (const TriangleId t : all_triangles(scene))
            if (scene.triangle_object[t] != o) kept.push_back(t);
        if (!take(with_triangles(scene, kept))) ++o;
    }
    // Ever smaller runs of triangles; as long as any of one length could go, that length again.
    for (std::size_t length = scene.triangles.size() / 2; length >= 1 && trials > 0;) {
        bool dropped = false;
        for (std::size_t first = 0; first < scene.triangles.size() && scene.triangles.size() > 1;) {
            std::vector<TriangleId> kept = all_triangles(scene);
            const std::size_t last       = std::min(first + length, kept.size());
            kept.erase(kept.begin() + std::ptrdiff_t(first), kept.begin() + std::ptrdiff_t(last));
            if (!kept.empty() && take(with_triangles(scene, kept)))
                dropped = true;
            else
                first += length;
            if (trials <= 0) break;
        }
        if (!dropped) length /= 2;
    }
    return scene;
}

}  // namespace umbra
