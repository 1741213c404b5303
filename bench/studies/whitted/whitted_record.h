// What `umbra whitted` found, as a record. Errors are those from the whole picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"

namespace umbra {

/// Rays of one depth, and the picture if rays stopped there.
struct WhittedDepthRecord {
    std::uint64_t depth = 0, eye = 0, reflected = 0, refracted = 0, met = 0, left = 0, shadow = 0,
                  total_reflections = 0, too_light = 0, too_deep = 0;
    double rmse = kUnknown, flip = kUnknown;
    std::string picture{};
};
template <class Fields>
void describe(Fields& of, Is<WhittedDepthRecord>) {
    of("depth", &WhittedDepthRecord::depth, "1: eye rays");
    of("eye", &WhittedDepthRecord::eye, "");
    of("reflected", &WhittedDepthRecord::reflected, "");
    of("refracted", &WhittedDepthRecord::refracted, "");
    of("met", &WhittedDepthRecord::met, "rays that met a surface");
    of("left", &WhittedDepthRecord::left, "rays that met nothing");
    of("shadow", &WhittedDepthRecord::shadow, "");
    of("total_reflections", &WhittedDepthRecord::total_reflections, "");
    of("too_light", &WhittedDepthRecord::too_light, "");
    of("too_deep", &WhittedDepthRecord::too_deep, "");
    of.may("rmse", &WhittedDepthRecord::rmse, "");
    of.may("flip", &WhittedDepthRecord::flip, "");
    of.may("picture", &WhittedDepthRecord::picture, "");
}

struct WhittedPhaseRecord {
    std::string name{};
    double ms = kUnknown, fraction = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<WhittedPhaseRecord>) {
    of("name", &WhittedPhaseRecord::name, "");
    of("ms", &WhittedPhaseRecord::ms, "of the fastest run");
    of("fraction", &WhittedPhaseRecord::fraction, "");
}

struct WhittedWayRecord {
    std::string name{};
    std::uint64_t rays             = 0;
    double ms                      = kUnknown;
    std::uint64_t different_pixels = 0;
    double max_difference = kUnknown, growth = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<WhittedWayRecord>) {
    of("name", &WhittedWayRecord::name,
       "raster: eye rays from the raster, rays from mirrors and glass alone; eye_rays: each eye ray by itself; everywhere: "
       "mirrored rays from every surface, too; any_weight: as raster, but no ray is too light");
    of("rays", &WhittedWayRecord::rays, "");
    of("ms", &WhittedWayRecord::ms, "");
    of("different_pixels", &WhittedWayRecord::different_pixels, "from raster");
    of("max_difference", &WhittedWayRecord::max_difference, "from raster");
    of("growth", &WhittedWayRecord::growth,
       "the factor by which secondary rays grow from depth to depth; null where they have no two depths");
}

struct WhittedSearchWayRecord {
    std::string name{};
    double build_ms = kUnknown, us = kUnknown, volumes = kUnknown, triangles = kUnknown;
    std::uint64_t different = 0;
};
template <class Fields>
void describe(Fields& of, Is<WhittedSearchWayRecord>) {
    of("name", &WhittedSearchWayRecord::name, "");
    of("build_ms", &WhittedSearchWayRecord::build_ms, "");
    of("us", &WhittedSearchWayRecord::us, "a ray, microseconds");
    of("volumes", &WhittedSearchWayRecord::volumes, "tested a ray");
    of("triangles", &WhittedSearchWayRecord::triangles, "tested a ray");
    of("different", &WhittedSearchWayRecord::different,
       "rays that met another place than the search of every triangle");
}

/// A sample of secondary rays by the tree, against every triangle, and in each way of a lecture; one thread.
struct WhittedSearchRecord {
    std::uint64_t triangles = 0, rays = 0, of = 0;
    double tree_us = kUnknown, search_us = kUnknown, ratio = kUnknown, all_by_search_ms = kUnknown;
    std::uint64_t different = 0;
    std::vector<WhittedSearchWayRecord> ways{};
};
template <class Fields>
void describe(Fields& of, Is<WhittedSearchRecord>) {
    of("triangles", &WhittedSearchRecord::triangles, "");
    of("rays", &WhittedSearchRecord::rays, "in the sample");
    of("of", &WhittedSearchRecord::of, "secondary rays");
    of("tree_us", &WhittedSearchRecord::tree_us, "a ray");
    of("search_us", &WhittedSearchRecord::search_us, "a ray");
    of("ratio", &WhittedSearchRecord::ratio, "");
    of("all_by_search_ms", &WhittedSearchRecord::all_by_search_ms, "of all secondary rays");
    of("different", &WhittedSearchRecord::different, "rays that met another place");
    of("ways", &WhittedSearchRecord::ways, "");
}

struct WhittedBlindRecord {
    std::uint64_t planes = 0, points = 0, points_in_shadow = 0;
    std::string picture{};
};
template <class Fields>
void describe(Fields& of, Is<WhittedBlindRecord>) {
    of("planes", &WhittedBlindRecord::planes, "plane mirrors");
    of("points", &WhittedBlindRecord::points, "diffuse points that a light reaches over a plane mirror");
    of("points_in_shadow", &WhittedBlindRecord::points_in_shadow, "those of them where S_j of that light is 0");
    of("picture", &WhittedBlindRecord::picture, "");
}

/// A picture traced in another way.
struct WhittedOtherRecord {
    double rmse = kUnknown, flip = kUnknown;
    std::uint64_t rays = 0;
    double ms          = kUnknown;
    std::string picture{};
};
template <class Fields>
void describe(Fields& of, Is<WhittedOtherRecord>) {
    of("rmse", &WhittedOtherRecord::rmse, "");
    of("flip", &WhittedOtherRecord::flip, "");
    of.may("rays", &WhittedOtherRecord::rays, "where they are traced anew");
    of.may("ms", &WhittedOtherRecord::ms, "where they are traced anew");
    of("picture", &WhittedOtherRecord::picture, "");
}

/// Mirror images kept as textures while the eye moves.
struct WhittedKeptRecord {
    double part           = kUnknown;
    std::uint64_t mirrors = 0;
    double kept = kUnknown, rmse = kUnknown;
    std::string picture{}, truth{};
};
template <class Fields>
void describe(Fields& of, Is<WhittedKeptRecord>) {
    of("part", &WhittedKeptRecord::part, "how far the eye moved, of its distance to the target");
    of("mirrors", &WhittedKeptRecord::mirrors, "points on mirrors");
    of("kept", &WhittedKeptRecord::kept, "the fraction of them whose mirror image was kept");
    of("rmse", &WhittedKeptRecord::rmse, "its error there, scene-linear");
    of("picture", &WhittedKeptRecord::picture, "");
    of.may("truth", &WhittedKeptRecord::truth, "the picture as it should be, of the last");
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
template <class Fields>
void describe(Fields& of, Is<WhittedFormulaRecord>) {
    of("bodies", &WhittedFormulaRecord::bodies, "how many, by kind");
    of("triangles_replaced", &WhittedFormulaRecord::triangles_replaced, "");
    of("triangles_left", &WhittedFormulaRecord::triangles_left, "");
    of("light_samples", &WhittedFormulaRecord::light_samples, "rays to a light with an area; null: none is asked");
    of("depths", &WhittedFormulaRecord::depths, "");
    of("totals", &WhittedFormulaRecord::totals, "rays of all depths, by kind");
    of("totals_of_triangles", &WhittedFormulaRecord::totals_of_triangles, "the same in the picture of triangles");
    of("rays", &WhittedFormulaRecord::rays, "");
    of("build_ms", &WhittedFormulaRecord::build_ms, "");
    of("ms", &WhittedFormulaRecord::ms, "");
    of("rmse", &WhittedFormulaRecord::rmse, "");
    of("max_difference", &WhittedFormulaRecord::max_difference, "");
    of("flip", &WhittedFormulaRecord::flip, "");
    of("picture", &WhittedFormulaRecord::picture, "");
}

struct WhittedBuildRecord {
    double tree_of_boxes = kUnknown, method = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<WhittedBuildRecord>) {
    of("tree_of_boxes", &WhittedBuildRecord::tree_of_boxes, "");
    of("method", &WhittedBuildRecord::method, "");
}

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
template <class Fields>
void describe(Fields& of, Is<WhittedRecord>) {
    of.all(&WhittedRecord::head);
    of("scene", &WhittedRecord::scene, "");
    of("method", &WhittedRecord::method, "of the shadows, as typed; null: none");
    of("depth", &WhittedRecord::depth, "rays on a path, the eye ray included");
    of("least_weight", &WhittedRecord::least_weight, "rays of less are not traced");
    of("pixel_samples", &WhittedRecord::pixel_samples, "eye rays a pixel");
    of("pixel_places", &WhittedRecord::pixel_places, "of the eye rays in a pixel");
    of("glossy", &WhittedRecord::glossy, "");
    of("picture", &WhittedRecord::picture, "");
    of("rays_picture", &WhittedRecord::rays_picture, "brighter where a pixel has more rays");
    of("most_rays_a_pixel", &WhittedRecord::most_rays_a_pixel, "white in that picture");
    of("undefined", &WhittedRecord::undefined, "S_j that the method left undefined, taken as lit");
    of("depths", &WhittedRecord::depths, "");
    of("build_ms", &WhittedRecord::build_ms, "");
    of("total_ms", &WhittedRecord::total_ms, "without building");
    of("phases", &WhittedRecord::phases, "");
    of("ways", &WhittedRecord::ways, "");
    of("search", &WhittedRecord::search, "null without secondary rays");
    of("blind", &WhittedRecord::blind, "null without plane mirrors");
    of("kept", &WhittedRecord::kept, "null without mirrored rays");
    of("screen_door", &WhittedRecord::screen_door, "null where the eye sees through no surface");
    of("single", &WhittedRecord::single, "of one eye ray a pixel; null where there are no more");
    of("formula", &WhittedRecord::formula, "null without bodies");
    of("csv", &WhittedRecord::csv, "");
}

}  // namespace umbra
