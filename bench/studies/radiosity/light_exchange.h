// `umbra radiosity`: light that diffuse surfaces send to one another, step by step, as pictures and a curve. It is
// never part of a comparison, in which S_j alone differs.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/bench/studies/study_report.h"

namespace umbra {

struct ExchangeOptions {
    double size       = 0.0625;  ///< longest edge of a patch, scene diagonals
    int steps         = 4000;    ///< at most
    double until      = 0.02;    ///< ends where this share of the first power, or less, is unshot
    int light_samples = 16;
    std::string command;
    std::function<void(const std::string&)> progress{};
};

/// Solves and writes into `folder`: direct.png, the diffuse light from the lights;
/// indirect.png, what surfaces add; both.png; patches.png, in which every patch has a colour of its own, and
/// elements_K.png, the elements of `radiosity`'s S_j of the K-th light; form_factors.png, from each patch to the first
/// that sent, on a logarithmic scale. Returns {schema, version, command, scene, patch_size, patches, steps, unshot:
/// [share after each step], arrived, ...}. Throws InputError.
[[nodiscard]] Json exchange_light(const PreparedScene& prepared, const ExchangeOptions& options,
                                  const std::filesystem::path& folder);

/// Pictures, and how fast power was sent, of the record of exchange_light.
[[nodiscard]] StudyReport exchange_report(const Json& record);

}  // namespace umbra
