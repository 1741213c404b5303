#include <fmt/format.h>

#include "umbra/bench/studies/motion/growth.h"
#include "umbra/bench/studies/motion/record_view.h"

namespace umbra {
namespace {

std::string general(double value) { return known(value) ? fmt::format("{:.3g}", value) : "none"; }

std::string times_of(const FamilyRecord& family) {
    std::string table = fmt::format("  {:36} {:>12} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "least ms", family.unit,
                                    "build", "aim", "look", "visibility", "MB");
    for (const GrowthSeriesRecord& method : family.methods) {
        for (const GrowthPointRecord& point : method.points) {
            const TimesRecord& times = point.times.phases;
            table += fmt::format("  {:36} {:>12.0f} {:>10} {:>10} {:>10} {:>10} {:>10.2f}\n", method.text, point.x,
                                 number_text(times.build_ms->min), number_text(times.aim_ms->min),
                                 number_text(times.look_ms->min), number_text(times.visibility_ms->min),
                                 static_cast<double>(point.memory_bytes) / 1e6);
        }
        if (!method.left_out.empty()) table += fmt::format("  {:36} {}\n", method.text, method.left_out);
    }
    return table;
}

std::string fits_of(const FamilyRecord& family) {
    std::string table = fmt::format("  {:36} {:12} {:>8} {:>16} {:>12}  {:10} {}\n", "exponents", "of", "fitted",
                                    "95 %", "theory", "verdict", "range; reason");
    for (const GrowthSeriesRecord& method : family.methods)
        for (const QuantityRecord& of : method.fits) {
            const FitRecord& fit = of.fit;
            const bool fitted    = fit.points > 0;
            table += fmt::format(
                "  {:36} {:12} {:>8} {:>16} {:>12}  {:10} {}{}\n", method.text, of.quantity,
                fitted ? number_text(fit.exponent) : "-",
                fitted ? fmt::format("{} to {}", number_text(fit.interval[0]), number_text(fit.interval[1]))
                       : "too short",
                of.theory ? fmt::format("{} to {}", general(of.theory->interval[0]), general(of.theory->interval[1]))
                          : "-",
                of.verdict.empty() ? "-" : of.verdict,
                fitted ? fmt::format("{} to {}; ", general(fit.range[0]), general(fit.range[1])) : "",
                of.theory ? of.theory->why : "");
        }
    return table;
}

std::string crossings_of(const FamilyRecord& family) {
    std::string lines;
    for (const CrossingRecord& c : family.crossings) {
        lines += fmt::format("  {}: {} is faster below {} {}, {} above (between {} and {}", c.quantity, c.below,
                             general(c.x), family.unit, c.above, general(c.between[0]), general(c.between[1]));
        if (c.fitted)
            lines += fmt::format("; the fits cross at {}, 95 % {} to {}", general(c.fitted->x),
                                 general(c.fitted->interval[0]), general(c.fitted->interval[1]));
        lines += ")\n";
    }
    return lines.empty() ? "  no two methods cross\n" : lines;
}

std::string external_of(const FamilyRecord& family) {
    if (!family.external) return "";
    const ExternalRecord& check = *family.external;
    std::string lines = "  shadow volumes of silhouettes over those of single triangles, aim and visibility:\n   ";
    for (const SizeRatioRecord& r : check.ours)
        lines += fmt::format(" {:.2g}: {} ({});", r.pixels, number_text(r.ratio),
                             known(r.interval[0]) ? fmt::format("{} to {}, {}", number_text(r.interval[0]),
                                                                number_text(r.interval[1]), coverage_text(r.coverage))
                                                  : "fewer than six rounds");
    lines += fmt::format("\n    {}:", check.source);
    for (const SizeRatioRecord& r : check.theirs) lines += fmt::format(" {:.2g}: {};", r.pixels, number_text(r.ratio));
    lines += check.our_crossings.empty()
                 ? "\n    they cross between 4.2e+06 and 1.7e+07 pixels; here not in this range\n"
                 : "\n    they cross between 4.2e+06 and 1.7e+07 pixels; here too, see above\n";
    return lines;
}

}  // namespace

std::string growth_table(const GrowthRecord& record) {
    std::string table;
    for (const FamilyRecord& family : record.growth)
        table += fmt::format("{}: {}\n{}{}{}{}", family.name, family.about, times_of(family), fits_of(family),
                             crossings_of(family), external_of(family));
    return table + machine_line(record.machine, record.load_average);
}

}  // namespace umbra
