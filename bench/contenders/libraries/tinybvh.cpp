/* tinybvh: the loop of embree.c over the trees of https://github.com/jbikker/tinybvh, version 1.6: float, hand-written
 * vector instructions, and none of Embree's care for rays that touch.
 *
 * Needs tiny_bvh.h (MIT; one file, in no distribution): cmake -D TINYBVH=/folder/of/it. On x86-64 it is compiled for
 * AVX2 and FMA (processors since 2013); elsewhere the layouts that need them are not offered.
 *
 * Traps: a ray has an end, but its start is always 0, so that tnear moves its origin, which rounds once more; triangles
 * of less than about 1e-6 units of area are missed (an absolute bound on the determinant, of some layouts); BVH4_CPU and
 * BVH8_CPU divide by a reciprocal of some 22 bits; a scene without triangles ends the program; large trees are built
 * by threads of tinybvh's own. */
#define TINYBVH_IMPLEMENTATION
#include <tiny_bvh.h>

#include <exception>
#include <memory>
#include <vector>

#include "ray_loop.h"

namespace {

struct Tree : ray_tree {
    explicit Tree(const umbra_scene& scene) : ray_tree{} {
        for (std::size_t i = 0; i < scene.vertices; ++i) {
            const float* p = scene.positions + 3 * i;
            positions.emplace_back(p[0], p[1], p[2], 0.0f);
        }
        for (std::size_t i = 0; i < scene.triangles; ++i)
            if (scene.blocks[i] != 0) corners.insert(corners.end(), scene.corners + 3 * i, scene.corners + 3 * i + 3);
    }
    virtual ~Tree() = default;

    std::vector<tinybvh::bvhvec4> positions;  // the trees keep pointers to both
    std::vector<std::uint32_t> corners;
};

template <class Bvh>
struct TreeOf : Tree {
    explicit TreeOf(const umbra_scene& scene) : Tree(scene) {
        occluded = [](const ray_tree*, const ray_segment*) { return 0; };
        if (corners.empty()) return;
        bvh.Build(positions.data(), corners.data(), static_cast<std::uint32_t>(corners.size() / 3));
        occluded = [](const ray_tree* self, const ray_segment* r) {
            const ray_vec from = ray_plus(r->from, r->start, r->direction);
            const tinybvh::Ray ray({from.x, from.y, from.z}, {r->direction.x, r->direction.y, r->direction.z},
                                   r->end - r->start);
            return static_cast<int>(static_cast<const TreeOf*>(self)->bvh.IsOccluded(ray));
        };
    }

    Bvh bvh;
};

template <class Bvh>
std::unique_ptr<Tree> tree_of(const umbra_scene& scene) {
    return std::make_unique<TreeOf<Bvh>>(scene);
}

// Parallel to the choices of `layout`.
constexpr std::unique_ptr<Tree> (*kLayouts[])(const umbra_scene&) = {
    tree_of<tinybvh::BVH>,
#ifdef BVH_USEAVX2
    tree_of<tinybvh::BVH_SoA>,
    tree_of<tinybvh::BVH4_CPU>,
    tree_of<tinybvh::BVH8_CPU>,
#define LAYOUTS "BVH|BVH_SoA|BVH4_CPU|BVH8_CPU"
#else
#define LAYOUTS "BVH"
#endif
};

int build(const umbra_question* question, void** built, char* why) {
    try {
        const auto layout = static_cast<std::size_t>(question->settings[RAY_PARAMETERS].number);
        *built            = static_cast<ray_tree*>(kLayouts[layout](*question->scene).release());
        return 1;
    } catch (const std::exception& e) {
        return umbra_fail(why, e.what());
    }
}

void drop_built(void* built) { delete static_cast<Tree*>(static_cast<ray_tree*>(built)); }

constexpr umbra_parameter kParameters[] = {
    RAY_LOOP_PARAMETERS,
    {"layout", "BVH", 0, 0, LAYOUTS, "The class of tinybvh: two, four or eight boxes a node.", LAYOUTS, "build",
     UMBRA_CHOICE},
};

#define TEXT_OF(x) #x
#define VERSION(a, b, c) TEXT_OF(a) "." TEXT_OF(b) "." TEXT_OF(c)

}  // namespace

const umbra_contender_info* umbra_contender() {
    static constexpr umbra_contender_info info = {
        .version         = UMBRA_CONTENDER_VERSION,
        .lights          = UMBRA_HARD | UMBRA_RECTANGLE | UMBRA_DISK | UMBRA_SPHERE,
        .flags           = UMBRA_THREADS,
        .parameter_count = std::size(kParameters),
        .parameters      = kParameters,
        .name            = "tinybvh",
        .title           = "tinybvh",
        .release         = VERSION(TINY_BVH_VERSION_MAJOR, TINY_BVH_VERSION_MINOR, TINY_BVH_VERSION_SUB),
        .summary         = "BVH::IsOccluded for each ray, in float, with an epsilon.",
        .seed            = "seed",
        .build           = build,
        .aim             = nullptr,
        .look            = nullptr,
        .visibility      = ray_visibility,
        .drop_built      = drop_built,
        .drop_aimed      = nullptr,
        .drop_looked     = nullptr,
    };
    return &info;
}
