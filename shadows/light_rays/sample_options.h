// Options of all methods that sample area lights. A method's options derive from the struct here, and its list of
// parameters names the functions: each parameter is declared once.
#pragma once

#include <string_view>

#include "umbra/core/render/sampling.h"
#include "umbra/core/scene/lights.h"
#include "umbra/shadows/settings.h"

namespace umbra::rays {

struct SampleOptions {
    int samples     = 16;
    Sampler sampler = Sampler::sobol;
    int seed        = 0;
};

/// The samples of one light of the scene, of this kind; lights without an area have one.
[[nodiscard]] inline SampleSet samples_of(LightId light, LightKind kind, const SampleOptions& options) {
    return {options.sampler, is_area(kind) ? options.samples : 1,
            static_cast<std::uint32_t>(options.seed) + 0x9e3779b9u * light};
}

// The parameters of the struct above, for the method's own struct `Options`.

template <class Options>
[[nodiscard]] Parameter samples_parameter(std::string_view doc, std::string_view unit, std::string_view sweep) {
    return parameter<&SampleOptions::samples, Options>(
        "samples", doc,
        {.unit = unit, .phase = Phase::aim, .min = 1, .max = 65536, .sweep = sweep, .area_lights = true});
}

template <class Options>
[[nodiscard]] Parameter sampler_parameter() {
    return parameter<&SampleOptions::sampler, Options>(
        "sampler", "How the samples of an area light are spread; sobol is Owen-scrambled.",
        {.phase = Phase::aim, .choices = kSamplers, .sweep = "random|stratified|sobol", .area_lights = true});
}

template <class Options>
[[nodiscard]] Parameter seed_parameter() {
    return parameter<&SampleOptions::seed, Options>(
        "seed", "Picks the samples; equal seeds give equal bits.",
        {.phase = Phase::aim, .min = 0, .max = 2147483647, .area_lights = true});
}

}  // namespace umbra::rays
