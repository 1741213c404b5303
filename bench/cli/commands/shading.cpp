#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/shading/shading_page.h"

namespace umbra {
namespace {

struct ShadingLine {
    std::string scene, size, method = "ray_traced";
    std::vector<std::string> limits;
    std::filesystem::path out;
    bool as_json = false, no_shadows = false;
    ShadingOptions options;
};

int shading(const ShadingLine& line, const Common& common) {
    ShadingOptions options = line.options;
    options.command        = common.command;
    for (const std::string& limit : line.limits) options.limits.push_back(parse_shading_limit(limit));
    if (!line.no_shadows) options.method = parse_method(line.method);
    const PreparedScene prepared =
        prepare_scene(scene_file(line.scene, common.up), line.size.empty() ? Size{} : parse_size(line.size));
    if (options.method)
        if (const Service service = verdict(*options.method->make(), prepared.facts); !service) {
            print_error("{} does not serve this scene: {}\n", options.method->text(), service.why);
            return kNo;
        }
    const Json record = write_shading_study(prepared, options, line.out);
    if (line.as_json)
        print_out("{}", json_text(record));
    else if (!common.quiet)
        print_out("{}{}\n", shading_text(record), (line.out / "index.html").string());
    return record.contains("choice") && record["choice"]["model"].is_null() ? kNo : kDone;
}

}  // namespace

Action shading_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<ShadingLine>();
    app.add_option("SCENE", line->scene, "Scene: a file or a scene's name")->type_name("")->required();
    app.add_option("--method", line->method, "Method of the shadows, with settings")
        ->capture_default_str()
        ->type_name("METHOD");
    app.add_flag("--no-shadows", line->no_shadows, "Every light reaches every point that faces it");
    app.add_option("--max", line->limits,
                   "Name the cheapest model within METRIC=E: rmse, flip or perceived, from phong; repeatable")
        ->type_name("METRIC=E")
        ->take_all();
    app.add_option("--views", line->options.views, "Views that errors are taken from: the scene's own and others")
        ->check(number_in(1, 1000, "an integer from 1 to 1000"))
        ->default_val(3)
        ->type_name("N");
    app.add_option("--runs", line->options.runs, "Rounds, in each of which every model runs once")
        ->check(number_in(1, 1000, "an integer from 1 to 1000"))
        ->capture_default_str()
        ->type_name("N");
    app.add_option("--size", line->size, "Size of the pictures (default: the scene's)")->type_name("WIDTHxHEIGHT");
    app.add_flag("--json", line->as_json, "Print results.json instead of the table");
    app.add_option("-o,--output", line->out, "Folder to write to")->type_name("DIR")->required();
    return [line, &common] { return shading(*line, common); };
}

}  // namespace umbra
