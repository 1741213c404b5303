#include "umbra/bench/studies/whitted/whitted_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "umbra/bench/lab/antialias.h"
#include "umbra/bench/lab/asked_method.h"
#include "umbra/bench/studies/light/formula_scene.h"
#include "umbra/bench/studies/light/mirrored_light.h"
#include "umbra/bench/studies/light/search_ways.h"
#include "umbra/bench/studies/light/whitted.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/image/metrics.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/scene/uncomputed.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

constexpr double kMostTests = 1e8;  ///< of a ray and a triangle, in the search

/// How a picture's rays are traced.
enum class Way : std::uint8_t { raster, eye_rays, everywhere, any_weight };
constexpr std::array kWays{Way::raster, Way::eye_rays, Way::everywhere, Way::any_weight};
constexpr std::array<std::string_view, 4> kWayNames{"raster", "eye_rays", "everywhere", "any_weight"};

/// A picture and where its time went, milliseconds.
struct Traced {
    RayTree tree;
    TreeLight light;
    Image linear;   ///< of pixels
    Image shown{};  ///< the same to be displayed, of the picture alone that others are compared with
    double eye_ms = 0, gather_ms = 0;

    [[nodiscard]] double ms() const {
        return eye_ms + tree.trace_ms + tree.spawn_ms + tree.face_ms + light.shadow_ms + light.sum_ms + gather_ms;
    }
    [[nodiscard]] std::uint64_t rays() const {
        std::uint64_t rays = 0;
        for (const RayLevel& level : tree.levels) rays += level.counts.traced();
        return rays;
    }
};

/// All that the ways share.
struct Study {
    const PreparedScene& prepared;
    const WhittedOptions& options;
    const RayScene& rays;
    AskedMethod& shadows;
    const fs::path& folder;  ///< of all pictures
    TreeOptions tree;
    CameraFrame fine;  ///< of the eye rays, tree.side x tree.side a pixel

    [[nodiscard]] const Scene& scene() const { return prepared.scene; }
    [[nodiscard]] int width() const { return prepared.points.raster->width; }
    [[nodiscard]] int height() const { return prepared.points.raster->height; }
    [[nodiscard]] Image picture(const Traced& traced, int depth) const {
        return box_filtered(gather(scene(), traced.tree, traced.light, depth), tree.side);
    }
    [[nodiscard]] Image shown(const Image& linear) const { return displayed(linear, scene().tone, scene().exposure); }
    void say(const std::string& what) const {
        if (options.progress) options.progress(what);
    }
};

/// Writes a picture of pixels and compares it with the whole one.
WhittedOtherRecord write_other(const Study& study, const Traced& whole, const Image& linear, const std::string& file) {
    const Image shown = study.shown(linear);
    write_image(study.folder / file, shown);
    return {.rmse = image_error(whole.linear, linear).rmse, .flip = flip_ldr(whole.shown, shown).mean, .picture = file};
}

PointBatch eye_points(const Study& study, bool one_by_one) {
    const TreeOptions& tree = study.tree;
    if (!one_by_one && tree.eye_places == EyePlaces::regular)
        return subpixel_points(study.rays, study.scene(), study.width(), study.height(), tree.side);
    return trace_eye_rays(study.rays, study.scene(), study.fine, tree.eye_places, tree.side);
}

/// Finds light and picture of a tree whose S_j, [level][light], `ask()` returns.
template <class Ask>
void add_light(const Study& study, Traced& traced, const Ask& ask) {
    std::vector<std::vector<VisibilityPlane>> visibility;
    const double shadow_ms = timed_ms([&] { visibility = ask(); });
    traced.light           = light_of_rays(study.scene(), traced.tree, visibility);
    traced.light.shadow_ms = shadow_ms;
    traced.gather_ms       = timed_ms([&] { traced.linear = study.picture(traced, study.tree.depth); });
}

Traced trace_once(const Study& study, Way way, Transparency transparency = Transparency::blend) {
    TreeOptions options  = study.tree;
    options.everywhere   = way == Way::everywhere;
    options.transparency = transparency;
    if (way == Way::any_weight) options.least_weight = 0;
    Traced traced;
    PointBatch eye;
    traced.eye_ms = timed_ms([&] { eye = eye_points(study, way == Way::eye_rays || way == Way::everywhere); });
    traced.tree   = trace_rays(study.rays, study.scene(), std::move(eye), options);
    add_light(study, traced, [&] {
        std::vector<const PointBatch*> batches;
        for (const RayLevel& level : traced.tree.levels) batches.push_back(&level.points);
        return study.shadows.of(batches);
    });
    return traced;
}

/// The fastest of some runs; all make the same picture.
template <class Trace>
Traced fastest(int runs, const Trace& trace) {
    Traced best = trace();
    for (int run = 1; run < runs; ++run)
        if (Traced again = trace(); again.ms() < best.ms()) best = std::move(again);
    return best;
}

WhittedDepthRecord counts_record(std::size_t level, const RayCounts& counts) {
    return {.depth             = level + 1,
            .eye               = counts.eye,
            .reflected         = counts.reflected,
            .refracted         = counts.refracted,
            .met               = counts.met,
            .left              = counts.traced() - counts.met,
            .shadow            = counts.shadow,
            .total_reflections = counts.total,
            .too_light         = counts.too_light,
            .too_deep          = counts.too_deep};
}

/// Rays of all depths by kind.
Members<std::uint64_t> totals(const RayTree& tree) {
    RayCounts all;
    for (const RayLevel& level : tree.levels) {
        all.eye += level.counts.eye, all.reflected += level.counts.reflected;
        all.refracted += level.counts.refracted, all.shadow += level.counts.shadow;
        all.met += level.counts.met, all.total += level.counts.total;
    }
    return {{"eye", all.eye}, {"reflected", all.reflected}, {"refracted", all.refracted},
            {"met", all.met}, {"shadow", all.shadow},       {"total_reflections", all.total}};
}

std::vector<WhittedDepthRecord> depth_records(const Study& study, const Traced& whole) {
    std::vector<WhittedDepthRecord> depths;
    for (std::size_t level = 0; level < whole.tree.levels.size(); ++level) {
        const int depth = static_cast<int>(level) + 1;
        const WhittedOtherRecord other =
            write_other(study, whole, study.picture(whole, depth), fmt::format("depth_{}.png", depth));
        WhittedDepthRecord& record = depths.emplace_back(counts_record(level, whole.tree.levels[level].counts));
        record.rmse = other.rmse, record.flip = other.flip, record.picture = other.picture;
    }
    return depths;
}

std::vector<WhittedPhaseRecord> phase_records(const Traced& traced) {
    std::vector<WhittedPhaseRecord> phases;
    const double all = traced.ms();
    const auto add   = [&](const char* name, double ms) { phases.push_back({name, ms, all > 0 ? ms / all : 0}); };
    add("eye_rays", traced.eye_ms);
    add("secondary_rays", traced.tree.trace_ms);
    add("shadows", traced.tree.face_ms + traced.light.shadow_ms);
    add("sums", traced.light.sum_ms);
    add("directions", traced.tree.spawn_ms);
    add("gathering", traced.gather_ms);
    return phases;
}

WhittedWayRecord way_record(Way way, const Traced& traced, const Traced& raster) {
    const ImageError error = image_error(raster.linear, traced.linear);
    std::vector<double> secondary;  // rays by depth
    for (std::size_t level = 1; level < traced.tree.levels.size(); ++level)
        secondary.push_back(static_cast<double>(traced.tree.levels[level].rays.size()));
    return {.name             = std::string(kWayNames[static_cast<std::size_t>(way)]),
            .rays             = traced.rays(),
            .ms               = traced.ms(),
            .different_pixels = error.differing,
            .max_difference   = error.max,
            .growth           = secondary.size() < 2 ? kUnknown : growth_factor(secondary)};
}

/// Whether a ray meets both triangles, or none, at one place: at an edge it may meet either neighbour.
bool same_place(const Scene& scene, const Ray& ray, TriangleId one, TriangleId other) {
    if (one == other) return true;
    if (one == kNoTriangle || other == kNoTriangle) return false;
    return std::abs(distance_to_plane(scene, ray, one) - distance_to_plane(scene, ray, other)) <=
           1e-6 * static_cast<double>(bounds(scene).diagonal());
}

std::uint64_t different_places(const Scene& scene, const std::vector<Ray>& rays, const std::vector<TriangleId>& one,
                               const std::vector<TriangleId>& other) {
    std::uint64_t different = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) different += same_place(scene, rays[k], one[k], other[k]) ? 0 : 1;
    return different;
}

/// The same rays in the ways that the lecture names, against what the search of every triangle found.
std::vector<WhittedSearchWayRecord> search_way_records(const Study& study, const std::vector<Ray>& sample,
                                                       const std::vector<TriangleId>& by_search) {
    const Scene& scene = study.scene();
    const auto rays    = static_cast<double>(sample.size());
    std::vector<double> starts;
    for (const Ray& ray : sample) starts.push_back(least_distance(study.rays, ray));
    std::vector<WhittedSearchWayRecord> ways;
    for (const SearchWay way : kSearchWays) {
        std::optional<SpaceSearch> search;
        const double build_ms = timed_ms([&] { search.emplace(way, scene); });
        SearchSteps steps;
        std::vector<TriangleId> met(sample.size());
        const double ms = timed_ms([&] {
            for (std::size_t k = 0; k < sample.size(); ++k) met[k] = search->first(sample[k], starts[k], steps);
        });
        ways.push_back({.name      = std::string(to_string(way)),
                        .build_ms  = build_ms,
                        .us        = 1000 * ms / rays,
                        .volumes   = static_cast<double>(steps.volumes) / rays,
                        .triangles = static_cast<double>(steps.triangles) / rays,
                        .different = different_places(scene, sample, met, by_search)});
    }
    return ways;
}

/// Secondary rays by the tree of boxes and against every triangle, one thread each.
std::optional<WhittedSearchRecord> search_record(const Study& study, const RayTree& tree) {
    std::size_t all = 0;
    for (std::size_t level = 1; level < tree.levels.size(); ++level) all += tree.levels[level].rays.size();
    if (all == 0) return {};
    const std::size_t triangles = study.scene().triangles.size();
    const auto most             = static_cast<std::size_t>(kMostTests / static_cast<double>(triangles));
    const std::size_t step      = std::max<std::size_t>(1, all / std::clamp<std::size_t>(most, 1, 100'000));
    std::vector<Ray> sample;
    std::size_t next = 0, at = 0;
    for (std::size_t level = 1; level < tree.levels.size(); ++level)
        for (std::size_t i = 0; i < tree.levels[level].rays.size(); ++i, ++at)
            if (at == next) {
                sample.push_back(secondary_ray(study.scene(), tree, level, i));
                next += step;
            }
    std::vector<TriangleId> by_tree(sample.size()), by_search(sample.size());
    const auto run_tree = [&] {
        const FlushDenormals flush;
        for (std::size_t k = 0; k < sample.size(); ++k) by_tree[k] = first_by_tree(study.rays, sample[k]);
    };
    run_tree();  // fills the caches
    const double tree_ms   = timed_ms(run_tree),
                 search_ms = timed_ms([&] {
                     for (std::size_t k = 0; k < sample.size(); ++k)
                         by_search[k] = first_by_search(study.rays, study.scene(), sample[k]);
                 });
    const auto rays        = static_cast<double>(sample.size());
    return WhittedSearchRecord{.triangles        = triangles,
                               .rays             = sample.size(),
                               .of               = all,
                               .tree_us          = 1000 * tree_ms / rays,
                               .search_us        = 1000 * search_ms / rays,
                               .ratio            = search_ms / tree_ms,
                               .all_by_search_ms = search_ms / rays * static_cast<double>(all),
                               .different        = different_places(study.scene(), sample, by_tree, by_search),
                               .ways             = search_way_records(study, sample, by_search)};
}

/// Rays a pixel, black 1, white the most.
Image ray_picture(const Study& study, const RayTree& tree, double& most) {
    const std::vector<std::uint32_t> rays = rays_by_eye_ray(tree);
    Image fine(study.fine.width, study.fine.height, {"R", "G", "B"});
    for (std::size_t i = 0; i < rays.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) fine.at(i, c) = static_cast<float>(rays[i]);
    Image image       = box_filtered(fine, study.tree.side);
    most              = static_cast<double>(*std::ranges::max_element(image.data));
    const float range = static_cast<float>(std::max(most - 1, 1.0));
    for (float& value : image.data) value = srgb_from_linear(std::clamp((value - 1) / range, 0.0f, 1.0f));
    return image;
}

bool is_diffuse(const Material& material) { return material.k_d * material.O_d != vec3(0); }

/// Pixel centres that lights reach over plane mirrors, orange where S_j of such a light is 0, in a dim picture.
std::optional<WhittedBlindRecord> blind_record(const Study& study, const Image& shown) {
    const PointBatch& points              = study.prepared.points;
    const std::vector<MirrorPlane> planes = mirror_planes(study.scene());
    if (planes.empty()) return {};
    const std::vector<VisibilityPlane> straight = study.shadows(points);
    std::vector<std::uint8_t> reached(points.size(), 0), dark(points.size(), 0);
    for (LightId j = 0; j < study.scene().lights.size(); ++j) {
        const std::vector<std::uint8_t> lit = lit_by_mirrors(study.rays, study.scene(), points, j, planes);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (lit[i] == 0 || !is_diffuse(study.scene().material(points.triangle[i]))) continue;
            reached[i] = 1;
            if (!points.faces(j, i) || (straight[j].defined(i) && straight[j].s[i] == 0)) dark[i] = 1;
        }
    }
    Image map = shown;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const vec3 orange(0.9f, 0.6f, 0.0f), pale(0.34f, 0.71f, 0.91f);
        for (int c = 0; c < 3; ++c) {
            float& value = map.at(i, static_cast<std::size_t>(c));
            value        = 0.4f * value + (reached[i] != 0 ? 0.6f * (dark[i] != 0 ? orange : pale)[c] : 0.0f);
        }
    }
    write_image(study.folder / "blind.png", map);
    const auto marked = [](const std::vector<std::uint8_t>& marks) {
        return static_cast<std::uint64_t>(std::ranges::count(marks, std::uint8_t{1}));
    };
    return WhittedBlindRecord{planes.size(), marked(reached), marked(dark), "blind.png"};
}

/// Null where the eye sees through no surface.
std::optional<WhittedOtherRecord> screen_door_record(const Study& study, const Traced& blended) {
    if (std::ranges::all_of(blended.tree.levels, [](const RayLevel& level) { return level.own.empty(); })) return {};
    const Traced traced       = trace_once(study, Way::raster, Transparency::screen_door);
    WhittedOtherRecord record = write_other(study, blended, traced.linear, "screen_door.png");
    record.rays = traced.rays(), record.ms = traced.ms();
    return record;
}

/// The picture of one eye ray a pixel, of those that the whole has. Null where it has no more.
std::optional<WhittedOtherRecord> single_record(const Study& study, const Traced& traced) {
    if (study.tree.side == 1) return {};
    const Image fine = gather(study.scene(), traced.tree, traced.light, study.tree.depth);
    Image linear(study.width(), study.height(), fine.channels);
    const auto side = static_cast<std::size_t>(study.tree.side), width = static_cast<std::size_t>(study.width());
    for (std::size_t i = 0; i < traced.linear.data.size() / 3; ++i) {
        const std::size_t x = i % width * side + side / 2, y = i / width * side + side / 2;
        for (std::size_t c = 0; c < 3; ++c) linear.at(i, c) = fine.at(y * width * side + x, c);
    }
    return write_other(study, traced, linear, "single.png");
}

/// The picture of eye rays that look from `camera`; the scene is the study's.
Traced trace_from(const Study& study, const Camera& camera) {
    Scene moved         = study.scene();
    moved.camera        = camera;
    TreeOptions options = study.tree;
    options.glossy      = false;
    Traced traced;
    traced.tree  = trace_rays(study.rays, moved,
                              subpixel_points(study.rays, moved, study.width(), study.height(), options.side), options);
    traced.light = light_of_rays(moved, traced.tree, std::ref(study.shadows));
    return traced;
}

/// Where mirror images are kept as textures of their surfaces while the eye moves: each point of a mirror shows what it
/// mirrored to the eye before. Sideways, by parts of the distance to the target. Null without mirrored rays.
std::optional<std::vector<WhittedKeptRecord>> kept_records(const Study& study, const Traced& before) {
    if (before.tree.levels.size() < 2 || study.tree.eye_places != EyePlaces::regular) return {};
    const auto mirrored_in = [&](const Traced& traced) {
        Image all          = gather(study.scene(), traced.tree, traced.light, study.tree.depth);
        const Image direct = gather(study.scene(), traced.tree, traced.light, 1);
        for (std::size_t k = 0; k < all.data.size(); ++k) all.data[k] -= direct.data[k];
        return all;
    };
    const auto mirrors = [&](const PointBatch& points, std::size_t i) {
        return points.triangle[i] != kNoTriangle && study.scene().material(points.triangle[i]).reflect > 0;
    };
    const PointBatch& old_points = before.tree.levels[0].points;
    const Image kept             = mirrored_in(before);
    const Camera camera          = study.scene().camera;
    const CameraFrame& raster    = *old_points.raster;
    const dvec3 way              = glm::length(dvec3(camera.target) - dvec3(camera.eye)) * raster.right;
    std::vector<WhittedKeptRecord> moves;
    for (const double part : {0.0, 0.01, 0.03, 0.1}) {
        Camera moved             = camera;
        moved.eye                = vec3(dvec3(camera.eye) + part * way);
        const Traced now         = trace_from(study, moved);
        const PointBatch& points = now.tree.levels[0].points;
        const Image truth        = gather(study.scene(), now.tree, now.light, study.tree.depth);
        const Image now_mirrored = mirrored_in(now);
        Image shown              = truth;
        std::uint64_t of = 0, known = 0;
        double squares = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!mirrors(points, i)) continue;
            ++of;
            const dvec3 at = raster.project(dvec3(points.position(i)));
            if (at.z <= 0 || at.x < 0 || at.y < 0 || at.x >= raster.width || at.y >= raster.height) continue;
            const auto texel = static_cast<std::size_t>(at.y) * static_cast<std::size_t>(raster.width) +
                               static_cast<std::size_t>(at.x);
            if (!mirrors(old_points, texel)) continue;  // hidden before: traced anew
            ++known;
            for (std::size_t c = 0; c < 3; ++c) {
                const float error = kept.at(texel, c) - now_mirrored.at(i, c);
                shown.at(i, c) += error;
                squares += static_cast<double>(error) * static_cast<double>(error) / 3;
            }
        }
        const std::string file = fmt::format("kept_{}.png", moves.size());
        write_image(study.folder / file, study.shown(box_filtered(shown, study.tree.side)));
        moves.push_back({.part    = part,
                         .mirrors = of,
                         .kept    = of > 0 ? static_cast<double>(known) / static_cast<double>(of) : 0,
                         .rmse    = known > 0 ? std::sqrt(squares / static_cast<double>(known)) : 0,
                         .picture = file});
        if (moves.size() == 4) {
            write_image(study.folder / "moved.png", study.shown(box_filtered(truth, study.tree.side)));
            moves.back().truth = "moved.png";
        }
    }
    return moves;
}

/// The picture in which rays meet bodies by formula.
Traced trace_formula(const Study& study, const FormulaScene& bodies) {
    Traced traced;
    traced.tree = bodies.trace(study.fine, study.tree);
    add_light(study, traced, [&] {
        std::vector<std::vector<VisibilityPlane>> visibility;
        for (std::size_t level = 0; level < traced.tree.levels.size(); ++level)
            visibility.push_back(study.options.method
                                     ? bodies.visibility(traced.tree, level)
                                     : lit_everywhere(study.scene(), traced.tree.levels[level].points));
        return visibility;
    });
    return traced;
}

/// Null without bodies.
std::optional<WhittedFormulaRecord> formula_record(const Study& study, const Traced& triangles) {
    if (!study.options.bodies) return {};
    const Bodies& bodies = *study.options.bodies;
    std::optional<FormulaScene> scene;
    const double build_ms          = timed_ms([&] { scene.emplace(study.scene(), bodies); });
    const Traced traced            = fastest(study.options.runs, [&] { return trace_formula(study, *scene); });
    const WhittedOtherRecord other = write_other(study, triangles, traced.linear, "formula.png");
    const bool sampled = study.options.method && std::ranges::any_of(study.scene().lights, is_area, &Light::kind);
    WhittedFormulaRecord record{.bodies              = {{"spheres", bodies.count(BodyKind::sphere)},
                                                        {"boxes", bodies.count(BodyKind::box)},
                                                        {"cylinders", bodies.count(BodyKind::cylinder)},
                                                        {"cones", bodies.count(BodyKind::cone)},
                                                        {"tori", bodies.count(BodyKind::torus)}},
                                .triangles_replaced  = bodies.triangles(),
                                .triangles_left      = study.scene().triangles.size() - bodies.triangles(),
                                .totals              = totals(traced.tree),
                                .totals_of_triangles = totals(triangles.tree),
                                .rays                = traced.rays(),
                                .build_ms            = build_ms,
                                .ms                  = traced.ms(),
                                .rmse                = other.rmse,
                                .max_difference      = image_error(triangles.linear, traced.linear).max,
                                .flip                = other.flip,
                                .picture             = other.picture};
    if (sampled) record.light_samples = kFormulaLightSamples;
    for (std::size_t level = 0; level < traced.tree.levels.size(); ++level)
        record.depths.push_back(counts_record(level, traced.tree.levels[level].counts));
    return record;
}

}  // namespace

void correct_warnings(Scene& scene) {
    for (const UncomputedTerm& term : find_uncomputed(scene)) {
        if (term.term == kCutout) continue;
        const std::string beginning = fmt::format("The {} is not computed", in_words(term));
        std::erase_if(scene.warnings, [&](const std::string& w) { return w.starts_with(beginning); });
    }
}

std::string refusal_of(const MethodInfo& method) {
    if (!method.needs_raster) return "";
    return "it answers for the points of a raster alone, and what mirrors and glass show lies elsewhere";
}

WhittedRecord trace_whitted(const PreparedScene& prepared, const WhittedOptions& options, const fs::path& folder) {
    const int side  = samples_along_side(options.pixel_samples);
    const int width = prepared.points.raster->width, height = prepared.points.raster->height;
    check_memory(prepared.scene, prepared.scene.source, width, height, options.pixel_samples, Work::picture);
    std::optional<RayScene> rays;
    const double rays_ms = timed_ms([&] { rays.emplace(prepared.scene); });
    std::optional<AskedMethod> shadows;
    const double method_ms = timed_ms([&] { shadows.emplace(prepared.scene, prepared.facts, options.method); });
    const TreeOptions tree{.depth        = options.depth,
                           .least_weight = options.least_weight,
                           .glossy       = options.glossy,
                           .eye_places   = options.places,
                           .side         = side};
    const Study study{
        prepared, options, *rays, *shadows, folder, tree, frame(prepared.scene.camera, width * side, height * side)};
    const auto trace = [&](Way way) { return fastest(options.runs, [&] { return trace_once(study, way); }); };

    study.say("tracing");
    Traced raster = trace(Way::raster);
    raster.shown  = study.shown(raster.linear);
    write_image(folder / "whitted.png", raster.shown);
    double most_rays = 0;
    write_image(folder / "rays.png", ray_picture(study, raster.tree, most_rays));

    std::vector<WhittedWayRecord> ways;
    for (const Way way : kWays) {
        study.say(fmt::format("tracing: {}", kWayNames[static_cast<std::size_t>(way)]));
        ways.push_back(way_record(way, way == Way::raster ? raster : trace(way), raster));
    }
    WhittedRecord record{.head              = head_record(options.command),
                         .scene             = scene_record(prepared.scene),
                         .depth             = static_cast<std::uint64_t>(options.depth),
                         .least_weight      = options.least_weight,
                         .pixel_samples     = static_cast<std::uint64_t>(options.pixel_samples),
                         .pixel_places      = std::string(to_string(options.places)),
                         .glossy            = options.glossy,
                         .picture           = "whitted.png",
                         .rays_picture      = "rays.png",
                         .most_rays_a_pixel = most_rays,
                         .undefined         = raster.light.undefined,
                         .depths            = depth_records(study, raster),
                         .build_ms          = {rays_ms, method_ms},
                         .total_ms          = raster.ms(),
                         .phases            = phase_records(raster),
                         .ways              = std::move(ways)};
    if (options.method) record.method = options.method->text();
    study.say("testing every triangle");
    record.search      = search_record(study, raster.tree);
    record.blind       = blind_record(study, raster.shown);
    record.screen_door = screen_door_record(study, raster);
    record.single      = single_record(study, raster);
    study.say("moving the eye");
    record.kept = kept_records(study, raster);
    if (options.bodies) study.say("tracing: formula");
    record.formula = formula_record(study, raster);
    return record;
}

}  // namespace umbra
