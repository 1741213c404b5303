#include "umbra/bench/shading/shading_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "umbra/bench/run/asked_method.h"
#include "umbra/bench/shading/stages.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/image/metrics.h"
#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/render/shading_models.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

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

/// Calls visit(i) for the middle of each three neighbours of a row that show one object.
template <class Visit>
void for_each_triple(const Scene& scene, const PointBatch& points, const Visit& visit) {
    const auto width     = static_cast<std::size_t>(points.raster->width);
    const auto object_at = [&](std::size_t i) {
        return points.triangle[i] == kNoTriangle ? ~0u : scene.triangle_object[points.triangle[i]];
    };
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        if (i % width == 0 || (i + 1) % width == 0 || object_at(i) == ~0u) continue;
        if (object_at(i - 1) == object_at(i) && object_at(i + 1) == object_at(i)) visit(i);
    }
}

/// The root mean square difference of what the eye takes two pictures for, which is more than the light where that
/// changes: the luminance and how much it changes from a pixel to the next.
double perceived_difference(const PreparedScene& prepared, const Image& a, const Image& b) {
    const auto perceived = [](const Image& linear, std::size_t i) {
        return luminance(linear, i) + std::abs(luminance(linear, i + 1) - luminance(linear, i - 1)) / 2;
    };
    double sum          = 0;
    std::size_t triples = 0;
    for_each_triple(prepared.scene, prepared.points, [&](std::size_t i) {
        sum += std::pow(perceived(a, i) - perceived(b, i), 2);
        ++triples;
    });
    return triples > 0 ? std::sqrt(sum / static_cast<double>(triples)) : 0;
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
    double sum               = 0;
    std::size_t triples      = 0;
    for_each_triple(diffuse, points, [&](std::size_t i) {
        sum += std::pow(luminance(linear, i - 1) - 2 * luminance(linear, i) + luminance(linear, i + 1), 2);
        ++triples;
    });
    return triples > 0 ? std::sqrt(sum / static_cast<double>(triples)) : 0;
}

double ratio(double a, double b) { return b > 0 ? a / b : a > 0 ? std::numeric_limits<double>::infinity() : 1; }

/// A figure that may be infinite, which JSON has not.
std::string figure(const Json& value, int digits) {
    return value.is_null() ? "-" : fmt::format("{:.{}f}", value.get<double>(), digits);
}

/// Grey where both are the same, brighter where the first is.
Image difference_of(const Image& a, const Image& b) {
    Image difference(a.width, a.height, {"R", "G", "B"});
    for (std::size_t k = 0; k < a.data.size(); ++k) difference.data[k] = 0.5f + (a.data[k] - b.data[k]);
    return difference;
}

struct Measured {
    ShadedPicture shaded;
    Image shown;
    double ms         = 0;
    std::size_t asked = 0;
};

Measured measure(ShadingModel model, const PreparedScene& prepared, const ShadingOptions& options,
                 AskedMethod& shadows) {
    Measured measured;
    for (int run = 0; run < options.runs; ++run) {
        const double ms = timed_ms([&] {
            measured.shaded = shade_by(model, prepared.scene, prepared.points,
                                       [&](const PointBatch& points) { return shadows(points); });
        });
        measured.ms     = run == 0 ? ms : std::min(measured.ms, ms);
    }
    measured.asked = model == ShadingModel::constant ? 0 : shadows.asked();
    measured.shown = displayed(measured.shaded.linear, prepared.scene.tone, prepared.scene.exposure);
    return measured;
}

}  // namespace

Json compare_shading(const PreparedScene& prepared, const ShadingOptions& options, const fs::path& folder) {
    AskedMethod shadows(prepared.scene, prepared.facts, options.method);
    const Measured phong   = measure(ShadingModel::phong, prepared, options, shadows);
    const double brightest = highlight(phong.shaded.linear, prepared.points),
                 smooth    = kink(ShadingModel::phong, prepared);
    Json record            = {{"schema", kResultsSchema},
                              {"version", version()},
                              {"command", options.command},
                              {"scene", scene_json(prepared.scene)},
                              {"method", options.method ? Json(options.method->text()) : Json()},
                              {"models", Json::array()}};
    for (const ShadingModel model : kShadingModels) {
        const Measured here = model == ShadingModel::phong ? phong : measure(model, prepared, options, shadows);
        const std::string name(to_string(model)), picture = name + ".png", difference = name + "_difference.png";
        write_image(folder / picture, here.shown);
        write_image(folder / difference, difference_of(here.shown, phong.shown));
        const Image& linear = here.shaded.linear;
        record["models"].push_back({{"name", name},
                                    {"evaluations", here.shaded.evaluations},
                                    {"asked", here.asked},
                                    {"ms", number(here.ms)},
                                    {"rmse", number(image_error(phong.shaded.linear, linear).rmse)},
                                    {"flip", number(flip_ldr(phong.shown, here.shown).mean)},
                                    {"perceived", number(perceived_difference(prepared, phong.shaded.linear, linear))},
                                    {"highlight", number(ratio(highlight(linear, prepared.points), brightest))},
                                    {"kink", number(ratio(kink(model, prepared), smooth))},
                                    {"picture", picture},
                                    {"difference", difference}});
    }
    record["stages"] = Json::array();
    for (const Stage& stage : draw_stages(prepared, [&](const PointBatch& points) { return shadows(points); })) {
        const std::string picture = fmt::format("stage_{}_{}.png", record["stages"].size() + 1, stage.name);
        write_image(folder / picture, stage.picture);
        record["stages"].push_back({{"name", stage.name}, {"about", stage.about}, {"picture", picture}});
    }
    return record;
}

std::string shading_text(const Json& record) {
    std::string text = fmt::format("{:<16} {:>12} {:>12} {:>9} {:>9} {:>9} {:>9} {:>10} {:>7}\n", "model",
                                   "evaluations", "S_j asked", "ms", "RMSE", "FLIP", "perceived", "highlight", "kinks");
    for (const Json& m : record["models"])
        text += fmt::format("{:<16} {:>12} {:>12} {:>9.2f} {:>9.5f} {:>9.5f} {:>9.5f} {:>10} {:>7}\n",
                            m["name"].get<std::string>(), m["evaluations"].get<std::uint64_t>(),
                            m["asked"].get<std::uint64_t>(), m["ms"].get<double>(), m["rmse"].get<double>(),
                            m["flip"].get<double>(), m["perceived"].get<double>(), figure(m["highlight"], 3),
                            figure(m["kink"], 2));
    return text;
}

}  // namespace umbra
