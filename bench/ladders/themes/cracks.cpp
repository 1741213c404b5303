// Ladders over where a surface is not closed, or only just: cracks, T-junctions, rays that pass by edges and vertices.
#include <cmath>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/ladders/themes/close_view.h"

namespace umbra {
namespace {

/// A sheet, 1 long, in two halves with a crack of this width between them; without one they share the edge.
Scene crack_scene(double width) {
    Scene scene = empty_stage();
    add_close_floor(scene, width > 0 ? 8 * width : 1e-3);
    const dvec3 near = kHalfway - 0.5 * width * kAcross, far = kHalfway + 0.5 * width * kAcross;
    Mesh sheet         = quad(near - kAlong, near - kAlong - kAcross, near + kAlong - kAcross, near + kAlong);
    const Mesh another = quad(far - kAlong, far + kAlong, far + kAlong + kAcross, far - kAlong + kAcross);
    for (const uvec3& t : another.triangles) sheet.triangles.push_back(t + 4u);
    sheet.positions.insert(sheet.positions.end(), another.positions.begin(), another.positions.end());
    add_body(scene, "sheet", sheet);
    add_close_light(scene);
    if (width == 0) add_rim_light(scene, kHalfway + kAcross);
    return scene;
}

/// A long edge, on one side of it one triangle, on the other two, whose common vertex lies off the edge by `gap`, or
/// as far as rounding brings it.
Scene t_junction_scene(double gap) {
    Scene scene = empty_stage();
    add_close_floor(scene, gap > 0 ? 8 * gap : 1e-3);
    const dvec3 a(vec3(kHalfway - kAlong)), b(vec3(kHalfway + 0.7 * kAlong));
    const dvec3 on_edge = a + (b - a) / 1.7;
    add_body(scene, "sheet",
             {{vec3(a), vec3(b), vec3(on_edge + gap * kAcross), vec3(on_edge - kAcross), vec3(on_edge + kAcross)},
              {},
              {{0, 1, 3}, {0, 4, 2}, {2, 4, 1}}});
    add_close_light(scene);
    if (gap == 0) add_rim_light(scene, 0.5 * (on_edge + kAcross + b));
    return scene;
}

/// A hilly sheet of right-angled triangles, whose vertices the light projects onto a square grid in the floor; the eye,
/// below it and looking straight down, has its pixels there, except for a fraction of the grid's spacing. Ten pixels at
/// each side of the picture are lit.
Scene lattice_scene(double beside) {
    constexpr int kCells      = 60;
    constexpr double kSpacing = 1.0 / 32;
    const dvec3 light(vec3(1.7f, 2.9f, 1.3f));
    Scene scene = floor_stage(3);
    scene.width = scene.height = 80;
    // Lines through pixels, except the first and the last, which are between them: the shadow's border is at none.
    const auto line = [](int k) { return kSpacing * (k - 0.5 * kCells + (k == 0 ? 0.0 : k == kCells ? 1.0 : 0.5)); };
    Mesh sheet;
    for (int j = 0; j <= kCells; ++j)
        for (int i = 0; i <= kCells; ++i) {
            const double height = 1 + ((5 * i + 3 * j + i * j) % 16) / 64.0;
            const dvec3 shadow(line(i) + kSpacing * beside, 0, line(j) + 0.5 * kSpacing * beside);
            sheet.positions.emplace_back(shadow + (height / light.y) * (light - shadow));
        }
    for (unsigned j = 0; j < kCells; ++j)
        for (unsigned i = 0; i < kCells; ++i) {
            const unsigned first = j * (kCells + 1) + i, below = first + kCells + 1;
            sheet.triangles.push_back({first, below, below + 1});
            sheet.triangles.push_back({first, below + 1, first + 1});
        }
    add_body(scene, "sheet", sheet);
    add_point_light(scene, vec3(light));
    scene.camera.projection = Projection::orthographic;
    scene.camera.height     = 2.5f;
    scene.camera.eye        = {0, 0.5f, 0};
    scene.camera.target     = vec3(0);
    scene.camera.up         = {0, 0, -1};
    return scene;
}

}  // namespace

const Ladder crack_ladder{
    .name  = "crack",
    .title = "Crack in a sheet",
    .about =
        "Two halves of a sheet leave a crack between them, which lets a stripe of light through; on the last rung they "
        "share an edge and the sheet is closed. The picture shows only the stripe, and on the last rung what a second "
        "light throws past the sheet's rim.",
    .unit  = "of the sheet's half width",
    .rungs = tenths_to_0(),
    .scene = crack_scene};

const Ladder t_junction_ladder{
    .name  = "t_junction",
    .title = "T-junction",
    .about =
        "A vertex in the middle of a longer edge lies at this distance from it, on the last rung only at its rounding "
        "error, and leaves a slit. Everything beside the slit is in shadow, except what a second light throws past the "
        "sheet's rim on the last rung.",
    .unit  = "of the sheet's half width",
    .rungs = tenths_to_0(),
    .scene = t_junction_scene};

const Ladder beside_edges_ladder{.name  = "beside_edges",
                                 .title = "Light that passes close to edges and vertices",
                                 .about =
                                     "The sheet of small triangles is closed. The segments to the light pass its "
                                     "vertices at this fraction of an edge length, on the last rung at the rounding "
                                     "error. Users of ray tracers report rays that slip through there.",
                                 .unit  = "of an edge length",
                                 .rungs = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0.0},
                                 .scene = lattice_scene};

}  // namespace umbra
