#include <fmt/format.h>

#include <string>
#include <vector>

#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/studies/shading/shading_study.h"

namespace umbra {
namespace {

struct ShadingLine {
    std::string scene;
    Size size;
    ShadowMethod method;
    std::vector<std::string> limits;
    std::filesystem::path out;
    bool as_json = false;
    ShadingOptions options;
};

int shading(const ShadingLine& line, const Common& common) {
    ShadingOptions options = line.options;
    options.command        = common.command;
    for (const std::string& limit : line.limits) options.limits.push_back(parse_shading_limit(limit));
    options.method               = line.method.choice();
    const PreparedScene prepared = prepare_scene(scene_file(line.scene, common.up), line.size);
    if (options.method)
        if (const Service service = verdict(*options.method->make(), prepared.facts); !service) {
            print_error("{} does not serve this scene: {}\n", options.method->text(), service.why);
            return kNo;
        }
    const ShadingRecord record = write_study(line.out, compare_shading, shading_report, prepared, options);
    print_record(line.as_json, common, to_record(record), [&] {
        return fmt::format("{}{}\n", study_text(shading_report(record)), (line.out / "index.html").string());
    });
    return record.choice && !record.choice->model ? kNo : kDone;
}

}  // namespace

Action shading_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<ShadingLine>();
    add_scene(app, line->scene)->required();
    add_shadow_method(app, line->method);
    app.add_option("--max", line->limits,
                   "Name the cheapest model within METRIC=E: rmse, flip or perceived, from phong; repeatable")
        ->type_name("METRIC=E")
        ->take_all();
    line->options.views = 3;
    add_number(app, "--views", line->options.views, "Views that errors are taken from: the scene's own and others", 1,
               1000);
    add_number(app, "--runs", line->options.runs, "Rounds, in each of which every model runs once", 1, 1000);
    add_size(app, line->size);
    add_json(app, line->as_json);
    add_output(app, line->out);
    return [line, &common] { return shading(*line, common); };
}

}  // namespace umbra
