#include "umbra/bench/pages/failures.h"

#include <fmt/format.h>

#include "umbra/bench/pages/report_page.h"

namespace umbra {
namespace {

std::string line(const std::string& who, const FailureRecord& failure, std::optional<double> rung = {}) {
    std::string where;
    if (rung) where += fmt::format(" at {:g}", *rung);
    if (failure.light && !failure.light->empty()) where += " at light " + *failure.light;
    return fmt::format("{} failed{}: {}", who, where, failure.message);
}

}  // namespace

std::vector<std::string> scene_failures(const Results& results) {
    std::vector<std::string> lines;
    if (const auto& failed = results.reference.failed)
        lines.push_back(line(fmt::format("The reference {}", failed->method), failed->failure));
    for (const MethodRecord& method : results.methods)
        if (method.failed) lines.push_back(line(method_label(method, results.methods), *method.failed));
    return lines;
}

std::vector<std::string> listed_failures(const std::vector<ListedFailureRecord>& failed) {
    std::vector<std::string> lines;
    for (const ListedFailureRecord& f : failed)
        lines.push_back(fmt::format("{}{}: {}", f.ladder, f.scene, line(f.method, f.failure, f.rung)));
    return lines;
}

}  // namespace umbra
