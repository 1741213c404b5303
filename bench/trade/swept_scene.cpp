#include "umbra/bench/trade/swept_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/statistics/statistics.h"

namespace umbra {
namespace {

struct KnownMetric {
    const char *name, *title;
};
constexpr std::array kShown = {KnownMetric{"rmse", "RMSE of S"},
                               KnownMetric{"interior", "Wrong interior points, fraction"},
                               KnownMetric{"edge_displacement_px.p95", "Edge displacement (95 %), pixels"},
                               KnownMetric{"flip", "FLIP of the picture, mean"}};

double not_negative(const Field& field) {
    const double value = field.number().value_or(-1);
    if (!(value >= 0) || !std::isfinite(value)) field.refuse("a number of at least 0");
    return value;
}

std::optional<double> not_negative_if_there(const Field& field) {
    if (!field.present()) return std::nullopt;
    return not_negative(field);
}

std::vector<SweptMetric> shown_metrics(const Field& sweep) {
    std::vector<SweptMetric> all, shown;
    for (const Field& metric : sweep["metrics"].items()) {
        SweptMetric m{metric["name"].required_text(), {}, metric["doc"].text()};
        const std::string unit = metric["unit"].text();
        m.title                = in_words(m.name) + (unit.empty() ? "" : ", " + unit);
        all.push_back(std::move(m));
    }
    for (const KnownMetric& known : kShown)
        for (const SweptMetric& metric : all)
            if (metric.name == known.name) shown.push_back({metric.name, known.title, metric.doc});
    return shown.empty() ? all : shown;
}

std::optional<SweptError> error_of(const Field& setting, const std::string& metric) {
    std::optional<SweptError> error;
    for (const Field& view : setting["views"].items()) {
        const Field value = view["metrics"][metric];
        if (!value.present()) continue;
        const double e = not_negative(value);
        if (!error) error = SweptError{.least = e, .worst = e};
        error->least = std::min(error->least, e);
        error->worst = std::max(error->worst, e);
        for (const Field& name : view["at_least"].items()) error->at_least = error->at_least || name.text() == metric;
    }
    if (error) {
        error->bound = not_negative_if_there(setting["bounds"][metric]);
        if (error->bound) error->bound = std::max(*error->bound, error->worst);
    }
    return error;
}

/// By linear interpolation between the sorted values.
double quantile(std::vector<double> values, double fraction) {
    std::sort(values.begin(), values.end());
    const double at         = fraction * double(values.size() - 1);
    const std::size_t below = std::size_t(at);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (at - double(below)) * (values[above] - values[below]);
}

std::optional<FrameCost> cost_of(const SweptScene& scene, const Field& setting) {
    const auto median = not_negative_if_there(setting["cost_ms"]);
    if (!median) return std::nullopt;
    FrameCost cost{*median, *median, *median};
    const auto phase = [&](const char* name, const char* member) { return setting["times"][name][member]; };
    const auto build = phase("build_ms", "samples").items(), aim = phase("aim_ms", "samples").items(),
               look = phase("look_ms", "samples").items(),  // none in records of older versions
        visibility  = phase("visibility_ms", "samples").items();
    std::vector<double> rounds;
    if (build.size() == visibility.size() && aim.size() == visibility.size())
        for (std::size_t r = 0; r < visibility.size(); ++r)
            rounds.push_back(frame_cost_ms(scene.workload,
                                           {not_negative(build[r]), not_negative(aim[r]),
                                            r < look.size() ? not_negative(look[r]) : 0, not_negative(visibility[r])}));
    if (!rounds.empty()) {
        cost.low  = std::min(*median, quantile(rounds, 0.25));
        cost.high = std::max(*median, quantile(rounds, 0.75));
    } else {
        const auto end = [&](const char* member) {
            return frame_cost_ms(
                scene.workload,
                {phase("build_ms", member).number().value_or(0), phase("aim_ms", member).number().value_or(0),
                 phase("look_ms", member).number().value_or(0), phase("visibility_ms", member).number().value_or(0)});
        };
        if (phase("visibility_ms", "min").present()) cost.low = std::min(*median, end("min"));
        if (phase("visibility_ms", "max").present()) cost.high = std::max(*median, end("max"));
    }
    return cost;
}

SweptSetting read_setting(const SweptScene& scene, const Field& field) {
    SweptSetting s;
    s.text           = field["text"].required_text();
    s.method         = field["name"].required_text();
    s.title          = field["title"].text().empty() ? in_words(s.method) : field["title"].text();
    const auto colon = s.text.find(':');
    s.label          = colon == std::string::npos ? "defaults" : s.text.substr(colon + 1);
    s.preset         = field["preset"].text();
    s.failed         = field["failed"].present();
    s.excluded       = field["excluded"].text();
    if (s.failed)
        s.note = "failed: " + field["failed"]["message"].text();
    else if (field["serves"]["how"].text() == "not")
        s.note = "not served: " + field["serves"]["why"].text();
    if (s.note.empty()) s.cost = cost_of(scene, field);
    s.memory_bytes = field["memory_bytes"].number();
    s.coverage     = field["coverage"].number();
    for (const SweptMetric& metric : scene.metrics)
        s.errors.push_back(s.note.empty() ? error_of(field, metric.name) : std::nullopt);
    return s;
}

}  // namespace

SweptScene read_swept_scene(const std::filesystem::path& file) {
    const Field root = read_results(file);
    SweptScene scene{.head    = from_record<HeadRecord>(root),
                     .machine = from_record<MachineRecord>(root["machine"]),
                     .file    = file,
                     .name    = {},
                     .title   = {}};
    const Field sweep = root["sweep"];
    if (!sweep.present()) sweep.refuse("an object, as umbra sweep writes it");
    scene.name  = root["scene"]["name"].required_text();
    scene.title = root["scene"]["title"].text();
    if (scene.title.empty()) scene.title = in_words(scene.name);
    scene.triangles = root["facts"]["triangles"].number().value_or(0);
    scene.views     = int(std::clamp(sweep["views"].number().value_or(1), 1.0, 1e6));
    scene.noise_bar = not_negative_if_there(sweep["turns"]["noise_bar"]);
    if (sweep["turns"].present() && !scene.noise_bar) scene.noise_bar = noise_bar({});  // of too few rounds
    if (const Field w = sweep["workload"]; w.present()) {
        scene.workload = {not_negative(w["camera"]), not_negative(w["light"]), not_negative(w["object"])};
        if (!(scene.workload.camera + scene.workload.light + scene.workload.object > 0))
            w.refuse("something that moves");
    }
    scene.metrics = shown_metrics(sweep);
    for (const Field& setting : sweep["settings"].items()) scene.settings.push_back(read_setting(scene, setting));
    return scene;
}

std::vector<SweptMethod> swept_methods(const std::vector<SweptScene>& scenes) {
    std::vector<SweptMethod> methods;
    for (const SweptScene& scene : scenes)
        for (const SweptSetting& s : scene.settings)
            if (std::none_of(methods.begin(), methods.end(), [&](const SweptMethod& m) { return m.name == s.method; }))
                methods.push_back({s.method, s.title});
    const auto scenes_of = [&](const SweptMethod& m) {
        return std::count_if(scenes.begin(), scenes.end(), [&](const SweptScene& scene) {
            return std::any_of(scene.settings.begin(), scene.settings.end(),
                               [&](const SweptSetting& s) { return s.method == m.name && s.cost; });
        });
    };
    std::stable_sort(methods.begin(), methods.end(),
                     [&](const SweptMethod& a, const SweptMethod& b) { return scenes_of(a) > scenes_of(b); });
    return methods;
}

std::size_t index_of(const std::vector<SweptMethod>& methods, const std::string& name) {
    return std::size_t(
        std::find_if(methods.begin(), methods.end(), [&](const SweptMethod& m) { return m.name == name; }) -
        methods.begin());
}

}  // namespace umbra
