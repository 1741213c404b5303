#include "umbra/bench/studies/motion/growth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "report_assets.h"
#include "umbra/bench/pages/chart_parts.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/studies/motion/record_view.h"

namespace umbra {
namespace {

using nlohmann::json;

// The chart, in units of its viewBox.
constexpr double kLeft = 52, kRight = 430, kTop = 12, kBottom = 250;

/// 1000 as 10³; 0.1 and 1 as they are.
std::string decade(int exponent) {
    return exponent >= -1 && exponent <= 2 ? fmt::format("{:g}", std::pow(10, exponent)) : "10" + superscript(exponent);
}

/// A tick at every decade of the axis.
json decade_ticks(const chart::LogAxis& axis) {
    json all = json::array();
    for (double e = axis.low; e <= axis.high; ++e)
        all.push_back({{"at", chart::coordinate(axis(std::pow(10, e)))}, {"label", decade(static_cast<int>(e))}});
    return all;
}

/// The least time of the rounds at one size, in milliseconds, as the fits take it; below a clock's step there is no
/// logarithm to draw.
double at(const GrowthPointRecord& point, bool whole_frame) {
    const TimesRecord& times = point.times.phases;
    double least             = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < times.visibility_ms->samples.size(); ++r) {
        const auto of = [r](const auto& phase) { return phase->samples.at(r); };
        least         = std::min(least, of(times.visibility_ms) + of(times.look_ms) +
                                            (whole_frame ? of(times.aim_ms) + of(times.build_ms) : 0));
    }
    return std::max(least, 1e-3);
}

json chart_view(const FamilyRecord& family, bool whole_frame, const std::string& caption) {
    std::vector<double> xs, ys;
    for (const GrowthSeriesRecord& method : family.methods)
        for (const GrowthPointRecord& point : method.points) {
            xs.push_back(point.x);
            ys.push_back(at(point, whole_frame));
        }
    if (xs.empty()) return {{"any", false}};
    const chart::LogAxis x(xs, 1, kLeft, kRight), y(ys, 1, kBottom, kTop);
    json lines = json::array();
    for (std::size_t m = 0; m < family.methods.size(); ++m) {
        const GrowthSeriesRecord& method = family.methods[m];
        std::string path;
        json dots = json::array();
        for (const GrowthPointRecord& point : method.points) {
            const std::string px = chart::coordinate(x(point.x)), py = chart::coordinate(y(at(point, whole_frame)));
            path += fmt::format("{}{} {}", path.empty() ? "M" : "L", px, py);
            dots.push_back({{"x", px}, {"y", py}});
        }
        if (path.empty()) continue;
        lines.push_back({{"colour", std::to_string(mark_style(m).colour)},
                         {"dashes", m < 6 ? "" : "5 3"},
                         {"path", path},
                         {"dots", std::move(dots)},
                         {"method", method.text}});
    }
    return {{"any", true},
            {"caption", caption},
            {"unit", family.unit},
            {"x_ticks", decade_ticks(x)},
            {"y_ticks", decade_ticks(y)},
            {"lines", std::move(lines)}};
}

json fit_row(const GrowthSeriesRecord& method, const QuantityRecord& of) {
    const bool fitted = of.fit.points > 0;
    const auto range  = [](const std::vector<double>& pair) {
        return pair[0] == pair[1] ? score(known(pair[0]))
                                   : fmt::format("{} to {}", score(known(pair[0])), score(known(pair[1])));
    };
    return {{"method", method.text},
            {"quantity", in_words(of.quantity)},
            {"exponent", fitted ? score(known(of.fit.exponent)) : "too short to fit"},
            {"interval", fitted ? range(of.fit.interval) : ""},
            {"range", fitted ? fmt::format("{} to {}", count(of.fit.range[0]), count(of.fit.range[1])) : ""},
            {"theory", of.theory ? range(of.theory->interval) : kNone},
            {"why", of.theory ? of.theory->why : ""},
            {"verdict", of.verdict},
            {"disagrees", of.verdict == "below" || of.verdict == "above"}};
}

/// A size that a fit leads to, which may be beyond any that there are.
std::string size_text(double size) { return known(size).value_or(0) > 1e9 ? "over 10⁹" : count(known(size)); }

json external_view(const ExternalRecord& check) {
    json ours = json::array(), theirs = json::array();
    for (const SizeRatioRecord& r : check.ours)
        ours.push_back({{"pixels", count(r.pixels)},
                        {"ratio", score(known(r.ratio))},
                        {"interval", interval_in_words(r.interval, r.coverage, "fewer than six rounds")}});
    for (const SizeRatioRecord& r : check.theirs)
        theirs.push_back({{"pixels", count(r.pixels)}, {"ratio", score(known(r.ratio))}});
    return {{"source", check.source},
            {"ours", std::move(ours)},
            {"theirs", std::move(theirs)},
            {"crosses", !check.our_crossings.empty()}};
}

json family_view(const FamilyRecord& family) {
    json fits = json::array(), crossings = json::array(), left_out = json::array();
    for (const GrowthSeriesRecord& method : family.methods) {
        for (const QuantityRecord& fit : method.fits) fits.push_back(fit_row(method, fit));
        if (!method.left_out.empty()) left_out.push_back(fmt::format("{}: {}", method.text, method.left_out));
    }
    for (const CrossingRecord& c : family.crossings)
        crossings.push_back(
            {{"quantity", in_words(c.quantity)},
             {"below", c.below},
             {"above", c.above},
             {"x", count(known(c.x))},
             {"between", fmt::format("{} to {}", count(known(c.between[0])), count(known(c.between[1])))},
             {"fit", c.fitted ? size_text(c.fitted->x) : kNone},
             {"fit_interval",
              c.fitted ? fmt::format("{} to {}", size_text(c.fitted->interval[0]), size_text(c.fitted->interval[1]))
                       : ""}});
    json charts = json::array();
    for (json chart : {chart_view(family, false, "Visibility: the camera moved"),
                       chart_view(family, true, "All phases: an object moved")})
        if (chart["any"].get<bool>()) charts.push_back(std::move(chart));
    return {{"id", family.name},
            {"title", family.title},
            {"about", family.about},
            {"unit", family.unit},
            {"charts", std::move(charts)},
            {"fits", std::move(fits)},
            {"crossings", std::move(crossings)},
            {"left_out", std::move(left_out)},
            {"external", family.external ? external_view(*family.external) : json(false)}};
}

}  // namespace

void write_growth_page(const GrowthRecord& record, const std::filesystem::path& out, StagedFiles& staged) {
    json view        = record_view(record.head, record.machine, record.load_average, record.failed);
    view["families"] = json::array();
    for (const FamilyRecord& family : record.growth) view["families"].push_back(family_view(family));
    write_page(out, assets::growth_html, {"Growth: times over triangles, pixels, lights, samples"}, std::move(view),
               staged);
}

}  // namespace umbra
