#include "umbra/bench/studies/motion/growth_theory.h"

namespace umbra {
namespace {

constexpr Interval kConstant{0, 0}, kLogarithmic{0, 0.15}, kLinear{1, 1}, kSorting{1, 1.15}, kUpToLinear{0, 1},
    kRootToLinear{0.5, 1}, kSquare{2, 2}, kUpToSquare{0, 2};

struct Row {
    std::string_view family, method;
    Quantity quantity;
    Interval exponent;
    std::string_view why;
};

constexpr Row kRows[] = {
    // n triangles of one body: a silhouette of sqrt(n) edges.
    {"triangles", "planar_projection", Quantity::build, kLinear, "every triangle is listed"},
    {"triangles", "planar_projection", Quantity::aim, kSorting, "every triangle is projected"},
    {"triangles", "planar_projection", Quantity::camera_frame, kUpToLinear,
     "every projected triangle enters a tree of points: at most linear"},
    {"triangles", "shadow_volumes", Quantity::build, kSorting, "edges are found by sorting"},
    {"triangles", "shadow_volumes", Quantity::aim, kSorting,
     "every triangle is turned to the light, every edge summed"},
    {"triangles", "shadow_volumes", Quantity::camera_frame, kRootToLinear,
     "sqrt(n) silhouette edges extrude sides, but every lit triangle is a cap"},
    {"triangles", "shadow_zbuffer", Quantity::build, kLinear, "every triangle is classified as a caster"},
    {"triangles", "shadow_zbuffer", Quantity::aim, kUpToLinear,
     "n triangles are drawn, and a constant number of texels"},
    {"triangles", "shadow_zbuffer", Quantity::camera_frame, kConstant, "a point reads the map"},
    {"triangles", "ray_traced", Quantity::build, kSorting, "a tree of n boxes"},
    {"triangles", "ray_traced", Quantity::camera_frame, kLogarithmic, "a ray descends a tree of n boxes"},
    {"triangles", "exact", Quantity::build, kSorting, "a tree of n boxes"},
    {"triangles", "exact", Quantity::camera_frame, kLogarithmic, "a segment descends a tree of n boxes"},
    {"triangles", "shadow_volumes", Quantity::memory, kLinear, "an entry a triangle and an edge"},
    {"triangles", "shadow_zbuffer", Quantity::memory, kUpToLinear, "a constant map and an entry a triangle"},
    {"triangles", "ray_traced", Quantity::memory, kLinear, "a tree of n boxes"},
    {"triangles", "exact", Quantity::memory, kLinear, "a tree of n boxes"},
    // n / 12 boxes: silhouettes of n edges, each shorter by sqrt(n).
    {"bodies", "planar_projection", Quantity::build, kLinear, "every triangle is listed"},
    {"bodies", "planar_projection", Quantity::aim, kSorting, "every triangle is projected"},
    {"bodies", "shadow_volumes", Quantity::build, kSorting, "edges are found by sorting"},
    {"bodies", "shadow_volumes", Quantity::aim, kSorting, "every triangle is turned to the light, every edge summed"},
    {"bodies", "shadow_volumes", Quantity::camera_frame, kRootToLinear,
     "n edges extrude sides, shorter ones that meet fewer points each"},
    {"bodies", "shadow_zbuffer", Quantity::camera_frame, kConstant, "a point reads the map"},
    {"bodies", "shadow_zbuffer", Quantity::aim, kUpToLinear, "n triangles are drawn, and a constant number of texels"},
    {"bodies", "ray_traced", Quantity::build, kSorting, "a tree of n boxes"},
    {"bodies", "ray_traced", Quantity::camera_frame, kLogarithmic, "a ray descends a tree of n boxes"},
    {"bodies", "exact", Quantity::build, kSorting, "a tree of n boxes"},
    {"bodies", "exact", Quantity::camera_frame, kLogarithmic, "a segment descends a tree of n boxes"},
    // p pixels.
    {"pixels", "planar_projection", Quantity::build, kConstant, "knows no pixels"},
    {"pixels", "planar_projection", Quantity::aim, kConstant, "knows no pixels"},
    {"pixels", "planar_projection", Quantity::camera_frame, kUpToLinear,
     "points enter a tree, of which a shadow's edge meets sqrt(p)"},
    {"pixels", "shadow_volumes", Quantity::build, kConstant, "knows no pixels"},
    {"pixels", "shadow_volumes", Quantity::aim, kConstant, "knows no pixels"},
    {"pixels", "shadow_volumes", Quantity::camera_frame, kRootToLinear,
     "points enter a tree, of which a face's edge meets sqrt(p); every point reads its count"},
    {"pixels", "shadow_zbuffer", Quantity::aim, kConstant, "knows no pixels"},
    {"pixels", "shadow_zbuffer", Quantity::camera_frame, kLinear, "every point reads the map"},
    {"pixels", "ray_traced", Quantity::build, kConstant, "knows no pixels"},
    {"pixels", "ray_traced", Quantity::camera_frame, kLinear, "a ray a point"},
    {"pixels", "exact", Quantity::build, kConstant, "knows no pixels"},
    {"pixels", "exact", Quantity::camera_frame, kLinear, "a segment a point"},
    // l lights.
    {"lights", "", Quantity::build, kConstant, "knows no lights"},
    {"lights", "", Quantity::aim, kLinear, "one aim a light"},
    {"lights", "", Quantity::camera_frame, kLinear, "one answer a light and point"},
    // s samples of an area light.
    {"samples", "planar_projection", Quantity::build, kConstant, "knows no samples"},
    {"samples", "planar_projection", Quantity::aim, kLinear, "one projection a sample"},
    {"samples", "planar_projection", Quantity::camera_frame, kLinear, "one shadow a sample"},
    {"samples", "planar_projection", Quantity::memory, kLinear, "all shadows are kept"},
    {"samples", "ray_traced", Quantity::build, kConstant, "knows no samples"},
    {"samples", "ray_traced", Quantity::camera_frame, kLinear, "a ray a sample"},
    // r texels along a side.
    {"resolution", "shadow_zbuffer", Quantity::build, kConstant, "knows no texels"},
    {"resolution", "shadow_zbuffer", Quantity::aim, kUpToSquare, "r x r texels are cleared and drawn, for n triangles"},
    {"resolution", "shadow_zbuffer", Quantity::camera_frame, kConstant,
     "a point reads the same number of texels; a larger map lies in slower memory"},
    {"resolution", "shadow_zbuffer", Quantity::memory, kSquare, "r x r texels"},
};

}  // namespace

std::string_view to_string(Quantity quantity) {
    constexpr std::string_view kNames[]{"build", "aim", "camera_frame", "light_frame", "object_frame", "memory"};
    return kNames[static_cast<std::size_t>(quantity)];
}

std::optional<Theory> growth_theory(std::string_view family, std::string_view method, Quantity quantity) {
    for (const Row& row : kRows)
        if (row.family == family && (row.method.empty() || row.method == method) && row.quantity == quantity)
            return Theory{row.exponent, row.why};
    return std::nullopt;
}

std::string_view compare_with_theory(const Interval& fitted, const Theory& theory) {
    if (fitted.high < theory.exponent.low) return "below";
    if (fitted.low > theory.exponent.high) return "above";
    return fitted.high - fitted.low <= kDecisive ? "agrees" : "undecided";
}

}  // namespace umbra
