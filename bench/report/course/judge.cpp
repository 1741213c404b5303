#include "umbra/bench/report/course/judge.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/compare/compare.h"
#include "umbra/bench/contenders/contender.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/pages/embed.h"
#include "umbra/bench/report/course/apart.h"
#include "umbra/bench/report/course/grade_page.h"
#include "umbra/bench/report/course/platforms.h"
#include "umbra/bench/report/report.h"
#include "umbra/bench/sweep/content_key.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/stopwatch.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHandedIn = "handed_in";  ///< what records call a program or answers

constexpr const char* kOneFile = "page.html";

struct PlatformFile {
    const char* name;
    std::string (*text)(const GradeRecord& grade);
};
constexpr PlatformFile kPlatformFiles[] = {
    {"gradescope.json", gradescope_text},
    {"autolab.json", autolab_text},
    {"prairielearn.json", prairielearn_text},
    {"classroom50.json", [](const GradeRecord& grade) { return classroom50_text(grade, std::time(nullptr)); }},
    {"junit.xml", grade_junit}};

std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

std::string submission_key(const Submission& handed_in, const std::string& rubric_key) {
    std::string key = combined_key({rubric_key, handed_in.name});
    if (handed_in.method) return combined_key({key, handed_in.method->text(), code_key(*handed_in.method->info)});
    for (const fs::path& file : files_in(handed_in.folder))
        key = combined_key({key, file.lexically_relative(handed_in.folder).string(), bytes_of(file)});
    return key;
}

/// The record of an equal key, if there is one.
std::optional<GradeRecord> kept(const fs::path& file, const std::string& key) {
    if (key.empty() || !fs::is_regular_file(file)) return std::nullopt;
    try {
        auto record = from_record<GradeRecord>(parse_json(bytes_of(file), file.string()));
        if (record.key == key) return record;
    } catch (const InputError&) {  // of another version: it is graded again
    }
    return std::nullopt;
}

/// The file of a scene's answers; empty where there is none. A link is none: it may lead to what somebody else handed in.
fs::path answers_in(const fs::path& folder, const std::string& scene) {
    for (const char* ending : {".npy", ".exr"})
        if (fs::path file = folder / (scene + ending); fs::is_regular_file(fs::symlink_status(file))) return file;
    return {};
}

/// The first word of `run` that looks like a file and is none in the folder; empty: the program is there.
std::string missing_word(const std::vector<std::string>& run, const fs::path& folder) {
    for (const std::string& word : run)
        if (word.find_first_of("./") != std::string::npos && !word.starts_with('-') && fs::path(word).is_relative() &&
            !fs::is_regular_file(folder / word))
            return word;
    return {};
}

/// What answers on the scenes.
struct Asked {
    std::optional<MethodChoice> method{};  ///< on every scene
    fs::path answers{};                    ///< else: the folder of files

    [[nodiscard]] std::optional<MethodChoice> on(const std::string& scene) const {
        if (method) return method;
        const fs::path file = answers_in(answers, scene);
        if (file.empty()) return std::nullopt;
        return MethodChoice(answers_method({.name = kHandedIn, .where = file}));
    }
};

/// Throws InputError or MethodError: why nothing can be asked.
Asked asked_of(const Submission& handed_in, const Rubric& rubric, std::span<const ChosenScene> scenes, bool protect,
               GradeRecord& record) {
    if (handed_in.method) return {.method = handed_in.method};
    std::vector<std::string> run = rubric.record.run;
    if (run.empty()) run = {"./run"};
    const std::string missing = missing_word(run, handed_in.folder);
    if (!missing.empty()) {
        const auto answered = [&](const ChosenScene& scene) {
            return !answers_in(handed_in.folder, scene.name).empty();
        };
        if (std::ranges::any_of(scenes, answered)) return {.answers = handed_in.folder};
        throw InputError(fmt::format("the folder holds no file {}, and no {}.npy or {}.exr with answers", missing,
                                     scenes[0].name, scenes[0].name));
    }
    if (const fs::path first = run[0]; first.is_relative() && run[0].find('/') != std::string::npos &&
                                       access((handed_in.folder / first).c_str(), X_OK) != 0)
        throw InputError(fmt::format("{} is not executable, expected chmod +x {}", run[0], run[0]));
    const LimitsRecord& limits = rubric.record.limits;
    record.apart               = apart_record(limits, protect);
    ContenderRecord program{.command   = apart_command(run, handed_in.folder, limits, protect),
                            .timeout_s = limits.answer_s};
    program.says = introduction(program.command, handed_in.folder, limits.answer_s);
    return {.method = MethodChoice(program_method(kHandedIn, program, handed_in.folder))};
}

CompareOptions options_of(const Rubric& rubric, const JudgeOptions& options) {
    CompareOptions to;
    to.size = rubric.size, to.out = options.out, to.command = options.command, to.threads = options.threads;
    to.budget.seconds = rubric.record.limits.scene_s;
    to.add_page       = write_scene_page;
    const bool timed  = std::ranges::any_of(rubric.record.items, [](const auto& item) { return item.of == "time"; });
    to.repeats        = timed ? Repeats{} : kOnce;
    return to;
}

/// Students are not told where on the grader's machine their files were.
std::string without_folder(std::string message, const fs::path& folder) {
    const std::string start = folder.string() + "/";
    if (!folder.empty())
        for (std::size_t at = message.find(start); at != std::string::npos; at = message.find(start))
            message.erase(at, start.size());
    return message;
}

bool can_be_read(const fs::path& scene) {
    try {
        static_cast<void>(load_scene(scene));
        return true;
    } catch (const InputError&) {
        return false;
    }
}

/// One scene: compared, or why not. Scenes that cannot be read are in `record.not_compared`, and nothing is returned.
std::optional<Compared> compared_on(const ChosenScene& scene, const std::string& as, const Asked& asked,
                                    const Rubric& rubric, CompareOptions options, GradeRecord& record) {
    Compared compared{.asked = as, .folder = scene.folder};
    const std::optional<MethodChoice> method = asked.on(scene.name);
    if (!method) {
        compared.why = fmt::format("there is no {}.npy or {}.exr", scene.name, scene.name);
        return compared;
    }
    options.folder  = scene.folder;
    options.choices = {*method};
    for (const std::string& text : rubric.record.methods)
        if (MethodChoice choice = parse_method(text); choice.text() != method->text())
            options.choices.push_back(std::move(choice));
    try {
        compared.results = compare_scene(scene.file, options);
        compared.method  = std::string(method->info->name);
        return compared;
    } catch (const InputError& e) {
        if (!asked.answers.empty() && can_be_read(scene.file)) {  // then it is the answers that cannot
            compared.why = e.what();
            return compared;
        }
        record.not_compared.emplace_back(e.what());
        return std::nullopt;
    }
}

}  // namespace

std::string rubric_key(const Rubric& rubric) {
    std::string key = combined_key({version(), rubric.text});
    for (const fs::path& scene : rubric.scenes) key = combined_key({key, scene_key(load_scene(scene))});
    for (const std::string& text : rubric.record.methods) key = combined_key({key, code_key(*parse_method(text).info)});
    return combined_key({key, code_key(*parse_method("exact").info)});
}

GradeRecord judge(const Submission& handed_in, const Rubric& rubric, const JudgeOptions& options) {
    GradeRecord record{.head      = head_record(options.command),
                       .handed_in = handed_in.name,
                       .method    = handed_in.method ? handed_in.method->text() : kHandedIn};
    if (!options.key.empty())
        record.key = combined_key({submission_key(handed_in, options.key), options.embed ? kOneFile : ""});
    StagedFiles staged;
    const auto write_platform_files = [&](const GradeRecord& grade) {
        for (const PlatformFile& file : kPlatformFiles) staged.write(options.out / file.name, file.text(grade));
    };
    if (auto same = kept(options.out / "results.json", record.key)) {
        write_platform_files(*same);  // which also say what their environment says now
        staged.commit();
        return *same;
    }
    for (const PlatformFile& file : kPlatformFiles) record.files.emplace_back(file.name);
    if (options.embed) record.files.emplace_back(kOneFile);
    check_writable_beside(options.out, record.files);
    const PlaceLock lock = PlaceLock::inside(options.out);
    const Stopwatch start;
    const std::vector<ChosenScene> scenes = chosen_scenes(rubric.scenes);
    std::vector<Compared> all;
    try {
        const Asked asked      = asked_of(handed_in, rubric, scenes, options.protect, record);
        CompareOptions compare = options_of(rubric, options);
        for (std::size_t s = 0; s < scenes.size(); ++s) {
            compare.progress = [&](const std::string& what) {
                if (options.progress) options.progress(fmt::format("{}: {}: {}", handed_in.name, scenes[s].name, what));
            };
            const std::string as = rubric.record.scenes.empty() ? scenes[s].name : rubric.record.scenes[s];
            if (auto one = compared_on(scenes[s], as, asked, rubric, compare, record)) all.push_back(std::move(*one));
        }
    } catch (const InputError& e) {
        record.failed = e.what();
    } catch (const MethodError& e) {
        record.failed = e.what();
    }
    record.failed = without_folder(record.failed, handed_in.folder);
    for (Compared& scene : all) scene.why = without_folder(scene.why, handed_in.folder);
    end_idle_programs();
    grade(record, rubric.record, all);
    record.seconds = start.seconds();
    for (const Compared& scene : all)
        if (!scene.method.empty()) record.scenes.push_back(scene.folder);
    write_platform_files(record);
    staged.write(options.out / "results.json", json_text(to_record(record)));
    write_grade_page(record, rubric.record, all, options.out, staged);
    staged.commit();
    if (options.embed) write_text(options.out / kOneFile, embedded_page(options.out / "index.html"));
    return record;
}

}  // namespace umbra
