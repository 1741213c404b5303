#include "umbra/shadows/maps/light_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/core/base/memory.h"

namespace umbra {
namespace {

constexpr double kWide      = 1.19175359;  // tan 50 degrees: beyond this one map wastes more than six
constexpr double kWideCone  = 1.7320509;   // tan 60 degrees, for a spot's own cone
constexpr double kFloatNear = 1e-6;        // near / far; reversed floats resolve any such ratio evenly
constexpr double kEpsilon   = std::numeric_limits<double>::epsilon();

/// Chooses the views of a light and fits them; their maps are empty.
class Fitting {
public:
    Fitting(const BuiltCasters& built, const SelectedCasters& casters, const Light& light,
            const LightViews::Options& options);

    std::vector<MapView> views;
    bool cover_all = true;

private:
    void fit_directional(dvec3 direction);
    void fit_around(const Light& light);
    /// Depth limits of a perspective window about the axis, with no geometry nearer to the light than `nearest`.
    void set_depth(LightFrame& frame, double nearest) const;
    void add_view(LightFrame frame, int resolution);
    /// A cleared map, in the memory of a spare one if it can be had.
    [[nodiscard]] DepthMap new_map(int resolution);

    const LightViews::Options& options_;
    const SelectedCasters& casters_;
    std::vector<DepthMap> spare_;
    double bytes_;  ///< of the casters, and of the maps so far
};

Fitting::Fitting(const BuiltCasters& built, const SelectedCasters& casters, const Light& light,
                 const LightViews::Options& options)
    : options_(options), casters_(casters), bytes_(static_cast<double>(built.memory_bytes())) {
    for (MapView& view : built.spare->exchange({})) {
        spare_.push_back(std::move(view.map));
        if (view.midpoint) spare_.push_back(std::move(*view.midpoint));
    }
    if (casters.box().empty()) return;
    if (light.kind == LightKind::directional)
        fit_directional(dvec3(light.direction));
    else
        fit_around(light);
}

void Fitting::fit_directional(dvec3 direction) {
    LightFrame frame = looking_along(dvec3(casters_.box().centre()), direction, false);
    fit_to_scene(frame, casters_, kInfinity);
    add_view(frame, options_.resolution);
}

void Fitting::fit_around(const Light& light) {
    const dvec3 origin(light.position);
    // Reversed floats resolve any distance from the light as well as any other, unorm depth does not.
    const double nearest = options_.format == DepthFormat::float32 ? 0 : casters_.distance(origin);
    LightFrame cube =
        looking_along(origin, light.kind == LightKind::spot ? dvec3(light.direction) : dvec3(0, 0, 1), true);
    int resolution = options_.resolution;
    if (light.kind == LightKind::spot) {
        const double rim = std::tan(static_cast<double>(light.spot.cutoff));
        LightFrame cone  = cube;
        if (rim > 0 && fit_to_scene(cone, casters_, std::min(rim, kWideCone))) return add_view(cone, resolution);
        if (rim > 0 && rim <= kWideCone) {
            cone.half = dvec2(rim);
            set_depth(cone, nearest);
            add_view(cone, resolution);
            cover_all = options_.surround > 0;
            if (!cover_all) return;
            resolution = static_cast<int>(std::ceil(std::max(options_.surround * resolution, 4 * options_.border)));
        }
    }
    const dvec3 to_scene = dvec3(casters_.box().centre()) - origin;
    if (views.empty() && glm::length(to_scene) > 0) {
        LightFrame whole = looking_along(origin, to_scene, true);
        if (fit_to_scene(whole, casters_, kWide)) return add_view(whole, resolution);
    }
    // Sides of the cube as even permutations and turns of one right-handed frame.
    const std::array<dvec3, 3> axes{cube.x, cube.y, cube.z};
    for (int k = 0; k < 3; ++k)
        for (double sign : {1.0, -1.0}) {
            LightFrame side = cube;
            side.x          = sign * axes[(k + 1) % 3];
            side.y          = axes[(k + 2) % 3];
            side.z          = sign * axes[k];
            set_depth(side, nearest);
            add_view(side, resolution);
        }
}

void Fitting::set_depth(LightFrame& frame, double nearest) const {
    const auto depth = casters_.ranges<1>([&](dvec3 p) { return std::array{frame.light_space(p).z}; });
    frame.far        = depth[0].max > 0 ? depth[0].max : 1;
    frame.near       = std::max(depth[0].min, nearest / std::sqrt(1 + glm::dot(frame.half, frame.half)));
}

void Fitting::add_view(LightFrame frame, int resolution) {
    const double inner = 1 - 2 * options_.border / resolution;
    frame.half /= inner;
    if (std::isfinite(frame.reach)) frame.reach = inner + 1e-3 / resolution;
    // Casters that are not fitted may lie before the near plane, where they are drawn as nearness 1: the points that
    // they shade must stay behind that when a bias has moved them.
    const double room = options_.headroom * 2 * std::max(frame.half.x, frame.half.y) / resolution;
    if (options_.all_depths)
        frame.near = std::min(frame.near, casters_.least_drawn([&](dvec3 p) { return frame.light_space(p).z; }));
    if (frame.perspective) {
        // A step of unorm depth at `far` must not exceed a sample's width there: near bounds that step.
        const double floor = options_.format == DepthFormat::float32
                                 ? kFloatNear
                                 : resolution * DepthMap(1, 1, options_.format).quantum(1) / 2;
        frame.near = std::min(std::max(frame.near * (1 - room), floor * frame.far), (1 - 64 * kEpsilon) * frame.far);
    } else {
        frame.near = std::min(frame.near, frame.far) - room;
    }
    // The scene's last depth is not nearness 0, where the steps of floats no longer tell how far they are rounded.
    frame.far += 0.01 * (frame.far - frame.near);
    if (casters_.seen_by(frame.clip_from_world()).empty()) return;
    const double bytes = (options_.midpoints ? 8.0 : 4.0) * resolution * resolution;
    if (bytes_ + bytes > options_.memory_limit)
        throw UsageError(
            fmt::format("{}: resolution={} takes more than half of the machine's memory "
                        "({:.0f} MiB a map, {} of them so far), expected a smaller one",
                        options_.method, options_.resolution, bytes / (1 << 20), views.size()));
    views.push_back({frame, new_map(resolution)});
    if (options_.midpoints) views.back().midpoint = new_map(resolution);
    bytes_ += bytes;
}

DepthMap Fitting::new_map(int resolution) {
    const auto fits  = [&](const DepthMap& m) { return m.width() == resolution && m.format() == options_.format; };
    const auto found = std::ranges::find_if(spare_, fits);
    if (found == spare_.end()) {
        spare_.clear();
        return {resolution, resolution, options_.format};
    }
    DepthMap map = std::move(*found);
    spare_.erase(found);
    map.clear();
    return map;
}

/// For a map of size x size samples, as wide as the view's, that shows one of these at (size / 2, size / 2).
dmat4 clip_around(const MapView& view, ivec2 sample, int size) {
    const double there = 1.0 / size;
    const dvec2 samples(view.map.width(), view.map.height());
    const dvec2 here = (2.0 * dvec2(sample) + 1.0) / samples - 1.0, scale = samples / static_cast<double>(size);
    dmat4 clip_from_world = view.frame.clip_from_world();
    for (int column = 0; column < 4; ++column) {
        dvec4& c = clip_from_world[column];
        c.x      = (c.x - here.x * c.w) * scale.x + there * c.w;
        c.y      = (c.y - here.y * c.w) * scale.y + there * c.w;
    }
    return clip_from_world;
}

}  // namespace

double LightViews::half_of_memory() { return 0.5 * usable_memory(); }

std::vector<TriangleId> owners(const MapView& view, const SelectedCasters& casters, Faces faces,
                               std::span<const std::size_t> samples) {
    static_assert(DepthMap::kNoOwner == kNoTriangle);
    const dmat4 clip_from_world = view.frame.clip_from_world();
    const Scene& scene          = casters.scene();
    return view.map.owners(clip_from_world, scene.positions, scene.triangles, casters.seen_by(clip_from_world), faces,
                           samples);
}

TriangleId owner(const MapView& view, const SelectedCasters& casters, Faces faces, ivec2 sample) {
    constexpr int kSize         = 8;
    const dmat4 clip_from_world = clip_around(view, sample, kSize);
    DepthMap around(kSize, kSize, view.map.format());
    const Scene& scene   = casters.scene();
    const auto triangles = casters.reaching(clip_from_world);
    around.draw(clip_from_world, scene.positions, triangles, faces);
    const std::size_t middle = kSize / 2 * kSize + kSize / 2;
    return around.owners(clip_from_world, scene.positions, scene.triangles, triangles, faces, {&middle, 1}).front();
}

void draw_around(MapView& view, const SelectedCasters& casters, Faces faces, ivec2 sample, int around) {
    // The whole map's own corners and spans, since others are rounded otherwise.
    view.map.draw(view.frame.clip_from_world(), casters.scene().positions,
                  casters.reaching(clip_around(view, sample, 2 * (around + 2))), faces);
}

LightViews::LightViews(const Built& from, LightId at, const Options& options)
    : Aimed(from, at),
      casters_(as<BuiltCasters>(from).casters, source()),
      spare_(as<BuiltCasters>(from).spare),
      faces_(options.faces) {
    Fitting fitting(as<BuiltCasters>(from), casters_, source(), options);
    views_     = std::move(fitting.views);
    cover_all_ = fitting.cover_all;
    rasterise();
}

LightViews::~LightViews() { (void)spare_->exchange(std::move(views_)); }

std::size_t LightViews::memory_bytes() const {
    std::size_t bytes = 0;
    for (const MapView& view : views_)
        bytes += view.map.memory_bytes() + (view.midpoint ? view.midpoint->memory_bytes() : 0);
    return bytes;
}

void LightViews::rasterise() {
    const std::vector<vec3>& positions = scene().positions;
    for (MapView& view : views_) {
        const dmat4 clip_from_world = view.frame.clip_from_world();
        const auto triangles        = casters_.seen_by(clip_from_world);
        view.map.draw(clip_from_world, positions, triangles, faces_);
        if (!view.midpoint) continue;
        // A surface that blocks nothing may be the second one: a box's lower side, on a floor.
        view.midpoint->draw_behind(view.map, clip_from_world, positions, casters_.seen_by(clip_from_world, true),
                                   faces_);
        const LightFrame& f = view.frame;
        view.midpoint->move_towards(view.map, [&f](double first, double second) {
            return f.nearness(0.5 * (f.depth(first) + f.depth(second)));
        });
    }
}

}  // namespace umbra
