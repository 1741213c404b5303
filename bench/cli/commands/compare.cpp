#include "umbra/bench/compare/compare.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/cli/long_runs.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/core/base/error.h"

namespace umbra {

Action compare_command(CLI::App& app, const Common& common) {
    struct Line {
        std::vector<std::string> scenes;
        bool as_json = false;
        CompareOptions options;
    };
    const auto line         = std::make_shared<Line>();
    CompareOptions& options = line->options;
    add_scenes(app, line->scenes);
    add_methods(app, options.methods);
    add_answer_files(app, options.choices);
    add_reference(app, options.reference, options.points, "exact, or ray tracing where exact does not serve the scene");
    add_size(app, options.size);
    add_pixel_samples(app, options.pixel_samples,
                      "Points a pixel in pictures: 1, 4, 9, 16 ... (planes and errors stay at pixel centres)");
    add_budget(app, options.budget);
    add_json(app, line->as_json, "a line");
    add_output(app, options.out);
    return [line, &common] {
        return_scenes(line->options.methods, line->scenes);
        if (line->scenes.empty()) throw UsageError("compare: SCENE is required");
        if (line->scenes.size() > 1 &&
            std::ranges::any_of(line->options.choices, [](const auto& c) { return !c.info->is_timed; }))
            throw UsageError(
                fmt::format("--answers: a file is of one scene, and there are {} ({}); of several files "
                            "each has its own --answers",
                            line->scenes.size(), fmt::join(line->scenes, ", ")));
        check_writable_beside(line->options.out);
        const PlaceLock lock  = PlaceLock::inside(line->options.out);
        const ScenesDone done = compare_on_terminal(scene_files(line->scenes, common.up), line->options, common,
                                                    {.as_json = line->as_json});
        const int code        = exit_code(done);
        return code == kDone && !done.missing.empty() ? kUnreadable : code;
    };
}

}  // namespace umbra
