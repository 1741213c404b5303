#include "umbra/bench/motion/growth_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report_assets.h"
#include "umbra/bench/motion/record_view.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

// The chart, in units of its viewBox.
constexpr double kLeft = 52, kRight = 430, kTop = 12, kBottom = 250;

std::string coordinate(double v) { return fmt::format("{:.1f}", v); }

/// 1000 as 10³; 0.1 and 1 as they are.
std::string decade(int exponent) {
    return exponent >= -1 && exponent <= 2 ? fmt::format("{:g}", std::pow(10, exponent)) : "10" + superscript(exponent);
}

/// Whole decades around the values.
struct LogScale {
    int low = 0, high = 1;
    double from = 0, to = 1;

    LogScale(const std::vector<double>& values, double from_, double to_) : from(from_), to(to_) {
        const auto [least, most] = std::ranges::minmax(values);
        low                      = static_cast<int>(std::floor(std::log10(least)));
        high                     = std::max(low + 1, static_cast<int>(std::ceil(std::log10(most) - 1e-9)));
    }
    double operator()(double v) const { return from + (std::log10(v) - low) / (high - low) * (to - from); }
    json ticks() const {
        json all = json::array();
        for (int e = low; e <= high; ++e)
            all.push_back({{"at", coordinate((*this)(std::pow(10.0, e)))}, {"label", decade(e)}});
        return all;
    }
};

/// Milliseconds of one quantity at one point; below a clock's step there is no logarithm to draw.
double at(const Json& point, bool whole_frame) {
    const Json& times = point["times"];
    double ms         = times["visibility_ms"]["min"].get<double>();
    if (times.contains("look_ms")) ms += times["look_ms"]["min"].get<double>();
    if (whole_frame) ms += times["aim_ms"]["min"].get<double>() + times["build_ms"]["min"].get<double>();
    return std::max(ms, 1e-3);
}

json chart_view(const Json& family, bool whole_frame, const std::string& caption) {
    std::vector<double> xs, ys;
    for (const Json& method : family["methods"])
        for (const Json& point : method["points"]) {
            xs.push_back(point["x"].get<double>());
            ys.push_back(at(point, whole_frame));
        }
    if (xs.empty()) return {{"any", false}};
    const LogScale x(xs, kLeft, kRight), y(ys, kBottom, kTop);
    json lines = json::array();
    for (std::size_t m = 0; m < family["methods"].size(); ++m) {
        const Json& method = family["methods"][m];
        std::string path;
        json dots = json::array();
        for (const Json& point : method["points"]) {
            const std::string px = coordinate(x(point["x"].get<double>())), py = coordinate(y(at(point, whole_frame)));
            path += fmt::format("{}{} {}", path.empty() ? "M" : "L", px, py);
            dots.push_back({{"x", px}, {"y", py}});
        }
        if (path.empty()) continue;
        lines.push_back({{"colour", std::to_string(mark_style(m).colour)},
                         {"dashes", m < 6 ? "" : "5 3"},
                         {"path", path},
                         {"dots", std::move(dots)},
                         {"method", method["text"]}});
    }
    return {{"any", true},          {"caption", caption},   {"unit", family["unit"]},
            {"x_ticks", x.ticks()}, {"y_ticks", y.ticks()}, {"lines", std::move(lines)}};
}

json fit_row(const Json& method, const Json& fit) {
    const bool fitted = fit.contains("exponent"), theory = fit.contains("theory");
    const auto range = [](const Json& pair) {
        return pair[0] == pair[1] ? score(value(pair[0]))
                                  : fmt::format("{} to {}", score(value(pair[0])), score(value(pair[1])));
    };
    return {
        {"method", method["text"]},
        {"quantity", in_words(text(fit["quantity"]))},
        {"exponent", fitted ? score(value(fit["exponent"])) : "too short to fit"},
        {"interval", fitted ? range(fit["interval"]) : ""},
        {"range", fitted ? fmt::format("{} to {}", count(value(fit["range"][0])), count(value(fit["range"][1]))) : ""},
        {"theory", theory ? range(fit["theory"]["interval"]) : kNone},
        {"why", theory ? text(fit["theory"]["why"]) : ""},
        {"verdict", fit.contains("verdict") ? text(fit["verdict"]) : ""},
        {"disagrees", fit.contains("verdict") && (fit["verdict"] == "below" || fit["verdict"] == "above")}};
}

/// A size that a fit leads to, which may be beyond any that there are.
std::string size_text(const Json& size) {
    const auto v = value(size);
    return v && *v > 1e9 ? "over 10⁹" : count(v);
}

json family_view(const Json& family) {
    json fits = json::array(), crossings = json::array(), left_out = json::array();
    for (const Json& method : family["methods"]) {
        for (const Json& fit : method["fits"]) fits.push_back(fit_row(method, fit));
        if (method.contains("left_out"))
            left_out.push_back(fmt::format("{}: {}", text(method["text"]), text(method["left_out"])));
    }
    for (const Json& c : family["crossings"]) {
        const bool fitted = !c["fitted"].is_null();
        crossings.push_back(
            {{"quantity", in_words(text(c["quantity"]))},
             {"below", c["below"]},
             {"above", c["above"]},
             {"x", count(value(c["x"]))},
             {"between", fmt::format("{} to {}", count(value(c["between"][0])), count(value(c["between"][1])))},
             {"fit", fitted ? size_text(c["fitted"]["x"]) : kNone},
             {"fit_interval", fitted ? fmt::format("{} to {}", size_text(c["fitted"]["interval"][0]),
                                                   size_text(c["fitted"]["interval"][1]))
                                     : ""}});
    }
    json external = false;
    if (const Json& check = family["external"]; !check.is_null()) {
        json ours = json::array(), theirs = json::array();
        for (const Json& r : check["ours"])
            ours.push_back({{"pixels", count(value(r["pixels"]))},
                            {"ratio", score(value(r["ratio"]))},
                            {"interval", r["interval"][0].is_null()
                                             ? "fewer than six rounds"
                                             : fmt::format("{} to {}, {}", score(value(r["interval"][0])),
                                                           score(value(r["interval"][1])), coverage_text(r))}});
        for (const Json& r : check["theirs"])
            theirs.push_back({{"pixels", count(value(r["pixels"]))}, {"ratio", score(value(r["ratio"]))}});
        external = {{"source", check["source"]},
                    {"ours", std::move(ours)},
                    {"theirs", std::move(theirs)},
                    {"crosses", !check["our_crossings"].empty()}};
    }
    json charts = json::array();
    for (json chart : {chart_view(family, false, "Visibility: the camera moved"),
                       chart_view(family, true, "All phases: an object moved")})
        if (chart["any"].get<bool>()) charts.push_back(std::move(chart));
    return {{"id", family["name"]},
            {"title", family["title"]},
            {"about", family["about"]},
            {"unit", family["unit"]},
            {"charts", std::move(charts)},
            {"fits", std::move(fits)},
            {"has_crossings", !crossings.empty()},
            {"crossings", std::move(crossings)},
            {"has_left_out", !left_out.empty()},
            {"left_out", std::move(left_out)},
            {"external", std::move(external)}};
}

}  // namespace

void write_growth_page(const Json& record, const std::filesystem::path& out, StagedFiles& staged) {
    json view        = record_view(record, "family");
    view["families"] = json::array();
    for (const Json& family : record["growth"]) view["families"].push_back(family_view(family));
    const PageHead head = {"Growth: times over triangles, pixels, lights, samples", "", {}};
    staged.write(out / "index.html", render_page(assets::growth_html, head, view));
    write_page_assets(out, head.scripts, staged);
}

}  // namespace umbra
