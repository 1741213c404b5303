#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/lab/at_work.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/point_answer.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

struct WhyLine {
    std::string scene, light;
    Size size;
    int x = 0, y = 0;
    std::vector<std::string> methods;
    bool as_json = false;
};

struct WhyLightRecord {
    std::string light{};
    bool away = false, unshadowed = false;
    std::string decided{}, truth{};
    std::vector<AnswerRecord> methods{};
};
DESCRIBE(WhyLightRecord) {
    MEMBERS(light, methods);
    of.may(MEMBER(away), "the light is behind the surface");
    of.may(MEMBER(unshadowed), "the object receives no shadows, or the point lies in the light");
    of.may(MEMBER(decided), "why no method is asked, in words");
    of.may(MEMBER(truth), "what is in the way, in words");
}

struct PointRecord {
    TriangleRecord on{};
    float u = 0, v = 0;
    std::vector<float> position{};
    std::vector<double> origin{};
};
DESCRIBE(PointRecord) {
    of.all(&R::on);
    MEMBERS(u, v, position);
    of.may(MEMBER(origin), "where (0, 0, 0) is in the numbers of the scene file");
}

struct WhyRecord {
    std::string scene{};
    std::vector<int> pixel{};
    PointRecord point{};
    std::vector<WhyLightRecord> lights{};
};
DESCRIBE(WhyRecord) {
    MEMBERS(scene);
    of(MEMBER(pixel), "column and row, from 0 at the top left");
    MEMBERS(point, lights);
}

std::string text_of(const WhyRecord& record) {
    const PointRecord& point = record.point;
    std::string text = fmt::format("{}: pixel {}, {}: triangle {} of {}, position {:.6g} {:.6g} {:.6g}\n", record.scene,
                                   record.pixel[0], record.pixel[1], point.on.triangle, point.on.object,
                                   point.position[0], point.position[1], point.position[2]);
    for (const WhyLightRecord& light : record.lights) {
        text += fmt::format("light {}\n", light.light);
        if (!light.decided.empty()) text += "  " + light.decided + "\n";
        if (!light.truth.empty()) text += fmt::format("  {:24} {}\n", "the truth", light.truth);
        for (const AnswerRecord& a : light.methods) {
            text += fmt::format("  {:24} {}\n", a.method, sentence(a));
            if (!a.difference.empty()) text += fmt::format("  {:24}   unlike the truth: {}\n", "", a.difference);
        }
    }
    return text;
}

int why(const WhyLine& line, const Common& common) {
    const std::filesystem::path file = scene_file(line.scene, common.up);
    const PreparedScene prepared     = prepare_scene(file, line.size);
    const Scene& scene               = prepared.scene;
    const PointBatch& points         = prepared.points;
    const int width = points.raster->width, height = points.raster->height;
    if (line.x < 0 || line.x >= width || line.y < 0 || line.y >= height)
        throw UsageError(fmt::format("pixel {}, {}: expected 0 to {}, 0 to {}", line.x, line.y, width - 1, height - 1));
    const auto i =
        static_cast<std::size_t>(line.y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(line.x);
    if (points.triangle[i] == kNoTriangle) {
        print_error("no surface at pixel {}, {}\n", line.x, line.y);
        return kNo;
    }
    if (!line.light.empty() && std::ranges::find(scene.lights, line.light, &Light::name) == scene.lights.end())
        throw UsageError(fmt::format("no light \"{}\" in {}", line.light, scene.name));
    const std::vector<MethodChoice> choices = chosen_methods(line.methods, {}, {&file, 1});

    const vec3 p = points.position(i);
    WhyRecord record{.scene = scene.name,
                     .pixel = {line.x, line.y},
                     .point = {triangle_record(scene, points.triangle[i]), points.u[i], points.v[i], {p.x, p.y, p.z}}};
    if (const dvec3 o = scene.origin; o != dvec3(0)) record.point.origin = {o.x, o.y, o.z};
    std::vector<LightId> lights;
    for (LightId light = 0; light < scene.lights.size(); ++light)
        if (line.light.empty() || scene.lights[light].name == line.light) {
            lights.push_back(light);
            record.lights.push_back(
                {.light = scene.lights[light].name, .decided = decided_in_words(scene, points, light, i)});
        }
    // The truth first, whichever methods are asked: it says what their answers should be.
    MethodAtWork reference(default_reference(prepared.facts).choice, scene, prepared.facts);
    std::vector<AnswerRecord> truths(lights.size());
    for (std::size_t k = 0; k < lights.size(); ++k) {
        WhyLightRecord& entry = record.lights[k];
        if (!points.asks(lights[k], i)) {
            (points.faces(lights[k], i) ? entry.unshadowed : entry.away) = true;
            continue;
        }
        truths[k]   = answer_record(reference, points, i, lights[k]);
        entry.truth = truths[k].answered ? truth_in_words(truths[k], scene, points, i, lights[k]) : truths[k].failed;
    }
    for (const MethodChoice& choice : choices) {
        MethodAtWork work(choice, scene, prepared.facts);
        const Service service = work.service();
        for (std::size_t k = 0; k < lights.size(); ++k) {
            if (!points.asks(lights[k], i)) continue;
            AnswerRecord answer{.method = choice.text(), .not_served = service.why};
            if (service) {
                answer = answer_record(work, points, i, lights[k]);
                // The truth is that of areas: another measure is no error.
                if (work.method().measures() == Measure::area)
                    add_difference(answer, truths[k], scene, points, i, lights[k]);
            }
            record.lights[k].methods.push_back(std::move(answer));
        }
    }
    print_out("{}", line.as_json ? json_text(to_record(record)) : without_controls(text_of(record)));
    return kDone;
}

}  // namespace

Action why_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<WhyLine>();
    add_scene(app, line->scene)->required();
    app.add_option("X", line->x, "Column of the pixel, from 0")->type_name("")->required();
    app.add_option("Y", line->y, "Row of the pixel, from 0 at the top")->type_name("")->required();
    app.add_option("--light", line->light, "One light (default: all)")->type_name("NAME");
    add_methods(app, line->methods, "Methods, with settings (default: those that compare runs)");
    add_size(app, line->size);
    app.add_flag("--json", line->as_json, "Print the reasons as JSON");
    return [line, &common] { return why(*line, common); };
}

}  // namespace umbra
