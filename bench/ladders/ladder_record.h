// What climbs found, as results.json of `umbra ladder` holds it, and as the table that the terminal shows.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"
#include "umbra/bench/ladders/ladder_break.h"
#include "umbra/bench/ladders/ladder_run.h"

namespace umbra {

/// RungOutcome; where the method did not run to its end, without figures.
struct RungOutcomeRecord {
    ServiceRecord serves{};
    std::string stopped{};
    std::optional<std::uint64_t> points{}, undefined{};
    std::optional<VisibilityError::Kind> false_shadow{}, false_light{};
    std::optional<std::uint64_t> interior_lit{}, interior_shadow{};
    std::optional<double> interior_share{}, mae{};
    std::optional<bool> broken{};
    std::optional<std::optional<std::string>> kind{};  ///< with figures; null: no point is wrong
};
DESCRIBE(RungOutcomeRecord) {
    of.name("outcome", "what a method made of a rung; without figures where it did not run to its end");
    MEMBERS(serves);
    of.may(MEMBER(stopped), "what it threw");
    of.may(MEMBER(points));
    of.may(MEMBER(undefined));
    of.may(MEMBER(false_shadow));
    of.may(MEMBER(false_light));
    of.may(MEMBER(interior_lit), "as of the rung, of the points that the method answers");
    of.may(MEMBER(interior_shadow), "likewise");
    of.may(MEMBER(interior_share), "", {{}, 0, 1});
    of.may(MEMBER(mae), "", {{}, 0, 1});
    of.may(MEMBER(broken));
    of.may(MEMBER(kind));
}

/// How a method fared on a ladder. Rungs are named by their values.
struct ClimbRecord {
    std::string name{}, title{}, text{};
    std::optional<std::string> preset{};
    std::optional<double> breaks_at{};
    std::optional<std::string> kind{};
    std::optional<double> silent_from{}, not_served_from{}, not_judged_from{};
    std::string why{};
    std::optional<std::uint64_t> judged_rungs{};
    std::optional<double> least_coverage{};
    std::vector<RungOutcomeRecord> rungs{};
    std::optional<std::vector<double>> first_rung_ms{};
    std::optional<BreakRecord> shown{};
};
DESCRIBE(ClimbRecord) {
    of.name("climb", "how a method fared on a ladder; rungs are named by their values, null: none");
    MEMBERS(name, title);
    of.must(MEMBER(text), "method and settings, as typed");
    of(MEMBER(preset), "whose settings these are; null where they are of none");
    MEMBERS(breaks_at);
    of(MEMBER(kind), "",
       one_of({"acne", "false shadow", "leak", "detachment", "false light", "penumbra", "stopped", "wrong sum"}));
    of(MEMBER(silent_from), "from here on to the last rung, most points are undefined");
    of(MEMBER(not_served_from), "from here on to the last rung");
    of(MEMBER(not_judged_from),
       "from here on to the last rung, too few interior points of a kind, no points or no reference");
    MEMBERS(why);
    of.may(MEMBER(judged_rungs), "on which it ran and has enough interior points of each kind");
    of.may(MEMBER(least_coverage), "of the judged rungs: the least share of the points that it answers", {{}, 0, 1});
    of(MEMBER(rungs), "of the judged rungs");
    of.may(MEMBER(first_rung_ms),
           "build, aim and visibility on the first rung, a value a round, all methods in turns; empty where the method "
           "does not serve it");
    of.may("break", &R::shown);
}

struct LadderWordsRecord {
    std::string name{}, title{}, about{}, unit{};
};
DESCRIBE(LadderWordsRecord) {
    of.must(MEMBER(name));
    of.must(MEMBER(title));
    MEMBERS(about);
    of(MEMBER(unit), "of the value of a rung");
}

/// A ladder as `umbra list --json` names it.
struct LadderInfoRecord : LadderWordsRecord {
    std::vector<double> rungs{};
};
DESCRIBE(LadderInfoRecord) {
    of.name("ladder");
    describe(of, Is<LadderWordsRecord>{});
    MEMBERS(rungs);
}

/// A ladder that was climbed.
struct LadderRecord : LadderWordsRecord {
    std::vector<Rung> rungs{};
    std::uint64_t not_climbed = 0;
    std::vector<ClimbRecord> methods{};
};
DESCRIBE(LadderRecord) {
    of.name("ladder");
    describe(of, Is<LadderWordsRecord>{});
    MEMBERS(rungs);
    of(MEMBER(not_climbed), "rungs beyond the last of `rungs`");
    MEMBERS(methods);
}

struct LaddersRecord {
    HeadRecord head{};
    MachineRecord machine{};
    std::optional<double> breaking_share{};
    std::vector<LadderRecord> ladders{};
    std::vector<ListedFailureRecord> failed{};
    std::optional<BudgetRecord> budget{};
};
DESCRIBE(LaddersRecord) {
    of.all(&R::head);
    MEMBERS(machine);
    of(MEMBER(breaking_share),
       "a method that serves a scene approximately breaks where a larger fraction of the compared points is wrong in "
       "the interior",
       {{}, 0, 1});
    MEMBERS(ladders);
    of(MEMBER(failed), "methods, references and whole ladders");
    of.may(MEMBER(budget));
}

/// Throws InputError: "FILE:/POINTER: found WHAT, expected WHAT".
[[nodiscard]] LaddersRecord read_ladders(const std::filesystem::path& file);

[[nodiscard]] LadderInfoRecord ladder_info(const Ladder& ladder);
[[nodiscard]] LadderRecord ladder_record(const LadderRun& run);

/// Methods and references that threw on a ladder, at their first such rung.
[[nodiscard]] std::vector<ListedFailureRecord> failed_climbs(const LadderRun& run);
/// "LADDER: METHOD: It failed at RUNG, light LIGHT: message".
[[nodiscard]] std::string failed_climb_in_words(const ListedFailureRecord& failed);

/// A row a ladder, a column a method: the rung that breaks and the kind of error.
[[nodiscard]] std::string ladder_table(std::span<const LadderRecord> ladders);

/// One cell of that table.
[[nodiscard]] std::string climb_in_words(const ClimbRecord& climbed, const LadderRecord& ladder);

}  // namespace umbra
