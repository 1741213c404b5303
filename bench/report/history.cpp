#include "umbra/bench/report/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "report_assets.h"
#include "umbra/bench/base/statistics.h"
#include "umbra/bench/lab/results.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/paths.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using Kind   = HistoryCell::Kind;

std::vector<Results> records_in(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
        if (is_file(entry->path() / "results.json")) files.push_back(entry->path() / "results.json");
    if (error) throw InputError(fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
    if (is_file(folder / "results.json")) files.push_back(folder / "results.json");
    std::sort(files.begin(), files.end());
    std::vector<Results> records;
    for (const fs::path& file : files) {
        const Field root = read_results(file);
        if (root.has("scene") && root.has("lights") && root.has("reference") && root.has("methods"))
            records.push_back(from_record<Results>(root));
    }
    if (records.empty())
        throw InputError(fmt::format("{}: found no record, expected results.json of umbra compare", folder.string()));
    return records;
}

/// A method's answers and times at one commit.
struct KeptRun {
    HistoryCell cell{};
    std::vector<double> totals{};  ///< of each round, milliseconds
    double calibration = kUnknown, noise = noise_bar({});
};

/// The time of each round in which all phases ran.
std::vector<double> totals_of(const TimesRecord& times) {
    std::vector<double> totals;
    bool is_first = true;
    for (const auto* phase : {&times.build_ms, &times.aim_ms, &times.look_ms, &times.visibility_ms}) {
        if (!*phase) continue;
        const std::vector<double>& samples = (*phase)->samples;
        if (is_first) totals.assign(samples.size(), 0);
        is_first = false;
        totals.resize(std::min(totals.size(), samples.size()));
        for (std::size_t i = 0; i < totals.size(); ++i) totals[i] += samples[i];
    }
    return totals;
}

KeptRun kept_run(const MethodRecord& method, const Results& results) {
    KeptRun run;
    if (method.failed) {
        run.cell.kind = Kind::wrong;
        run.cell.says = method.failed->message;
        return run;
    }
    if (method.serves.how == "not") {
        run.cell.kind = Kind::refused;
        run.cell.says = method.serves.why;
        return run;
    }
    run.cell.kind = Kind::equal;
    double wrong = 0, points = 0;
    for (const ErrorRecord& error : method.errors) {
        for (const auto& part : {error.interior.lit, error.interior.umbra, error.interior.penumbra})
            wrong += double(part.value_or(0));
        points += double(error.points.value_or(0));
    }
    run.cell.wrong = points > 0 ? wrong / points : 0;
    if (method.times) {
        run.totals  = totals_of(method.times->phases);
        run.cell.ms = totals(method).object_ms.value_or(0);
    }
    if (results.turns && !results.turns->calibration_ms.empty()) {
        run.calibration = median(results.turns->calibration_ms);
        run.noise       = results.turns->noise_bar.value_or(run.noise);
    }
    return run;
}

/// The cells of a row, all against the first that has answers.
std::vector<HistoryCell> compared(std::vector<KeptRun> runs) {
    const auto has_answers = [](const KeptRun& run) { return run.cell.kind == Kind::equal; };
    const auto first       = std::find_if(runs.begin(), runs.end(), has_answers);
    std::vector<HistoryCell> cells;
    for (KeptRun& run : runs) {
        if (has_answers(run)) {
            HistoryCell& cell   = run.cell;
            const double faster = first->calibration / run.calibration;  // than this machine was the first one
            if (std::isfinite(faster)) {
                cell.ms *= faster;
                for (double& total : run.totals) total *= faster;
            }
            cell.ratio = first->cell.ms > 0 ? cell.ms / first->cell.ms : 1;
            if (&run != &*first && !run.totals.empty() && !first->totals.empty() &&
                differs(ratio_of_samples(run.totals, first->totals), std::max(run.noise, first->noise)))
                cell.kind = cell.ratio > 1 ? Kind::slower : Kind::faster;
            if (cell.wrong > first->cell.wrong) {
                cell.kind = Kind::wrong;
                cell.says = fmt::format("{} % of the points are wrong outside the edge band, before {} %",
                                        percent(cell.wrong), percent(first->cell.wrong));
            }
        }
        cells.push_back(run.cell);
    }
    return cells;
}

std::string_view word_of(Kind kind) {
    constexpr std::array<std::string_view, 6> kWords{"absent", "refused", "wrong", "slower", "equal", "faster"};
    return kWords[static_cast<std::size_t>(kind)];
}

bool is_timed(const HistoryCell& cell) { return cell.kind >= Kind::slower && cell.ms > 0; }

/// "+12 %", "-5 %".
std::string change_in_words(double ratio) { return fmt::format("{:+.0f} %", 100 * (ratio - 1)); }

}  // namespace

History read_history(const std::vector<fs::path>& folders) {
    History history;
    std::map<std::pair<std::string, std::string>, std::size_t> row_of;
    std::vector<std::vector<KeptRun>> runs;
    for (std::size_t commit = 0; commit < folders.size(); ++commit) {
        const fs::path folder = folders[commit].has_filename() ? folders[commit] : folders[commit].parent_path();
        history.commits.push_back(folder.filename().string());
        for (const Results& results : records_in(folder))
            for (const MethodRecord& method : results.methods) {
                const std::string text  = method.text.empty() ? method.name : method.text;
                const auto [row, added] = row_of.try_emplace({results.scene.name, text}, history.rows.size());
                if (added) {
                    history.rows.push_back({results.scene.name, text, {}});
                    runs.emplace_back(folders.size());
                }
                runs[row->second][commit] = kept_run(method, results);
            }
    }
    for (std::size_t i = 0; i < runs.size(); ++i) history.rows[i].cells = compared(std::move(runs[i]));
    return history;
}

std::string history_page(const History& history) {
    using nlohmann::json;
    json rows = json::array();
    for (const HistoryRow& row : history.rows) {
        double least = std::numeric_limits<double>::infinity(), most = 0;
        for (const HistoryCell& cell : row.cells)
            if (is_timed(cell)) least = std::min(least, cell.ms), most = std::max(most, cell.ms);
        const double range = std::log(std::max(most / least, 1.5));  // noise has little colour
        json cells         = json::array();
        for (const HistoryCell& cell : row.cells) {
            const bool timed = is_timed(cell);
            cells.push_back(
                {{"kind", word_of(cell.kind)},
                 {"blue", timed ? fmt::format("{:.0f}", 100 - 100 * std::log(cell.ms / least) / range) : ""},
                 {"ms", timed ? milliseconds(cell.ms) : ""},
                 {"change", cell.kind == Kind::slower || cell.kind == Kind::faster ? change_in_words(cell.ratio) : ""},
                 {"refused", cell.kind == Kind::refused},
                 {"wrong", cell.kind == Kind::wrong},
                 {"says", cell.says}});
        }
        rows.push_back({{"scene", row.scene}, {"method", row.method}, {"cells", std::move(cells)}});
    }
    return render_page(assets::history_html, {}, {{"commits", history.commits}, {"rows", std::move(rows)}});
}

std::string history_text(const History& history) {
    std::string text, cells;
    for (std::size_t commit = 0; commit < history.commits.size(); ++commit) {
        std::map<Kind, std::size_t> counts;
        for (const HistoryRow& row : history.rows) {
            const HistoryCell& cell = row.cells[commit];
            ++counts[cell.kind];
            if (cell.kind == Kind::wrong || cell.kind == Kind::slower)
                cells +=
                    fmt::format("{}: {} {}: {}: {}\n", history.commits[commit], row.scene, row.method,
                                word_of(cell.kind), cell.kind == Kind::wrong ? cell.says : change_in_words(cell.ratio));
        }
        text += history.commits[commit] + ":";
        const char* separator = " ";
        for (const auto& [kind, n] : counts)
            text += fmt::format("{}{} {}", std::exchange(separator, ", "), n, word_of(kind));
        text += "\n";
    }
    return text + cells;
}

}  // namespace umbra
