#include "umbra/bench/ladders/ladder_break.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/base/files.h"
#include "umbra/bench/compare/explained_points.h"
#include "umbra/bench/compare/pictures.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/io/scene_writer.h"

namespace umbra {
namespace {

constexpr int kTrials = 120;  ///< scenes asked while reducing; counted, not timed, so that the result is the same

/// The break is still there: of the same kind, on at least half as many points.
bool still_breaks(const Scene& scene, const MethodChoice& method, const RungOutcome& whole) {
    try {
        const RungOutcome o = outcome(*set_stage(scene), method);
        return o.broken() && o.kind == whole.kind && 2 * o.interior() >= whole.interior();
    } catch (...) {
        return false;  // no truth: nothing to break against
    }
}

}  // namespace

BreakRecord write_break(const std::filesystem::path& folder, const std::string& name, const Ladder& ladder,
                        double value, const MethodChoice& method) {
    const Scene whole        = ladder.scene(value);
    const RungOutcome broken = outcome(*set_stage(whole), method);
    Scene scene              = minimal_scene(
                     whole, [&](const Scene& smaller) { return still_breaks(smaller, method, broken); }, kTrials);
    scene.title = fmt::format("{}, {:g}{}{}", ladder.title, value, ladder.unit.empty() ? "" : " ", ladder.unit);
    scene.shows = fmt::format("Where {} breaks: {}.", method.text(), broken.kind);

    const std::unique_ptr<RungStage> stage = set_stage(scene);
    std::vector<Explained> explained;
    MethodRun run{method};
    const RungOutcome o = outcome(*stage, method, &explained, &run);
    const auto interior = [](const Explained& light) {
        return light.error.false_shadow.interior + light.error.false_light.interior;
    };
    const auto worst = LightId(std::ranges::max_element(explained, {}, interior) - explained.begin());

    const auto file = [&](const char* ending) { return name + ending; };
    write_text(folder / file(".json"), native_text(scene));
    write_image(folder / file(".S.png"), visibility_picture(stage->points, run.planes[worst]));
    write_image(folder / file(".truth.png"), visibility_picture(stage->points, stage->truth.planes[worst]));
    write_image(folder / file(".classes.png"),
                class_picture(stage->points, explained[worst].classes, stage->truth.planes[worst]));
    return {.scene            = file(".json"),
            .visibility       = file(".S.png"),
            .truth            = file(".truth.png"),
            .classes          = file(".classes.png"),
            .light            = scene.lights[worst].name,
            .width            = static_cast<std::uint64_t>(scene.width),
            .height           = static_cast<std::uint64_t>(scene.height),
            .triangles        = scene.triangles.size(),
            .triangles_before = whole.triangles.size(),
            .points           = o.points,
            .interior         = o.interior(),
            .reference        = stage->truth.choice.text(),
            .explained = explained_points(scene, stage->points, worst, run, stage->truth, explained[worst].classes)};
}

}  // namespace umbra
