#include "umbra/bench/studies/motion/motion.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

/// Where nobody names any, those that measure the visible area, which all are compared by.
std::vector<MethodChoice> methods_on(const PreparedScene& prepared, const std::filesystem::path& file,
                                     const MotionCommand& command) {
    std::vector<MethodChoice> chosen = chosen_methods(command.methods, command.choices, {&file, 1});
    if (command.methods.empty() && command.choices.empty() && !prepared.facts.hard_lights_only)
        std::erase_if(chosen, [](const MethodChoice& choice) { return choice.make()->measures() != Measure::area; });
    return chosen;
}

}  // namespace

MotionRecord measure_motion(const std::vector<std::filesystem::path>& files, const MotionCommand& command,
                            std::vector<std::string>& unreadable) {
    const std::vector<ChosenScene> scenes = chosen_scenes(files);
    static_cast<void>(chosen_methods(command.methods, command.choices, files));  // what is typed is wrong now
    MotionRecord record{.head         = head_record(command.command),
                        .budget       = budget_record(command.options.still.most),
                        .machine      = machine_record(command.threads),
                        .load_average = {.before = load_average()},
                        .frames       = static_cast<std::uint64_t>(command.options.frames),
                        .arc_degrees  = kArc,
                        .area_points  = command.options.area_points,
                        .max_rmse     = command.max_rmse};
    const auto fail = [&](const std::string& scene, const std::string& method, const std::string& message) {
        record.failed.push_back({.scene = scene, .method = method, .failure = {.message = message}});
    };
    for (const auto& [file, name, folder] : scenes) {
        try {
            PreparedScene prepared = prepare_scene(file, command.size);
            if (std::ranges::all_of(prepared.points.triangle, [](TriangleId t) { return t == kNoTriangle; }))
                throw InputError(fmt::format("{}: no surface is in view, so that no point is compared", file.string()));
            prepared.scene.name      = name;
            const auto chosen        = methods_on(prepared, file, command);
            const SceneMotion motion = run_motion(std::move(prepared), chosen, command.options);
            for (const MethodMotion& method : motion.methods)
                if (method.failed) fail(name, method.still.choice.text(), *method.failed);
            record.motion.push_back(scene_motion_record(motion, command.max_rmse));
        } catch (const InputError& e) {
            unreadable.emplace_back(e.what());
        } catch (const UsageError&) {
            throw;
        } catch (...) {
            fail(name, "the reference", current_message());
        }
    }
    if (record.motion.empty()) return record;
    record.load_average.after = load_average();
    StagedFiles staged;
    staged.write(command.out / "results.json", json_text(to_record(record)));
    write_motion_page(record, command.out, staged);
    staged.commit();
    return record;
}

}  // namespace umbra
