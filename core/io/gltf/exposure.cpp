#include "umbra/core/io/gltf/exposure.h"

#include <fmt/format.h>

#include "umbra/core/io/arriving_light.h"

namespace umbra {

void set_exposure(Scene& scene) {
    const double middle = median_arriving(scene, [](const Light&) { return true; });
    if (middle == 0 || (middle >= 0.1 && middle <= 2)) return;
    scene.exposure = static_cast<float>(1 / middle);
    scene.warnings.push_back(fmt::format(
        "The lights are given in lux or candela, of which {:.3g} arrive at the median triangle: the exposure "
        "is set to {:.3g}.",
        middle, scene.exposure));
}

void warn_of_units(Scene& scene) {
    // Blender's exporter turns 1 W of a point light into 683 / (4 pi) = 54 cd by default, but 1 W/m2 of a sun into
    // 1 lux. Its other units leave out the factor 683 lm/W, and the lights have the proportions that Blender shows.
    constexpr double kFar = 100;
    const auto is_point   = [](const Light& l) { return l.kind == LightKind::point || l.kind == LightKind::spot; };
    const auto is_sun     = [](const Light& l) { return l.kind == LightKind::directional; };
    const double points = median_arriving(scene, is_point), suns = median_arriving(scene, is_sun);
    if (suns > 0 && points > kFar * suns)
        scene.warnings.push_back(
            fmt::format("At the median triangle the point and spot lights (candela) give {:.0f} times the light of the "
                        "directional ones (lux). If Blender wrote this file: its exporter's Lighting Mode \"Standard\" "
                        "multiplies the power of point and spot lights by 683 lm/W, but not the strength of suns; "
                        "Lighting Mode \"Unitless\" keeps the lights in proportion.",
                        points / suns));
}

}  // namespace umbra
