#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/cli/options.h"
#include "umbra/bench/contenders/truth_set.h"
#include "umbra/core/base/error.h"

namespace umbra {

Action score_command(CLI::App& app, const Common& common) {
    struct Line {
        std::filesystem::path set;
        std::vector<std::string> answers;
        bool as_json = false;
    };
    const auto line = std::make_shared<Line>();
    app.add_option("SET", line->set, "Folder that umbra truth wrote")->type_name("")->required();
    app.add_option("ANSWERS", line->answers,
                   "NAME=FOLDER, which holds SCENE.npy for each scene (FOLDER:measure=irradiance)")
        ->type_name("")
        ->required();
    add_json(app, line->as_json);
    return [line, &common] {
        std::vector<NamedAnswers> answers;
        for (const std::string& text : line->answers) {
            NamedAnswers named = parse_answers(text);
            if (std::ranges::find(answers, named.name, &NamedAnswers::name) != answers.end())
                throw UsageError(
                    fmt::format("{}: other answers are called {}, too, expected each name once", text, named.name));
            answers.push_back(std::move(named));
        }
        const std::vector<ScoreRecord> scores = score(line->set, answers);
        Json record                           = to_record(head_record(common.command));
        for (const ScoreRecord& each : scores) record["scores"].push_back(to_record(each));
        print_record(line->as_json, {}, record, [&] {  // aloud: the table is the result
            std::string text =
                fmt::format("{:<16} {:<24} {:<12} {:>8} {:>9} {:>7} {:>7} {:>6} {:>8} {:>8} {:>9}\n", "answers",
                            "scene", "light", "points", "undefined", "shadow", "light", "edge", "mae", "rmse", "bias");
            for (const ScoreRecord& s : scores)
                text += fmt::format("{:<16} {:<24} {:<12} {:>8} {:>9} {:>7} {:>7} {:>6} {:>8.5f} {:>8.5f} {:>+9.5f}\n",
                                    s.contender, s.scene, s.light, s.points, s.undefined, s.false_shadow, s.false_light,
                                    s.edge, s.mae, s.rmse, s.bias);
            return text;
        });
        return kDone;
    };
}

}  // namespace umbra
