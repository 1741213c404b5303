#include "umbra/bench/report/lecture_experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "report_assets.h"
#include "umbra/bench/base/files.h"
#include "umbra/bench/base/staged_folder.h"
#include "umbra/bench/lab/asked_method.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/report/formula.h"
#include "umbra/bench/studies/light/shading_models.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/image/metrics.h"
#include "umbra/core/render/shade.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A variant of an experiment, with what it lacks.
struct ExperimentSetting {
    const json &variant, &experiment, &base;

    /// Null where nobody has it.
    [[nodiscard]] json operator[](const char* key) const {
        for (const json* of : {&variant, &experiment, &base})
            if (const auto found = of->find(key); found != of->end()) return *found;
        return {};
    }
    [[nodiscard]] std::string text(const char* key) const { return (*this)[key].get<std::string>(); }
    void define_names(NamedNumbers& names) const {
        for (const json* of : {&base, &experiment, &variant})
            for (const json& definition : of->value("let", json::array())) define(names, definition.get<std::string>());
    }
};

json scene_of(const ExperimentSetting& setting, const fs::path& scenes) {
    json scene      = setting.base["scene"];
    const json& own = setting.experiment.value("scene", json::object());
    if (own.is_string()) {
        const fs::path file = scenes / (own.get<std::string>() + ".json");
        std::ifstream in(file);
        scene = json::parse(in, nullptr, false);
        if (scene.is_discarded()) throw InputError(fmt::format("{}: cannot be read", file.string()));
    } else {
        scene.merge_patch(own);
    }
    const json set = setting.variant.value("set", json::object());
    for (const auto& [pointer, value] : set.items()) scene[json::json_pointer(pointer)] = value;
    return scene;
}

/// A picture, and what is known at its pixels.
struct MeasuredPicture {
    Image linear, shown;
    std::vector<VisibilityPlane> planes;

    void name_pixel(NamedNumbers& names, std::size_t i, std::size_t j) const {
        const std::size_t pixel = j * static_cast<std::size_t>(linear.width) + i;
        names["i"]              = static_cast<double>(i);
        names["j"]              = static_cast<double>(j);
        for (std::size_t c = 0; c < 3; ++c) {
            names[std::string(1, "RGB"[c])] = static_cast<double>(linear.at(pixel, c));
            names[std::string(1, "rgb"[c])] = static_cast<double>(linear_from_srgb(shown.at(pixel, c)));
        }
        if (!planes.empty()) names["S"] = static_cast<double>(planes[0].s[pixel]);
    }
};

MeasuredPicture picture_of_experiment(const ExperimentSetting& setting, const fs::path& file) {
    const PreparedScene prepared = prepare_scene(file, {}, 1, Work::picture);
    AskedMethod shadows(prepared.scene, prepared.facts, parse_method(setting.text("method")));
    MeasuredPicture picture;
    picture.planes   = shadows(prepared.points);
    const json model = setting["model"];
    if (model.is_null()) {
        picture.linear = shade(prepared.scene, prepared.points, picture.planes);
    } else {
        const auto named = std::ranges::find(kShadingModels, model.get<std::string>(),
                                             [](ShadingModel each) { return to_string(each); });
        if (named == kShadingModels.end()) throw InputError(fmt::format("no shading model {}", model.dump()));
        const AskVisibility ask = [&](const PointBatch& points) { return shadows(points); };
        picture.linear          = shade_by(*named, prepared.scene, prepared.points, ask).linear;
    }
    picture.shown = displayed(picture.linear, prepared.scene.tone, prepared.scene.exposure);
    return picture;
}

/// Pixels from one end of the line to the other.
std::vector<std::pair<std::size_t, std::size_t>> pixels_along(const json& line) {
    const auto ends = line.get<std::array<int, 4>>();
    const int steps = std::max(std::abs(ends[2] - ends[0]), std::abs(ends[3] - ends[1]));
    std::vector<std::pair<std::size_t, std::size_t>> pixels;
    for (int k = 0; k <= steps; ++k)
        pixels.emplace_back(ends[0] + (ends[2] - ends[0]) * k / std::max(1, steps),
                            ends[1] + (ends[3] - ends[1]) * k / std::max(1, steps));
    return pixels;
}

/// What is measured beside the formula, at each pixel of the line; without a picture the formula alone.
ExperimentCurve curve_along(const ExperimentSetting& setting, const MeasuredPicture* picture) {
    ExperimentCurve curve{.name = setting.text("name")};
    NamedNumbers names;
    for (const auto& [i, j] : pixels_along(setting["line"])) {
        names["i"] = static_cast<double>(i), names["j"] = static_cast<double>(j);
        if (picture != nullptr) picture->name_pixel(names, i, j);
        setting.define_names(names);
        curve.x.push_back(formula_value(setting.text("x"), names));
        curve.formula.push_back(formula_value(setting.text("formula"), names));
        if (picture != nullptr) curve.measured.push_back(formula_value(setting.text("value"), names));
    }
    return curve;
}

void note_deviation(const ExperimentSetting& setting, ExperimentCurve& curve) {
    for (std::size_t k = 0; k < curve.formula.size(); ++k) {
        if (std::isnan(curve.formula[k])) continue;
        const double off = std::abs(curve.measured[k] - curve.formula[k]);
        // What is not a number is farther off than any number that a record can hold.
        constexpr double kFarthest = std::numeric_limits<double>::max();
        curve.deviation            = std::max(curve.deviation.value_or(0), off <= kFarthest ? off : kFarthest);
    }
    curve.limit = setting["limit"].get<double>();
}

/// The mean along the line in each frame of the scene's animation.
ExperimentCurve curve_of_frames(const ExperimentSetting& setting, const fs::path& file) {
    ExperimentCurve curve{.name = setting.text("name")};
    const auto frames = setting["frames"].get<int>();
    for (int k = 0; k < frames; ++k) {
        const MeasuredPicture picture = picture_of_experiment(setting, fmt::format("{}@{}", file.string(), k));
        NamedNumbers names{{"k", k}};
        double sum        = 0;
        const auto pixels = pixels_along(setting["line"]);
        for (const auto& [i, j] : pixels) {
            picture.name_pixel(names, i, j);
            sum += formula_value(setting.text("value"), names);
        }
        setting.define_names(names);
        curve.x.push_back(k);
        curve.measured.push_back(sum / static_cast<double>(pixels.size()));
        curve.formula.push_back(formula_value(setting.text("formula"), names));
    }
    return curve;
}

}  // namespace

const json& lecture_experiments() {
    static const json all = json::parse(assets::experiments_json);
    return all;
}

ExperimentRecord run_experiment(const std::string& id, const json& experiment, const json& base, const fs::path& folder,
                                const fs::path& scenes) {
    ExperimentRecord record{.name = id, .law = experiment.value("law", "")};
    std::vector<std::string> texts;  // of the pictures' scenes
    std::vector<MeasuredPicture> pictures;
    std::vector<std::size_t> of_variants;  // the picture of each
    for (const json& variant : experiment["variants"]) {
        const ExperimentSetting setting{variant, experiment, base};
        const std::string text = scene_of(setting, scenes).dump(2) + "\n", frame = setting["frame"].dump(),
                          drawn = text + frame + setting["model"].dump() + setting["method"].dump();
        const auto same         = static_cast<std::size_t>(std::ranges::find(texts, drawn) - texts.begin());
        of_variants.push_back(same);
        if (same == texts.size()) {
            texts.push_back(drawn);
            const std::string name = fmt::format("{}-{}", id, same + 1);
            const json caption     = setting["caption"];  // where a curve's name says too little of the picture
            record.pictures.push_back({caption.is_null() ? setting.text("name") : caption.get<std::string>(),
                                       {name + ".png"},
                                       {name + ".json"}});
            write_text(folder / (name + ".json"), text);
            pictures.push_back(picture_of_experiment(setting, folder / (name + ".json@" + frame)));
            write_image(folder / (name + ".png"), pictures.back().shown);
        }
        if (setting["formula"].is_null()) continue;
        const bool over_frames = !setting["frames"].is_null();
        ExperimentCurve curve  = over_frames ? curve_of_frames(setting, folder / record.pictures[same].scene.name)
                                             : curve_along(setting, &pictures[same]);
        note_deviation(setting, curve);
        record.curves.push_back(std::move(curve));
    }
    for (const json& formula : experiment.value("also", json::array()))
        record.curves.push_back(curve_along({formula, experiment, base}, nullptr));
    for (const json& pair : experiment.value("pairs", json::array())) {
        const std::size_t one   = of_variants[pair[0].get<std::size_t>()],
                          other = of_variants[pair[1].get<std::size_t>()];
        record.pairs.push_back({record.pictures[one].name, record.pictures[other].name,
                                image_error(pictures[one].linear, pictures[other].linear).rmse});
    }
    const ExperimentSetting whole{experiment, experiment, base};
    record.x = whole.text("x_title"), record.y = whole.text("y_title");
    return record;
}

std::vector<ListedFailureRecord> draw_experiments(const fs::path& out, const fs::path& scenes,
                                                  const std::string& command) {
    StagedFolder folder(out);
    ExperimentsRecord record{.head = head_record(command)};
    const json& all = lecture_experiments();
    for (const auto& [id, experiment] : all["experiments"].items()) {
        const json& scene = experiment.value("scene", json::object());  // another folder of scenes may not have it
        if (scene.is_string() && !fs::exists(scenes / (scene.get<std::string>() + ".json"))) continue;
        try {
            record.experiments.push_back(run_experiment(id, experiment, all["base"], folder.folder(), scenes));
        } catch (const std::exception& error) {
            record.failed.push_back({.scene = id, .method = "the experiment", .failure = {.message = error.what()}});
        }
    }
    write_text(folder.folder() / "results.json", json_text(to_record(record)));
    folder.commit();
    return record.failed;
}

}  // namespace umbra
