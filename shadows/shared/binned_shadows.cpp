#include "umbra/shadows/shared/binned_shadows.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <optional>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/shared/binned_points.h"
#include "umbra/shadows/shared/coherent_order.h"
#include "umbra/shadows/shared/exact_segment.h"
#include "umbra/shadows/shared/shadow_planes.h"

namespace umbra {
namespace {

using namespace binned_shadows_detail;
using exact_detail::ExactPoint;
using exact_detail::Segment;

/// A triangle without area is no surface: it has no inside to cross and bounds no shadow.
bool blocks(const Scene& scene, TriangleId t) {
    return scene.blocks(t) && !is_degenerate(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
}

}  // namespace

/// The points that ask, in the light's image.
struct BinnedShadows::Picture {
    const Light* light;
    LightImage image;
    BinnedPoints asking;
};

namespace {

template <class Crossed>
void test_lanes(const Scene& scene, const Light& light, TriangleId t, const PointBatch& points, const Block& block,
                int unsure, std::uint8_t inside, Marks& marks, const Crossed& crossed) {
    std::uint8_t hit = inside, touched = 0;
    for (auto rest = static_cast<unsigned>(unsure); rest != 0; rest &= rest - 1) {
        const auto lane       = static_cast<std::size_t>(std::countr_zero(rest));
        const std::uint32_t i = block.index[lane];
        if (points.triangle[i] == t) continue;
        const ExactPoint point(scene, points.triangle[i], points.u[i], points.v[i]);
        const auto meeting = Segment(point, light).meeting(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
        if (meeting == Segment::Meeting::crosses) hit |= static_cast<std::uint8_t>(1u << lane);
        if (meeting == Segment::Meeting::touches) touched |= static_cast<std::uint8_t>(1u << lane);
    }
    if (hit != 0) marks.crossed.fetch_or(hit, std::memory_order_relaxed);
    if (touched != 0) marks.touched.fetch_or(touched, std::memory_order_relaxed);
    for (unsigned rest = hit; rest != 0; rest &= rest - 1)
        crossed(block.index[static_cast<std::size_t>(std::countr_zero(rest))], t);
}

}  // namespace

BinnedShadows::BinnedShadows(const Scene& scene) : scene_(&scene), casts_(scene.triangles.size()) {
    parallel_ranges(casts_.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) casts_[t] = blocks(scene, static_cast<TriangleId>(t)) ? 1 : 0;
    });
    if (scene.triangles.empty()) return;
    order_ = coherent_order(scene, casts_);
    eights_.resize((order_.size() + kLanes - 1) / kLanes);
    parallel_ranges(eights_.size(), 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = kLanes * begin; k < std::min(kLanes * end, order_.size()); ++k)
            for (int c = 0; c < 3; ++c)
                for (int axis = 0; axis < 3; ++axis)
                    eights_[k / kLanes].corner[c][axis][k % kLanes] = scene.vertex(order_[k], c)[axis];
    });
    const Box box       = bounds(scene);
    centre_             = 0.5 * (dvec3(box.min) + dvec3(box.max));
    const dvec3 corners = glm::max(glm::abs(dvec3(box.min)), glm::abs(dvec3(box.max)));
    reach_              = std::max({corners.x, corners.y, corners.z});
}

void BinnedShadows::visibility(const PointBatch& points, LightId light, Visibility out) const {
    Picture picture = bin(points, light);
    cast_all(picture, points, [](std::uint32_t, TriangleId) {});
    const PointBins& bins = picture.asking.bins;
    parallel_ranges(bins.blocks(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            const unsigned crossed = bins.marks(b).crossed, touched = bins.marks(b).touched;
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const std::uint32_t i = bins.block(b).index[lane];
                out.s[i]              = (crossed >> lane & 1u) != 0 ? 0.0f : 1.0f;
                if ((touched & ~crossed) >> lane & 1u) out.answer[i] = Answer::on_boundary;
            }
        }
    });
    for (const std::uint32_t i : picture.asking.next_to_light) out.s[i] = 1;
    each_next_to_light(picture, points, [&](std::uint32_t i, TriangleId, Segment::Meeting meeting) {
        if (meeting == Segment::Meeting::crosses) out.s[i] = 0, out.answer[i] = Answer::given;
        if (meeting == Segment::Meeting::touches) out.answer[i] = Answer::on_boundary;
        return meeting != Segment::Meeting::crosses;
    });
}

void BinnedShadows::blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const {
    std::vector<std::atomic<TriangleId>> lowest(points.size());
    for (auto& t : lowest) t = kNoTriangle;
    Picture picture = bin(points, light);
    cast_all(
        picture, points,
        [&](std::uint32_t i, TriangleId t) {
            TriangleId known = lowest[i];
            while (t < known && !lowest[i].compare_exchange_weak(known, t)) {
            }
        },
        false);
    for (std::size_t i = 0; i < points.size(); ++i) blockers[i] = lowest[i];
    each_next_to_light(picture, points, [&](std::uint32_t i, TriangleId t, Segment::Meeting meeting) {
        if (meeting == Segment::Meeting::crosses) blockers[i] = t;
        return meeting != Segment::Meeting::crosses;
    });
}

BinnedShadows::Picture BinnedShadows::bin(const PointBatch& points, LightId light) const {
    const LightImage image(scene_->lights[light], centre_, reach_);
    return {&scene_->lights[light], image, bin_points(*scene_, points, light, image, centre_)};
}

/// Points whose places are unknown against every triangle: calls met(i, t, meeting) until that is false.
template <class Met>
void BinnedShadows::each_next_to_light(const Picture& picture, const PointBatch& points, const Met& met) const {
    parallel_ranges(picture.asking.next_to_light.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t i = picture.asking.next_to_light[k];
            const ExactPoint point(*scene_, points.triangle[i], points.u[i], points.v[i]);
            const Segment segment(point, *picture.light);
            for (TriangleId t = 0; t < casts_.size(); ++t)
                if (casts_[t] != 0 && t != points.triangle[i] &&
                    !met(i, t, segment.meeting(scene_->vertex(t, 0), scene_->vertex(t, 1), scene_->vertex(t, 2))))
                    break;
        }
    });
}

/// Tests every triangle against the points that may be behind it. Calls crossed(i, t) where t hides point i.
/// `once`: points that are hidden already need not be tested again. Then triangles that face the light go first: what
/// is behind a closed surface is hidden by them, and the others, which are behind the points that are still lit, find
/// few.
template <class Crossed>
void BinnedShadows::cast_all(Picture& picture, const PointBatch& points, const Crossed& crossed, bool once) const {
    const std::size_t groups = eights_.size();
    std::vector<std::uint8_t> later(groups);
    parallel_ranges(groups, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t g = begin; g < end; ++g)
            later[g] = !cast(g, once ? Which::facing_light : Which::all, picture, points, crossed, once);
    });
    if (!once) return;
    picture.asking.bins.drop_hidden();
    parallel_ranges(groups, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t g = begin; g < end; ++g)
            if (later[g] != 0) cast(g, Which::all, picture, points, crossed, once);
    });
}

/// The triangles from order_[8 group] on, eight or as many as there are. Does nothing and returns false where `which`
/// is of those that face the light and most do not.
template <class Crossed>
bool BinnedShadows::cast(std::size_t group, Which which, const Picture& picture, const PointBatch& points,
                         const Crossed& crossed, bool once) const {
    const std::size_t first = group * kLanes;
    const auto own          = std::span(order_).subspan(first, std::min(kLanes, order_.size() - first));
    const Eight& eight      = eights_[group];
    LightImage::Corners corners;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t axis = 0; axis < 3; ++axis) std::copy_n(eight.corner[c][axis], kLanes, corners[c][axis]);
    const unsigned casting              = (1u << own.size()) - 1;
    const LightImage::Windings windings = picture.image.windings(corners);
    if (which == Which::facing_light &&
        2 * static_cast<std::size_t>(std::popcount(windings.towards & casting)) < own.size())
        return false;
    const auto corners_of = [&](std::size_t lane) {
        std::array<dvec3, 3> of;
        for (std::size_t c = 0; c < 3; ++c) of[c] = {corners[c][0][lane], corners[c][1][lane], corners[c][2][lane]};
        return of;
    };
    const auto planes_of_all = [&] {
        LightImage::Corners near, travel;
        double turn[kLanes];
        for (std::size_t c = 0; c < 3; ++c)
            for (int axis = 0; axis < 3; ++axis)
                for (std::size_t i = 0; i < kLanes; ++i) near[c][axis][i] = corners[c][axis][i] - centre_[axis];
        picture.image.travel(corners, travel);
        for (std::size_t i = 0; i < kLanes; ++i) {
            const auto vertex = [&](std::size_t c) {
                return vec3(eight.corner[c][0][i], eight.corner[c][1][i], eight.corner[c][2][i]);
            };
            turn[i] = (windings.away >> i & 1u) != 0 ? 1.0
                      : (windings.towards >> i & 1u) != 0
                          ? -1.0
                          : -side_of_light(*picture.light, vertex(0), vertex(1), vertex(2));
        }
        return ShadowPlanes(near, travel, turn, picture.asking.reach);
    };
    std::optional<ShadowPlanes> planes;
    const auto meet = [&](std::size_t lane, std::size_t b) {
        Marks& marks              = picture.asking.bins.marks(b);
        const std::uint8_t hidden = marks.crossed.load(std::memory_order_relaxed);
        if (once && hidden == 0xff) return;
        const TriangleId t = own[lane];
        if (!planes) planes = planes_of_all();
        const Block& block          = picture.asking.bins.block(b);
        const auto [inside, unsure] = planes->test(lane, block);
        test_lanes(*scene_, *picture.light, t, points, block, once ? unsure & ~hidden : unsure, inside, marks, crossed);
    };

    Extents extents;
    const unsigned within = picture.image.extents(corners, extents) & casting;
    for (unsigned rest = casting & ~within; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
        for (int f = 0; f < picture.image.faces(); ++f)
            if (const auto extent = picture.image.extent(f, corners_of(lane)))
                picture.asking.bins.visit(*extent, [&](std::size_t b, const Extent&) { meet(lane, b); });
    }
    // Triangles that are next to one another look for points together.
    Extent all;
    all.low_u = all.low_v = all.depth = Extents::kFar, all.high_u = all.high_v = -Extents::kFar;
    float sum = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        if ((within >> lane & 1u) == 0) {
            extents.clear(lane);
            continue;
        }
        const Extent extent = extents.at(lane);
        all.low_u = std::min(all.low_u, extent.low_u), all.high_u = std::max(all.high_u, extent.high_u);
        all.low_v = std::min(all.low_v, extent.low_v), all.high_v = std::max(all.high_v, extent.high_v);
        all.depth = std::min(all.depth, extent.depth);
        sum += extent.high_u - extent.low_u + (extent.high_v - extent.low_v);
    }
    if (all.high_u - all.low_u + (all.high_v - all.low_v) <= sum) {
        picture.asking.bins.visit(all, [&](std::size_t b, const Extent& box) {
            for (unsigned over = triangles_over(extents, box); over != 0; over &= over - 1)
                meet(static_cast<std::size_t>(std::countr_zero(over)), b);
        });
        return true;
    }
    for (unsigned rest = within; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
        picture.asking.bins.visit(extents.at(lane), [&](std::size_t b, const Extent&) { meet(lane, b); });
    }
    return true;
}

}  // namespace umbra
