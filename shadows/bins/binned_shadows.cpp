#include "umbra/shadows/bins/binned_shadows.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <mutex>
#include <optional>

#include "umbra/core/base/parallel.h"
#include "umbra/shadows/bins/point_bins.h"
#include "umbra/shadows/bins/shadow_planes.h"
#include "umbra/shadows/geometry/exact_contacts.h"
#include "umbra/shadows/geometry/triangle_tree.h"

namespace umbra {
namespace {

using namespace bins;
using exact_visibility::Contacts;
using exact_visibility::ExactPoint;
using exact_visibility::Segment;

/// Blocks are requested from memory this many before they are tested.
constexpr std::size_t kAhead = 4;

/// Blocks that are enough for several threads.
constexpr std::size_t kMany = 8192;

}  // namespace

/// Eight triangles that follow one another in order_, or as many as there are.
struct BinnedShadows::Group {
    std::span<const TriangleId> triangles{};
    LightImage::Corners corners;
    LightImage::Windings windings{};
    Extents extents;
    unsigned within = 0;  ///< those that have an extent, because they lie in one face

    [[nodiscard]] unsigned all() const { return (1u << triangles.size()) - 1; }
    /// At least half of them do.
    [[nodiscard]] bool faces_light() const {
        return 2 * static_cast<std::size_t>(std::popcount(windings.towards & all())) >= triangles.size();
    }
};

/// Results of a search, kept for their memory.
struct BinnedShadows::Search {
    PointBins::Start start{};
    std::vector<PointBins::Found> found{};
};

/// The points that ask, in the light's image.
struct BinnedShadows::Picture {
    const Light* light;
    LightImage image;
    BinnedPoints asking;
    std::mutex mutex{};            ///< of `touches`
    std::vector<Touch> touches{};  ///< that were found, some of them twice

    /// From any thread.
    void add(std::span<const Touch> found) {
        if (found.empty()) return;
        const std::lock_guard lock(mutex);
        touches.insert(touches.end(), found.begin(), found.end());
    }
};

namespace {

/// Which of the lanes in `unsure` triangle t hides, and which segments touch it.
struct Met {
    unsigned crossed = 0, touched = 0;
};
Met meet_exactly(const Scene& scene, const Light& light, TriangleId t, const PointBatch& points, const Block& block,
                 unsigned unsure) {
    Met met;
    for (unsigned rest = unsure; rest != 0; rest &= rest - 1) {
        const auto lane       = static_cast<std::size_t>(std::countr_zero(rest));
        const std::uint32_t i = block.index[lane];
        const ExactPoint point(scene, points, i);
        const auto meeting = Segment(point, light).meeting(scene, t);
        if (meeting == Segment::Meeting::crosses) met.crossed |= 1u << lane;
        if (meeting == Segment::Meeting::touches) met.touched |= 1u << lane;
    }
    return met;
}

/// The lanes of points that lie on the triangle, whose segments start there: floats are unsure of each of them, and
/// exact predicates would only say that they do not meet it.
unsigned lanes_on(const Block& block, TriangleId t) {
    unsigned lanes = 0;
    for (std::size_t i = 0; i < kLanes; ++i) lanes |= static_cast<unsigned>(block.triangle[i] == t) << i;
    return lanes;
}

}  // namespace

BinnedShadows::BinnedShadows(const Scene& scene) : scene_(scene), casts_(scene.triangles.size()) {
    parallel_ranges(casts_.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) casts_[t] = occludes(scene, static_cast<TriangleId>(t)) ? 1 : 0;
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
    parallel_ranges(bins.tiles(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t tile = begin; tile < end; ++tile)
            for (std::size_t b = bins.first(tile); b < bins.last(tile); ++b) {
                const unsigned crossed = bins.marks(b).crossed;
                for (std::size_t lane = 0; lane < kLanes; ++lane)
                    out.s[bins.block(b).index[lane]] = (crossed >> lane & 1u) != 0 ? 0.0f : 1.0f;
            }
    });
    for (const std::uint32_t i : picture.asking.next_to_light) out.s[i] = 1;
    each_next_to_light(picture, points, [&](std::uint32_t i, TriangleId) { out.s[i] = 0; });
    each_touched(
        picture, points, [&](std::uint32_t i) { return out.s[i] != 0; },
        [&](std::uint32_t i, TriangleId, Contacts::Together together) {
            out.s[i] = together.passed.x;
            if (!together.agreed) out.answer[i] = Answer::on_boundary;
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
    each_next_to_light(picture, points, [&](std::uint32_t i, TriangleId t) { blockers[i] = t; });
    each_touched(
        picture, points, [&](std::uint32_t i) { return blockers[i] == kNoTriangle; },
        [&](std::uint32_t i, TriangleId t, Contacts::Together together) {
            if (together.passed == vec3(0)) blockers[i] = t;
        });
}

BinnedShadows::Picture BinnedShadows::bin(const PointBatch& points, LightId light) const {
    const LightImage image(scene_.lights[light], centre_, reach_);
    return {&scene_.lights[light], image, bin_points(scene_, points, light, image, centre_)};
}

/// Points whose places are unknown against every triangle: calls crossed(i, t) for the first that is.
template <class Crossed>
void BinnedShadows::each_next_to_light(Picture& picture, const PointBatch& points, const Crossed& crossed) const {
    parallel_ranges(picture.asking.next_to_light.size(), 4, [&](std::size_t begin, std::size_t end) {
        std::vector<Touch> touches;
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t i = picture.asking.next_to_light[k];
            const ExactPoint point(scene_, points, i);
            const Segment segment(point, *picture.light);
            for (TriangleId t = 0; t < casts_.size(); ++t) {
                if (casts_[t] == 0 || t == points.triangle[i]) continue;
                const auto m = segment.meeting(scene_, t);
                if (m == Segment::Meeting::touches) touches.emplace_back(i, t);
                if (m != Segment::Meeting::crosses) continue;
                crossed(i, t);
                break;
            }
        }
        picture.add(touches);
    });
}

/// Calls met(i, t, together) for the touched points with asks(i): t is the first triangle that touches point i,
/// together the contacts of all that do.
template <class Asks, class Met>
void BinnedShadows::each_touched(Picture& picture, const PointBatch& points, const Asks& asks, const Met& met) const {
    std::vector<Touch>& touches = picture.touches;
    std::erase_if(touches, [&](const Touch& touch) { return !asks(touch.first); });
    std::sort(touches.begin(), touches.end());
    touches.erase(std::unique(touches.begin(), touches.end()), touches.end());
    std::vector<std::size_t> first;  // of each point
    for (std::size_t k = 0; k < touches.size(); ++k)
        if (k == 0 || touches[k].first != touches[k - 1].first) first.push_back(k);
    parallel_ranges(first.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            const std::uint32_t i = touches[first[f]].first;
            const ExactPoint point(scene_, points, i);
            const Segment segment(point, *picture.light);
            std::optional<Contacts> contacts;
            for (std::size_t k = first[f]; k < touches.size() && touches[k].first == i; ++k)
                add_contact(contacts, segment, scene_, touches[k].second);
            met(i, touches[first[f]].second, contacts->together());
        }
    });
}

/// Tests every triangle against the points that may be behind it. Calls crossed(i, t) where t hides point i. `once`:
/// hidden points are not tested again. Then triangles that face the light go first: they hide all points behind a
/// closed surface, and the others, which are behind the points that are still lit, find few.
template <class Crossed>
void BinnedShadows::cast_all(Picture& picture, const PointBatch& points, const Crossed& crossed, bool once) const {
    std::vector<std::uint8_t> later(eights_.size());
    const auto cast = [&](Which which) {
        parallel_ranges(eights_.size(), 64, [&](std::size_t begin, std::size_t end) {
            std::vector<Group> groups;
            Search search;
            for (std::size_t first = begin; first < end; first += kLanes) {
                groups.clear();
                for (std::size_t g = first; g < std::min(first + kLanes, end); ++g) {
                    if (which == Which::later && later[g] == 0) continue;
                    groups.push_back(group(g, picture));
                    if (which != Which::facing_light) continue;
                    later[g] = groups.back().faces_light() ? 0 : 1;
                    if (later[g] != 0) groups.pop_back();
                }
                if (!groups.empty()) cast_groups(groups, picture, points, crossed, once, search);
            }
        });
    };
    cast(once ? Which::facing_light : Which::all);
    if (!once) return;
    picture.asking.bins.drop_hidden();
    cast(Which::later);
}

BinnedShadows::Group BinnedShadows::group(std::size_t g, const Picture& picture) const {
    const std::size_t first = g * kLanes;
    Group made;
    made.triangles = std::span(order_).subspan(first, std::min<std::size_t>(kLanes, order_.size() - first));
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t axis = 0; axis < 3; ++axis)
            std::copy_n(eights_[g].corner[c][axis], kLanes, made.corners[c][axis]);
    made.windings = picture.image.windings(made.corners);
    made.within   = picture.image.extents(made.corners, made.extents) & made.all();
    return made;
}

/// For groups that follow one another: their searches begin together.
template <class Crossed>
void BinnedShadows::cast_groups(std::span<const Group> groups, Picture& picture, const PointBatch& points,
                                const Crossed& crossed, bool once, Search& search) const {
    Extent around = Extent::nothing();
    for (const Group& group : groups)
        for (unsigned rest = group.within; rest != 0; rest &= rest - 1)
            around.add(group.extents.at(static_cast<std::size_t>(std::countr_zero(rest))));
    picture.asking.bins.start(around, search.start);
    for (const Group& group : groups) {
        find(group, picture, search);
        if (!search.found.empty()) test(group, picture, points, crossed, once, search);
    }
}

void BinnedShadows::find(const Group& group, const Picture& picture, Search& search) const {
    const PointBins& bins = picture.asking.bins;
    search.found.clear();
    bins.find(group.extents, group.within, search.start, search.found);
    for (unsigned rest = group.all() & ~group.within; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
        std::array<dvec3, 3> corners;
        for (std::size_t c = 0; c < 3; ++c)
            corners[c] = {group.corners[c][0][lane], group.corners[c][1][lane], group.corners[c][2][lane]};
        for (int f = 0; f < picture.image.faces(); ++f) {
            const auto extent = picture.image.extent(f, corners);
            if (!extent) continue;
            Extents one;
            for (std::size_t k = 0; k < kLanes; ++k) one.clear(k);
            one.set(lane, *extent);
            bins.find(one, 1u << lane, search.found);
        }
    }
}

ShadowPlanes BinnedShadows::planes(const Group& group, const Picture& picture) const {
    LightImage::Corners near, travel;
    double turn[kLanes];
    for (std::size_t c = 0; c < 3; ++c)
        for (int axis = 0; axis < 3; ++axis)
            for (std::size_t i = 0; i < kLanes; ++i) near[c][axis][i] = group.corners[c][axis][i] - centre_[axis];
    picture.image.travel(group.corners, travel);
    for (std::size_t i = 0; i < kLanes; ++i) {
        const auto vertex = [&](std::size_t c) {
            return vec3(dvec3(group.corners[c][0][i], group.corners[c][1][i], group.corners[c][2][i]));
        };
        turn[i] = (group.windings.away >> i & 1u) != 0 ? 1.0
                  : (group.windings.towards >> i & 1u) != 0
                      ? -1.0
                      : -side_of_light(*picture.light, vertex(0), vertex(1), vertex(2));
    }
    return {near, travel, turn, picture.asking.reach};
}

/// Tests the triangles against the blocks that were found; where these are many, as behind a wall, from all threads.
template <class Crossed>
void BinnedShadows::test(const Group& group, Picture& picture, const PointBatch& points, const Crossed& crossed,
                         bool once, const Search& search) const {
    const PointBins& bins = picture.asking.bins;
    std::optional<ShadowPlanes> shadows;
    const auto test_found = [&](std::size_t begin, std::size_t end) {
        std::vector<Touch> touches;
        for (std::size_t f = begin; f < end; ++f) {
            const PointBins::Found found = search.found[f];
            if (f + kAhead < search.found.size()) bins.prefetch(search.found[f + kAhead].block);
            Marks& marks          = bins.marks(found.block);
            const unsigned hidden = once ? marks.crossed.load(std::memory_order_relaxed) : 0u;
            if (hidden == 0xff) continue;
            if (!shadows) shadows.emplace(planes(group, picture));
            const Block& block = bins.block(found.block);
            ShadowPlanes::InShadow lanes[kLanes];
            unsigned all = 0;
            for (unsigned rest = shadows->test(found.triangles, block, lanes); rest != 0; rest &= rest - 1) {
                const auto k       = static_cast<std::size_t>(std::countr_zero(rest));
                const TriangleId t = group.triangles[k];
                Met met;
                if (lanes[k].unsure != 0)
                    met = meet_exactly(scene_, *picture.light, t, points, block,
                                       lanes[k].unsure & ~hidden & ~lanes_on(block, t));
                met.crossed |= lanes[k].inside;
                all |= met.crossed;
                for (unsigned hit = met.touched; hit != 0; hit &= hit - 1)
                    touches.emplace_back(block.index[static_cast<std::size_t>(std::countr_zero(hit))], t);
                for (unsigned hit = met.crossed; hit != 0; hit &= hit - 1)
                    crossed(block.index[static_cast<std::size_t>(std::countr_zero(hit))], t);
            }
            if ((all & ~hidden) != 0) marks.crossed.fetch_or(static_cast<std::uint8_t>(all), std::memory_order_relaxed);
        }
        picture.add(touches);
    };
    if (search.found.size() < kMany) return test_found(0, search.found.size());
    shadows.emplace(planes(group, picture));
    parallel_ranges(search.found.size(), kMany / 4, test_found);
}

}  // namespace umbra
