// `umbra radiosity`: light that diffuse surfaces send to one another, step by step, as pictures and a curve. It is
// never part of a comparison, in which S_j alone differs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/prepare.h"
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

/// A picture of the elements of `radiosity`'s S_j of a light.
struct LightElementsRecord {
    std::string light{}, picture{};
};
DESCRIBE(LightElementsRecord) { MEMBERS(light, picture); }

struct ExchangeRecord {
    HeadRecord head{};
    SceneRecord scene{};
    double patch_size     = kUnknown;
    std::uint64_t patches = 0;
    std::vector<double> unshot{};
    std::uint64_t steps = 0;
    double arrived      = kUnknown;
    std::vector<std::string> pictures{};
    std::vector<LightElementsRecord> elements{};
    std::vector<std::string> csv{};
};
DESCRIBE(ExchangeRecord) {
    of.all(&R::head);
    MEMBERS(scene);
    of(MEMBER(patch_size), "longest edge, scene diagonals");
    MEMBERS(patches);
    of(MEMBER(unshot), "share of the power, before the first step and after each");
    MEMBERS(steps);
    of(MEMBER(arrived), "share of what was sent");
    MEMBERS(pictures, elements, csv);
}

/// Solves and writes into `folder`: direct.png, the diffuse light from the lights;
/// indirect.png, what surfaces add; both.png; patches.png, in which every patch has a colour of its own, and
/// elements_K.png, the elements of `radiosity`'s S_j of the K-th light; form_factors.png, from each patch to the first
/// that sent, on a logarithmic scale. Throws InputError.
[[nodiscard]] ExchangeRecord exchange_light(const PreparedScene& prepared, const ExchangeOptions& options,
                                            const std::filesystem::path& folder);

/// Pictures, and how fast power was sent.
[[nodiscard]] StudyReport exchange_report(const ExchangeRecord& record);

}  // namespace umbra
