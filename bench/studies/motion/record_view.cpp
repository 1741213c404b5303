#include "umbra/bench/studies/motion/record_view.h"

#include <fmt/format.h>

#include "umbra/bench/pages/report_text.h"

namespace umbra {

std::string interval_in_words(const std::vector<double>& interval, double coverage, const char* none) {
    if (!known(interval[0])) return none;
    return fmt::format("{} to {}, {}", score(known(interval[0])), score(known(interval[1])), coverage_text(coverage));
}

std::string coverage_text(double coverage) { return coverage > 0 ? fmt::format("{:.1f} %", 100 * coverage) : "-"; }

std::string number_text(double value, int digits) { return known(value) ? fmt::format("{:.{}f}", value, digits) : "-"; }

std::string machine_line(const MachineRecord& machine, const LoadRecord& load) {
    return fmt::format("{}, {}, load average {} to {}\n", machine.cpu,
                       counted(static_cast<double>(machine.threads), "thread"), number_text(load.before),
                       number_text(load.after));
}

nlohmann::json record_view(const HeadRecord& head, const MachineRecord& machine, const LoadRecord& load,
                           const std::vector<ListedFailureRecord>& failed) {
    nlohmann::json failures = nlohmann::json::array();
    for (const ListedFailureRecord& f : failed)
        failures.push_back(fmt::format("{}{}: {}: {}", f.scene, f.family, f.method, f.failure.message));
    return {{"command", without_folders(head.command)},
            {"version", head.version},
            {"cpu", machine.cpu},
            {"threads", counted(static_cast<double>(machine.threads), "thread")},
            {"load", fmt::format("{} to {}", score(known(load.before)), score(known(load.after)))},
            {"failures", std::move(failures)}};
}

}  // namespace umbra
