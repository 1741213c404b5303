#include "umbra/bench/contenders/contender.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/base/staged_folder.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/contenders/gate.h"
#include "umbra/bench/contenders/program_session.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

struct ContenderLine {
    std::string action;
    std::vector<std::string> words;
    std::string save;
    double timeout_s = 120;
    bool as_json     = false;
    fs::path out;
    Size size;
};

/// What is to be checked: a contender that is known, its file, or a command; and the file that says so then, if any.
struct Checked {
    ContenderRecord record{};
    fs::path folder{}, file{};
};

Checked asked_for(const ContenderLine& line) {
    if (line.words.size() == 1)
        if (const auto file = contender_file(line.words[0])) {
            Checked found{.record = read_contender(*file), .file = *file};
            found.folder = fs::absolute(*file).parent_path() / found.record.folder;
            return found;
        }
    const auto& known = methods();
    if (const auto plugin = std::ranges::find(known, "library", &MethodInfo::outside);
        plugin != known.end() && line.words.size() == 1)
        throw UsageError(fmt::format("contender check: no method is called {:?}, that of the library is \"{}\"",
                                     line.words[0], (*plugin)->name));
    Checked typed{.record = {.command = line.words, .folder = "..", .timeout_s = line.timeout_s},
                  .folder = fs::current_path()};
    if (!line.save.empty()) typed.file = fs::path("contenders") / (line.save + ".json");
    return typed;
}

/// Prints the rows of the gate, and calls save(), which returns a sentence for people, where all are passed.
int print_gate(const MethodInfo& method, const ContenderLine& line, const Common& common,
               const std::function<std::string()>& save) {
    const std::vector<GateRow> rows = on_terminal(common, [&](const auto& progress) { return gate(method, progress); });
    const bool passed               = std::ranges::all_of(rows, &GateRow::passed);
    const std::string saved         = passed ? save() : "";
    Json found                      = to_record(head_record(common.command));
    found["contender"] = method.title, found["passed"] = passed;
    for (const GateRow& row : rows)
        found["rows"].push_back({{"question", row.question}, {"passed", row.passed}, {"found", row.found}});
    print_record(line.as_json, common, found, [&] {
        std::string text = fmt::format("{}\n", method.title);
        for (const GateRow& row : rows)
            text += fmt::format("{}  {}: {}\n", row.passed ? "passed" : "FAILED", row.question, row.found);
        return text + saved;
    });
    return passed ? kDone : kNo;
}

int check(const ContenderLine& line, const Common& common) {
    if (line.words.empty())
        throw UsageError(
            "contender check: expected a command (umbra contender check -- python3 mine.py), or the name or "
            "the file of a contender");
    if (!line.save.empty()) check_method_name(line.save);
    for (const MethodInfo* known : methods()) {
        if (known->outside == "program") continue;
        if (known->name == line.save)
            throw UsageError(
                fmt::format("--save {}: that is a method of this program, expected another name", line.save));
        if (line.words.size() == 1 && known->name == line.words[0]) {
            if (!line.save.empty())
                throw UsageError("--save: is for programs, expected none; --plugin names a library on each line");
            return print_gate(*known, line, common, [] { return ""; });
        }
    }
    Checked checked         = asked_for(line);
    ContenderRecord& record = checked.record;
    const fs::path& file    = checked.file;
    record.says             = introduction(record.command, checked.folder, record.timeout_s);
    return print_gate(program_method("contender", record, checked.folder), line, common, [&]() -> std::string {
        if (file.empty()) return "";
        record.checked = record.says.version;
        make_folder(file.parent_path());
        StagedFiles staged;
        staged.write(file, json_text(to_record(record)));
        staged.commit();
        return fmt::format("{} says so: it is a method now, --methods {}\n", file.string(), file.stem().string());
    });
}

int show(const ContenderLine& line, const Common& common) {
    if (line.words.size() != 1) throw UsageError("contender show: one SCENE is expected");
    if (line.out.empty()) throw UsageError("contender show: -o DIR is required");
    const PreparedScene prepared = prepare_scene(scene_file(line.words[0], common.up), line.size);
    const Scene& scene           = prepared.scene;
    StagedFolder stage(line.out);
    const fs::path& folder = stage.folder();
    const Json settings    = Json::object();
    std::vector<Json> messages{hello_message(fs::absolute(line.out)), scene_message(folder, scene, settings),
                               build_message(settings), points_message(folder, scene, prepared.points, settings)};
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        messages.push_back(aim_message(scene, j, settings));
        Json visibility = visibility_message(folder, prepared.points, j, settings);
        // Of one run after the other these are the same files; here they stand side by side.
        visibility["asked"] = fmt::format("asked-{}.npy", j), visibility["answers"] = fmt::format("answers-{}.npy", j);
        fs::rename(folder / "asked.npy", folder / visibility["asked"].get<std::string>());
        messages.push_back(visibility);
    }
    messages.push_back({{"message", "end"}});
    std::string lines;
    for (const Json& message : messages) lines += message.dump() + "\n";
    write_text(folder / "messages.jsonl", lines);
    Json record        = to_record(head_record(common.command));  // which makes the folder one of ours
    record["files"]    = {"messages.jsonl"};
    record["messages"] = messages;
    write_text(folder / "results.json", json_text(record));
    stage.commit();
    if (!common.quiet)
        print_out("{}", without_controls(fmt::format(
                            "{}: {} messages (messages.jsonl), {} points, {} triangles, {} light{}\n",
                            line.out.string(), messages.size(), prepared.points.size(), scene.triangles.size(),
                            scene.lights.size(), scene.lights.size() == 1 ? "" : "s")));
    return kDone;
}

}  // namespace

Action contender_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<ContenderLine>();
    app.add_option("ACTION", line->action,
                   "check: ask a program from outside questions with known answers; show: write what it would be asked")
        ->check(CLI::IsMember({"check", "show"}))
        ->type_name("")
        ->required();
    app.add_option(
           "WORDS", line->words,
           "check: a command and its arguments, a contender's name or file, or a plugin's method; show: a scene")
        ->type_name("");
    app.add_option("--save", line->save, "check: write contenders/NAME.json where it passes")->type_name("NAME");
    app.add_option("--timeout", line->timeout_s, "check: seconds that an answer may take (120)")
        ->check(number_in(0.1, 86400, "seconds, 0.1 to 86400"))
        ->type_name("S");
    add_json(app, line->as_json, "the rows");
    add_size(app, line->size);
    app.add_option("-o,--output", line->out, "show: folder to write to")->type_name("DIR");
    return [line, &common] { return line->action == "check" ? check(*line, common) : show(*line, common); };
}

}  // namespace umbra
