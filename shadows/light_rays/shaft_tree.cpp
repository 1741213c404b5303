#include "umbra/shadows/light_rays/shaft_tree.h"

#include <algorithm>
#include <cstring>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/parallel.h"
#include "umbra/shadows/geometry/triangle_tree.h"

namespace umbra::rays {
namespace {

/// Bound of a height's error above a plane, in float and ray space, where coordinates are about 1; far below kWider.
constexpr float kRounding = 4e-6f;

using Floats = Lanes<float>;
using Masks  = Lanes<std::int32_t>;

// By reference: processors differ in how they pass and return eight numbers.

void load(const float (&from)[8], Floats& to) { std::memcpy(&to, from, sizeof to); }

/// Sets the bits of the lanes that are above the plane.
void mark_above(Masks& above, float nx, float ny, float nz, float beyond, const float (&x)[8], const float (&y)[8],
                const float (&z)[8]) {
    Floats px, py, pz;
    load(x, px), load(y, py), load(z, pz);
    above = nx * px + ny * py + nz * pz > beyond;
}

/// Bit k: lane k is 0.
unsigned zeros(const Masks& masks) {
    const Masks bits = ~masks & Masks{1, 2, 4, 8, 16, 32, 64, 128};
    unsigned all     = 0;
    for (int k = 0; k < 8; ++k) all |= static_cast<unsigned>(bits[k]);
    return all;
}

std::vector<TriangleId> ordered(const Scene& scene) {
    std::vector<std::uint8_t> blocks(scene.triangles.size());
    for (TriangleId t = 0; t < blocks.size(); ++t) blocks[t] = scene.blocks(t) ? 1 : 0;
    return coherent_order(scene, blocks);
}

/// Boxes of `count` things, eight a node; of(k) is the box of thing k.
template <class Of>
std::vector<EightBoxes> boxes_of(std::size_t count, const Of& of) {
    std::vector<EightBoxes> nodes((count + 7) / 8);
    parallel_ranges(nodes.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n)
            for (std::size_t lane = 0; lane < 8; ++lane) nodes[n].set(lane, of(std::min(8 * n + lane, count - 1)));
    });
    return nodes;
}

EightBoxes::Bounds around(const EightTriangles& t) {
    Box box;
    for (int lane = 0; lane < 8; ++lane)
        for (int k = 0; k < 3; ++k) box = extend(box, vec3(t.x[k][lane], t.y[k][lane], t.z[k][lane]));
    return {box.min, box.max};
}

}  // namespace

void ShaftPlanes::add(dvec3 normal, double offset) {
    nx_[count_] = static_cast<float>(normal.x), ny_[count_] = static_cast<float>(normal.y);
    nz_[count_] = static_cast<float>(normal.z), beyond_[count_] = static_cast<float>(offset) + kRounding;
    ++count_;
}

UMBRA_FOR_EACH_PROCESSOR unsigned ShaftPlanes::may_meet(const EightBoxes& boxes) const {
    Masks outside{}, above{};
    for (std::size_t s = 0; s < count_; ++s) {
        // The corner that is lowest above the plane.
        const float nx = nx_[s], ny = ny_[s], nz = nz_[s];
        mark_above(above, nx, ny, nz, beyond_[s], nx > 0 ? boxes.low[0] : boxes.high[0],
                   ny > 0 ? boxes.low[1] : boxes.high[1], nz > 0 ? boxes.low[2] : boxes.high[2]);
        outside |= above;
    }
    return zeros(outside);
}

UMBRA_FOR_EACH_PROCESSOR unsigned ShaftPlanes::may_meet(const EightTriangles& t) const {
    Masks outside{}, a{}, b{}, c{};
    for (std::size_t s = 0; s < count_; ++s) {
        const float nx = nx_[s], ny = ny_[s], nz = nz_[s], beyond = beyond_[s];
        mark_above(a, nx, ny, nz, beyond, t.x[0], t.y[0], t.z[0]);
        mark_above(b, nx, ny, nz, beyond, t.x[1], t.y[1], t.z[1]);
        mark_above(c, nx, ny, nz, beyond, t.x[2], t.y[2], t.z[2]);
        outside |= a & b & c;
    }
    return zeros(outside);
}

ShaftTree::ShaftTree(const Scene& scene, const RaySpace& space) {
    const std::vector<TriangleId> order = ordered(scene);
    if (order.empty()) return;
    count_ = order.size();
    leaves_.resize((order.size() + 7) / 8);
    parallel_ranges(leaves_.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n)
            for (std::size_t lane = 0; lane < 8; ++lane) {
                const TriangleId t    = order[std::min(8 * n + lane, order.size() - 1)];
                EightTriangles& eight = leaves_[n];
                eight.id[lane]        = t;
                for (int k = 0; k < 3; ++k) {
                    const vec3 p     = space.point(scene.vertex(t, k));
                    eight.x[k][lane] = p.x, eight.y[k][lane] = p.y, eight.z[k][lane] = p.z;
                }
            }
    });
    levels_.push_back(boxes_of(leaves_.size(), [&](std::size_t k) { return around(leaves_[k]); }));
    while (levels_.back().size() > 1) {
        const std::vector<EightBoxes>& below = levels_.back();
        levels_.push_back(boxes_of(below.size(), [&](std::size_t k) { return below[k].bounds(); }));
    }
}

std::size_t ShaftTree::memory_bytes() const {
    std::size_t bytes = leaves_.capacity() * sizeof(EightTriangles);
    for (const auto& level : levels_) bytes += level.capacity() * sizeof(EightBoxes);
    return bytes;
}

}  // namespace umbra::rays
