#include "umbra/bench/lab/results.h"

#include <fmt/format.h>

#include <algorithm>

namespace umbra {

std::string record_text(const Results& results) { return json_text(to_record(results)); }

std::string label_of(const MethodRecord& method) {
    std::string label = method.title.empty() ? method.name : method.title;
    if (method.title.empty()) std::ranges::replace(label, '_', ' ');
    const auto colon = method.text.find(':');
    return colon == std::string::npos ? label : fmt::format("{} ({})", label, method.text.substr(colon + 1));
}

Json results_schema() {
    Json schema = schema_of<Results>("results.json: several shadow methods on one scene, compared with a reference");
    schema["description"] =
        "Times in milliseconds, memory in bytes, S_j in [0, 1] (1 lit, 0 umbra). null: undefined, infinite, or not "
        "measured by this reference.";
    return schema;
}

}  // namespace umbra
