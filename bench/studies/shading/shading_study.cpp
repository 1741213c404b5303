#include "umbra/bench/studies/shading/shading_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/lab/asked_method.h"
#include "umbra/bench/studies/light/shading_models.h"
#include "umbra/bench/studies/shading/stages.h"
#include "umbra/bench/sweep/views.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/image/metrics.h"
#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/render/shade.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

constexpr auto kPhong = static_cast<std::size_t>(ShadingModel::phong);  ///< in the order of kShadingModels

double luminance(const Image& linear, std::size_t i) {
    return 0.2126 * static_cast<double>(linear.at(i, 0)) + 0.7152 * static_cast<double>(linear.at(i, 1)) +
           0.0722 * static_cast<double>(linear.at(i, 2));
}

/// The largest luminance of a pixel with a surface.
double highlight(const Image& linear, const PointBatch& points) {
    double largest = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points.triangle[i] != kNoTriangle) largest = std::max(largest, luminance(linear, i));
    return largest;
}

/// The root mean square of value_at(i) over the middle i of each three neighbours of a row that show one object.
template <class Value>
double rms_of_triples(const Scene& scene, const PointBatch& points, const Value& value_at) {
    const auto width     = static_cast<std::size_t>(points.raster->width);
    const auto object_at = [&](std::size_t i) {
        return points.triangle[i] == kNoTriangle ? ~0u : scene.triangle_object[points.triangle[i]];
    };
    double sum          = 0;
    std::size_t triples = 0;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        if (i % width == 0 || (i + 1) % width == 0 || object_at(i) == ~0u) continue;
        if (object_at(i - 1) != object_at(i) || object_at(i + 1) != object_at(i)) continue;
        sum += std::pow(value_at(i), 2);
        ++triples;
    }
    return triples > 0 ? std::sqrt(sum / static_cast<double>(triples)) : 0;
}

/// The root mean square difference of what the eye takes two pictures for, which is more than the light where that
/// changes: the luminance and how much it changes from a pixel to the next.
double perceived_difference(const PreparedScene& prepared, const Image& a, const Image& b) {
    const auto perceived = [](const Image& linear, std::size_t i) {
        return luminance(linear, i) + std::abs(luminance(linear, i + 1) - luminance(linear, i - 1)) / 2;
    };
    return rms_of_triples(prepared.scene, prepared.points,
                          [&](std::size_t i) { return perceived(a, i) - perceived(b, i); });
}

/// The root mean square of I(x - 1) - 2 I(x) + I(x + 1) of the luminance over triples of pixels that show one object,
/// of the diffuse light without shadows: highlights and edges of shadows would outshine the bands.
double kink(ShadingModel model, const PreparedScene& prepared) {
    Scene diffuse = prepared.scene;
    for (Material& material : diffuse.materials) material.k_s = vec3(0);
    const PointBatch& points = prepared.points;
    const Image linear       = shade_by(model, diffuse, points, [&](const PointBatch& asked) {
                             return lit_everywhere(diffuse, asked);
                         }).linear;
    return rms_of_triples(diffuse, points, [&](std::size_t i) {
        return luminance(linear, i - 1) - 2 * luminance(linear, i) + luminance(linear, i + 1);
    });
}

double ratio(double a, double b) { return b > 0 ? a / b : a > 0 ? std::numeric_limits<double>::infinity() : 1; }

/// Grey where both are the same, brighter where the first is.
Image difference_of(const Image& a, const Image& b) {
    Image difference(a.width, a.height, {"R", "G", "B"});
    for (std::size_t k = 0; k < a.data.size(); ++k) difference.data[k] = 0.5f + (a.data[k] - b.data[k]);
    return difference;
}

struct Measured {
    ShadedPicture shaded;
    Image shown;
    std::vector<double> times_ms{};
    std::size_t asked = 0;
};

/// One run of a model.
void run(ShadingModel model, const PreparedScene& prepared, AskedMethod& shadows, Measured& measured) {
    measured.times_ms.push_back(
        timed_ms([&] { measured.shaded = shade_by(model, prepared.scene, prepared.points, std::ref(shadows)); }));
    measured.asked = model == ShadingModel::constant ? 0 : shadows.asked();
}

/// All models, and `phong` once more, in rounds that begin with another one each time.
std::vector<Measured> measure(const PreparedScene& prepared, const ShadingOptions& options, AskedMethod& shadows) {
    std::vector<ShadingModel> models(kShadingModels.begin(), kShadingModels.end());
    models.push_back(ShadingModel::phong);
    std::vector<Measured> measured(models.size());
    for (int round = 0; round < options.runs; ++round)
        for (std::size_t k = 0; k < models.size(); ++k) {
            const std::size_t turn = (k + static_cast<std::size_t>(round)) % models.size();
            run(models[turn], prepared, shadows, measured[turn]);
        }
    for (Measured& m : measured) m.shown = displayed(m.shaded.linear, prepared.scene.tone, prepared.scene.exposure);
    return measured;
}

ShadingErrorsRecord errors(const PreparedScene& prepared, const Measured& phong, const Measured& here) {
    return {image_error(phong.shaded.linear, here.shaded.linear).rmse, flip_ldr(phong.shown, here.shown).mean,
            perceived_difference(prepared, phong.shaded.linear, here.shaded.linear)};
}

/// The largest errors of each model over the views, of which the first is measured already.
std::vector<ShadingErrorsRecord> worst_errors(const PreparedScene& prepared, const std::vector<Measured>& measured,
                                              const ShadingOptions& options) {
    std::vector<ShadingErrorsRecord> worst(kShadingModels.size(), {0, 0, 0});
    const auto take = [&](const PreparedScene& view, const std::vector<Measured>& seen) {
        for (std::size_t k = 0; k < worst.size(); ++k) {
            const ShadingErrorsRecord found = errors(view, seen[kPhong], seen[k]);
            worst[k]                        = {std::max(worst[k].rmse, found.rmse), std::max(worst[k].flip, found.flip),
                                               std::max(worst[k].perceived, found.perceived)};
        }
    };
    take(prepared, measured);
    for (int v = 1; v < options.views; ++v) {
        const PreparedScene view = prepare_scene(view_of(prepared.scene, v), prepared.scene.name, {});
        AskedMethod shadows(view.scene, view.facts, options.method);
        ShadingOptions once = options;
        once.runs           = 1;
        take(view, measure(view, once, shadows));
    }
    return worst;
}

}  // namespace

ShadingRecord compare_shading(const PreparedScene& prepared, const ShadingOptions& options, const fs::path& folder) {
    AskedMethod shadows(prepared.scene, prepared.facts, options.method);
    const std::vector<Measured> measured = measure(prepared, options, shadows);
    const Measured &phong = measured[kPhong], &again = measured.back();
    const double brightest = highlight(phong.shaded.linear, prepared.points),
                 smooth    = kink(ShadingModel::phong, prepared);
    const auto worst       = worst_errors(prepared, measured, options);
    ShadingRecord record{.head      = head_record(options.command),
                         .scene     = scene_record(prepared.scene),
                         .views     = options.views,
                         .noise_bar = noise_bar(paired_ratio(again.times_ms, phong.times_ms))};
    if (options.method) record.method = options.method->text();
    for (std::size_t k = 0; k < kShadingModels.size(); ++k) {
        const ShadingModel model = kShadingModels[k];
        const Measured& here     = measured[k];
        const std::string name(to_string(model)), picture = name + ".png", difference = name + "_difference.png";
        write_image(folder / picture, here.shown);
        write_image(folder / difference, difference_of(here.shown, phong.shown));
        const Image& linear             = here.shaded.linear;
        const ShadingErrorsRecord found = errors(prepared, phong, here);
        record.models.push_back({.name        = name,
                                 .evaluations = here.shaded.evaluations,
                                 .asked       = here.asked,
                                 .ms          = median(here.times_ms),
                                 .times_ms    = here.times_ms,
                                 .rmse        = found.rmse,
                                 .worst       = worst[k],
                                 .flip        = found.flip,
                                 .perceived   = found.perceived,
                                 .highlight   = ratio(highlight(linear, prepared.points), brightest),
                                 .kink        = ratio(kink(model, prepared), smooth),
                                 .picture     = picture,
                                 .difference  = difference});
    }
    if (!is_too_noisy(record.noise_bar)) record.front = shading_front(record.models);
    if (!options.limits.empty()) record.choice = choose_shading(record, options.limits);
    for (const Stage& stage : draw_stages(prepared, std::ref(shadows))) {
        const std::string picture = fmt::format("stage_{}_{}.png", record.stages.size() + 1, stage.name);
        write_image(folder / picture, stage.picture);
        record.stages.push_back({std::string(stage.name), std::string(stage.about), picture});
    }
    return record;
}

}  // namespace umbra
