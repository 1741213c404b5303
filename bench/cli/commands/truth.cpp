#include "umbra/bench/contenders/truth_set.h"

#include <fmt/format.h>

#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

/// Whether a folder is another one, or would lie in it.
bool is_in(const std::filesystem::path& folder, const std::filesystem::path& other) {
    const auto whole = [](const std::filesystem::path& p) {
        return std::filesystem::weakly_canonical(std::filesystem::absolute(p)) / "";
    };
    const auto relative = whole(folder).lexically_relative(whole(other));
    return !relative.empty() && *relative.begin() != "..";
}

}  // namespace

Action truth_command(CLI::App& app, const Common& common) {
    struct Line {
        std::vector<std::string> scenes;
        TruthOrder order;
    };
    const auto line = std::make_shared<Line>();
    add_scenes(app, line->scenes);
    add_size(app, line->order.size);
    app.add_option("--withhold", line->order.withhold, "Folder for the answers: the set then holds the questions alone")
        ->type_name("DIR");
    app.add_option("--license", line->order.license, "License of the set, for its metadata")->type_name("TEXT");
    add_output(app, line->order.out);
    return [line, &common] {
        TruthOrder order = line->order;
        if (line->scenes.empty()) throw UsageError("truth: SCENE is required");
        if (!order.withhold.empty() && (is_in(order.withhold, order.out) || is_in(order.out, order.withhold)))
            throw UsageError("--withhold: is the folder of -o or within it, or it is within that, expected one beside");
        order.scenes             = scene_files(line->scenes, common.up);
        const TruthSetRecord set = on_terminal(common, order, [&] { return write_truth(order); });
        std::uint64_t asked      = 0;
        for (const TruthSceneRecord& scene : set.scenes) asked += scene.asked;
        if (!common.quiet)
            print_out("{}",
                      without_controls(fmt::format("{}: {} scene{}, {} pairs of point and light\n", order.out.string(),
                                                   set.scenes.size(), set.scenes.size() == 1 ? "" : "s", asked)));
        return kDone;
    };
}

}  // namespace umbra
