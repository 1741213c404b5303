#include "umbra/shadows/shared/binned_shadows.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <memory>
#include <optional>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/shared/exact_segment.h"
#include "umbra/shadows/shared/point_bins.h"
#include "umbra/shadows/shared/shadow_planes.h"

namespace umbra {
namespace {

using namespace binned_shadows_detail;
using exact_detail::ExactPoint;
using exact_detail::Segment;

constexpr std::uint8_t kNowhere = 0xff;
constexpr std::size_t kPart     = 16384;  ///< points that one thread places at a time

/// A triangle without area is no surface: it has no inside to cross and bounds no shadow.
bool blocks(const Scene& scene, TriangleId t) {
    return scene.blocks(t) && !is_degenerate(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
}

}  // namespace

/// The points that ask, in the light's image.
struct BinnedShadows::Picture {
    const Light* light;
    LightImage image;
    std::vector<PointBins> faces{};
    std::vector<std::uint32_t> next_to_light{};  ///< points without a place
    dvec3 reach{0};                              ///< the largest magnitude of each coordinate, less the centre
};

namespace {

/// `side`: on which side of the triangle the light is, as side_of_light says.
ShadowPlanes planes_of(const std::array<dvec3, 3>& corners, const LightImage& image, dvec3 reach, dvec3 centre,
                       int side) {
    std::array<dvec3, 3> near, travel;
    for (std::size_t k = 0; k < 3; ++k) near[k] = corners[k] - centre, travel[k] = image.travel(corners[k]);
    if (side == 0) return ShadowPlanes::of_edge_on(near, reach);
    return {near, travel, static_cast<double>(-side), reach};
}

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
    const Box box = bounds(scene);
    if (scene.triangles.empty()) return;
    centre_             = 0.5 * (dvec3(box.min) + dvec3(box.max));
    const dvec3 corners = glm::max(glm::abs(dvec3(box.min)), glm::abs(dvec3(box.max)));
    reach_              = std::max({corners.x, corners.y, corners.z});
}

void BinnedShadows::visibility(const PointBatch& points, LightId light, Visibility out) const {
    const Picture picture = bin(points, light);
    const auto always     = [](std::uint32_t, TriangleId) {};
    cast_all(picture, points, always);
    parallel_ranges(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (points.asks(light, i)) out.s[i] = 1;
    });
    for (const PointBins& bins : picture.faces)
        parallel_ranges(bins.blocks(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t b = begin; b < end; ++b)
                for (std::size_t lane = 0; lane < kLanes; ++lane) {
                    const std::uint32_t i = bins.block(b).index[lane];
                    const auto bit        = 1u << lane;
                    if ((bins.marks(b).crossed & bit) != 0)
                        out.s[i] = 0;
                    else if ((bins.marks(b).touched & bit) != 0)
                        out.answer[i] = Answer::on_boundary;
                }
        });
    each_next_to_light(picture, points, [&](std::uint32_t i, TriangleId, Segment::Meeting meeting) {
        if (meeting == Segment::Meeting::crosses) out.s[i] = 0, out.answer[i] = Answer::given;
        if (meeting == Segment::Meeting::touches) out.answer[i] = Answer::on_boundary;
        return meeting != Segment::Meeting::crosses;
    });
}

void BinnedShadows::blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const {
    std::vector<std::atomic<TriangleId>> lowest(points.size());
    for (auto& t : lowest) t = kNoTriangle;
    const Picture picture = bin(points, light);
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
    const Light& lamp = scene_->lights[light];
    Picture picture{&lamp, LightImage(lamp, centre_, reach_)};
    // Pages of memory are first touched where they are filled, by all threads.
    const std::size_t n  = points.size();
    const auto positions = std::make_unique_for_overwrite<vec3[]>(n);
    const auto all       = std::make_unique_for_overwrite<PointBins::Entry[]>(n);
    const auto sorted    = std::make_unique_for_overwrite<PointBins::Entry[]>(n);
    const auto face      = std::make_unique_for_overwrite<std::uint8_t[]>(n);
    struct Part {
        std::array<std::size_t, 6> next{};  ///< points of each face; then where its next one goes
        std::vector<std::uint32_t> without{};
        vec3 reach{0};
    };
    std::vector<Part> parts((n + kPart - 1) / kPart);
    const auto each_part = [&](const auto& body) {
        parallel_ranges(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) body(parts[k], k * kPart, std::min(n, (k + 1) * kPart));
        });
    };
    each_part([&](Part& part, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            face[i] = kNowhere;
            if (!points.asks(light, i)) continue;
            const dvec3 p = exact_position(*scene_, points, i);
            positions[i]  = vec3(p - centre_);
            part.reach    = glm::max(part.reach, glm::abs(positions[i]));
            if (const auto place = picture.image.place(p)) {
                face[i] = static_cast<std::uint8_t>(place->face);
                all[i]  = {static_cast<float>(place->at.x), static_cast<float>(place->at.y),
                           static_cast<float>(place->depth), static_cast<std::uint32_t>(i)};
                ++part.next[face[i]];
            } else {
                part.without.push_back(static_cast<std::uint32_t>(i));
            }
        }
    });
    const auto faces = static_cast<std::size_t>(picture.image.faces());
    std::array<std::size_t, 7> first{};
    for (std::size_t f = 0; f < faces; ++f) {
        first[f + 1] = first[f];
        for (Part& part : parts) {
            const std::size_t count = part.next[f];
            part.next[f]            = first[f + 1];
            first[f + 1] += count;
        }
    }
    for (const Part& part : parts) {
        picture.next_to_light.insert(picture.next_to_light.end(), part.without.begin(), part.without.end());
        picture.reach = glm::max(picture.reach, dvec3(part.reach));
    }
    each_part([&](Part& part, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (face[i] != kNowhere) sorted[part.next[face[i]]++] = all[i];
    });
    for (std::size_t f = 0; f < faces; ++f) {
        const std::size_t count = first[f + 1] - first[f];
        picture.faces.emplace_back(std::span(sorted.get() + first[f], count), std::span(all.get() + first[f], count),
                                   std::span(positions.get(), n));
    }
    return picture;
}

/// Points whose places are unknown against every triangle: calls met(i, t, meeting) until that is false.
template <class Met>
void BinnedShadows::each_next_to_light(const Picture& picture, const PointBatch& points, const Met& met) const {
    parallel_ranges(picture.next_to_light.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t i = picture.next_to_light[k];
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
/// `once`: points that are hidden already need not be tested again.
template <class Crossed>
void BinnedShadows::cast_all(const Picture& picture, const PointBatch& points, const Crossed& crossed,
                             bool once) const {
    parallel_ranges(casts_.size(), 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            if (casts_[t] != 0) cast(static_cast<TriangleId>(t), picture, points, crossed, once);
    });
}

template <class Crossed>
void BinnedShadows::cast(TriangleId t, const Picture& picture, const PointBatch& points, const Crossed& crossed,
                         bool once) const {
    const std::array<dvec3, 3> corners{dvec3(scene_->vertex(t, 0)), dvec3(scene_->vertex(t, 1)),
                                       dvec3(scene_->vertex(t, 2))};
    std::optional<ShadowPlanes> planes;
    for (int f = 0; f < picture.image.faces(); ++f) {
        const PointBins& bins = picture.faces[static_cast<std::size_t>(f)];
        if (bins.blocks() == 0) continue;
        const std::optional<Extent> extent = picture.image.extent(f, corners);
        if (!extent) continue;
        bins.visit(*extent, [&](std::size_t b) {
            Marks& marks              = bins.marks(b);
            const std::uint8_t hidden = marks.crossed.load(std::memory_order_relaxed);
            if ((once && hidden == 0xff) || !ShadowPlanes::any_in(*extent, bins.block(b))) return;
            if (!planes) {
                const int side =
                    side_of_light(*picture.light, scene_->vertex(t, 0), scene_->vertex(t, 1), scene_->vertex(t, 2));
                planes = planes_of(corners, picture.image, picture.reach, centre_, side);
            }
            const auto [inside, unsure] = planes->test(bins.block(b));
            test_lanes(*scene_, *picture.light, t, points, bins.block(b), once ? unsure & ~hidden : unsure, inside,
                       marks, crossed);
        });
    }
}

}  // namespace umbra
