// results.json of `umbra growth`: times over sizes, the power laws that they follow, and where methods cross.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"
#include "umbra/bench/studies/motion/growth_run.h"

namespace umbra {

[[nodiscard]] Allowed quantities();  ///< the words of Quantity

struct GrowthPointRecord {
    double x = kUnknown;
    std::string text{};
    TurnTimesRecord times{};
    std::uint64_t memory_bytes = 0;
    double noise_bar           = kUnknown;
};
DESCRIBE(GrowthPointRecord) {
    of(MEMBER(x), "the size", at_least(1));
    of(MEMBER(text), "the method as typed");
    MEMBERS(times, memory_bytes, noise_bar);
}

struct TheoryRecord {
    std::vector<double> interval{};
    std::string why{};
};
DESCRIBE(TheoryRecord) {
    of(MEMBER(interval), "of the exponent", kTwoNumbers);
    MEMBERS(why);
}

/// A power law through the times.
struct FitRecord {
    double exponent = kUnknown;
    std::vector<double> interval{};
    double factor = kUnknown, r_squared = kUnknown;
    std::uint64_t points = 0;
    std::vector<double> range{};
};
DESCRIBE(FitRecord) {
    of.may(MEMBER(exponent));
    of.may(MEMBER(interval), "95 %", kTwoNumbers);
    of.may(MEMBER(factor), "milliseconds or bytes at x = 1");
    of.may(MEMBER(r_squared));
    of.may(MEMBER(points), "", at_least(3));
    of.may(MEMBER(range), "the sizes that were fitted", kTwoNumbers);
}

struct QuantityRecord {
    std::string quantity{};
    FitRecord fit{};  ///< unknown where there are too few points
    std::optional<TheoryRecord> theory{};
    std::string verdict{};
};
DESCRIBE(QuantityRecord) {
    of(MEMBER(quantity),
       "camera_frame: look and visibility; light_frame: aim and visibility; object_frame: all phases; memory in bytes",
       quantities());
    of.all(&R::fit);
    of.may(MEMBER(theory));
    of.may(MEMBER(verdict), "where the fitted interval lies beside theory's; undecided: it is too wide to say",
           one_of({"agrees", "below", "above", "undecided"}));
}

struct GrowthSeriesRecord {
    std::string name{}, title{}, text{}, left_out{};
    std::vector<GrowthPointRecord> points{};
    std::vector<QuantityRecord> fits{};
};
DESCRIBE(GrowthSeriesRecord) {
    MEMBERS(name, title);
    of(MEMBER(text), "as typed, without the parameter that grows");
    MEMBERS(points, fits);
    of.may(MEMBER(left_out), "why it has no points beyond its last");
}

struct FittedCrossingRecord {
    double x = kUnknown;
    std::vector<double> interval{};
    bool inside = false;
};
DESCRIBE(FittedCrossingRecord) {
    MEMBERS(x);
    of(MEMBER(interval), "95 %", kTwoNumbers);
    of(MEMBER(inside), "within the sizes that were measured");
}

/// Between two neighbouring sizes at which the paired ratios of times differ from 1, one way and then the other.
struct CrossingRecord {
    std::string quantity{}, below{}, above{};
    double x = kUnknown;  ///< where the line through the logarithms of the two ratios is 1
    std::vector<double> between{};
    std::optional<FittedCrossingRecord> fitted{};
};
DESCRIBE(CrossingRecord) {
    of(MEMBER(quantity), "", quantities());
    of(MEMBER(below), "the method that is faster at smaller sizes");
    MEMBERS(above, x);
    of(MEMBER(between), "neighbouring sizes at which one and then the other is faster, beyond the noise", kTwoNumbers);
    MEMBERS(fitted);
}

struct SizeRatioRecord {
    double pixels = kUnknown, ratio = kUnknown;
    std::vector<double> interval{};
    double coverage = kUnknown;
};
DESCRIBE(SizeRatioRecord) {
    MEMBERS(pixels);
    of(MEMBER(ratio), "of silhouettes to single triangles");
    of.may(MEMBER(interval), "of our rounds; null: of fewer than six there is none", kTwoNumbers);
    of.may(MEMBER(coverage), "the probability with which the interval holds the median of the ratios; 0: there is none",
           kFraction);
}

/// Others' times beside ours.
struct ExternalRecord {
    std::string source{}, quantity{};
    std::vector<SizeRatioRecord> theirs{};
    std::vector<double> their_crossing{};
    std::vector<SizeRatioRecord> ours{};
    std::vector<std::vector<double>> our_crossings{};
};
DESCRIBE(ExternalRecord) {
    MEMBERS(source);
    of(MEMBER(quantity), "", quantities());
    MEMBERS(theirs);
    of(MEMBER(their_crossing), "", kTwoNumbers);
    MEMBERS(ours, our_crossings);
}

struct FamilyRecord {
    std::string name{}, title{}, about{}, unit{};
    std::vector<double> sizes{};
    std::vector<GrowthSeriesRecord> methods{};
    std::vector<CrossingRecord> crossings{};
    std::optional<ExternalRecord> external{};
};
DESCRIBE(FamilyRecord) {
    of(MEMBER(name), "", one_of({"triangles", "bodies", "pixels", "lights", "samples", "resolution"}));
    MEMBERS(title, about);
    of(MEMBER(unit), "of the sizes");
    MEMBERS(sizes, methods, crossings);
    of(MEMBER(external), "null where not both ways of shadow volumes ran");
}

struct GrowthRecord {
    HeadRecord head{};
    std::optional<BudgetRecord> budget{};
    MachineRecord machine{};
    LoadRecord load_average{};
    std::vector<FamilyRecord> growth{};
    std::vector<ListedFailureRecord> failed{};
};
DESCRIBE(GrowthRecord) {
    of.all(&R::head);
    of.may(MEMBER(budget));
    MEMBERS(machine);
    of(MEMBER(load_average), "of the last minute, before the first time and after the last; null: unknown");
    of(MEMBER(growth), "one entry a family");
    MEMBERS(failed);
}

/// Crossings between sizes that both have, without `fitted`; sizes at which there is no difference count for neither.
[[nodiscard]] std::vector<CrossingRecord> measured_crossings(const GrowthSeries& a, const GrowthSeries& b,
                                                             Quantity quantity);
[[nodiscard]] FamilyRecord family_record(const GrowthRun& run);

}  // namespace umbra
