#include <fmt/format.h>

#include <limits>

#include "umbra/bench/base/scratch_folder.h"
#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/gate/diff_set.h"
#include "umbra/bench/gate/diff_views.h"
#include "umbra/bench/pages/embed.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/paths.h"

namespace umbra {
namespace {

struct DiffLine {
    std::string a, b;
    std::filesystem::path html, junit, markdown, tolerance;
    DiffOptions options;
    bool embed = false, as_json = false;
};

int diff(DiffLine line, const Common& common) {
    DiffOptions& options     = line.options;
    const std::string ending = options.map.extension().string();
    if (!is_folder(line.a) && !options.map.empty() && ending != ".png" && ending != ".exr")
        throw UsageError(
            fmt::format("-o {}: not a picture format, expected FILE.png or FILE.exr", options.map.string()));
    if (line.embed && line.html.empty()) throw UsageError("--embed needs --html FILE");
    if (!line.tolerance.empty()) options.tolerance = std::make_shared<Tolerance>(read_tolerance(line.tolerance));
    std::optional<ScratchFolder> workshop;  // where a page and its pictures are until they are one file
    if (line.embed) workshop.emplace();
    const std::filesystem::path page = workshop ? workshop->path() / "page.html" : line.html;
    if (!line.html.empty()) options.pictures = diff_pictures_folder(page);
    const DiffSet set =
        on_terminal(common, [&](const auto& progress) { return diff_set(line.a, line.b, options, progress); });
    StagedFiles staged;
    if (!line.junit.empty()) staged.write(line.junit, diff_set_junit(set));
    if (!line.markdown.empty()) staged.write(line.markdown, diff_set_markdown(set));
    if (!line.html.empty()) write_diff_page(page, set);
    if (line.embed) staged.write(line.html, embedded_page(page));
    staged.commit();
    const auto replace = nlohmann::json::error_handler_t::replace;
    print_out("{}", line.as_json ? diff_set_json(set).dump(1, ' ', false, replace) + "\n" : diff_set_text(set));
    return static_cast<int>(set.worst());
}

}  // namespace

Action diff_command(CLI::App& app, const Common& common) {
    constexpr double kMany = std::numeric_limits<double>::max();
    const auto line        = std::make_shared<DiffLine>();
    DiffOptions& options   = line->options;
    app.add_option("A", line->a, "Reference image, or a folder of images")->type_name("")->required();
    app.add_option("B", line->b, "Image or folder to compare with it")->type_name("")->required();
    app.add_option("--channels", options.channels,
                   "Compare only these channels, as in R,G,B,S.* (of a further part: PART.R)")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("NAMES");
    const CLI::Validator positive = number_in(0, kMany, "a number, 0 or larger");
    CLI::Option* tolerance =
        app.add_option("--tolerance", line->tolerance, "Rules for each image, instead of the limits (docs/gate.md)")
            ->type_name("FILE.json");
    const auto limit = [&](const char* name, auto& value, const char* about, const CLI::Validator& check) {
        CLI::Option* option = app.add_option(name, value, about)->check(check)->type_name("X");
        if (std::string_view(name) != "--warn") option->excludes(tolerance);
    };
    limit("--fail", options.fail, "Largest difference of a value that is allowed (default: 1e-6)", positive);
    limit("--fail-percent", options.fail_percent, "Percentage of pixels that may differ by more than --fail",
          number_in(0, 100, "a percentage, 0 to 100"));
    limit("--fail-rmse", options.fail_rmse, "Largest root mean square difference allowed", positive);
    limit("--fail-flip", options.fail_flip, "Largest mean FLIP of any layer (R, G, B) allowed",
          number_in(0, 1, "a number from 0 to 1"));
    limit("--fail-psnr", options.fail_psnr, "Smallest PSNR allowed, dB", number_in(-kMany, kMany, "a finite number"));
    limit("--fail-ssim", options.fail_ssim, "Smallest SSIM of any layer allowed",
          number_in(-1, 1, "a number from -1 to 1"));
    limit("--warn", options.warn, "Largest difference of a value that still counts as the same", positive);
    app.add_option("-o,--output", options.map,
                   "Write a difference map: FILE.png (colours) or FILE.exr (FLIP, and B - A of every channel); for "
                   "folders, a folder")
        ->type_name("FILE");
    app.add_option("--html", line->html, "Write a page: A, B, difference map and figures side by side")
        ->type_name("FILE");
    app.add_flag("--embed", line->embed, "Write the page as one file, its pictures inside");
    app.add_option("--markdown", line->markdown, "Write a table in Markdown, for a comment on a pull request")
        ->type_name("FILE");
    app.add_option("--junit", line->junit, "Write JUnit XML, one test case per image")->type_name("FILE");
    app.add_flag("--json", line->as_json, "Print JSON");
    app.footer(
        "Exit codes: 0 same, 1 close (within the limits), 2 differs, 3 sizes, parts, channels, windows or colour "
        "metadata differ, 4 unreadable; of "
        "folders the largest.");
    return [line, &common] { return diff(*line, common); };
}

}  // namespace umbra
