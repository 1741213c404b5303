#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "report_assets.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/studies/whitted/whitted_study.h"

namespace umbra {
namespace {

using Names = std::map<std::string, std::string>;

const Names kAboutPhases{{"eye_rays", "What each eye ray meets, in packets of neighbouring rays: the raster"},
                         {"secondary_rays", "What mirrored and refracted rays meet"},
                         {"shadows", "S_j of all these points, and which lights are in front of them"},
                         {"sums", "The sum at these points"},
                         {"directions", "Where mirrored and refracted rays go"},
                         {"gathering", "Adding intensities, from the last depth to the first"}},
    kAboutWays{{"raster", "Eye rays from the raster, other rays from mirrors and glass alone"},
               {"eye_rays", "Each eye ray by itself, other rays from mirrors and glass alone"},
               {"everywhere", "Each eye ray by itself, mirrored rays from every surface"},
               {"any_weight", "Eye rays from the raster, no ray too light"}},
    kAboutSearch{{"spheres", "A tree of bounding spheres"},
                 {"boxes", "A tree of bounding boxes"},
                 {"cells", "Equal cells (a grid)"},
                 {"octree", "Boxes halved along three axes (an octree)"},
                 {"bsp", "Boxes halved along one axis (a BSP tree)"}},
    kAboutKinds{{"eye", "eye rays"},
                {"reflected", "reflected rays"},
                {"refracted", "refracted rays"},
                {"met", "rays that met a surface"},
                {"shadow", "shadow rays"},
                {"total_reflections", "total reflections"}},
    kAboutPlaces{
        {"regular", ""}, {"jittered", ", each anywhere in its part of the pixel"}, {"random", ", anywhere in it"}};

std::string in(const Names& names, const std::string& name) {
    const auto found = names.find(name);
    return found == names.end() ? name : found->second;
}

std::string figure(double value, int digits) {
    return std::isnan(value) ? kNone : fmt::format("{:.{}f}", value, digits);
}

std::string how_many(std::uint64_t value, const char* noun = "ray") { return counted(double(value), noun); }
std::string digits(double value) { return score(known(value)); }

/// "RMSE 0.01 from the picture, FLIP 0.02".
template <class Record>
std::string errors_of(const Record& picture, const char* whole = "the picture") {
    return fmt::format("RMSE {} from {}, FLIP {}", figure(picture.rmse, 5), whole, figure(picture.flip, 4));
}

/// The rows of a table, each with what its name means.
template <class Record>
Json explained(const std::vector<Record>& records, const Names& names) {
    Json rows = to_record(records);
    for (std::size_t k = 0; k < records.size(); ++k) rows[k]["about"] = in(names, records[k].name);
    return rows;
}

/// Eye, reflected, refracted and shadow rays of all depths, and the time.
std::string lead(const WhittedRecord& record) {
    std::string text;
    for (const auto& [rays, noun] : {std::pair{&WhittedDepthRecord::eye, "eye ray"},
                                     {&WhittedDepthRecord::reflected, "reflected ray"},
                                     {&WhittedDepthRecord::refracted, "refracted ray"},
                                     {&WhittedDepthRecord::shadow, "shadow ray"}}) {
        std::uint64_t all = 0;
        for (const WhittedDepthRecord& d : record.depths) all += d.*rays;
        text += (text.empty() ? "" : ", ") + how_many(all, noun);
    }
    return fmt::format("{}; {} ms without building.", text, figure(record.total_ms, 1));
}

void show_picture(const WhittedRecord& record, StudyReport& report) {
    std::vector<StudyPicture>& seen = report.pictures["seen"];
    seen.push_back({record.picture, "The scene with mirrors and glass",
                    fmt::format("The picture: {} a pixel{}, up to depth {}.", how_many(record.pixel_samples, "eye ray"),
                                in(kAboutPlaces, record.pixel_places), count(record.depth))});
    seen.push_back(
        {record.rays_picture, "The scene, brighter where a pixel has more rays",
         fmt::format("Size of the tree of rays: black 1 ray an eye ray, white {:.3g}.", record.most_rays_a_pixel)});
    if (const auto& blind = record.blind) {
        seen.push_back({blind->picture, "The scene, coloured where light arrives by way of a mirror",
                        fmt::format("Not seen: {} of diffuse surfaces to which a plane mirror sends light, {} of them "
                                    "(orange) in shadow of that light.",
                                    how_many(blind->points, "pixel"), count(blind->points_in_shadow))});
        report.sentences.push_back({fmt::format("light by way of a plane mirror, not seen: {} pixels, {} of them in "
                                                "shadow",
                                                count(blind->points), count(blind->points_in_shadow)),
                                    Shown::in_terminal});
    }
    if (const auto& door = record.screen_door) {
        seen.push_back({door->picture, "The scene with surfaces drawn through a screen of eye rays",
                        fmt::format("Screen door instead of blending: each eye ray sees a surface that lets light "
                                    "through alone, or what is behind it alone. {}; {}. Surfaces of equal opacity hide "
                                    "one another.",
                                    how_many(door->rays), errors_of(*door))});
        report.sentences.push_back(
            {fmt::format("screen door instead of blending: RMSE {}, {}", figure(door->rmse, 5), how_many(door->rays)),
             Shown::in_terminal});
    }
    if (const auto& single = record.single)
        seen.push_back({single->picture, "The scene with one eye ray a pixel",
                        fmt::format("One eye ray a pixel: {}.", errors_of(*single))});
    for (const WhittedDepthRecord& d : record.depths)
        report.pictures["depths"].push_back({d.picture, "The scene with rays up to depth " + count(d.depth),
                                             fmt::format("Up to depth {}.", count(d.depth))});
}

void show_tables(const WhittedRecord& record, StudyReport& report) {
    Json phases = explained(record.phases, kAboutPhases);
    for (Json& phase : phases) phase["percent"] = 100 * phase["fraction"].get<double>();
    report.tables = {
        {"depths",
         "Rays and errors by depth",
         {{"depth", "depth", kCount},
          {.key = "eye", .head = "eye", .notation = kCount, .shown = Shown::in_terminal},
          {"reflected", "reflected", kCount},
          {"refracted", "refracted", kCount},
          {"met", "met a surface", kCount},
          {"left", "left", kCount},
          {"shadow", "shadow rays", kCount},
          {.key = "total_reflections", .head = "total reflections", .notation = kCount, .shown = Shown::on_page},
          {"too_light", "too light", kCount},
          {"too_deep", "too deep", kCount},
          {"rmse", "RMSE", decimals(5)},
          {.key = "flip", .head = "FLIP", .notation = decimals(4), .shown = Shown::on_page}},
         to_record(record.depths)},
        {"phases",
         "Time of the picture by phase",
         {{.key = "name", .head = "phase", .shown = Shown::in_terminal},
          {.key = "about", .head = "phase", .shown = Shown::on_page},
          {"ms", "time", decimals(1), "ms"},
          {"percent", "part", decimals(1), "%"}},
         std::move(phases)},
        {"ways",
         "The picture with more rays than it requires",
         {{.key = "name", .head = "way", .shown = Shown::in_terminal},
          {.key = "about", .head = "rays", .shown = Shown::on_page},
          {"rays", "traced", kCount},
          {"ms", "time", decimals(1), "ms"},
          {"different_pixels", "pixels that differ", kCount},
          {.key = "max_difference", .head = "largest difference", .notation = kSignificant, .shown = Shown::on_page},
          {.key = "growth", .head = "factor from depth to depth", .notation = kSignificant, .shown = Shown::on_page}},
         explained(record.ways, kAboutWays)}};
}

constexpr std::array<std::array<const char*, 2>, 5> kKindsOfBodies{
    {{"spheres", "sphere"}, {"boxes", "box"}, {"cylinders", "cylinder"}, {"cones", "cone"}, {"tori", "torus"}}};

/// "2 spheres, 1 box", or "spheres: 2, boxes: 1"; records of earlier versions have spheres and boxes alone.
std::string bodies_in_words(const Members<std::uint64_t>& bodies, bool plural_first) {
    std::vector<std::string> parts;
    for (const auto& [plural, one] : kKindsOfBodies) {
        const std::uint64_t* many = bodies.find(plural);
        if (many != nullptr && *many > 0)
            parts.push_back(plural_first ? fmt::format("{}: {}", plural, count(*many))
                                         : fmt::format("{} {}", count(*many), *many == 1 ? one : plural));
    }
    return fmt::format("{}", fmt::join(parts, ", "));
}

void show_formula(const WhittedRecord& record, StudyReport& report) {
    report.words["formula"] = Json::array();
    if (!record.formula) return;
    const WhittedFormulaRecord& formula = *record.formula;
    report.words["formula"].push_back({{"bodies", bodies_in_words(formula.bodies, false)},
                                       {"replaced", how_many(formula.triangles_replaced, "triangle")},
                                       {"left", how_many(formula.triangles_left, "triangle")},
                                       {"samples", formula.light_samples ? count(*formula.light_samples) : ""}});
    report.pictures["formula"] = {
        {record.picture, "The scene with its bodies as triangles",
         fmt::format("Triangles: {} ms.", figure(record.total_ms, 1))},
        {formula.picture, "The scene with its bodies by formula",
         fmt::format("By formula: {}, {} ms; {}, largest difference {}.", how_many(formula.rays), figure(formula.ms, 1),
                     errors_of(formula, "the picture of triangles"), digits(formula.max_difference))}};
    report.sentences.push_back(
        {fmt::format("by formula ({}, instead of {} triangles): {} ms; RMSE {}, FLIP {}, largest "
                     "difference {}",
                     bodies_in_words(formula.bodies, true), count(formula.triangles_replaced), figure(formula.ms, 1),
                     figure(formula.rmse, 5), figure(formula.flip, 4), fmt::format("{:.4g}", formula.max_difference)),
         Shown::in_terminal});
    StudyTable kinds{.name    = "formula",
                     .caption = "Rays of all depths",
                     .columns = {{.key = "kind", .head = "rays", .shown = Shown::in_terminal},
                                 {.key = "about", .head = "rays", .shown = Shown::on_page},
                                 {"triangles", "triangles", kCount},
                                 {"formula", "by formula", kCount}},
                     .rows    = Json::array()};
    for (const auto& [kind, found] : formula.totals) {
        const std::uint64_t* triangles = formula.totals_of_triangles.find(kind);
        kinds.rows.push_back({{"kind", kind},
                              {"about", in(kAboutKinds, kind)},
                              {"triangles", triangles != nullptr ? Json(*triangles) : Json()},
                              {"formula", found}});
    }
    report.tables.push_back(std::move(kinds));
}

void show_kept(const std::vector<WhittedKeptRecord>& kept, StudyReport& report) {
    Json moves = Json::array();
    for (const WhittedKeptRecord& move : kept) {
        report.pictures["kept"].push_back(
            {move.picture, "The scene with kept mirror images",
             fmt::format("Mirror images of before, the eye moved by {:g} %: RMSE {} on mirrors.", 100 * move.part,
                         figure(move.rmse, 5))});
        moves.push_back(to_record(move));
        moves.back()["percent"]      = 100 * move.part;
        moves.back()["kept_percent"] = 100 * move.kept;
    }
    report.pictures["kept"].push_back({kept.back().truth, "The scene from the moved eye", "The last, traced anew."});
    report.tables.push_back({"kept",
                             "Mirror images kept as textures while the eye moves",
                             {{"percent", "eye moved by", kGeneral, "%"},
                              {"mirrors", "points on mirrors", kCount},
                              {"kept_percent", "kept", decimals(1), "%"},
                              {"rmse", "RMSE on mirrors", decimals(5)}},
                             std::move(moves)});
}

void show_search(const WhittedSearchRecord& search, StudyReport& report) {
    report.words["search"].push_back({{"rays", count(search.rays)},
                                      {"of", count(search.of)},
                                      {"triangles", count(search.triangles)},
                                      {"tree", digits(search.tree_us)},
                                      {"search", digits(search.search_us)},
                                      {"ratio", digits(search.ratio)},
                                      {"seconds", digits(search.all_by_search_ms / 1000)},
                                      {"different", count(search.different)}});
    report.sentences.push_back(
        {fmt::format("a ray: {} µs by the tree of boxes, {} µs against all {} triangles ({} rays)",
                     digits(search.tree_us), digits(search.search_us), count(search.triangles), count(search.rays)),
         Shown::in_terminal});
    report.tables.push_back({"search",
                             "The same rays in other ways, without vector instructions",
                             {{.key = "name", .head = "way", .shown = Shown::in_terminal},
                              {.key = "about", .head = "way", .shown = Shown::on_page},
                              {"build_ms", "building", kSignificant, "ms"},
                              {"us", "a ray", kSignificant, "µs"},
                              {"volumes", "volumes tested a ray", kSignificant},
                              {"triangles", "triangles tested a ray", kSignificant},
                              {"different", "met another place", kCount}},
                             explained(search.ways, kAboutSearch)});
}

}  // namespace

StudyReport whitted_report(const WhittedRecord& record) {
    const std::string& title = record.scene.title;
    StudyReport report{.title = "Ray tracing: " + title, .page = assets::whitted_html};
    report.words = {{"title", title},
                    {"lead", lead(record)},
                    {"method", record.method.value_or("none")},
                    {"warnings", record.scene.warnings},
                    {"depth", count(record.depth)},
                    {"least_weight", fmt::format("{:g}", record.least_weight)},
                    {"has_mirrors", record.blind.has_value()},
                    {"glossy", record.glossy},
                    {"search", Json::array()},
                    {"undefined", record.undefined > 0 ? count(record.undefined) : ""}};
    show_tables(record, report);
    if (record.search) show_search(*record.search, report);
    if (record.kept) show_kept(*record.kept, report);
    show_picture(record, report);
    show_formula(record, report);
    if (record.undefined > 0)
        report.sentences.push_back(
            {fmt::format("S_j left undefined and taken as lit: {}", count(record.undefined)), Shown::in_terminal});
    return report;
}

}  // namespace umbra
