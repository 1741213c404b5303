// results.json of two swept scenes, by hand: their fronts, ratios and sentences are worked out in trade_test.cpp.
#pragma once

#include "report_fixture.h"

namespace umbra::trade_fixture {

using nlohmann::json;

inline json samples(double ms) {
    return {{"median", ms}, {"min", 0.9 * ms}, {"max", 1.2 * ms}, {"runs", 3}, {"samples", {0.9 * ms, ms, 1.2 * ms}}};
}

/// A setting with its RMSE by view. With 10 camera movements a second and 1 of the light, a frame costs
/// 0.1 aim + visibility.
inline json setting(const std::string& text, double aim, double visibility, const std::vector<double>& rmse) {
    const std::string name = text.substr(0, text.find(':'));
    json s                 = {{"text", text},
                              {"name", name},
                              {"title", "The " + name},
                              {"preset", nullptr},
                              {"parameters", json::object()},
                              {"serves", {{"how", "approximately"}, {"why", "by hand"}}},
                              {"memory_bytes", 3 << 20},
                              {"coverage", 1},
                              {"excluded", nullptr},
                              {"views", json::array()},
                              {"bounds", {{"rmse", nullptr}}},
                              {"times", {{"build_ms", samples(400)}, {"aim_ms", samples(aim)}, {"visibility_ms", samples(visibility)}}},
                              {"cost_ms", 0.1 * aim + visibility}};
    double worst           = 0;
    for (std::size_t v = 0; v < rmse.size(); ++v) {
        s["views"].push_back({{"view", v}, {"metrics", {{"rmse", rmse[v]}}}});
        worst = std::max(worst, rmse[v]);
    }
    s["bounds"]["rmse"] = 1.2 * worst;
    return s;
}

inline json scene(const std::string& name, const std::vector<json>& settings) {
    return {{"schema", kResultsSchema},
            {"version", "0.1.0"},
            {"command", "umbra sweep /somewhere/court.json -o out"},
            {"machine", {{"cpu", "A CPU"}, {"cores", 2}, {"threads", 2}}},
            {"scene", {{"name", name}, {"title", "The " + name}}},
            {"facts", {{"triangles", 1234567}}},
            {"sweep",
             {{"views", 2},
              {"metrics", {{{"name", "rmse"}, {"unit", ""}, {"doc", "Root mean square error."}}}},
              {"turns", {{"noise_bar", 0.034}, {"calibration_ms", {20, 21, 20}}}},
              {"workload", {{"camera", 10}, {"light", 1}, {"object", 0}}},
              {"settings", settings}}}};
}

/// Costs 1.2, 2.5, 4, 5, 20, 90, 62; planar_projection is cheap and without error, but answers for 60 % of the points;
/// one setting failed and one was not timed.
inline json court() {
    json planar = setting("planar_projection", 0, 0.5, {0, 0}), failed = setting("shadow_volumes", 1, 1, {0, 0}),
         untimed        = setting("shadow_zbuffer:resolution=8192", 1, 1, {0.015, 0.014});
    planar["coverage"]  = 0.6;
    planar["excluded"]  = "it leaves 40 % of the points undefined";
    failed["failed"]    = {{"light", nullptr}, {"message", "out of patience"}};
    failed["excluded"]  = "it failed";
    untimed["cost_ms"]  = nullptr;
    untimed["excluded"] = "it was not timed";
    untimed.erase("times");
    json fast      = setting("shadow_zbuffer:resolution=512", 2, 1, {0.04, 0.055});
    fast["preset"] = "fast";
    return scene("court", {planar, failed, untimed, fast, setting("shadow_zbuffer", 5, 2, {0.021, 0.018}),
                           setting("shadow_zbuffer:resolution=4096", 10, 3, {0.03, 0.03}),
                           setting("ray_traced", 0, 5, {0.012, 0.0125}),
                           setting("ray_traced:samples=64", 0, 20, {0.0031, 0.0029}),
                           setting("ray_traced:samples=256", 0, 90, {0.002, 0.002}), setting("exact", 10, 61, {0, 0})});
}

/// Costs 2, 1, 8.
inline json yard() {
    return scene("yard", {setting("shadow_zbuffer", 0, 2, {0.01, 0.009}), setting("ray_traced", 0, 1, {0.02, 0.02}),
                          setting("exact", 0, 8, {0, 0})});
}

}  // namespace umbra::trade_fixture
