#include "umbra/bench/studies/bias/bias_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/lab/at_work.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/core/base/error.h"
#include "umbra/core/errors/error_causes.h"

namespace umbra {
namespace {

/// What a light's points are compared with.
struct LightTruth {
    enum class Place : std::uint8_t { unjudged, terminator, interior, edge };
    std::vector<Place> place;
    std::vector<float> s;
};

/// Judged is what `umbra compare` judges; at the terminator nothing is wrong.
LightTruth find_truth(MethodAtWork& reference, const Scene& scene, const PointBatch& points, LightId light) {
    VisibilityPlane plane(points.size());
    reference.visibility(light, plane.out());
    const std::vector<std::uint8_t> band = edge_band(points, light, plane, kHardTolerance);
    ClassPlane classes                   = error_classes(points, light, plane, plane, kHardTolerance);
    mark_terminator(classes, scene, points, light);
    LightTruth truth{std::vector<LightTruth::Place>(points.size(), LightTruth::Place::unjudged), {}};
    for (std::size_t i = 0; i < points.size(); ++i)
        if (is_compared(classes[i]))
            truth.place[i] = classes[i] == ErrorClass::terminator ? LightTruth::Place::terminator
                             : band[i] != 0                       ? LightTruth::Place::edge
                                                                  : LightTruth::Place::interior;
    truth.s = std::move(plane.s);
    return truth;
}

BiasErrors count_wrong(const LightTruth& truth, const VisibilityPlane& plane) {
    BiasErrors errors;
    for (std::size_t i = 0; i < plane.s.size(); ++i) {
        if (truth.place[i] <= LightTruth::Place::terminator || plane.answer[i] != Answer::given) continue;
        const float difference = plane.s[i] - truth.s[i];
        if (std::abs(difference) <= kHardTolerance) continue;
        VisibilityError::Kind& kind = difference < 0 ? errors.false_shadow : errors.false_light;
        ++(truth.place[i] == LightTruth::Place::edge ? kind.edge : kind.interior);
    }
    return errors;
}

MethodChoice with_bias(MethodChoice choice, std::string_view mode, double constant, double slope,
                       double normal_offset) {
    Settings& settings = choice.settings;
    settings.set("bias", mode);
    settings.set("constant", constant);
    settings.set("slope", slope);
    settings.set("normal_offset", normal_offset);
    return choice;
}

/// The studied method on one scene. A setting repeats only the phases that it changes.
class Lookups {
public:
    Lookups(const PreparedScene& prepared, const MethodChoice& studied)
        : points_(prepared.points),
          studied_(studied),
          method_(studied, prepared.scene, prepared.facts),
          plane_(prepared.points.size()) {}
    [[nodiscard]] BiasErrors errors(LightId light, const LightTruth& truth, std::string_view mode, double constant = 0,
                                    double slope = 0, double normal_offset = 0) {
        method_.set(with_bias(studied_, mode, constant, slope, normal_offset));
        if (!method_.looks_at(points_)) method_.look(points_);
        plane_.clear();
        method_.visibility(light, plane_.out());
        return count_wrong(truth, plane_);
    }

private:
    const PointBatch& points_;
    const MethodChoice& studied_;
    MethodAtWork method_;
    VisibilityPlane plane_;
};

constexpr std::string_view kStudied = "shadow_zbuffer";  // the method whose bias this command is about

MethodChoice choose(const std::string& settings) {
    MethodChoice choice =
        parse_method(settings.empty() ? std::string(kStudied) : fmt::format("{}:{}", kStudied, settings));
    for (const char* studied : {"bias", "constant", "slope", "normal_offset"})
        if (!choice.settings.is_default(studied))
            throw UsageError(
                fmt::format("--map {}: the study varies {}, expected settings of maps and filters", settings, studied));
    return choice;
}

/// Every light without extent, in its centre.
void harden_lights(PreparedScene& prepared) {
    for (Light& light : prepared.scene.lights)
        if (is_area(light.kind)) light.kind = LightKind::point;
    face_lights(prepared.points, prepared.scene);
    prepared.facts = find_facts(prepared.scene);
}

/// Names the best setting of the grid, and counts those that are better than the automatic bias.
void compare_settings(BiasSceneRecord& scene) {
    const BiasGrid grid = bias_grid();
    std::vector<BiasCell> cells;  // constants fastest, then slopes, then normal offsets
    for (const BiasSliceRecord& slice : scene.slices)
        for (std::size_t row = 0; row < grid.slopes.size(); ++row)
            for (std::size_t column = 0; column < grid.constants.size(); ++column)
                cells.push_back(
                    {grid.constants[column], grid.slopes[row], slice.normal_offset, slice.rows[row][column]});
    scene.best_manual                    = *std::ranges::min_element(cells, {}, [](const BiasCell& c) {
        return std::tuple(c.errors.interior(), c.errors.edge(), c.constant + c.slope + c.normal_offset);
    });
    scene.settings                       = cells.size();
    scene.settings_better_than_automatic = static_cast<std::uint64_t>(std::ranges::count_if(
        cells, [&](const BiasCell& c) { return c.errors.interior() < scene.automatic.interior(); }));
}

/// All scenes' counts added up, as a scene called "all".
BiasSceneRecord add_up(const std::vector<BiasSceneRecord>& scenes) {
    BiasSceneRecord all = scenes.at(0);
    all.scene           = "all";
    all.title           = "All scenes";
    all.lights.clear();
    for (std::size_t k = 1; k < scenes.size(); ++k) {
        all.points += scenes[k].points;
        all.automatic += scenes[k].automatic;
        all.receiver_plane += scenes[k].receiver_plane;
        for (std::size_t slice = 0; slice < all.slices.size(); ++slice)
            for (std::size_t row = 0; row < all.slices[slice].rows.size(); ++row)
                for (std::size_t column = 0; column < all.slices[slice].rows[row].size(); ++column)
                    all.slices[slice].rows[row][column] += scenes[k].slices[slice].rows[row][column];
    }
    compare_settings(all);
    return all;
}

/// Runs `studied` over the grid.
BiasSceneRecord study_bias(PreparedScene prepared, const MethodChoice& studied,
                           const std::function<void(const std::string&)>& progress) {
    harden_lights(prepared);
    const Scene& scene  = prepared.scene;
    const BiasGrid grid = bias_grid();
    BiasSceneRecord study{.scene = scene.name, .title = scene.title};
    for (const Light& light : scene.lights) study.lights.push_back(light.name);
    for (double offset : grid.normal_offsets)
        study.slices.push_back(
            {offset, std::vector(grid.slopes.size(), std::vector<BiasErrors>(grid.constants.size()))});

    const Reference reference = default_reference(prepared.facts);
    progress(fmt::format("{}: {}", scene.name, reference.choice.info->name));
    MethodAtWork exact(reference.choice, scene, prepared.facts);
    exact.look(prepared.points);
    Lookups lookups(prepared, studied);
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        const LightTruth truth = find_truth(exact, scene, prepared.points, light);
        study.points += static_cast<std::uint64_t>(
            std::ranges::count_if(truth.place, [](LightTruth::Place p) { return p != LightTruth::Place::unjudged; }));
        study.automatic += lookups.errors(light, truth, "auto");
        study.receiver_plane += lookups.errors(light, truth, "receiver_plane");
        for (BiasSliceRecord& slice : study.slices) {
            progress(
                fmt::format("{}: {}, normal offset {}", scene.name, scene.lights[light].name, slice.normal_offset));
            for (std::size_t row = 0; row < grid.slopes.size(); ++row)
                for (std::size_t column = 0; column < grid.constants.size(); ++column)
                    slice.rows[row][column] += lookups.errors(light, truth, "manual", grid.constants[column],
                                                              grid.slopes[row], slice.normal_offset);
        }
    }
    compare_settings(study);
    return study;
}

}  // namespace

BiasErrors& BiasErrors::operator+=(const BiasErrors& other) {
    false_shadow.interior += other.false_shadow.interior;
    false_shadow.edge += other.false_shadow.edge;
    false_light.interior += other.false_light.interior;
    false_light.edge += other.false_light.edge;
    return *this;
}

BiasGrid bias_grid() {
    const std::vector<double> doubling{0, 0.125, 0.25, 0.5, 1, 2, 4, 8, 16, 32, 64, 128};
    return {doubling, doubling, {0, 1, 2, 4}};
}

void check_bias_map(const std::string& settings) {
    const MethodChoice studied = choose(settings);
    const BiasGrid grid        = bias_grid();
    for (double offset : grid.normal_offsets) (void)with_bias(studied, "manual", 0, 0, offset).make();
}

BiasRecord study_biases(const std::vector<std::filesystem::path>& files, const BiasOptions& options,
                        std::vector<std::string>& failed) {
    check_bias_map(options.map);
    const MethodChoice studied = choose(options.map);
    BiasRecord record{.head    = head_record(options.command),
                      .machine = machine_record(options.threads),
                      .size    = size_record(options.size),
                      .map     = options.map,
                      .grid    = bias_grid()};
    for (const auto& [file, name, folder] : chosen_scenes(files)) {
        try {
            PreparedScene prepared = prepare_scene(file, options.size);
            prepared.scene.name    = name;
            BiasSceneRecord study  = study_bias(std::move(prepared), studied, options.progress);
            if (study.points > 0)
                record.bias.push_back(std::move(study));
            else
                failed.push_back(fmt::format("{}: no point is judged: no lit surface is in view", file.string()));
        } catch (const InputError& e) {
            failed.emplace_back(e.what());
        } catch (...) {
            record.failed.push_back({.scene = name, .method = "the study", .failure = {.message = current_message()}});
        }
    }
    if (record.bias.empty()) return record;
    if (record.bias.size() > 1) record.bias.insert(record.bias.begin(), add_up(record.bias));

    StagedFiles staged;
    write_study_files(bias_report(record), record, options.out, staged);
    staged.commit();
    return record;
}

}  // namespace umbra
