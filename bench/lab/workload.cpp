#include "umbra/bench/lab/workload.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <vector>

#include "umbra/core/base/error.h"
#include "umbra/core/base/number_from.h"
#include "umbra/core/base/suggest.h"
#include "umbra/core/base/trimmed.h"

namespace umbra {
namespace {

constexpr std::string_view kExpected = "expected events a second, as in camera=60,light=1,object=0";

double rate(std::string_view pair, std::string_view text) {
    const auto value = number_from<double>(text);
    if (!value || !std::isfinite(*value) || *value < 0)
        throw UsageError(fmt::format("workload: {}: \"{}\" is not a rate, expected a number of 0 or more", pair, text));
    return *value;
}

double& member(Workload& workload, std::string_view name) {
    if (name == "camera") return workload.camera;
    if (name == "light") return workload.light;
    if (name == "object") return workload.object;
    refuse_unknown_name("workload: unknown event", name, std::vector<std::string>{"camera", "light", "object"});
}

}  // namespace

Workload parse_workload(const std::string& text) {
    Workload workload{0, 0, 0};
    std::set<std::string_view> seen;
    for (const std::string_view pair : split(text, ',')) {
        const std::size_t equals = pair.find('=');
        if (equals == std::string_view::npos)
            throw UsageError(fmt::format("workload: found \"{}\", {}", pair, kExpected));
        const std::string_view name = pair.substr(0, equals);
        member(workload, name)      = rate(pair, pair.substr(equals + 1));
        if (!seen.insert(name).second) throw UsageError(fmt::format("workload: {} is set twice", name));
    }
    if (workload.camera + workload.light + workload.object == 0)
        throw UsageError(fmt::format("workload: nothing moves in \"{}\", expected a rate above 0", text));
    return workload;
}

std::string to_text(const Workload& workload) {
    return fmt::format("camera={},light={},object={}", workload.camera, workload.light, workload.object);
}

double frame_cost_ms(const Workload& workload, const PhaseTimes& times) {
    const double frames = std::max({workload.camera, workload.light, workload.object});
    const auto of       = [&](double events, double ms) { return events > 0 ? events / frames * ms : 0; };
    return of(workload.object, times.build) + of(std::max(workload.light, workload.object), times.aim) +
           of(std::max(workload.camera, workload.object), times.look) + times.visibility;
}

}  // namespace umbra
