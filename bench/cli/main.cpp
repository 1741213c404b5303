// The command line. Each command is one function below; what it does stands in its own file.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "umbra/bench/cli/bias_command.h"
#include "umbra/bench/cli/inspect.h"
#include "umbra/bench/cli/ladder_command.h"
#include "umbra/bench/compare/compare.h"
#include "umbra/bench/diff/diff.h"
#include "umbra/bench/golden/golden.h"
#include "umbra/bench/ladders/ladder_record.h"
#include "umbra/bench/report/report.h"
#include "umbra/bench/run/canonical.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

enum Exit : int { kDone = 0, kNo = 1, kUsage = 2, kUnreadable = 4, kInternal = 5 };

/// What every command takes.
struct Common {
    int threads = 0;
    bool quiet  = false;
    std::string command;  ///< the command line, for the records
};

/// One line on the terminal that shows what is being done; nothing where standard error is no terminal.
class Progress {
public:
    explicit Progress(bool quiet) : on_(!quiet && isatty(STDERR_FILENO) != 0) {}
    ~Progress() {
        if (on_) std::fputs("\r\033[K", stderr);
    }
    Progress(const Progress&)            = delete;
    Progress& operator=(const Progress&) = delete;
    void operator()(const std::string& what) const {
        if (on_) fmt::print(stderr, "\r\033[K{}", what.substr(0, 110));
    }

private:
    bool on_;
};

/// Where the canonical scenes lie: $UMBRA_SCENES, else the folder this was built from.
fs::path scenes_folder() {
    const char* set = std::getenv("UMBRA_SCENES");
    return set != nullptr ? set : UMBRA_SCENES_FOLDER;
}

/// Where the goldens lie: $UMBRA_GOLDEN, else beside the tests this was built with.
fs::path golden_folder() {
    const char* set = std::getenv("UMBRA_GOLDEN");
    return set != nullptr ? set : UMBRA_GOLDEN_FOLDER;
}

int list(bool as_json) {
    Json record = {{"schema", kResultsSchema},
                   {"version", version()},
                   {"methods", Json::array()},
                   {"scenes", Json::array()},
                   {"metrics", {"mae", "rmse", "max", "bias", "psnr", "ssim", "flip"}},
                   {"ladders", Json::array()}};
    for (const MethodInfo* info : methods()) record["methods"].push_back(method_json(*info));
    for (const fs::path& scene : canonical_scenes(scenes_folder())) record["scenes"].push_back(scene.stem().string());
    for (const Ladder* ladder : ladders()) record["ladders"].push_back(ladder_info_json(*ladder));
    if (as_json) {
        fmt::print("{}\n", record.dump(1));
        return kDone;
    }
    for (const Json& m : record["methods"]) {
        fmt::print("{} - {} ({})\n  {}\n", m["name"].get<std::string>(), m["title"].get<std::string>(),
                   m["paper"].get<std::string>(), m["summary"].get<std::string>());
        for (const Json& p : m["parameters"]) {
            const std::string range = p.contains("choices") ? p["choices"].get<std::string>()
                                      : p.contains("min")
                                          ? fmt::format("{} to {}", p["min"].get<double>(), p["max"].get<double>())
                                          : "true or false";
            fmt::print("    {}={}  ({})  {}\n", p["name"].get<std::string>(),
                       p["default"].is_string() ? p["default"].get<std::string>() : p["default"].dump(), range,
                       p["doc"].get<std::string>());
        }
    }
    fmt::print("\nScenes:");
    for (const Json& s : record["scenes"]) fmt::print(" {}", s.get<std::string>());
    fmt::print("\nMetrics:");
    for (const Json& s : record["metrics"]) fmt::print(" {}", s.get<std::string>());
    fmt::print("\nLadders:");
    for (const Ladder* ladder : ladders()) fmt::print(" {}", ladder->name);
    fmt::print("\n");
    return kDone;
}

int inspect(const fs::path& file, const SilhouetteOptions& silhouettes, bool as_json) {
    const Scene scene = load_scene(file);
    const Json record = inspect_json(scene, find_facts(scene), silhouettes);
    fmt::print("{}\n", as_json ? record.dump(1) : inspect_text(record));
    return kDone;
}

int render(const fs::path& file, const RenderOptions& options) {
    const std::string ending = options.out.extension().string();
    if (ending != ".exr" && ending != ".png")
        throw UsageError(fmt::format("-o {}: no picture format (write FILE.exr or FILE.png)", options.out.string()));
    const Service service = render_scene(file, options);
    if (service) return kDone;
    fmt::print(stderr, "{}: not served: {}\n", options.method, service.why);
    return kNo;
}

int compare_images(const std::string& a, const std::string& b, const DiffOptions& options, bool as_json) {
    const DiffResult result = diff(a, b, options);
    fmt::print("{}", as_json ? diff_json(result).dump(1, ' ', false, Json::error_handler_t::replace) + "\n"
                             : diff_text(result));
    return static_cast<int>(result.verdict);
}

/// Compares the scenes and writes the pages over what came out, and over the folders `also`.
ScenesDone compare(const std::vector<fs::path>& files, CompareOptions options, const Common& common,
                   const std::vector<fs::path>& also = {}) {
    options.command = common.command;
    options.threads = thread_count();
    ScenesDone done;
    {
        const Progress progress(common.quiet);
        options.progress = [&](const std::string& what) { progress(what); };
        done             = compare_scenes(files, options);
    }
    std::vector<fs::path> folders;
    for (const std::string& name : done.names) folders.push_back(options.out / name);
    if (!folders.empty()) {
        folders.insert(folders.end(), also.begin(), also.end());
        write_report(folders, options.out, {});
    }
    if (!common.quiet && !folders.empty()) fmt::print("{}\n", (options.out / "index.html").string());
    for (const std::string& message : done.failed) fmt::print(stderr, "{}\n", message);
    for (const std::string& message : done.missing) fmt::print(stderr, "{}\n", message);
    for (const std::string& message : done.stopped) fmt::print(stderr, "{}\n", message);
    return done;
}

Json climb(LadderOptions options, const Common& common) {
    options.command = common.command;
    options.threads = thread_count();
    const Progress progress(common.quiet);
    options.progress = [&](const std::string& what) { progress(what); };
    return climb_ladders(options);
}

int ladder(const LadderOptions& options, bool as_json, const Common& common) {
    const Json record = climb(options, common);
    if (as_json)
        fmt::print("{}\n", record.dump(1));
    else if (!common.quiet)
        fmt::print("{}", ladder_table(record["ladders"]));
    return kDone;
}

int bias(const std::vector<fs::path>& files, BiasOptions options, const Common& common) {
    options.command = common.command;
    options.threads = thread_count();
    std::vector<std::string> failed;
    Json record;
    {
        const Progress progress(common.quiet);
        options.progress = [&](const std::string& what) { progress(what); };
        record           = study_biases(files, options, failed);
    }
    if (!common.quiet && !record["bias"].empty())
        fmt::print("{}{}\n", bias_table(record), (options.out / "index.html").string());
    for (const std::string& message : failed) fmt::print(stderr, "{}\n", message);
    return failed.empty() ? kDone : kUnreadable;
}

/// With folders: pages anew. Without: the main job.
int report(const std::vector<fs::path>& folders, const fs::path& out, const Common& common) {
    if (folders.empty()) {
        CompareOptions options;
        options.out = out;
        LadderOptions ladders;
        ladders.out = out / "ladders";
        climb(ladders, common);
        // A canonical scene whose mesh could not be obtained at set-up is left out: that is told, but it is no failure.
        const ScenesDone done = compare(canonical_scenes(scenes_folder()), options, common, {ladders.out});
        if (!done.stopped.empty()) return kInternal;
        return done.failed.empty() && !done.names.empty() ? kDone : kUnreadable;
    }
    write_report(folders, out, {});
    if (!common.quiet) fmt::print("{}\n", (out / "index.html").string());
    return kDone;
}

/// Renews the goldens and prints what changed; with `only_check` prints alone, and answers no where anything would.
int accept(GoldenOptions options, bool only_check, const Common& common) {
    const std::vector<fs::path> scenes = teaching_scenes(scenes_folder());
    check_golden_names(scenes, options);
    options.folder = golden_folder();
    options.renew  = !only_check;

    std::vector<GoldenChange> all;
    const auto print = [&](const std::vector<GoldenChange>& changes) {
        for (const GoldenChange& change : changes) {
            if (!common.quiet) fmt::print("{}: {}\n", change.name, to_string(change.kind));
            if (!common.quiet)
                for (const std::string& line : change.lines) fmt::print("    {}\n", line);
            all.push_back(change);
        }
    };
    for (const fs::path& scene : scenes) {
        const Progress progress(common.quiet);
        progress(scene.stem().string());
        print(golden_changes(scene, options));
    }
    print(golden_leftovers(scenes, options));
    if (common.quiet) return only_check && !all.empty() ? kNo : kDone;
    const auto count = [&](GoldenChange::Kind kind) {
        return std::count_if(all.begin(), all.end(), [&](const GoldenChange& c) { return c.kind == kind; });
    };
    if (all.empty())
        fmt::print("nothing changed\n");
    else
        fmt::print("{} changed, {} new, {} removed{}\n", count(GoldenChange::Kind::changed),
                   count(GoldenChange::Kind::added), count(GoldenChange::Kind::removed),
                   only_check ? "; nothing was written" : fmt::format(", in {}", options.folder.string()));
    return only_check && !all.empty() ? kNo : kDone;
}

int run(int argc, char** argv) {
    CLI::App app{
        "Umbra compares shadow algorithms: one scene, many methods, one question: which fraction of each light does "
        "each surface point see?"};
    app.name("umbra");
    app.require_subcommand(1);
    app.set_version_flag("--version", std::string(version()));
    app.footer(
        "Exit codes: 0 done, 1 the answer is no, 2 wrong usage, 4 unreadable input, 5 internal error.\n"
        "umbra test and umbra bench run the tests and the benchmarks; they belong to the script ./umbra.");
    app.fallthrough();
    Common common;
    for (int i = 0; i < argc; ++i) common.command += (i ? " " : "") + (i ? std::string(argv[i]) : std::string("umbra"));
    app.add_option("--threads", common.threads, "Threads to use (default: all)")->check(CLI::Range(1, 1024));
    app.add_flag("--quiet", common.quiet, "Print errors only");

    bool as_json           = false;
    CLI::App* list_command = app.add_subcommand("list", "Methods with parameters, scenes, metrics, ladders");
    list_command->add_flag("--json", as_json, "Print JSON");

    std::string scene;
    SilhouetteOptions silhouettes;
    CLI::App* inspect_command =
        app.add_subcommand("inspect", "What a scene requires; which method serves it, how, why");
    inspect_command->add_option("SCENE", scene, "Scene file (.json .gltf .glb .obj .nff .ply .off .stl)")->required();
    inspect_command
        ->add_option("--silhouettes", silhouettes.directions,
                     "Mean number of silhouette edges over N random light directions")
        ->check(CLI::Range(std::uint64_t{2}, std::uint64_t{10'000'000}));
    inspect_command->add_option("--seed", silhouettes.seed, "Seed of those directions");
    inspect_command->add_flag("--json", as_json, "Print JSON");

    std::string size, out;
    RenderOptions render_options;
    CLI::App* render_command = app.add_subcommand("render", "One picture of a scene by one method");
    render_command->add_option("SCENE", scene, "Scene file")->required();
    render_command->add_option("--method", render_options.method, "METHOD or METHOD:k=v,k=v")->capture_default_str();
    render_command->add_option("--size", size, "WIDTHxHEIGHT (default: the scene's own)");
    render_command->add_flag("--geometry", render_options.with_geometry,
                             "Write Z, N, P, id.object and id.face into the EXR too");
    render_command->add_option("-o,--output", out, "FILE.exr or FILE.png")->required();

    std::vector<std::string> scenes;
    CompareOptions compare_options;
    std::string reference;
    CLI::App* compare_command =
        app.add_subcommand("compare", "A scene under several methods: pictures, S_j, differences, errors, times");
    compare_command->add_option("SCENE", scenes, "Scene files")->required();
    compare_command->add_option("--methods", compare_options.methods, "METHOD[:k=v,...] ... (default: all that serve)");
    compare_command->add_option("--reference", reference, "METHOD[:k=v,...] to hold the others against");
    compare_command
        ->add_option("--reference-points", compare_options.points,
                     "Judge area lights on about N points, well spread (default: on all where that is not "
                     "too dear)")
        ->check(CLI::PositiveNumber);
    compare_command->add_option("--size", size, "WIDTHxHEIGHT (default: the scene's own)");
    compare_command->add_option("-o,--output", out, "Folder to write to")->required();

    std::string a, b, map;
    DiffOptions diff_options;
    CLI::App* diff_command = app.add_subcommand(
        "diff", "Difference of two images: 0 same, 1 close, 2 differs, 3 size or channels differ, 4 unreadable");
    diff_command->add_option("A", a, "Reference image")->required();
    diff_command->add_option("B", b, "Image to hold against it")->required();
    diff_command->add_option("--fail", diff_options.fail, "Largest difference of a value that is allowed");
    diff_command->add_option("--fail-percent", diff_options.fail_percent,
                             "Percentage of pixels that may be beyond --fail");
    diff_command->add_option("--fail-rmse", diff_options.fail_rmse, "Largest root mean square difference allowed");
    diff_command->add_option("--fail-flip", diff_options.fail_flip, "Largest mean FLIP allowed");
    diff_command->add_option("--fail-psnr", diff_options.fail_psnr, "Smallest PSNR allowed, dB");
    diff_command->add_option("--fail-ssim", diff_options.fail_ssim, "Smallest SSIM allowed");
    diff_command->add_option("--warn", diff_options.warn,
                             "Largest difference of a value that still counts as the same");
    diff_command->add_option("-o,--output", map, "Write the FLIP map to FILE.png or FILE.exr");
    diff_command->add_flag("--json", as_json, "Print JSON");

    LadderOptions ladder_options;
    CLI::App* ladder_command =
        app.add_subcommand("ladder", "Stability: the rung of each ladder at which each method breaks");
    ladder_command->add_option("NAME", ladder_options.names, "Ladders (default: all; umbra list names them)");
    ladder_command->add_option("--methods", ladder_options.methods, "METHOD[:k=v,...] ... (default: all but exact)");
    ladder_command->add_option("-o,--output", out, "Folder to write to")->required();
    ladder_command->add_flag("--json", as_json, "Print results.json instead of the table");

    GoldenOptions golden_options;
    bool only_check          = false;
    CLI::App* accept_command = app.add_subcommand(
        "accept", "Renew the goldens that the tests hold every method against, and print what changed");
    accept_command->add_option("NAME", golden_options.names, "SCENE, METHOD or SCENE/METHOD (default: all)");
    accept_command->add_flag("--check", only_check, "Write nothing; exit with 1 where anything would change");
    accept_command->add_option("--pictures", golden_options.pictures,
                               "Folder for reference, result and difference of what changed");

    BiasOptions bias_options;
    CLI::App* bias_command = app.add_subcommand(
        "bias", "The shadow z-buffer's bias: acne against detachment over constant, slope and normal offset");
    bias_command->add_option("SCENE", scenes, "Scene files (default: the canonical ones)");
    bias_command->add_option("--map", bias_options.map, "Settings of shadow_zbuffer other than bias: k=v,k=v");
    bias_command->add_option("--size", size, "WIDTHxHEIGHT (default: 320x180)");
    bias_command->add_option("-o,--output", out, "Folder to write to")->required();

    std::string report_out   = "results";
    CLI::App* report_command = app.add_subcommand(
        "report", "The main job: all canonical scenes under all methods; with folders: their pages anew");
    report_command->add_option("DIR", scenes, "Folders that compare wrote");
    report_command->add_option("-o,--output", report_out,
                               "Folder to write to (default: results; for one DIR, that folder)");

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? kDone : kUsage;
    }

    const ThreadLimit limit(common.threads);
    if (*list_command) return list(as_json);
    if (*inspect_command) return inspect(scene, silhouettes, as_json);
    if (*render_command) {
        if (!size.empty()) render_options.size = parse_size(size);
        render_options.out     = out;
        render_options.command = common.command;
        return render(scene, render_options);
    }
    if (*diff_command) {
        diff_options.map = map;
        return compare_images(a, b, diff_options, as_json);
    }
    if (*accept_command) return accept(golden_options, only_check, common);
    if (*compare_command) {
        if (!size.empty()) compare_options.size = parse_size(size);
        if (!reference.empty()) compare_options.reference = reference;
        compare_options.out   = out;
        const ScenesDone done = compare({scenes.begin(), scenes.end()}, compare_options, common);
        if (!done.stopped.empty()) return kInternal;
        return done.failed.empty() && done.missing.empty() ? kDone : kUnreadable;
    }
    if (*ladder_command) {
        ladder_options.out = out;
        return ladder(ladder_options, as_json, common);
    }
    if (*bias_command) {
        if (!size.empty()) bias_options.size = parse_size(size);
        bias_options.out = out;
        return bias(
            scenes.empty() ? canonical_scenes(scenes_folder()) : std::vector<fs::path>(scenes.begin(), scenes.end()),
            bias_options, common);
    }
    if (report_out.empty()) report_out = scenes.size() == 1 ? scenes[0] : "results";
    if (*report_command) return report({scenes.begin(), scenes.end()}, report_out, common);
    return kInternal;
}

}  // namespace
}  // namespace umbra

int main(int argc, char** argv) {
    try {
        return umbra::run(argc, argv);
    } catch (const umbra::UsageError& e) {
        fmt::print(stderr, "umbra: {}\n", e.what());
        return umbra::kUsage;
    } catch (const umbra::InputError& e) {
        fmt::print(stderr, "{}\n", e.what());
        return umbra::kUnreadable;
    } catch (const std::exception& e) {
        fmt::print(stderr, "umbra: internal error: {}\n", e.what());
        return umbra::kInternal;
    }
}
