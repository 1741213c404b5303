#include "umbra/bench/bias/bias_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "umbra/core/base/error.h"
#include "umbra/shadows/zbuffer/shadow_zbuffer.h"

namespace umbra {
namespace {

/// What a light's points are held against.
struct Truth {
    enum class Place : std::uint8_t { unjudged, interior, edge };
    std::vector<Place> place;
    std::vector<float> s;
};

Truth find_truth(Method& reference, const PointBatch& points, LightId light) {
    VisibilityPlane plane{std::vector<float>(points.size(), 0), std::vector<std::uint8_t>(points.size(), kDefined)};
    reference.aim(light);
    reference.visibility(points, light, plane.s, plane.defined);
    const std::vector<std::uint8_t> band = edge_band(points, light, plane, kHardTolerance);
    Truth truth{std::vector<Truth::Place>(points.size(), Truth::Place::unjudged), {}};
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points.facing[light][i] == Facing::front && plane.defined[i] == kDefined)
            truth.place[i] = band[i] != 0 ? Truth::Place::edge : Truth::Place::interior;
    truth.s = std::move(plane.s);
    return truth;
}

BiasErrors count_wrong(const Truth& truth, const VisibilityPlane& plane) {
    BiasErrors errors;
    for (std::size_t i = 0; i < plane.s.size(); ++i) {
        if (truth.place[i] == Truth::Place::unjudged || plane.defined[i] != kDefined) continue;
        const float difference = plane.s[i] - truth.s[i];
        if (std::abs(difference) <= kHardTolerance) continue;
        VisibilityError::Kind& kind = difference < 0 ? errors.false_shadow : errors.false_light;
        ++(truth.place[i] == Truth::Place::edge ? kind.edge : kind.interior);
    }
    return errors;
}

/// shadow_zbuffer on one scene, whose maps are asked with any bias.
class Lookups {
public:
    Lookups(const PreparedScene& prepared, const MethodChoice& choice)
        : points_(prepared.points), method_(choice.settings) {
        method_.build(prepared.scene, prepared.facts);
        plane_.s.resize(points_.size());
        plane_.defined.resize(points_.size());
    }
    void aim(LightId light) { method_.aim(light_ = light); }
    [[nodiscard]] BiasErrors errors(const Truth& truth, const Bias& bias) {
        std::ranges::fill(plane_.s, 0.0f);
        std::ranges::fill(plane_.defined, kDefined);
        method_.set_bias(bias);
        method_.visibility(points_, light_, plane_.s, plane_.defined);
        return count_wrong(truth, plane_);
    }

private:
    const PointBatch& points_;
    ShadowZBuffer method_;
    VisibilityPlane plane_;
    LightId light_ = 0;
};

MethodChoice choose(const std::string& settings, double normal_offset) {
    MethodChoice choice = parse_method(settings.empty() ? "shadow_zbuffer" : "shadow_zbuffer:" + settings);
    for (const char* studied : {"bias", "constant", "slope", "normal_offset"})
        if (!choice.settings.is_default(studied))
            throw UsageError(fmt::format(
                "--map {}: {} is what is studied (settings of maps and filters would be right)", settings, studied));
    choice.settings.set("normal_offset", fmt::format("{}", normal_offset));
    return choice;
}

/// Every light without extent, in its centre.
void harden_lights(PreparedScene& prepared) {
    for (Light& light : prepared.scene.lights)
        if (is_area(light.kind)) light.kind = LightKind::point;
    face_lights(prepared.points, prepared.scene);
    prepared.facts = find_facts(prepared.scene);
}

}  // namespace

BiasErrors& BiasErrors::operator+=(const BiasErrors& other) {
    false_shadow.interior += other.false_shadow.interior;
    false_shadow.edge += other.false_shadow.edge;
    false_light.interior += other.false_light.interior;
    false_light.edge += other.false_light.edge;
    return *this;
}

BiasGrid default_bias_grid() {
    const std::vector<double> doubling{0, 0.125, 0.25, 0.5, 1, 2, 4, 8, 16, 32, 64, 128};
    return {doubling, doubling, {0, 1, 2, 4}};
}

const BiasCell& best_cell(const BiasStudy& study) {
    return *std::ranges::min_element(study.cells, {}, [](const BiasCell& c) {
        return std::tuple(c.errors.interior(), c.errors.edge(), c.constant + c.slope + c.normal_offset);
    });
}

std::size_t better_cells(const BiasStudy& study) {
    return static_cast<std::size_t>(std::ranges::count_if(
        study.cells, [&](const BiasCell& c) { return c.errors.interior() < study.automatic.interior(); }));
}

BiasStudy add_up(const std::vector<BiasStudy>& studies) {
    BiasStudy all = studies.at(0);
    all.name      = "all";
    all.title     = "All scenes";
    all.lights.clear();
    for (std::size_t k = 1; k < studies.size(); ++k) {
        all.points += studies[k].points;
        all.automatic += studies[k].automatic;
        all.receiver_plane += studies[k].receiver_plane;
        for (std::size_t i = 0; i < all.cells.size(); ++i) all.cells[i].errors += studies[k].cells[i].errors;
    }
    return all;
}

BiasStudy study_bias(PreparedScene prepared, const std::string& settings, const BiasGrid& grid,
                     const std::function<void(const std::string&)>& progress) {
    std::vector<MethodChoice> choices;  // a slice; first of all, since they may be refused
    for (double offset : grid.normal_offsets) choices.push_back(choose(settings, offset));
    harden_lights(prepared);
    const Scene& scene = prepared.scene;
    BiasStudy study{scene.name, scene.title, {}, 0, {}, {}, {}};
    for (const Light& light : scene.lights) study.lights.push_back(light.name);
    for (double offset : grid.normal_offsets)
        for (double slope : grid.slopes)
            for (double constant : grid.constants) study.cells.push_back({constant, slope, offset, {}});

    progress(fmt::format("{}: exact", scene.name));
    const MethodChoice choice               = parse_method("exact");
    const std::unique_ptr<Method> reference = choice.info->make(choice.settings);
    reference->build(scene, prepared.facts);
    std::vector<Truth> truths;
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        truths.push_back(find_truth(*reference, prepared.points, light));
        study.points += static_cast<std::uint64_t>(
            std::ranges::count_if(truths.back().place, [](Truth::Place p) { return p != Truth::Place::unjudged; }));
    }

    const std::size_t slice = grid.constants.size() * grid.slopes.size();
    for (std::size_t k = 0; k < grid.normal_offsets.size(); ++k) {
        // The border of a map depends on the offset: maps of their own are what the method itself would draw.
        Lookups lookups(prepared, choices[k]);
        for (LightId light = 0; light < scene.lights.size(); ++light) {
            progress(
                fmt::format("{}: {}, normal offset {}", scene.name, scene.lights[light].name, grid.normal_offsets[k]));
            lookups.aim(light);
            if (grid.normal_offsets[k] == 0) {
                study.automatic += lookups.errors(truths[light], {BiasMode::automatic, 0, 0, 0});
                study.receiver_plane += lookups.errors(truths[light], {BiasMode::receiver_plane, 0, 0, 0});
            }
            for (BiasCell& cell : std::span(study.cells).subspan(k * slice, slice))
                cell.errors +=
                    lookups.errors(truths[light], {BiasMode::manual, cell.constant, cell.slope, cell.normal_offset});
        }
    }
    return study;
}

}  // namespace umbra
