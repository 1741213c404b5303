#include "umbra/core/scene/uncomputed.h"

#include <fmt/format.h>

#include <algorithm>

namespace umbra {
namespace {

struct Term {
    std::string_view name, consequence;  ///< empty: drawn_and_in_shadows()
    bool (*asked)(const Material& m);
};
constexpr Term kTerms[] = {
    {"opacity", "", [](const Material& m) { return m.opacity < 1; }},
    {"transmit", "", [](const Material& m) { return m.transmit > 0; }},
    {"reflect", "surfaces show no mirror images", [](const Material& m) { return m.reflect > 0; }},
    {"index_of_refraction", "nothing is refracted", [](const Material& m) { return m.index_of_refraction != 1; }},
    {kCutout, "surfaces are whole, and so are their shadows", [](const Material& m) { return m.cutout; }},
};

/// The same surfaces in S_j, which is not as they are drawn.
std::string_view drawn_and_in_shadows(TransparentOccluders transparent) {
    switch (transparent) {
        case TransparentOccluders::ignore:
            return "surfaces are drawn opaque. They throw no shadow (transparent_occluders: ignore)";
        case TransparentOccluders::block:
            return "surfaces are drawn opaque. They throw full shadows (transparent_occluders: block)";
        case TransparentOccluders::multiply: break;
    }
    return "surfaces are drawn opaque. Their shadows let through what they do (transparent_occluders: multiply)";
}

constexpr std::size_t kNamed = 3;  ///< a sentence names this many materials

}  // namespace

std::vector<UncomputedTerm> find_uncomputed(const Scene& scene) {
    std::vector<std::uint8_t> used(scene.materials.size(), 0);
    for (const Object& object : scene.objects)
        if (object.triangle_count > 0) used[object.material] = 1;
    std::vector<UncomputedTerm> found;
    for (const Term& term : kTerms) {
        UncomputedTerm uncomputed{
            term.name, term.consequence.empty() ? drawn_and_in_shadows(scene.transparent) : term.consequence, {}};
        for (std::size_t m = 0; m < scene.materials.size(); ++m)
            if (used[m] && term.asked(scene.materials[m])) uncomputed.materials.push_back(scene.materials[m].name);
        if (!uncomputed.materials.empty()) found.push_back(std::move(uncomputed));
    }
    return found;
}

std::string in_words(const UncomputedTerm& term) {
    const std::size_t n = term.materials.size();
    std::string names;
    for (std::size_t i = 0; i < std::min(n, kNamed); ++i)
        names += fmt::format("{}\"{}\"", i == 0 ? "" : i + 1 == n ? " and " : ", ", term.materials[i]);
    if (n > kNamed) names += fmt::format(" and {} more", n - kNamed);
    return fmt::format("{} of material{} {}", term.term, n == 1 ? "" : "s", names);
}

}  // namespace umbra
