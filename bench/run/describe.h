// Facts, methods and machine as JSON: the parts of results.json, `inspect --json` and `list --json` that are the same.
#pragma once

#include <nlohmann/json.hpp>

#include "umbra/bench/run/results_file.h"
#include "umbra/bench/run/run.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/method.h"

namespace umbra {

using Json = nlohmann::ordered_json;

[[nodiscard]] std::string_view version();
[[nodiscard]] Json machine_json(int threads);
[[nodiscard]] double load_average();    ///< of the last minute: programs that run or want to; NaN where unknown
[[nodiscard]] int usable_processors();  ///< those that this process may run on (its CPU affinity)
[[nodiscard]] Json scene_json(const Scene& scene);
[[nodiscard]] Json facts_json(const SceneFacts& facts);
[[nodiscard]] Json lights_json(const SceneFacts& facts);
[[nodiscard]] Json method_json(const MethodInfo& info);             ///< with parameters, their ranges and documentation
[[nodiscard]] Json setting_json(const Parameter& p, double value);  ///< typed: a number, a boolean or a word
[[nodiscard]] Json service_json(const Service& service);
[[nodiscard]] Json timing_json(const Timing& timing);
[[nodiscard]] Json budget_json(const Budget& budget);
/// As files hold it: indented, with a newline at the end; bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string json_text(const Json& record);
[[nodiscard]] Json number(double value);  ///< null where it is not finite: JSON has no infinity

}  // namespace umbra
