// results.json of `umbra growth`: times over sizes, the power laws that they follow, and where methods cross.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/motion/growth_run.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

[[nodiscard]] Allowed quantities();  ///< the words of Quantity

struct GrowthPointRecord {
    double x = kUnknown;
    std::string text{};
    TurnTimesRecord times{};
    std::uint64_t memory_bytes = 0;
    double noise_bar           = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<GrowthPointRecord>) {
    of("x", &GrowthPointRecord::x, "the size", at_least(1));
    of("text", &GrowthPointRecord::text, "the method as typed");
    of("times", &GrowthPointRecord::times, "");
    of("memory_bytes", &GrowthPointRecord::memory_bytes, "");
    of("noise_bar", &GrowthPointRecord::noise_bar, "");
}

struct TheoryRecord {
    std::vector<double> interval{};
    std::string why{};
};
template <class Fields>
void describe(Fields& of, Is<TheoryRecord>) {
    of("interval", &TheoryRecord::interval, "of the exponent", kTwoNumbers);
    of("why", &TheoryRecord::why, "");
}

/// A power law through the times.
struct FitRecord {
    double exponent = kUnknown;
    std::vector<double> interval{};
    double factor = kUnknown, r_squared = kUnknown;
    std::uint64_t points = 0;
    std::vector<double> range{};
};
template <class Fields>
void describe(Fields& of, Is<FitRecord>) {
    of.may("exponent", &FitRecord::exponent, "");
    of.may("interval", &FitRecord::interval, "95 %", kTwoNumbers);
    of.may("factor", &FitRecord::factor, "milliseconds or bytes at x = 1");
    of.may("r_squared", &FitRecord::r_squared, "");
    of.may("points", &FitRecord::points, "", at_least(3));
    of.may("range", &FitRecord::range, "the sizes that were fitted", kTwoNumbers);
}

struct QuantityRecord {
    std::string quantity{};
    FitRecord fit{};  ///< unknown where there are too few points
    std::optional<TheoryRecord> theory{};
    std::string verdict{};
};
template <class Fields>
void describe(Fields& of, Is<QuantityRecord>) {
    of("quantity", &QuantityRecord::quantity,
       "camera_frame: look and visibility; light_frame: aim and visibility; object_frame: all phases; memory in bytes",
       quantities());
    of.all(&QuantityRecord::fit);
    of.may("theory", &QuantityRecord::theory, "");
    of.may("verdict", &QuantityRecord::verdict,
           "where the fitted interval lies beside theory's; undecided: it is too wide to say",
           one_of({"agrees", "below", "above", "undecided"}));
}

struct GrowthSeriesRecord {
    std::string name{}, title{}, text{}, left_out{};
    std::vector<GrowthPointRecord> points{};
    std::vector<QuantityRecord> fits{};
};
template <class Fields>
void describe(Fields& of, Is<GrowthSeriesRecord>) {
    of("name", &GrowthSeriesRecord::name, "");
    of("title", &GrowthSeriesRecord::title, "");
    of("text", &GrowthSeriesRecord::text, "as typed, without the parameter that grows");
    of("points", &GrowthSeriesRecord::points, "");
    of("fits", &GrowthSeriesRecord::fits, "");
    of.may("left_out", &GrowthSeriesRecord::left_out, "why it has no points beyond its last");
}

struct FittedCrossingRecord {
    double x = kUnknown;
    std::vector<double> interval{};
    bool inside = false;
};
template <class Fields>
void describe(Fields& of, Is<FittedCrossingRecord>) {
    of("x", &FittedCrossingRecord::x, "");
    of("interval", &FittedCrossingRecord::interval, "95 %", kTwoNumbers);
    of("inside", &FittedCrossingRecord::inside, "within the sizes that were measured");
}

struct CrossingRecord {
    std::string quantity{}, below{}, above{};
    double x = kUnknown;
    std::vector<double> between{};
    std::optional<FittedCrossingRecord> fitted{};
};
template <class Fields>
void describe(Fields& of, Is<CrossingRecord>) {
    of("quantity", &CrossingRecord::quantity, "", quantities());
    of("below", &CrossingRecord::below, "the method that is faster at smaller sizes");
    of("above", &CrossingRecord::above, "");
    of("x", &CrossingRecord::x, "");
    of("between", &CrossingRecord::between,
       "neighbouring sizes at which one and then the other is faster, beyond the noise", kTwoNumbers);
    of("fitted", &CrossingRecord::fitted, "");
}

struct SizeRatioRecord {
    double pixels = kUnknown, ratio = kUnknown;
    std::vector<double> interval{};
    double coverage = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<SizeRatioRecord>) {
    of("pixels", &SizeRatioRecord::pixels, "");
    of("ratio", &SizeRatioRecord::ratio, "of silhouettes to single triangles");
    of.may("interval", &SizeRatioRecord::interval, "of our rounds; null: of fewer than six there is none", kTwoNumbers);
    of.may("coverage", &SizeRatioRecord::coverage,
           "the probability with which the interval holds the median of the ratios; 0: there is none", kFraction);
}

/// Others' times beside ours.
struct ExternalRecord {
    std::string source{}, quantity{};
    std::vector<SizeRatioRecord> theirs{};
    std::vector<double> their_crossing{};
    std::vector<SizeRatioRecord> ours{};
    std::vector<std::vector<double>> our_crossings{};
};
template <class Fields>
void describe(Fields& of, Is<ExternalRecord>) {
    of("source", &ExternalRecord::source, "");
    of("quantity", &ExternalRecord::quantity, "", quantities());
    of("theirs", &ExternalRecord::theirs, "");
    of("their_crossing", &ExternalRecord::their_crossing, "", kTwoNumbers);
    of("ours", &ExternalRecord::ours, "");
    of("our_crossings", &ExternalRecord::our_crossings, "");
}

struct FamilyRecord {
    std::string name{}, title{}, about{}, unit{};
    std::vector<double> sizes{};
    std::vector<GrowthSeriesRecord> methods{};
    std::vector<CrossingRecord> crossings{};
    std::optional<ExternalRecord> external{};
};
template <class Fields>
void describe(Fields& of, Is<FamilyRecord>) {
    of("name", &FamilyRecord::name, "", one_of({"triangles", "bodies", "pixels", "lights", "samples", "resolution"}));
    of("title", &FamilyRecord::title, "");
    of("about", &FamilyRecord::about, "");
    of("unit", &FamilyRecord::unit, "of the sizes");
    of("sizes", &FamilyRecord::sizes, "");
    of("methods", &FamilyRecord::methods, "");
    of("crossings", &FamilyRecord::crossings, "");
    of("external", &FamilyRecord::external, "null where not both ways of shadow volumes ran");
}

struct GrowthRecord {
    HeadRecord head{};
    std::optional<BudgetRecord> budget{};
    MachineRecord machine{};
    LoadRecord load_average{};
    std::vector<FamilyRecord> growth{};
    std::vector<ListedFailureRecord> failed{};
};
template <class Fields>
void describe(Fields& of, Is<GrowthRecord>) {
    of.all(&GrowthRecord::head);
    of.may("budget", &GrowthRecord::budget, "");
    of("machine", &GrowthRecord::machine, "");
    of("load_average", &GrowthRecord::load_average,
       "of the last minute, before the first time and after the last; null: unknown");
    of("growth", &GrowthRecord::growth, "one entry a family");
    of("failed", &GrowthRecord::failed, "");
}

[[nodiscard]] FamilyRecord family_record(const GrowthRun& run);
[[nodiscard]] Json growth_schema();  ///< JSON Schema, draft 4

}  // namespace umbra
