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

}  // namespace umbra
