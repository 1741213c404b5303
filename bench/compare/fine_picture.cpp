#include "umbra/bench/compare/fine_picture.h"

#include "umbra/bench/lab/antialias.h"
#include "umbra/core/render/shade.h"

namespace umbra {
namespace {

/// S_j of an area light at subpixels: interpolated between pixel centres where that shows no difference,
/// since a reference takes long at every point.
VisibilityPlane smoothed_plane(const PreparedScene& prepared, const MethodRun& run, LightId light) {
    std::vector<std::uint32_t> ask;
    VisibilityPlane plane  = between_centres(prepared.scene, prepared.points, run.planes[light], prepared.subpixels,
                                             prepared.pixel_side, light, ask);
    const PointBatch asked = pick(prepared.subpixels, ask);
    const VisibilityPlane answers = run.work->ask(asked, light);
    for (std::size_t k = 0; k < ask.size(); ++k) {
        plane.s[ask[k]] = answers.s[k], plane.answer[ask[k]] = answers.answer[k];
        if (run.is_coloured) plane.colour[ask[k]] = answers.colour[k];
    }
    return plane;
}

std::vector<VisibilityPlane> fine_planes(const PreparedScene& prepared, const MethodRun& run) {
    std::vector<VisibilityPlane> planes;
    run.work->look(prepared.subpixels);
    for (LightId j = 0; j < prepared.scene.lights.size(); ++j) {
        if (run.choice.info->reference && is_area(prepared.scene.lights[j].kind)) {
            planes.push_back(smoothed_plane(prepared, run, j));
            continue;
        }
        planes.emplace_back(prepared.subpixels.size(), run.is_coloured);
        run.work->visibility(j, planes.back().out());
    }
    run.work->forget_look();
    return planes;
}

/// Whether a picture may have several points a pixel: they are prepared, the method has answered the picture whole, and
/// is no file, which has answers at the centres of pixels alone.
bool is_fine(const PreparedScene& prepared, const MethodRun& run) {
    return prepared.pixel_side > 1 && run.judged.empty() && run.choice.info->is_timed;
}

}  // namespace

FinePicture fine_picture(const PreparedScene& prepared, const MethodRun& run) {
    if (!is_fine(prepared, run)) return {};
    FinePicture fine{run.choice.text(), fine_planes(prepared, run), {}};
    fine.linear = shade(prepared.scene, prepared.subpixels, fine.planes);
    return fine;
}

Image picture_of(const PreparedScene& prepared, const MethodRun& run, const Rendered& rendered,
                 const FinePicture& known) {
    if (!is_fine(prepared, run)) return rendered.shown;
    const auto seen = [&](const Image& fine) {
        return displayed(box_filtered(fine, prepared.pixel_side), prepared.scene.tone, prepared.scene.exposure);
    };
    if (known.of == run.choice.text()) return seen(known.linear);
    const std::vector<VisibilityPlane> planes = fine_planes(prepared, run);
    return seen(known.of.empty() ? shade(prepared.scene, prepared.subpixels, planes)
                                 : shade(prepared.scene, prepared.subpixels, planes, known.planes, known.linear));
}

}  // namespace umbra
