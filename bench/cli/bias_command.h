// `umbra bias`: studies the bias of the shadow z-buffer on scenes and writes the results as data and heat maps.
#pragma once

#include "umbra/bench/studies/bias/bias_study.h"

namespace umbra {

struct BiasOptions {
    Size size{320, 180};
    std::string map;  ///< settings of shadow_zbuffer other than bias, "k=v,k=v"; may be empty
    std::filesystem::path out;
    std::string command;  ///< for the record
    int threads = 0;
    std::function<void(const std::string&)> progress;  ///< receives status messages; may be empty
};

/// Studies the scenes and writes OUT/results.json, OUT/bias.csv and the page OUT/index.html. Returns the record. The
/// messages of unreadable scenes, or scenes whose meshes are missing, are appended to `failed`; these are skipped.
/// Scenes on which a method threw are in the record's `failed`; without any study nothing is written. Throws
/// UsageError, InputError.
BiasRecord study_biases(const std::vector<std::filesystem::path>& files, const BiasOptions& options,
                        std::vector<std::string>& failed);

}  // namespace umbra
