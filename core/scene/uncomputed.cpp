#include "umbra/core/scene/uncomputed.h"

#include <fmt/format.h>

#include <algorithm>

namespace umbra {
namespace {

struct Term {
    std::string_view name, consequence;
    bool (*asked)(const Material& m);
};
constexpr Term kTerms[] = {
    {"opacity", "surfaces are drawn opaque", [](const Material& m) { return m.opacity < 1; }},
    {"transmit", "surfaces are drawn opaque", [](const Material& m) { return m.transmit > 0; }},
    {"reflect", "surfaces show no mirror images", [](const Material& m) { return m.reflect > 0; }},
    {"index_of_refraction", "nothing is refracted", [](const Material& m) { return m.index_of_refraction != 1; }},
};

constexpr std::size_t kNamed = 3;  ///< a sentence names this many materials

}  // namespace

std::vector<UncomputedTerm> find_uncomputed(const Scene& scene) {
    std::vector<std::uint8_t> used(scene.materials.size(), 0);
    for (const Object& object : scene.objects)
        if (object.triangle_count > 0) used[object.material] = 1;
    std::vector<UncomputedTerm> found;
    for (const Term& term : kTerms) {
        UncomputedTerm uncomputed{term.name, term.consequence, {}};
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
