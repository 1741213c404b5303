#include "umbra/bench/report/report_views.h"

#include <nlohmann/json.hpp>

#include "umbra/bench/pages/why_point.h"

namespace umbra {

using nlohmann::json;

json why_view(const SceneFiles& scene) {
    const Results& results = scene.scene().results;
    const SizeRecord& size = results.size;
    json all               = json::array();
    if (!size.width || !size.height) return all;
    for (const LightRecord& light : results.lights)
        for (const MethodRecord& method : results.methods)
            for (const ErrorRecord& error : method.errors) {
                const LightFilesRecord* files = files_of(method.files, light.name);
                if (error.light != light.name || error.explained.empty() || files == nullptr) continue;
                const std::string label = method_label(method, results.methods);
                const json picture      = scene.figure(files->classes, label, "errors of " + light.name, "");
                if (!picture.is_object()) continue;
                json points = json::array();
                for (const ExplainedPointRecord& point : error.explained) {
                    if (point.pixel.size() != 2) continue;
                    points.push_back(why_point(point, {picture["src"], label, method.compared_with, size}));
                }
                all.push_back({{"label", label}, {"light", light.name}, {"points", std::move(points)}});
            }
    return all;
}

}  // namespace umbra
