#include "umbra/bench/sweep/trade_page.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "report_assets.h"
#include "umbra/bench/base/files.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/sweep/trade_views.h"

namespace umbra {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// The results.json of a scene where it lies below `root`, the folder that is handed out whole; a copy in `folder`
/// where it lies elsewhere.
fs::path below(const fs::path& root, const SweptScene& scene, const fs::path& folder, std::size_t k,
               StagedFiles& staged) {
    const fs::path relative = scene.file.lexically_relative(root);
    if (!relative.empty() && *relative.begin() != "..") return scene.file;
    fs::path copy = folder / fmt::format("{}-{}", k + 1, folder_name(scene.name)) / "results.json";
    staged.copy(scene.file, copy);
    return copy;
}

/// Everything that failed, in words.
json failures_of(const std::vector<SweptScene>& scenes) {
    json failures = json::array();
    for (const SweptScene& scene : scenes)
        for (const SweptSetting& s : scene.settings)
            if (s.failed) failures.push_back(fmt::format("{}: {} {}", scene.title, s.text, s.note));
    return failures;
}

}  // namespace

std::vector<TradeLine> write_trade_page(const std::vector<fs::path>& results_json, const fs::path& folder,
                                        const std::string& report, StagedFiles& staged) {
    const fs::path root = report.empty() ? folder : (folder / path_of_url(report)).lexically_normal().parent_path();
    std::vector<SweptScene> scenes;
    for (const fs::path& file : results_json) scenes.push_back(read_swept_scene(file));
    const std::vector<SweptMethod> methods = swept_methods(scenes);

    json view            = {{"report", report},
                            {"scene_count", counted(double(scenes.size()), "scene")},
                            {"method_count", counted(double(methods.size()), "method")},
                            {"scenes", json::array()},
                            {"runs", json::array()}};
    std::size_t settings = 0;
    std::vector<TradeLine> lines;
    for (std::size_t k = 0; k < scenes.size(); ++k) {
        settings += scenes[k].settings.size();
        add_run(view["runs"], scenes[k].head, scenes[k].machine);
        json scene        = swept_scene_view(scenes[k], methods, fmt::format("scene-{}", k + 1));
        scene["file"]     = url(below(root, scenes[k], folder, k, staged).lexically_relative(folder));
        const auto metric = scene["metric"].get<std::string>();
        lines.push_back({scenes[k].title, scene["id"].get<std::string>(),
                         (metric.empty() ? "" : metric + ": ") + scene["finding"].get<std::string>()});
        view["scenes"].push_back(std::move(scene));
    }
    view["failures"]      = failures_of(scenes);
    view["setting_count"] = counted(double(settings), "setting");
    view["fixed"]         = fixed_errors_view(scenes, methods);

    write_page(folder, assets::trade_html, {"The trade: error against frame cost"}, std::move(view), staged);
    return lines;
}

}  // namespace umbra
