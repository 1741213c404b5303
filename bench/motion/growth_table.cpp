#include <fmt/format.h>

#include "umbra/bench/motion/growth.h"
#include "umbra/bench/motion/record_view.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

std::string fixed(const Json& value, int digits = 2) {
    return value.is_null() ? "-" : fmt::format("{:.{}f}", value.get<double>(), digits);
}
std::string general(const Json& value) { return value.is_null() ? "none" : fmt::format("{:.3g}", value.get<double>()); }

std::string times_of(const Json& family) {
    std::string table = fmt::format("  {:36} {:>12} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "least ms",
                                    text(family["unit"]), "build", "aim", "look", "visibility", "MB");
    for (const Json& method : family["methods"]) {
        for (const Json& point : method["points"])
            table +=
                fmt::format("  {:36} {:>12.0f} {:>10} {:>10} {:>10} {:>10} {:>10.2f}\n", text(method["text"]),
                            point["x"].get<double>(), fixed(point["times"]["build_ms"]["min"]),
                            fixed(point["times"]["aim_ms"]["min"]), fixed(point["times"]["look_ms"]["min"]),
                            fixed(point["times"]["visibility_ms"]["min"]), point["memory_bytes"].get<double>() / 1e6);
        if (method.contains("left_out"))
            table += fmt::format("  {:36} {}\n", text(method["text"]), text(method["left_out"]));
    }
    return table;
}

std::string fits_of(const Json& family) {
    std::string table = fmt::format("  {:36} {:12} {:>8} {:>16} {:>12}  {:10} {}\n", "exponents", "of", "fitted",
                                    "95 %", "theory", "verdict", "range; reason");
    for (const Json& method : family["methods"])
        for (const Json& fit : method["fits"]) {
            const bool fitted = fit.contains("exponent"), theory = fit.contains("theory");
            table += fmt::format(
                "  {:36} {:12} {:>8} {:>16} {:>12}  {:10} {}{}\n", text(method["text"]), text(fit["quantity"]),
                fitted ? fixed(fit["exponent"]) : "-",
                fitted ? fmt::format("{} to {}", fixed(fit["interval"][0]), fixed(fit["interval"][1])) : "too short",
                theory ? fmt::format("{} to {}", general(fit["theory"]["interval"][0]),
                                     general(fit["theory"]["interval"][1]))
                       : "-",
                fit.contains("verdict") ? text(fit["verdict"]) : "-",
                fitted ? fmt::format("{} to {}; ", general(fit["range"][0]), general(fit["range"][1])) : "",
                theory ? text(fit["theory"]["why"]) : "");
        }
    return table;
}

std::string crossings_of(const Json& family) {
    std::string lines;
    for (const Json& c : family["crossings"]) {
        lines += fmt::format("  {}: {} is faster below {} {}, {} above (between {} and {}", text(c["quantity"]),
                             text(c["below"]), general(c["x"]), text(family["unit"]), text(c["above"]),
                             general(c["between"][0]), general(c["between"][1]));
        if (!c["fitted"].is_null())
            lines += fmt::format("; the fits cross at {}, 95 % {} to {}", general(c["fitted"]["x"]),
                                 general(c["fitted"]["interval"][0]), general(c["fitted"]["interval"][1]));
        lines += ")\n";
    }
    return lines.empty() ? "  no two methods cross\n" : lines;
}

std::string external_of(const Json& family) {
    const Json& check = family["external"];
    if (check.is_null()) return "";
    std::string lines = "  shadow volumes of silhouettes over those of single triangles, aim and visibility:\n   ";
    for (const Json& r : check["ours"])
        lines += fmt::format(" {:.2g}: {} ({});", r["pixels"].get<double>(), fixed(r["ratio"]),
                             r["interval"][0].is_null() ? "fewer than six rounds"
                                                        : fmt::format("{} to {}, {}", fixed(r["interval"][0]),
                                                                      fixed(r["interval"][1]), coverage_text(r)));
    lines += fmt::format("\n    {}:", text(check["source"]));
    for (const Json& r : check["theirs"])
        lines += fmt::format(" {:.2g}: {};", r["pixels"].get<double>(), fixed(r["ratio"]));
    lines += check["our_crossings"].empty()
                 ? "\n    they cross between 4.2e+06 and 1.7e+07 pixels; here not in this range\n"
                 : "\n    they cross between 4.2e+06 and 1.7e+07 pixels; here too, see above\n";
    return lines;
}

}  // namespace

std::string growth_table(const Json& record) {
    std::string table;
    for (const Json& family : record["growth"])
        table += fmt::format("{}: {}\n{}{}{}{}", text(family["name"]), text(family["about"]), times_of(family),
                             fits_of(family), crossings_of(family), external_of(family));
    table += fmt::format("{}, {}, load average {} to {}\n", text(record["machine"]["cpu"]),
                         counted(record["machine"]["threads"].get<double>(), "thread"),
                         fixed(record["load_average"]["before"]), fixed(record["load_average"]["after"]));
    return table;
}

}  // namespace umbra
