#include "umbra/bench/cli/ladder_command.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <iterator>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/staged_folder.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/lab/steps.h"
#include "umbra/bench/ladders/ladder_file.h"
#include "umbra/bench/ladders/ladder_page.h"
#include "umbra/bench/ladders/ladder_record.h"
#include "umbra/bench/ladders/ladder_run.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

constexpr std::string_view kTextbook = "textbook";

/// The textbook form of a method, where it is something else than its defaults.
std::optional<MethodChoice> textbook_form(const MethodInfo& info) {
    for (const Preset& preset : info.presets)
        if (preset.name == kTextbook)
            if (MethodChoice form = parse_method(fmt::format("{}@{}", info.name, preset.name));
                form.text() != info.name)
                return form;
    return std::nullopt;
}

/// All methods but the reference, with their defaults and, where that is something else, in their textbook form.
std::vector<MethodChoice> default_methods(bool only_by_default) {
    std::vector<MethodChoice> chosen;
    for (const MethodChoice& method : chosen_methods({}, {}, {})) {
        if (method.info->reference || (only_by_default && !method.info->by_default)) continue;
        chosen.push_back(method);
        if (auto form = textbook_form(*method.info)) chosen.push_back(std::move(*form));
    }
    return chosen;
}

/// What the files of a break are named by.
std::string break_name(const LadderRun& run, std::size_t m) {
    const auto same = std::count_if(run.methods.begin(), run.methods.begin() + std::ptrdiff_t(m),
                                    [&](const MethodChoice& other) { return other.info == run.methods[m].info; });
    return fmt::format("{}.{}{}", run.ladder->name, run.methods[m].info->name,
                       same ? fmt::format("-{}", same + 1) : "");
}

/// A textbook form that was climbed beside the default form.
bool is_twin(const std::vector<MethodChoice>& all, const MethodChoice& method) {
    const auto form = textbook_form(*method.info);
    return form && form->text() == method.text() &&
           std::any_of(all.begin(), all.end(), [&](const MethodChoice& m) { return m.text() == method.info->name; });
}

/// Where a textbook form breaks, on the ladder on which the default form holds for the most rungs longer.
struct TextbookBreak {
    const Ladder* ladder = nullptr;
    std::size_t entry    = 0;  ///< index into LaddersRecord::ladders
    double rung          = 0;
    std::size_t method   = 0;
    std::size_t gain     = 0;  ///< rungs
};

void find_textbook_break(const LadderRun& run, std::size_t m, std::size_t entry, TextbookBreak& best) {
    const Climb textbook = climb(run, m);
    if (!textbook.breaks_at || !run.rungs[*textbook.breaks_at].outcomes[m].ran()) return;
    for (std::size_t d = 0; d < run.methods.size(); ++d) {
        if (run.methods[d].text() != run.methods[m].info->name) continue;
        const std::size_t until = climb(run, d).breaks_at.value_or(run.rungs.size());
        if (until > *textbook.breaks_at && until - *textbook.breaks_at > best.gain)
            best = {run.ladder, entry, run.rungs[*textbook.breaks_at].value, m, until - *textbook.breaks_at};
    }
}

/// A ladder's run, or what stopped it.
struct Climbed {
    std::optional<LadderRun> run;
    std::exception_ptr stopped;
};

/// Several at a time: answers do not depend on that, and on one rung most work is no loop over many points. A thread
/// that waits for others within a ladder takes up no other ladder meanwhile.
std::vector<Climbed> climb_all(std::span<const Ladder* const> chosen, const std::vector<MethodChoice>& methods,
                               const LadderOptions& options) {
    std::vector<Climbed> all(chosen.size());
    Steps steps(chosen.size(), options.progress);
    std::mutex mutex;
    parallel_ranges(chosen.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            tbb::this_task_arena::isolate([&] {
                {
                    const std::lock_guard lock(mutex);
                    steps.next();
                }
                const auto progress = [&](const std::string& what) {
                    const std::lock_guard lock(mutex);
                    steps.show(what);
                };
                try {
                    all[i].run = climb_ladder(*chosen[i], methods, progress, options.patience_s, options.budget);
                } catch (...) {
                    all[i].stopped = std::current_exception();
                }
            });
    });
    return all;
}

}  // namespace

LaddersRecord climb_ladders(const LadderOptions& options) {
    if (holds_record_without(options.out, "ladders"))
        throw InputError(
            fmt::format("{}: holds the results of another command and is not replaced, expected another folder "
                        "with -o",
                        options.out.string()));
    std::vector<const Ladder*> chosen;
    for (const std::string& name : options.names) {
        const Ladder& ladder = is_ladder_file(name)
                                   ? read_ladder(name, [](const std::string& scene) { return scene_file(scene); })
                                   : find_ladder(name);
        const auto same      = [&](const Ladder* other) { return other->name == ladder.name; };
        if (std::ranges::any_of(chosen, same))
            throw UsageError(
                fmt::format("{}: another ladder is called {}, expected each name once", name, ladder.name));
        chosen.push_back(&ladder);
    }
    if (chosen.empty()) chosen.assign(ladders().begin(), ladders().end());
    const std::vector<MethodChoice> methods_chosen =
        options.methods.empty() ? default_methods(options.only_by_default) : chosen_methods(options.methods, {}, {});

    LaddersRecord record{.head           = head_record(options.command),
                         .machine        = machine_record(options.threads),
                         .breaking_share = kBreakingShare,
                         .budget         = budget_record(options.budget)};
    const auto add_failed = [&](const Ladder& ladder, const std::string& method) {
        record.failed.push_back({.ladder = ladder.name, .method = method, .failure = {.message = current_message()}});
    };
    std::vector<TextbookBreak> textbook(methods_chosen.size());  // by method
    StagedFolder staged(options.out);
    const std::filesystem::path breaks = staged.folder() / "breaks";
    std::filesystem::create_directory(breaks);
    std::vector<Climbed> climbed = climb_all(chosen, methods_chosen, options);
    Steps steps(chosen.size(), options.progress);
    const auto show_break = [&](const Ladder& ladder, double rung, const MethodChoice& method, const std::string& name,
                                ClimbRecord& of) {
        steps.show(fmt::format("{}: what breaks {}", ladder.name, method.text()));
        try {
            of.shown = write_break(breaks, name, ladder, rung, method);
        } catch (const InputError&) {  // a file that cannot be written
            throw;
        } catch (...) {
            add_failed(ladder, method.text());
        }
    };
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const Ladder* ladder = chosen[i];
        steps.next();
        try {
            if (climbed[i].stopped) std::rethrow_exception(climbed[i].stopped);
            LadderRun& run = *climbed[i].run;
            if (run.methods.size() > 1) {
                steps.show(fmt::format("{}: times", ladder->name));
                run.first_rung_ms = time_first_rung(*ladder, run.methods, options.budget);
            }
            LadderRecord entry = ladder_record(run);
            std::ranges::move(failed_climbs(run), std::back_inserter(record.failed));
            for (std::size_t m = 0; m < run.methods.size(); ++m) {
                if (is_twin(run.methods, run.methods[m])) {  // one scene a form is enough to see why
                    find_textbook_break(run, m, record.ladders.size(), textbook[m]);
                    continue;
                }
                const std::optional<std::size_t> breaks_at = climb(run, m).breaks_at;
                if (breaks_at && run.rungs[*breaks_at].outcomes[m].ran())
                    show_break(*ladder, run.rungs[*breaks_at].value, run.methods[m], break_name(run, m),
                               entry.methods[m]);
            }
            record.ladders.push_back(std::move(entry));
        } catch (const InputError&) {
            throw;
        } catch (...) {
            add_failed(*ladder, "the ladder");
        }
    }
    for (const TextbookBreak& best : textbook) {
        if (best.gain == 0) continue;
        const MethodChoice& method = methods_chosen[best.method];
        show_break(*best.ladder, best.rung, method,
                   fmt::format("{}.{}-{}", best.ladder->name, method.info->name, kTextbook),
                   record.ladders[best.entry].methods[best.method]);
    }
    write_text(staged.folder() / "results.json", json_text(to_record(record)));
    write_ladder_page(staged.folder());
    staged.commit();
    return record;
}

}  // namespace umbra
