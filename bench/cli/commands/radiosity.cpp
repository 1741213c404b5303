#include <CLI/CLI.hpp>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/cli/terminal.h"
#include "umbra/bench/radiosity/exchange_page.h"

namespace umbra {
namespace {

struct RadiosityLine {
    std::string scene, size;
    std::filesystem::path out;
    bool as_json = false;
    ExchangeOptions options;
};

int radiosity(const RadiosityLine& line, const Common& common) {
    ExchangeOptions options = line.options;
    options.command         = common.command;
    const PreparedScene prepared =
        prepare_scene(scene_file(line.scene, common.up), line.size.empty() ? Size{} : parse_size(line.size));
    Json record;
    {
        const Terminal terminal(common.quiet);
        options.progress = [&](const std::string& what) { terminal.progress(what); };
        record           = write_exchange_study(prepared, options, line.out);
    }
    if (line.as_json)
        print_out("{}", json_text(record));
    else if (!common.quiet)
        print_out("{} patches, {} steps, {:.2g} % of the power unshot\n{}\n", record["patches"].get<std::uint64_t>(),
                  record["steps"].get<int>(), 100 * record["unshot"].back().get<double>(),
                  (line.out / "index.html").string());
    return kDone;
}

}  // namespace

Action radiosity_command(CLI::App& app, const Common& common) {
    const auto line          = std::make_shared<RadiosityLine>();
    ExchangeOptions& options = line->options;
    app.add_option("SCENE", line->scene, "Scene: a file or a scene's name")->type_name("")->required();
    app.add_option("--patch", options.size, "Longest edge of a patch, in scene diagonals")
        ->check(number_in(0.001, 1, "a number from 0.001 to 1"))
        ->capture_default_str()
        ->type_name("SIZE");
    app.add_option("--steps", options.steps, "Steps at most")
        ->check(number_in(0, 1e6, "an integer from 0 to 1000000"))
        ->capture_default_str()
        ->type_name("N");
    app.add_option("--until", options.until, "End where no more than this share of the power is unshot")
        ->check(number_in(0, 1, "a number from 0 to 1"))
        ->capture_default_str()
        ->type_name("SHARE");
    app.add_option("--samples", options.light_samples, "Rays from a patch to an area light")
        ->check(number_in(1, 4096, "an integer from 1 to 4096"))
        ->capture_default_str()
        ->type_name("N");
    app.add_option("--size", line->size, "Size of the pictures (default: the scene's)")->type_name("WIDTHxHEIGHT");
    app.add_flag("--json", line->as_json, "Print results.json instead of a line");
    app.add_option("-o,--output", line->out, "Folder to write to")->type_name("DIR")->required();
    return [line, &common] { return radiosity(*line, common); };
}

}  // namespace umbra
