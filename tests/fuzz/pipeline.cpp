#include "umbra/tests/fuzz/pipeline.h"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/shade.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kMostTriangles = 1500, kMostLights = 6;

/// Settings of every method that reach other code than the defaults, with maps, patches and samples that are few:
/// a picture has 96 points.
constexpr std::array kSettings{
    "planar_projection:light_samples=4"sv,
    "planar_projection:light_samples=2,edges=per_triangle"sv,
    "scan_line"sv,
    "shadow_volumes"sv,
    "shadow_volumes:edges=silhouette,counting=depth_fail"sv,
    "shadow_volumes:edges=per_triangle"sv,
    "atherton_weiler"sv,
    "shadow_zbuffer:resolution=32"sv,
    "shadow_zbuffer:resolution=16,bias=manual,constant=1,slope=1,normal_offset=1,filter=pcf,fit=scene,depth=16"sv,
    "shadow_zbuffer:resolution=16,filter=pcf,kernel=disc,samples=4,rotation=noise,surface=midpoint,surround=0"sv,
    "shadow_zbuffer:resolution=16,filter=pcss,samples=4,rotation=gradient,faces=back,contact_steps=4"sv,
    "cascaded_maps:resolution=32"sv,
    "cascaded_maps:resolution=16,cascades=2,splits=logarithmic,depth_range=visible,blend=0.5,filter=pcf"sv,
    "cascaded_maps:resolution=16,cascades=3,window=frustum,stable=true,bias=receiver_plane"sv,
    "filtered_map:resolution=32"sv,
    "filtered_map:resolution=16,filter=pcss,kind=vsm,searches=2"sv,
    "filtered_map:resolution=16,kind=msm,empty=far,bias=manual,constant=1,precision=double"sv,
    "alias_free"sv,
    "ray_traced:samples=4"sv,
    "ray_traced:samples=4,offset=integer_offset,sampler=stratified,cull=none"sv,
    "ray_traced:samples=8,offset=epsilon,measure=irradiance"sv,
    "ray_traced:samples=4,coarseness=0.02"sv,
    "soft_volumes:samples=4"sv,
    "soft_volumes:samples=8,sampler=r2,doubtful=count"sv,
    "radiosity:size=0.25,levels=1,samples=1"sv,
    "radiosity:size=0.5,levels=2,samples=2,interpolation=constant"sv,
    "brute_force:samples=4"sv,
    "exact"sv,
    "exact:hard_lights=segments"sv};

std::vector<MethodChoice> choices() {
    std::vector<MethodChoice> all;
    for (const MethodInfo* info : methods()) {
        const std::size_t before = all.size();
        for (const std::string_view text : kSettings)
            if (text.substr(0, text.find(':')) == info->name) all.push_back(parse_method(text));
        if (all.size() == before)
            throw std::logic_error(std::string(info->name) + " is not among the fuzzer's settings");
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
    // By measure. That of irradiance takes up to a tenth of a second a point and is asked at a few points alone.
    std::array<std::optional<MethodRun>, 2> reference;
    for (const Measure measure : {Measure::area, Measure::irradiance}) {
        const Reference chosen = default_reference(prepared.facts, measure);
        reference[measure == Measure::area ? 0 : 1] =
            run_reference(chosen, scene, prepared.facts, prepared.points, 16).run;
    }
    static const std::vector<MethodChoice> all = choices();
    for (const MethodChoice& choice : all) {
        const MethodRun run = run_method(choice, scene, prepared.facts, prepared.points);
        if (!run.service) continue;
        const Image linear = shade(scene, prepared.points, run.planes);
        expect_numbers(linear, choice.text());
        expect_numbers(displayed(linear, scene.tone, scene.exposure), choice.text() + ", displayed");
        const MethodRun& truth = *reference[run.work->method().measures() == Measure::area ? 0 : 1];
        for (LightId j = 0; j < scene.lights.size(); ++j) (void)explain(scene, prepared.points, j, run, truth);
    }
}

}  // namespace umbra
