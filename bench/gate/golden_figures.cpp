#include "umbra/bench/gate/golden_figures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "umbra/bench/lab/outcome.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

constexpr int kRangeSeeds    = 32;
constexpr double kRangeWidth = 6;  // standard deviations: were the seed another, a figure would leave its range about
                                   // twice in a million (Student's t, 31 degrees of freedom, one new value)

bool is_range(const Json& figure) {
    return figure.is_array() && figure.size() == 2 && figure[0].is_number() && figure[1].is_number();
}

}  // namespace

Json figures_of(const PreparedScene& prepared, const MethodRun& run, const MethodRun& exact) {
    Json figures = Json::object();
    for (LightId j = 0; j < run.planes.size(); ++j) {
        const Explained explained     = explain(prepared.scene, prepared.points, j, run, exact);
        const VisibilityError& e      = explained.error;
        const EdgeDisplacement edges  = explained.displacement.value_or(EdgeDisplacement{});
        const PenumbraWidth penumbrae = explained.penumbra_width.value_or(PenumbraWidth{});

        figures[prepared.scene.lights[j].name] = {{"points", e.points},
                                                  {"undefined", e.undefined},
                                                  {"on_boundary", e.on_boundary},
                                                  {"lit", e.lit},
                                                  {"umbra", e.umbra},
                                                  {"penumbra", e.penumbra},
                                                  {"false_shadow_interior", e.false_shadow.interior},
                                                  {"acne", e.acne},
                                                  {"false_shadow_edge", e.false_shadow.edge},
                                                  {"false_light_interior", e.false_light.interior},
                                                  {"detachment", e.detachment},
                                                  {"leak", e.leak},
                                                  {"false_light_edge", e.false_light.edge},
                                                  {"terminator_wrong", e.terminator.wrong},
                                                  {"mae", e.mae},
                                                  {"edge_pieces", edges.pieces},
                                                  {"edge_unmatched", edges.unmatched},
                                                  {"edge_displacement_mean", edges.mean},
                                                  {"edge_displacement_max", edges.max},
                                                  {"penumbra_width", penumbrae.method}};
        if (!is_area(prepared.scene.lights[j].kind)) continue;
        Json& area                    = figures[prepared.scene.lights[j].name];
        area["penumbra_false_shadow"] = e.penumbra_error.false_shadow;
        area["penumbra_false_light"]  = e.penumbra_error.false_light;
    }
    return figures;
}

void add_figure_changes(const Json& accepted, const Json& now, Changes& changes) {
    for (const auto& light : accepted.items())
        if (!now.contains(light.key())) changes.add(light.key() + ": no longer in the scene", false);
    for (const auto& light : now.items()) {
        const Json old = accepted.value(light.key(), Json::object());
        if (old.empty()) {
            changes.add(light.key() + ": figures are new", false);
            continue;
        }
        for (const auto& item : old.items())
            if (!light.value().contains(item.key()))
                changes.add(fmt::format("{}: {} is no longer measured", light.key(), item.key()), false);
        std::vector<std::string> fresh;
        for (const auto& item : light.value().items()) {
            const std::string name = fmt::format("{}: {}", light.key(), item.key());
            const Json& value      = item.value();
            const bool at_edges =
                item.key().find("edge") != std::string::npos || item.key() == "mae" || item.key() == "penumbra_width";
            if (!old.contains(item.key())) {
                fresh.push_back(item.key());
            } else if (const Json& before = old[item.key()]; is_range(before)) {
                const bool below = value<before[0], above = value> before[1];
                if (below || above)
                    changes.add(fmt::format("{} {} is {} its range {}", name, value.dump(), below ? "below" : "above",
                                            before.dump()),
                                false);
            } else if (before != value) {
                changes.add(fmt::format("{} {} -> {}", name, before.dump(), value.dump()), at_edges);
            }
        }
        if (!fresh.empty()) changes.add(fmt::format("{}: new figures {}", light.key(), fmt::join(fresh, ", ")), false);
    }
}

Json with_ranges(Json figures, const PreparedScene& prepared, const MethodChoice& choice, const MethodRun& exact) {
    const std::vector<Light>& lights = prepared.scene.lights;
    if (std::none_of(lights.begin(), lights.end(), [&](const Light& l) { return is_sampled(choice, l); }))
        return figures;
    std::vector<Json> samples;
    for (int k = 0; k < kRangeSeeds; ++k) {
        MethodChoice seeded = choice;
        seeded.settings.set(choice.info->seed, 1000 + k);
        samples.push_back(figures_of(prepared, run_once(seeded, prepared), exact));
    }
    for (const Light& light : lights) {
        if (!is_sampled(choice, light)) continue;
        for (auto& item : figures[light.name].items()) {
            double sum = 0, squares = 0;
            for (const Json& sample : samples) sum += sample[light.name][item.key()].get<double>();
            const double mean = sum / kRangeSeeds;
            for (const Json& sample : samples)
                squares += std::pow(sample[light.name][item.key()].get<double>() - mean, 2);
            const double width = kRangeWidth * std::sqrt(squares / (kRangeSeeds - 1));
            if (width == 0) continue;
            const bool count = item.value().is_number_integer();
            const double low = std::max(0.0, mean - width), high = mean + width;
            if (count)
                item.value() = {static_cast<std::uint64_t>(low), static_cast<std::uint64_t>(std::ceil(high))};
            else
                item.value() = {std::stod(fmt::format("{:.3g}", low)), std::stod(fmt::format("{:.3g}", high))};
        }
    }
    return figures;
}

Figures read_figures(const fs::path& file) {
    std::ifstream in(file);
    if (!in) return {};
    const Json record    = Json::parse(in, nullptr, false);
    const auto object_of = [](const auto& is_member) {
        return
            [=](const Json& value) { return value.is_object() && std::all_of(value.begin(), value.end(), is_member); };
    };
    const auto is_figure  = [](const Json& value) { return value.is_number() || is_range(value); };
    const auto is_methods = object_of(object_of(object_of(is_figure)));
    if (!record.is_object() || !record.value("machine", Json()).is_string() ||
        !is_methods(record.value("methods", Json())))
        throw InputError(
            fmt::format("{}: expected the figures of methods and lights; remove the file and run umbra accept to "
                        "write it again",
                        file.string()));
    return {record["machine"], record["methods"]};
}

std::string figures_text(const Figures& figures) {
    std::string text = fmt::format("{{\n \"machine\": {},\n \"methods\": {{", Json(figures.machine).dump());
    bool first       = true;
    for (const MethodInfo* info : methods()) {
        const auto method = figures.methods.find(std::string(info->name));
        if (method == figures.methods.end()) continue;
        text += fmt::format("{}\n  \"{}\": {{", first ? "" : ",", info->name);
        for (auto light = method->begin(); light != method->end(); ++light)
            text += fmt::format("{}\n   {}: {}", light == method->begin() ? "" : ",", Json(light.key()).dump(),
                                light.value().dump());
        text += "\n  }";
        first = false;
    }
    return text + "\n }\n}\n";
}

}  // namespace umbra
