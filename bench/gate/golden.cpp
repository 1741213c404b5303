#include "umbra/bench/gate/golden.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>

#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/gate/golden_figures.h"
#include "umbra/bench/gate/golden_planes.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

constexpr Size kPlaneSize{96, 54}, kFigureSize{320, 180};

/// A scene with what its goldens need, made once for all methods.
struct GoldenScene {
    PreparedScene planes, figures;
    std::optional<MethodRun> exact;  ///< of `figures`; nothing where it does not serve

    explicit GoldenScene(const fs::path& file)
        : planes(prepare_scene(file, kPlaneSize)), figures(prepare_scene(file, kFigureSize)) {
        const Reference reference = default_reference(figures.facts);
        if (reference.exact) exact = run_once(reference.choice, figures);
    }
};

/// Holds one method against its golden; renews the file and its part of `accepted` where asked.
std::optional<GoldenChange> method_change(const GoldenScene& scene, const MethodChoice& choice,
                                          const GoldenOptions& options, Figures& accepted, StagedFiles& staged) {
    const std::string method(choice.info->name);
    const std::string& name = scene.planes.scene.name;
    const fs::path file     = options.folder / name / (method + ".exr");
    const bool kept         = accepted.methods.contains(method) || fs::exists(file);
    GoldenChange change{.name = fmt::format("{}/{}", name, method)};

    const MethodRun run = run_once(choice, scene.planes);
    if (!run.service) {
        if (!kept) return std::nullopt;
        change.kind  = GoldenChange::Kind::removed;
        change.lines = {"the method does not serve the scene: " + run.service.why};
        if (options.renew) {
            staged.remove(file);
            accepted.methods.erase(method);
        }
        return change;
    }

    const Image before = fs::exists(file) ? read_image(file).image : Image(kPlaneSize.width, kPlaneSize.height, {});
    const Image now    = coded_planes(scene.planes, run);
    Changes changes    = plane_changes(before, now, scene.planes);
    const std::size_t plane_lines = changes.lines.size();

    Json figures = Json::object();
    if (scene.exact) figures = figures_of(scene.figures, run_once(choice, scene.figures), *scene.exact);
    add_figure_changes(accepted.methods.value(method, Json::object()), figures, changes);
    if (changes.lines.empty()) return std::nullopt;

    change.kind     = kept ? GoldenChange::Kind::changed : GoldenChange::Kind::added;
    change.rounding = kept && changes.at_edges_alone && accepted.machine != rounding_machine();
    change.pictures = leave_pictures(options.pictures, method, scene.planes, before, now, changes.planes);
    if (options.renew && plane_lines > 0) {
        if (now.channels.empty())
            staged.remove(file);
        else
            write_image(staged.place(file), now);
    }
    if (options.renew && changes.lines.size() > plane_lines) {
        if (scene.exact)
            accepted.methods[method] = with_ranges(std::move(figures), scene.figures, choice, *scene.exact);
        else
            accepted.methods.erase(method);
    }
    change.lines = std::move(changes.lines);
    return change;
}

/// Goldens of methods that are no longer there.
std::vector<GoldenChange> method_leftovers(const std::string& scene, const GoldenOptions& options,
                                           const Figures& accepted, StagedFiles& staged) {
    std::set<std::string> names;
    for (const auto& item : accepted.methods.items()) names.insert(item.key());
    if (fs::exists(options.folder / scene))
        for (const auto& entry : fs::directory_iterator(options.folder / scene))
            if (entry.path().extension() == ".exr" && !is_hidden_name_of_ours(entry.path()))
                names.insert(entry.path().stem().string());
    for (const MethodInfo* info : methods()) names.erase(std::string(info->name));
    std::vector<GoldenChange> changes;
    for (const std::string& name : names) {
        changes.push_back({.name  = fmt::format("{}/{}", scene, name),
                           .kind  = GoldenChange::Kind::removed,
                           .lines = {"unknown method"}});
        if (options.renew) staged.remove(options.folder / scene / (name + ".exr"));
    }
    return changes;
}

}  // namespace

bool is_wanted(const GoldenOptions& options, const std::string& scene, std::string_view method) {
    const auto is_it = [&](const std::string& name) {
        return name == scene || name == method || name == fmt::format("{}/{}", scene, method);
    };
    return options.names.empty() || std::ranges::any_of(options.names, is_it);
}

std::string_view to_string(GoldenChange::Kind kind) {
    switch (kind) {
        case GoldenChange::Kind::changed: return "changed";
        case GoldenChange::Kind::added: return "new";
        case GoldenChange::Kind::removed: return "removed";
        case GoldenChange::Kind::failed: return "failed";
    }
    return "";
}

std::string rounding_machine() {
    const MachineRecord machine = machine_record(1);
#if defined(__x86_64__)
    const bool fused = __builtin_cpu_supports("fma") != 0;
#else
    const bool fused = true;
#endif
    return fmt::format("{}, {}, {}", machine.system, machine.compiler,
                       fused ? "fused multiply and add" : "no fused multiply and add");
}

std::vector<GoldenChange> golden_changes(const fs::path& file, const GoldenOptions& options) {
    const std::string name = file.stem().string();
    std::vector<MethodChoice> choices;
    for (const MethodInfo* info : methods())
        if (info->by_default && is_wanted(options, name, info->name)) choices.emplace_back(*info);
    std::vector<GoldenChange> changes = setting_changes(file, options);
    std::ranges::move(comparison_changes(file, options), std::back_inserter(changes));
    if (choices.empty()) return changes;

    const fs::path figures_file = options.folder / name / "figures.json";
    Figures accepted            = read_figures(figures_file);
    const bool all = choices.size() == std::size_t(std::ranges::count_if(methods(), &MethodInfo::by_default));
    StagedFiles staged;  // planes and figures change together
    if (all) std::ranges::move(method_leftovers(name, options, accepted, staged), std::back_inserter(changes));
    const std::size_t others = changes.size();
    const auto fail          = [&](const std::string& what) {
        changes.push_back({.name = what, .kind = GoldenChange::Kind::failed, .lines = {current_message()}});
    };
    std::optional<GoldenScene> scene;
    try {
        scene.emplace(file);
    } catch (const InputError&) {
        throw;
    } catch (...) {
        fail(name);
        return changes;
    }
    for (const MethodChoice& choice : choices) {
        try {
            if (auto change = method_change(*scene, choice, options, accepted, staged))
                changes.push_back(std::move(*change));
        } catch (const InputError&) {
            throw;
        } catch (...) {
            fail(fmt::format("{}/{}", name, choice.info->name));
        }
    }
    const auto failed = [](const GoldenChange& change) { return change.kind == GoldenChange::Kind::failed; };
    if (!options.renew || std::all_of(changes.begin() + std::ptrdiff_t(others), changes.end(), failed)) return changes;

    accepted.machine = rounding_machine();
    staged.write(figures_file, figures_text(accepted));
    staged.commit();
    return changes;
}

std::vector<GoldenChange> golden_leftovers(const std::vector<fs::path>& scenes, const GoldenOptions& options) {
    std::vector<GoldenChange> changes;
    if (!options.names.empty() || !fs::exists(options.folder)) return changes;
    for (const auto& entry : fs::directory_iterator(options.folder)) {
        const std::string name = entry.path().filename().string();
        const bool known = std::ranges::any_of(scenes, [&](const fs::path& scene) { return scene.stem() == name; });
        if (known || !entry.is_directory()) continue;
        changes.push_back({.name = name, .kind = GoldenChange::Kind::removed, .lines = {"unknown teaching scene"}});
        if (options.renew) fs::remove_all(entry.path());
    }
    return changes;
}

void check_golden_names(const std::vector<fs::path>& scenes, const GoldenOptions& options) {
    for (const std::string& name : options.names) {
        const bool known = std::ranges::any_of(scenes, [&](const fs::path& scene) {
            const std::string stem = scene.stem().string();
            const auto is_it      = [&](std::string_view golden) { return is_wanted({.names = {name}}, stem, golden); };
            const auto is_setting = [&](const GoldenSetting& s) { return s.scene == stem && is_it(s.method); };
            return is_it("compared") || std::ranges::any_of(golden_settings(), is_setting) ||
                   std::ranges::any_of(methods(), is_it, &MethodInfo::name);
        });
        if (known) continue;
        std::vector<std::string> there;
        for (const fs::path& scene : scenes) there.push_back(scene.stem().string());
        for (const MethodInfo* info : methods()) there.emplace_back(info->name);
        throw UsageError(fmt::format("unknown golden \"{}\", expected SCENE, METHOD or SCENE/METHOD of {}", name,
                                     fmt::join(there, ", ")));
    }
}

}  // namespace umbra
