#include "umbra/bench/report/course/rubric.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/record.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/core/base/error.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

std::string all_causes() {
    std::string all;
    for (const Cause& cause : causes()) all += (all.empty() ? "" : ", ") + std::string(cause.name);
    return all;
}

/// Sets what was left open; refuses what no submission could be judged by.
void complete(RubricItemRecord& item, const Field& at, const std::vector<std::string>& scenes) {
    const auto cause = std::ranges::find(causes(), item.of, &Cause::name);
    if (cause == causes().end()) at["of"].refuse("one of " + all_causes());
    const bool counts_scenes = item.of == "failed" || item.of == "refused";
    if (!std::isfinite(item.points)) at["points"].refuse("a number of points");
    if (!std::isfinite(item.full)) item.full = 0;
    if (!std::isfinite(item.none) && counts_scenes) item.none = 1;
    if (!std::isfinite(item.none)) at.refuse("a figure from which no points are given, \"none\"");
    if (item.none <= item.full) at["none"].refuse(fmt::format("more than \"full\", {}", item.full));
    if ((item.of == "time") != !item.against.empty())
        at.refuse(item.of == "time" ? "the method whose time is 1, \"against\"" : "no \"against\", which is of time");
    for (const Field& scene : at["scenes"].items())
        if (std::ranges::find(scenes, scene.text()) == scenes.end()) scene.refuse("a scene of the rubric");
}

void check_method(const Field& at) {
    try {
        static_cast<void>(parse_method(at.text()));
    } catch (const UsageError& error) {
        at.refuse(fmt::format("a method of this program ({})", error.what()));
    }
}

}  // namespace

const std::vector<Cause>& causes() {
    static const std::vector<Cause> all{
        {"acne", "%", "{} of the points are acne", "false_shadow.acne"},
        {"detachment", "%", "{} of the points are lit where a shadow should begin at its object",
         "false_light.detachment"},
        {"leak", "%", "{} of the points are lit through an occluder", "false_light.leak"},
        {"false_shadow", "%", "{} of the points are too dark, away from edges", "false_shadow.interior"},
        {"false_light", "%", "{} of the points are too bright, away from edges", "false_light.interior"},
        {"penumbra", "%", "{} of the points have another shade in the penumbra", "penumbra_error"},
        {"noise", "%", "{} of the points are noise", "noise_error"},
        {"edge", "%", "{} of the points are wrong at edges of shadows", "edge"},
        {"terminator", "%", "{} of the points whose normal faces away, and whose triangle does not, are wrong"},
        {"undefined", "%", "{} of the points that ask have no answer"},
        {"displacement", "px", "95 % of the edges of shadows are displaced by at most {}"},
        {"penumbra_width", "%", "the width of penumbrae differs from the true one by {}"},
        {"mae", "", "the mean absolute error of S is {}", "mae"},
        {"rmse", "", "the root mean square error of S is {}", "rmse"},
        {"bias", "", "the mean of S is off by {}"},
        {"time", "x", "it takes {} as long as the method beside it"},
        {"failed", "", "scenes of one failed or took too much time or memory"},
        {"refused", "", "scenes of one are not served"},
    };
    return all;
}

std::vector<fs::path> scenes_beside(const Field& names, const fs::path& file, const FindScene& find) {
    std::vector<fs::path> scenes;
    for (const Field& name : names.items()) scenes.push_back(scene_beside(name, file, find));
    return scenes;
}

void check_methods(const Field& names) {
    for (const Field& name : names.items()) check_method(name);
}

Size size_of(const Field& size) {
    try {
        return size.text().empty() ? Size{} : parse_size(size.text());
    } catch (const UsageError& e) {
        size.refuse(fmt::format("a size ({})", e.what()));
    }
}

Rubric read_rubric(const fs::path& file, const FindScene& find) {
    if (!fs::is_regular_file(file)) throw InputError(fmt::format("{}: is not there, or is no file", file.string()));
    Rubric rubric{.text = bytes_of(file)};
    const Field root     = parse_json(rubric.text, file.string());
    RubricRecord& record = rubric.record = from_strict_record<RubricRecord>(root);
    if (record.scenes.empty()) root["scenes"].refuse("a list with at least one scene");
    if (record.items.empty()) root["items"].refuse("a list with at least one item");
    if (!std::isfinite(record.step)) record.step = 0.1;
    if (record.step <= 0) root["step"].refuse("a number above 0");
    LimitsRecord& limits = record.limits;
    for (const auto& [limit, value] :
         {std::pair{&limits.answer_s, 60.0}, {&limits.scene_s, 300.0}, {&limits.memory_mib, 4096.0}})
        if (!std::isfinite(*limit)) *limit = value;
    rubric.size   = size_of(root["size"]);
    rubric.scenes = scenes_beside(root["scenes"], file, find);
    check_methods(root["methods"]);
    std::set<std::string> names;
    for (std::size_t i = 0; i < record.items.size(); ++i) {
        const Field at         = root["items"].items()[i];
        RubricItemRecord& item = record.items[i];
        complete(item, at, record.scenes);
        if (item.points > 0 && item.points < record.step)
            at["points"].refuse(fmt::format("at least \"step\", {}, to which points are rounded", record.step));
        if (!names.insert(item.name).second) at["name"].refuse("a name that no item before has");
        if (item.against.empty()) continue;
        check_method(at["against"]);
        if (std::ranges::find(record.methods, item.against) == record.methods.end())
            record.methods.push_back(item.against);
    }
    static_cast<void>(chosen_scenes(rubric.scenes));
    return rubric;
}

Rubric rubric_of(std::vector<fs::path> scenes) {
    return {.record = {.title = "A method beside the truth", .methods = {"shadow_zbuffer", "ray_traced"}, .step = 0.1},
            .scenes = std::move(scenes)};
}

}  // namespace umbra
