// Ladders over the sum: no shadow falls in them, and what may break is I_j f_att (k_d O_d (N.L) + k_s O_s (R.V)^n)
// itself. Each picture is brightest in its middle and must fall from there, finite and never negative.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/ladders/themes/close_view.h"

namespace umbra {
namespace {

enum class Falls : std::uint8_t { never_rises, always };

/// Walks from the middle pixel to the picture's four sides. `peak` is the middle pixel's value, to 1e-4 of it. Where
/// it falls always, neighbours are not equal either, down to a millionth of the peak.
std::string wrong_around_middle(const Image& linear, double peak, Falls falls) {
    const int x0 = linear.width / 2, y0 = linear.height / 2;
    const auto width = static_cast<std::size_t>(linear.width);
    const auto value = [&](int x, int y) {
        return linear.at(static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x), 0);
    };
    for (std::size_t i = 0; i < linear.pixels(); ++i)
        if (!std::isfinite(linear.at(i, 0)) || linear.at(i, 0) < 0)
            return fmt::format("pixel {}, {} is {}, expected a finite number >= 0", i % width, i / width,
                               linear.at(i, 0));
    if (!(std::abs(static_cast<double>(value(x0, y0)) - peak) <= 1e-4 * peak))
        return fmt::format("the middle pixel is {}, expected {}", value(x0, y0), peak);
    for (const ivec2 step : {ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1)})
        for (ivec2 p(x0, y0), q = p + step; q.x >= 0 && q.y >= 0 && q.x < linear.width && q.y < linear.height;
             p = q, q += step)
            if (value(q.x, q.y) > value(p.x, p.y) || (falls == Falls::always && value(q.x, q.y) == value(p.x, p.y) &&
                                                      static_cast<double>(value(p.x, p.y)) > 1e-6 * peak))
                return fmt::format("pixel {}, {} is {}, expected {} its neighbour nearer to the middle, {}", q.x, q.y,
                                   value(q.x, q.y), falls == Falls::always ? "less than" : "at most", value(p.x, p.y));
    return "";
}

/// A picture with a pixel in its middle, of a floor that only reflects what the ladder is about.
Scene middle_stage(double k_d, double k_s) {
    Scene scene  = empty_stage();
    scene.width  = 129;
    scene.height = 97;
    Material& m  = scene.materials[0];
    m.k_a        = vec3(0);
    m.k_d        = vec3(static_cast<float>(k_d));
    m.k_s        = vec3(static_cast<float>(k_s));
    return scene;
}

// ---- (R.V)^n --------------------------------------------------------------------------------------------------------

/// Degrees that hold most of cos^n.
float angle_of_lobe(double n) { return static_cast<float>(std::min(50.0, 500 / std::sqrt(n))); }

Scene shininess_scene(double n) {
    Scene scene = middle_stage(0, 0.75);
    add_body(scene, "floor", make_plane(8, 8));
    scene.materials[0].shininess = static_cast<float>(n);
    add_point_light(scene, {0, 1, -1});
    look(scene, {0, 1, 1}, {0, 0, 0}, angle_of_lobe(n));
    return scene;
}
std::string wrong_lobe(double, const Scene&, const Image& linear) {
    return wrong_around_middle(linear, 0.75, Falls::always);
}

Scene spot_scene(double n) {
    Scene scene    = middle_stage(0.75, 0);
    const dvec3 up = glm::normalize(dvec3(0.5, 1, 0.25)), x = glm::normalize(glm::cross(up, dvec3(0, 0, 1))),
                z = glm::cross(x, up);
    add_body(scene, "screen", quad(-4.0 * x - 4.0 * z, -4.0 * x + 4.0 * z, 4.0 * x + 4.0 * z, 4.0 * x - 4.0 * z));
    Light& spot        = add_point_light(scene, vec3(up));
    spot.kind          = LightKind::spot;
    spot.direction     = glm::normalize(-spot.position);
    spot.spot.exponent = static_cast<float>(n);
    look(scene, spot.position, {0, 0, 0}, angle_of_lobe(n));
    return scene;
}

// ---- f_att ----------------------------------------------------------------------------------------------------------

/// The most that f_att may be, where it is not limited to 1 (core/scene/lights.h).
constexpr double kMostAttenuation = 1e30;

Scene near_light_scene(double distance) {
    Scene scene = middle_stage(0.75, 0);
    add_close_floor(scene, 4 * distance);
    Light& light      = add_point_light(scene, {0, static_cast<float>(distance), 0});
    light.attenuation = {.c1 = 0, .c2 = 0, .c3 = 1, .clamp = false};
    return scene;
}
std::string wrong_near_light(double distance, const Scene&, const Image& linear) {
    return wrong_around_middle(linear, 0.75 / (distance * distance), Falls::always);
}

Scene coefficients_scene(double c) {
    Scene scene = middle_stage(0.75, 0);
    add_close_floor(scene, 0.375);
    const auto coefficient = static_cast<float>(c);
    Light& light           = add_point_light(scene, {0, 1, 0});
    light.attenuation      = {coefficient, coefficient, coefficient, false};
    return scene;
}
std::string wrong_coefficients(double c, const Scene&, const Image& linear) {
    return wrong_around_middle(linear, 0.75 * std::min(kMostAttenuation, 1 / (3 * c)), Falls::never_rises);
}

}  // namespace

const Ladder shininess_ladder{.name  = "shininess",
                              .title = "Shininess",
                              .about =
                                  "The exponent of a highlight. If a cosine near 1 has an error of one float step, its "
                                  "power with exponent 1000000 has an error of 5 %.",
                              .rungs     = powers_of_ten(0, 6),
                              .scene     = shininess_scene,
                              .wrong_sum = wrong_lobe};

const Ladder spot_exponent_ladder{.name  = "spot_exponent",
                                  .title = "Exponent of a spot light",
                                  .about =
                                      "The intensity of a spot light falls off with the angle from its axis: this is "
                                      "the same power of a cosine near 1.",
                                  .rungs     = powers_of_ten(0, 6),
                                  .scene     = spot_scene,
                                  .wrong_sum = wrong_lobe};

const Ladder attenuation_distance_ladder{.name  = "attenuation_distance",
                                         .title = "Attenuation close to the light",
                                         .about =
                                             "A light whose intensity falls off with the square of the distance is at "
                                             "this distance from the floor: the factor grows without limit.",
                                         .unit      = "from the light",
                                         .rungs     = powers_of_ten(-1, -9),
                                         .scene     = near_light_scene,
                                         .wrong_sum = wrong_near_light};

const Ladder attenuation_coefficients_ladder{
    .name  = "attenuation_coefficients",
    .title = "Attenuation with coefficients near 0",
    .about = "All three coefficients of the attenuation have this value; the factor, 1 divided by their sum, grows.",
    .rungs = {1e0, 1e-4, 1e-8, 1e-12, 1e-16, 1e-20, 1e-24, 1e-28, 1e-32, 1e-36},
    .scene = coefficients_scene,
    .wrong_sum = wrong_coefficients};

}  // namespace umbra
