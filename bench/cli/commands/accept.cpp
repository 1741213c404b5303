#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/gate/golden.h"
#include "umbra/bench/lab/chosen.h"

namespace umbra {
namespace {

struct AcceptLine {
    GoldenOptions options;
    bool only_check = false;
};

void print_change(const GoldenChange& change) {
    print_out("{}: {}\n", change.name, to_string(change.kind));
    for (const std::string& line : change.lines) print_out("    {}\n", line);
}

std::string summary(const std::vector<GoldenChange>& changes, const AcceptLine& line) {
    const auto count = [&](GoldenChange::Kind kind) { return std::ranges::count(changes, kind, &GoldenChange::kind); };
    if (changes.empty()) return "nothing changed";
    const auto failed = count(GoldenChange::Kind::failed);
    return fmt::format(
        "{} changed, {} new, {} removed{}{}", count(GoldenChange::Kind::changed), count(GoldenChange::Kind::added),
        count(GoldenChange::Kind::removed), failed > 0 ? fmt::format(", {} failed", failed) : "",
        line.only_check ? "; nothing was written" : fmt::format(", in {}", line.options.folder.string()));
}

int accept(AcceptLine line, const Common& common) {
    const std::vector<std::filesystem::path> scenes = teaching_scenes(scenes_folder());
    check_golden_names(scenes, line.options);
    line.options.folder = golden_folder();
    line.options.renew  = !line.only_check;
    std::optional<PlaceLock> lock;
    if (line.options.renew) lock.emplace(PlaceLock::inside(line.options.folder));

    std::vector<GoldenChange> all;
    const auto add = [&](const std::vector<GoldenChange>& changes) {
        for (const GoldenChange& change : changes) {
            if (!common.quiet || change.kind == GoldenChange::Kind::failed) print_change(change);
            all.push_back(change);
        }
    };
    for (const std::filesystem::path& scene : scenes)
        add(on_terminal(common, [&](const auto& progress) {
            progress(scene.stem().string());
            return golden_changes(scene, line.options);
        }));
    add(golden_leftovers(scenes, line.options));
    if (!common.quiet) print_out("{}\n", summary(all, line));
    if (std::ranges::count(all, GoldenChange::Kind::failed, &GoldenChange::kind) > 0) return kInternal;
    return line.only_check && !all.empty() ? kNo : kDone;
}

}  // namespace

Action accept_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<AcceptLine>();
    app.add_option("GOLDEN", line->options.names, "SCENE, METHOD or SCENE/METHOD (default: all)")->type_name("");
    app.add_flag("--check", line->only_check, "Write nothing; exit with 1 if anything would change");
    app.add_option("--pictures", line->options.pictures,
                   "Write golden, result and difference of everything that changed to DIR")
        ->type_name("DIR");
    return [line, &common] { return accept(*line, common); };
}

}  // namespace umbra
