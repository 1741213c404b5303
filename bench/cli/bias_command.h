// `umbra bias`: studies the shadow z-buffer's bias on scenes and writes what it found, as data and as heat maps.
#pragma once

#include "umbra/bench/bias/bias_study.h"

namespace umbra {

struct BiasOptions {
    Size size{320, 180};
    std::string map;  ///< settings of shadow_zbuffer other than bias, "k=v,k=v"; may be empty
    std::filesystem::path out;
    std::string command;  ///< for the record
    int threads = 0;
    std::function<void(const std::string&)> progress;  ///< told what is being done
};

/// Studies the scenes and writes OUT/results.json and the page OUT/index.html. Returns the record. Scenes that cannot
/// be read, or whose meshes are not there, are told to `failed` and left out. Throws UsageError, InputError.
Json study_biases(const std::vector<std::filesystem::path>& files, const BiasOptions& options,
                  std::vector<std::string>& failed);

/// The record's scenes as a table for a terminal.
[[nodiscard]] std::string bias_table(const Json& record);

}  // namespace umbra
