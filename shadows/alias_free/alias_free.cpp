// Alias-free shadows: not the scene is sampled as the light sees it, but the surface points that are asked are binned
// there, and every triangle is tested against the points in the bins that it covers. No tree, no bias, no resolution.
// Each test is a sign; where floats cannot tell it, the exact predicates do.
//
// This work is based on:
// Timo Aila, Samuli Laine. Alias-Free Shadow Maps. 2004
// Gregory Johnson, Juhyun Lee, Christopher Burns, William Mark. The Irregular Z-Buffer. 2005
// Chris Wyman, Rama Hoetzlein, Aaron Lefohn. Frustum-Traced Raster Shadows: Revisiting Irregular Z-Buffers. 2015
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <mutex>
#include <optional>
#include <vector>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/render/facing.h"
#include "umbra/shadows/alias_free/point_bins.h"
#include "umbra/shadows/alias_free/shadow_planes.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/shared/exact_segment.h"

namespace umbra {
namespace {

using namespace alias_free_detail;
using exact_detail::ExactPoint;
using exact_detail::Segment;

class AliasFree final : public Method {
public:
    void configure(const Settings&) override {}  // it has no parameters

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (!facts.hard_lights_only)
            return {How::not_at_all, "A point is in a triangle's shadow or not: no area lights."};
        return {How::exactly, "Signs in floats with a proven bound, and by exact predicates where it is too wide."};
    }

    void build(const Scene& scene, const SceneFacts&) override {
        scene_ = &scene;
        casts_.resize(scene.triangles.size());
        parallel_ranges(casts_.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                casts_[t] = scene.blocks(static_cast<TriangleId>(t)) ? 1 : 0;
            }
        });
        const Box box = bounds(scene);
        centre_       = scene.triangles.empty() ? dvec3(0) : 0.5 * (dvec3(box.min) + dvec3(box.max));
    }

    void aim(LightId light) override { light_ = &scene_->lights[light]; }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
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
    }

    /// Of the triangles that a point's segment crosses, the one of the lowest number.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override {
        std::vector<std::atomic<TriangleId>> lowest(points.size());
        for (auto& t : lowest) t = kNoTriangle;
        cast_all(
            bin(points, light), points,
            [&](std::uint32_t i, TriangleId t) {
                TriangleId known = lowest[i];
                while (t < known && !lowest[i].compare_exchange_weak(known, t)) {
                }
            },
            false);
        for (std::size_t i = 0; i < points.size(); ++i) blockers[i] = lowest[i];
    }

    [[nodiscard]] std::size_t memory_bytes() const override { return casts_.size(); }

private:
    /// The points that ask, in the light's image.
    struct Picture {
        LightImage image;
        std::vector<PointBins> faces;
        dvec3 reach{0};  ///< the largest magnitude of each coordinate, less the centre
        LightId light;
    };

    [[nodiscard]] Picture bin(const PointBatch& points, LightId light) const {
        Picture picture{LightImage(*light_, centre_), {}, dvec3(0), light};
        std::vector<vec3> positions(points.size());
        std::vector<PointBins::Entry> all(points.size());
        std::vector<std::uint8_t> face(points.size(), kNowhere);
        std::mutex mutex;
        parallel_ranges(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
            vec3 reach(0);
            for (std::size_t i = begin; i < end; ++i) {
                if (!points.asks(light, i)) continue;
                const dvec3 p = exact_position(*scene_, points, i);
                positions[i]  = vec3(p - centre_);
                reach         = glm::max(reach, glm::abs(positions[i]));
                if (const auto place = picture.image.place(p)) {
                    face[i] = static_cast<std::uint8_t>(place->face);
                    all[i]  = {static_cast<float>(place->at.x), static_cast<float>(place->at.y),
                               static_cast<float>(place->depth), static_cast<std::uint32_t>(i)};
                }
            }
            const std::lock_guard lock(mutex);
            picture.reach = glm::max(picture.reach, dvec3(reach));
        });
        std::vector<PointBins::Entry> of_face;
        for (int f = 0; f < picture.image.faces(); ++f) {
            of_face.clear();
            for (std::size_t i = 0; i < points.size(); ++i)
                if (face[i] == f) of_face.push_back(all[i]);
            picture.faces.emplace_back(of_face, positions);
        }
        return picture;
    }

    /// Tests every triangle against the points that may be behind it. Calls crossed(i, t) where t hides point i.
    /// `once`: points that are hidden already need not be tested again.
    template <class Crossed>
    void cast_all(const Picture& picture, const PointBatch& points, const Crossed& crossed, bool once = true) const {
        parallel_ranges(casts_.size(), 512, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t)
                if (casts_[t] != 0) cast(static_cast<TriangleId>(t), picture, points, crossed, once);
        });
    }

    template <class Crossed>
    void cast(TriangleId t, const Picture& picture, const PointBatch& points, const Crossed& crossed, bool once) const {
        const std::array<dvec3, 3> corners{dvec3(scene_->vertex(t, 0)), dvec3(scene_->vertex(t, 1)),
                                           dvec3(scene_->vertex(t, 2))};
        std::optional<ShadowPlanes> planes;
        bool is_edge_on = false;
        for (int f = 0; f < picture.image.faces() && !is_edge_on; ++f) {
            const PointBins& bins = picture.faces[static_cast<std::size_t>(f)];
            if (bins.blocks() == 0) continue;
            const std::optional<Extent> extent = picture.image.extent(f, corners);
            if (!extent) continue;
            bins.visit(*extent, [&](std::size_t b) {
                Marks& marks              = bins.marks(b);
                const std::uint8_t hidden = marks.crossed.load(std::memory_order_relaxed);
                if ((once && hidden == 0xff) || is_edge_on || !ShadowPlanes::any_in(*extent, bins.block(b))) return;
                if (!planes) {
                    const int side =
                        side_of_light(*light_, scene_->vertex(t, 0), scene_->vertex(t, 1), scene_->vertex(t, 2));
                    is_edge_on = side == 0;  // it hides nothing
                    if (is_edge_on) return;
                    planes = planes_of(corners, picture, -side);
                }
                const auto [inside, unsure] = planes->test(bins.block(b));
                test_lanes(t, points, bins.block(b), once ? unsure & ~hidden : unsure, inside, marks, crossed);
            });
        }
    }

    [[nodiscard]] ShadowPlanes planes_of(const std::array<dvec3, 3>& corners, const Picture& picture, int turn) const {
        std::array<dvec3, 3> near, travel;
        for (std::size_t k = 0; k < 3; ++k)
            near[k] = corners[k] - centre_, travel[k] = picture.image.travel(corners[k]);
        return {near, travel, static_cast<double>(turn), picture.reach};
    }

    template <class Crossed>
    void test_lanes(TriangleId t, const PointBatch& points, const Block& block, int unsure, std::uint8_t inside,
                    Marks& marks, const Crossed& crossed) const {
        std::uint8_t hit = inside, touched = 0;
        for (auto rest = static_cast<unsigned>(unsure); rest != 0; rest &= rest - 1) {
            const auto lane       = static_cast<std::size_t>(std::countr_zero(rest));
            const std::uint32_t i = block.index[lane];
            if (points.triangle[i] == t) continue;
            const ExactPoint point(*scene_, points.triangle[i], points.u[i], points.v[i]);
            const auto meeting =
                Segment(point, *light_).meeting(scene_->vertex(t, 0), scene_->vertex(t, 1), scene_->vertex(t, 2));
            if (meeting == Segment::Meeting::crosses) hit |= static_cast<std::uint8_t>(1u << lane);
            if (meeting == Segment::Meeting::touches) touched |= static_cast<std::uint8_t>(1u << lane);
        }
        if (hit != 0) marks.crossed.fetch_or(hit, std::memory_order_relaxed);
        if (touched != 0) marks.touched.fetch_or(touched, std::memory_order_relaxed);
        for (unsigned rest = hit; rest != 0; rest &= rest - 1)
            crossed(block.index[static_cast<std::size_t>(std::countr_zero(rest))], t);
    }

    static constexpr std::uint8_t kNowhere = 0xff;

    const Scene* scene_ = nullptr;
    const Light* light_ = nullptr;
    dvec3 centre_{0};
    std::vector<std::uint8_t> casts_;  ///< one a triangle: it blocks light
};

}  // namespace

extern const MethodInfo alias_free;
const MethodInfo alias_free{
    .name  = "alias_free",
    .title = "Alias-free shadows",
    .paper =
        "Timo Aila, Samuli Laine, Alias-Free Shadow Maps, 2004; Gregory Johnson et al., The Irregular Z-Buffer, 2005",
    .summary =
        "Bins the surface points that are asked in the light's image and tests every triangle against the points in "
        "the "
        "bins that it covers: exact, without a tree, a bias or a resolution. A sign that floats cannot tell is found "
        "by "
        "exact predicates. Limit: no area lights; every triangle is looked at for every picture.",
    .by_default = false,
    .shown_on   = {"sun_on_plane", "stairs", "interpenetrating", "self_shadow"},
    .create     = create<AliasFree>};

}  // namespace umbra
