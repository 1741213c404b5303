// What `umbra whitted` found, as a record. Errors are those from the whole picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"

namespace umbra {

/// Rays of one depth, and the picture if rays stopped there.
struct WhittedDepthRecord {
    std::uint64_t depth = 0, eye = 0, reflected = 0, refracted = 0, met = 0, left = 0, shadow = 0,
                  total_reflections = 0, too_light = 0, too_deep = 0;
    double rmse = kUnknown, flip = kUnknown;
    std::string picture{};
};
DESCRIBE(WhittedDepthRecord) {
    of(MEMBER(depth), "1: eye rays");
    MEMBERS(eye, reflected, refracted);
    of(MEMBER(met), "rays that met a surface");
    of(MEMBER(left), "rays that met nothing");
    MEMBERS(shadow, total_reflections, too_light, too_deep);
    of.may(MEMBER(rmse));
    of.may(MEMBER(flip));
    of.may(MEMBER(picture));
}

struct WhittedPhaseRecord {
    std::string name{};
    double ms = kUnknown, fraction = kUnknown;
};
DESCRIBE(WhittedPhaseRecord) {
    MEMBERS(name);
    of(MEMBER(ms), "of the fastest run");
    MEMBERS(fraction);
}

struct WhittedWayRecord {
    std::string name{};
    std::uint64_t rays             = 0;
    double ms                      = kUnknown;
    std::uint64_t different_pixels = 0;
    double max_difference = kUnknown, growth = kUnknown;
};
DESCRIBE(WhittedWayRecord) {
    of(MEMBER(name),
       "raster: eye rays from the raster, rays from mirrors and glass alone; eye_rays: each eye ray by itself; everywhere: "
       "mirrored rays from every surface, too; any_weight: as raster, but no ray is too light");
    MEMBERS(rays, ms);
    of(MEMBER(different_pixels), "from raster");
    of(MEMBER(max_difference), "from raster");
    of(MEMBER(growth),
       "the factor by which secondary rays grow from depth to depth; null where they have no two depths");
}

struct WhittedSearchWayRecord {
    std::string name{};
    double build_ms = kUnknown, us = kUnknown, volumes = kUnknown, triangles = kUnknown;
    std::uint64_t different = 0;
};
DESCRIBE(WhittedSearchWayRecord) {
    MEMBERS(name, build_ms);
    of(MEMBER(us), "a ray, microseconds");
    of(MEMBER(volumes), "tested a ray");
    of(MEMBER(triangles), "tested a ray");
    of(MEMBER(different), "rays that met another place than the search of every triangle");
}

/// A sample of secondary rays by the tree, against every triangle, and in each way of a lecture; one thread.
struct WhittedSearchRecord {
    std::uint64_t triangles = 0, rays = 0, of = 0;
    double tree_us = kUnknown, search_us = kUnknown, ratio = kUnknown, all_by_search_ms = kUnknown;
    std::uint64_t different = 0;
    std::vector<WhittedSearchWayRecord> ways{};
};
DESCRIBE(WhittedSearchRecord) {
    MEMBERS(triangles);
    of(MEMBER(rays), "in the sample");
    of(MEMBER(of), "secondary rays");
    of(MEMBER(tree_us), "a ray");
    of(MEMBER(search_us), "a ray");
    MEMBERS(ratio);
    of(MEMBER(all_by_search_ms), "of all secondary rays");
    of(MEMBER(different), "rays that met another place");
    MEMBERS(ways);
}

struct WhittedBlindRecord {
    std::uint64_t planes = 0, points = 0, points_in_shadow = 0;
    std::string picture{};
};
DESCRIBE(WhittedBlindRecord) {
    of(MEMBER(planes), "plane mirrors");
    of(MEMBER(points), "diffuse points that a light reaches over a plane mirror");
    of(MEMBER(points_in_shadow), "those of them where S_j of that light is 0");
    MEMBERS(picture);
}

/// A picture traced in another way.
struct WhittedOtherRecord {
    double rmse = kUnknown, flip = kUnknown;
    std::uint64_t rays = 0;
    double ms          = kUnknown;
    std::string picture{};
};
DESCRIBE(WhittedOtherRecord) {
    MEMBERS(rmse, flip);
    of.may(MEMBER(rays), "where they are traced anew");
    of.may(MEMBER(ms), "where they are traced anew");
    MEMBERS(picture);
}

/// Mirror images kept as textures while the eye moves.
struct WhittedKeptRecord {
    double part           = kUnknown;
    std::uint64_t mirrors = 0;
    double kept = kUnknown, rmse = kUnknown;
    std::string picture{}, truth{};
};
DESCRIBE(WhittedKeptRecord) {
    of(MEMBER(part), "how far the eye moved, of its distance to the target");
    of(MEMBER(mirrors), "points on mirrors");
    of(MEMBER(kept), "the fraction of them whose mirror image was kept");
    of(MEMBER(rmse), "its error there, scene-linear");
    MEMBERS(picture);
    of.may(MEMBER(truth), "the picture as it should be, of the last");
}

/// The picture in which rays meet bodies by formula.
struct WhittedFormulaRecord {
    Members<std::uint64_t> bodies{};
    std::uint64_t triangles_replaced = 0, triangles_left = 0;
    std::optional<std::uint64_t> light_samples{};
    std::vector<WhittedDepthRecord> depths{};
    Members<std::uint64_t> totals{}, totals_of_triangles{};
    std::uint64_t rays = 0;
    double build_ms = kUnknown, ms = kUnknown, rmse = kUnknown, max_difference = kUnknown, flip = kUnknown;
    std::string picture{};
};
DESCRIBE(WhittedFormulaRecord) {
    of(MEMBER(bodies), "how many, by kind");
    MEMBERS(triangles_replaced, triangles_left);
    of(MEMBER(light_samples), "rays to a light with an area; null: none is asked");
    MEMBERS(depths);
    of(MEMBER(totals), "rays of all depths, by kind");
    of(MEMBER(totals_of_triangles), "the same in the picture of triangles");
    MEMBERS(rays, build_ms, ms, rmse, max_difference, flip, picture);
}

struct WhittedBuildRecord {
    double tree_of_boxes = kUnknown, method = kUnknown;
};
DESCRIBE(WhittedBuildRecord) { MEMBERS(tree_of_boxes, method); }

struct WhittedRecord {
    HeadRecord head{};
    SceneRecord scene{};
    std::optional<std::string> method{};
    std::uint64_t depth         = 0;
    double least_weight         = kUnknown;
    std::uint64_t pixel_samples = 0;
    std::string pixel_places{};
    bool glossy = false;
    std::string picture{}, rays_picture{};
    double most_rays_a_pixel = kUnknown;
    std::uint64_t undefined  = 0;
    std::vector<WhittedDepthRecord> depths{};
    WhittedBuildRecord build_ms{};
    double total_ms = kUnknown;
    std::vector<WhittedPhaseRecord> phases{};
    std::vector<WhittedWayRecord> ways{};
    std::optional<WhittedSearchRecord> search{};
    std::optional<WhittedBlindRecord> blind{};
    std::optional<std::vector<WhittedKeptRecord>> kept{};
    std::optional<WhittedOtherRecord> screen_door{}, single{};
    std::optional<WhittedFormulaRecord> formula{};
    std::vector<std::string> csv{};
};
DESCRIBE(WhittedRecord) {
    of.all(&R::head);
    MEMBERS(scene);
    of(MEMBER(method), "of the shadows, as typed; null: none");
    of(MEMBER(depth), "rays on a path, the eye ray included");
    of(MEMBER(least_weight), "rays of less are not traced");
    of(MEMBER(pixel_samples), "eye rays a pixel");
    of(MEMBER(pixel_places), "of the eye rays in a pixel");
    MEMBERS(glossy, picture);
    of(MEMBER(rays_picture), "brighter where a pixel has more rays");
    of(MEMBER(most_rays_a_pixel), "white in that picture");
    of(MEMBER(undefined), "S_j that the method left undefined, taken as lit");
    MEMBERS(depths, build_ms);
    of(MEMBER(total_ms), "without building");
    MEMBERS(phases, ways);
    of(MEMBER(search), "null without secondary rays");
    of(MEMBER(blind), "null without plane mirrors");
    of(MEMBER(kept), "null without mirrored rays");
    of(MEMBER(screen_door), "null where the eye sees through no surface");
    of(MEMBER(single), "of one eye ray a pixel; null where there are no more");
    of(MEMBER(formula), "null without bodies");
    MEMBERS(csv);
}

}  // namespace umbra
