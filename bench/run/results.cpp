#include "umbra/bench/run/results.h"

namespace umbra {

std::string record_text(const Results& results) { return json_text(to_record(results)); }

Json results_schema() {
    Json schema = schema_of<Results>("results.json: several shadow methods on one scene, compared with a reference");
    schema["description"] =
        "Times in milliseconds, memory in bytes, S_j in [0, 1] (1 lit, 0 umbra). null: undefined, infinite, or not "
        "measured by this reference.";
    return schema;
}

}  // namespace umbra
