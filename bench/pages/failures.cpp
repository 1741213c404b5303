#include "umbra/bench/pages/failures.h"

#include <fmt/format.h>

#include "umbra/bench/pages/report_page.h"

namespace umbra {
namespace {

std::string line(const std::string& who, const Field& failure) {
    std::string where;
    if (const auto rung = failure["rung"].number()) where += fmt::format(" at {:g}", *rung);
    if (const std::string light = failure["light"].text(); !light.empty()) where += " at light " + light;
    return fmt::format("{} failed{}: {}", who, where, failure["message"].text());
}

}  // namespace

bool failed(const Field& method) { return method["failed"].present(); }

std::vector<std::string> scene_failures(const Field& root) {
    std::vector<std::string> lines;
    if (const Field failure = root["reference"]["failed"]; failure.present())
        lines.push_back(line(fmt::format("The reference {}", failure["method"].text()), failure));
    const std::vector<Field> methods = root["methods"].items();
    for (const Field& method : methods)
        if (failed(method)) lines.push_back(line(method_label(method, methods), method["failed"]));
    return lines;
}

std::vector<std::string> listed_failures(const Field& root) {
    std::vector<std::string> lines;
    for (const Field& failure : root["failed"].items()) {
        const std::string where = failure["ladder"].text() + failure["scene"].text();
        lines.push_back(fmt::format("{}: {}", where, line(failure["method"].text(), failure)));
    }
    return lines;
}

}  // namespace umbra
