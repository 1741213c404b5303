#include <fmt/format.h>

#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/studies/radiosity/light_exchange.h"

namespace umbra {

Action radiosity_command(CLI::App& app, const Common& common) {
    struct Line {
        std::string scene;
        Size size;
        std::filesystem::path out;
        bool as_json = false;
        ExchangeOptions options;
    };
    const auto line          = std::make_shared<Line>();
    ExchangeOptions& options = line->options;
    add_scene(app, line->scene)->required();
    add_number(app, "--patch", options.size, "Longest edge of a patch, in scene diagonals", 0.001, 1, "SIZE");
    add_number(app, "--steps", options.steps, "Steps at most", 0, 1'000'000);
    add_number(app, "--until", options.until, "End where no more than this fraction of the power is unshot", 0, 1,
               "SHARE");
    add_number(app, "--samples", options.light_samples, "Rays from a patch to an area light", 1, 4096);
    add_size(app, line->size);
    add_json(app, line->as_json, "a line");
    add_output(app, line->out);
    return [line, &common] {
        const PreparedScene prepared = prepare_scene(scene_file(line->scene, common.up), line->size);
        const ExchangeRecord record  = on_terminal(common, line->options, [&] {
            return write_study(line->out, exchange_light, exchange_report, prepared, line->options);
        });
        print_record(line->as_json, common, to_record(record), [&] {
            return fmt::format("{}{}\n", study_text(exchange_report(record)), (line->out / "index.html").string());
        });
        return kDone;
    };
}

}  // namespace umbra
