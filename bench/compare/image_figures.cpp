#include "umbra/bench/compare/image_figures.h"

#include "umbra/core/render/shade.h"

namespace umbra {

Rendered render_planes(const Scene& scene, const PointBatch& points, std::span<const VisibilityPlane> planes) {
    Rendered r;
    r.linear = shade(scene, points, planes);
    r.shown  = displayed(r.linear, scene.tone, scene.exposure);
    return r;
}

ImageFigures image_figures(std::span<const VisibilityPlane> planes, Rendered rendered, const Rendered& reference) {
    for (const VisibilityPlane& plane : planes)
        for (std::size_t i = 0; i < plane.size(); ++i)
            if (!plane.defined(i))
                for (std::size_t c = 0; c < 3; ++c) {
                    rendered.linear.at(i, c) = reference.linear.at(i, c);
                    rendered.shown.at(i, c)  = reference.shown.at(i, c);
                }
    ImageFigures f;
    f.flip    = flip_ldr(reference.shown, rendered.shown);
    f.figures = {image_error(rendered.linear, reference.linear).rmse, image_error(rendered.shown, reference.shown).psnr,
                 ssim(rendered.shown, reference.shown), f.flip.mean, flip_hdr(reference.linear, rendered.linear).mean};
    return f;
}

}  // namespace umbra
