#include "umbra/tests/fuzz/pipeline.h"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "umbra/bench/run/explain.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/bench/run/reference.h"
#include "umbra/bench/run/run.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/shade.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

constexpr std::size_t kMostTriangles = 1500, kMostLights = 6;

/// Settings that reach other code than the defaults, and small maps and samples, which are quick.
constexpr std::array<std::string_view, 10> kSettings{
    "planar_projection:light_samples=4",
    "shadow_volumes",
    "shadow_volumes:edges=silhouette,counting=depth_fail",
    "shadow_volumes:edges=per_triangle",
    "shadow_zbuffer:resolution=32",
    "shadow_zbuffer:resolution=16,bias=manual,constant=1,slope=1,normal_offset=1,filter=pcf,fit=scene,depth=16",
    "ray_traced:samples=4",
    "ray_traced:samples=4,offset=integer_offset,sampler=stratified",
    "ray_traced:samples=8,offset=epsilon,measure=irradiance",
    "exact"};

/// kSettings, and the defaults of methods that are not among them.
std::vector<MethodChoice> choices() {
    std::vector<MethodChoice> all;
    for (const MethodInfo* info : methods()) {
        bool named = false;
        for (const std::string_view text : kSettings)
            if (text.substr(0, text.find(':')) == info->name) all.push_back(parse_method(text)), named = true;
        if (!named) all.emplace_back(*info);
    }
    return all;
}

void expect_numbers(const Image& image, const std::string& what) {
    for (const float x : image.data)
        if (std::isnan(x)) throw std::logic_error(what + ": a pixel is no number");
}

}  // namespace

void run_pipeline(const std::filesystem::path& scene_file) {
    {
        const Scene scene = load_scene(scene_file);
        if (scene.triangles.size() > kMostTriangles || scene.lights.size() > kMostLights) return;
    }
    const PreparedScene prepared = prepare_scene(scene_file, {12, 8});
    const Scene& scene           = prepared.scene;
    const Repeats once{1, 0};
    // By measure. That of irradiance takes up to a tenth of a second a point and is asked at a few points alone.
    std::array<std::optional<MethodRun>, 2> reference;
    for (const Measure measure : {Measure::area, Measure::irradiance}) {
        const Reference chosen = default_reference(prepared.facts, measure);
        reference[measure == Measure::area ? 0 : 1] =
            run_reference(chosen, scene, prepared.facts, prepared.points, 16).run;
    }
    for (const MethodChoice& choice : choices()) {
        const MethodRun run = run_method(choice, scene, prepared.facts, prepared.points, once);
        if (!run.service) continue;
        const Image linear = shade(scene, prepared.points, run.planes);
        expect_numbers(linear, choice.text());
        expect_numbers(displayed(linear, scene.tone, scene.exposure), choice.text() + ", displayed");
        const MethodRun& truth = *reference[run.method->measures() == Measure::area ? 0 : 1];
        for (LightId j = 0; j < scene.lights.size(); ++j) (void)explain(scene, prepared.points, j, run, truth);
    }
}

}  // namespace umbra
