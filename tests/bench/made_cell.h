// Records that tests make up as JSON, as files hold them.
#pragma once

#include <fstream>
#include <string>

#include "umbra/bench/base/record.h"
#include "umbra/bench/sweep/cell_record.h"
#include "umbra/bench/sweep/cell_store.h"

namespace umbra {

/// Of no particular method where none is named.
inline Cell cell_from(Json json) {
    if (!json.contains("name")) json["name"] = "ray_traced";
    return from_record<Cell>(parse_json(json.dump(), "cell"));
}

/// As if a run had kept it there; its member `key` names it.
inline void keep_made(const CellStore& store, const Json& kept) {
    std::ofstream(store.folder() / (kept.at("key").get<std::string>() + ".json")) << kept;
}

}  // namespace umbra
