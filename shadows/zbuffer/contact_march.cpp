#include "umbra/shadows/zbuffer/contact_march.h"

#include <algorithm>
#include <limits>

namespace umbra {

std::optional<std::size_t> march(const Scene& scene, const PointBatch& picture, dvec3 p, const Light& light,
                                 const ContactMarch& contact) {
    const CameraFrame& camera = *picture.raster;
    const bool perspective    = camera.projection == Projection::perspective;
    const bool infinite       = light.kind == LightKind::directional;
    const dvec3 path          = infinite ? -dvec3(light.direction) : dvec3(light.position) - p;
    const double distance     = glm::length(path);
    if (!(distance > 0)) return {};
    const double length = infinite ? contact.length : std::min(contact.length, distance);
    const dvec3 step    = path * (length / (distance * contact.steps));
    for (int k = 1; k <= contact.steps; ++k) {
        const dvec3 q     = p + static_cast<double>(k) * step;
        const dvec3 pixel = camera.project(q);
        const bool inside = pixel.x >= 0 && pixel.y >= 0 && pixel.x < camera.width && pixel.y < camera.height;
        if (!inside || (perspective && pixel.z <= 0)) return {};
        const std::size_t i = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(camera.width) +
                              static_cast<std::size_t>(pixel.x);
        if (picture.triangle[i] == kNoTriangle || !scene.blocks(picture.triangle[i])) continue;
        const dvec3 s(picture.position(i)), n(picture.normal(i));
        const bool faces_eye = glm::dot(n, perspective ? s - camera.eye : camera.forward) < 0;
        const double before  = (faces_eye ? 1 : -1) * glm::dot(n, q - s);
        // Positions and normals of the picture are floats.
        const double rounding =
            8 * static_cast<double>(std::numeric_limits<float>::epsilon()) * (glm::length(s) + glm::length(q - s));
        if (before < -rounding && before >= -contact.thickness) return i;
    }
    return {};
}

}  // namespace umbra
