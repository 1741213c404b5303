#include "umbra/core/io/arriving_light.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/scene/photometry.h"

namespace umbra {
namespace {

constexpr double kInvisible = 1e-3;  ///< a quarter of the smallest step above black in a picture of 8 bits

double largest(vec3 c) { return static_cast<double>(std::max({c.r, c.g, c.b})); }

vec3 centre_of(const Scene& scene, TriangleId t) {
    return scene.vertex(t, 0) / 3.0f + scene.vertex(t, 1) / 3.0f + scene.vertex(t, 2) / 3.0f;
}

/// The largest value that the light can have anywhere on the triangle: at its nearest distance, cones ignored.
double at_most(const Scene& scene, const Light& light, TriangleId t) {
    const double own = largest(light.diffuse);
    if (light.kind == LightKind::directional) return own;
    Box box;
    for (int k = 0; k < 3; ++k) box = extend(box, scene.vertex(t, k));
    const dvec3 nearest   = glm::clamp(dvec3(light.position), dvec3(box.min), dvec3(box.max));
    const double distance = glm::distance(nearest, dvec3(light.position));
    if (light.range > 0 && distance > double(light.range)) return 0;
    const double candela = light.photometry ? double(peak(*light.photometry)) : 1;
    return own * candela * double(attenuation_factor(light.attenuation, static_cast<float>(distance)));
}

double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

std::vector<TriangleId> sample_triangles(const Scene& scene) {
    std::vector<TriangleId> samples;
    const std::size_t step = scene.triangles.size() / kArrivingSamples + 1;
    for (std::size_t t = 0; t < scene.triangles.size(); t += step) samples.push_back(static_cast<TriangleId>(t));
    return samples;
}

double arriving(const Scene& scene, const Light& light, TriangleId triangle) {
    return largest(falloff(light, centre_of(scene, triangle)) * light.diffuse);
}

double median_arriving(const Scene& scene, const std::function<bool(const Light&)>& counts) {
    std::vector<double> values;
    for (const TriangleId t : sample_triangles(scene)) {
        const vec3 centre = centre_of(scene, t);
        vec3 all(0), counted(0);
        for (const Light& light : scene.lights) {
            const vec3 arrives = falloff(light, centre) * light.diffuse;
            all += arrives;
            if (counts(light)) counted += arrives;
        }
        if (largest(all) > 0 && std::isfinite(largest(all))) values.push_back(largest(counted));
    }
    return median(values);
}

void warn_of_invisible_lights(Scene& scene) {
    const std::vector<TriangleId> samples = sample_triangles(scene);
    // The brightest light at each triangle; the others are compared with the one at the median triangle.
    struct Brightest {
        double value      = 0;
        std::size_t light = 0;
    };
    std::vector<Brightest> brightest;
    for (const TriangleId t : samples) {
        Brightest b;
        for (std::size_t j = 0; j < scene.lights.size(); ++j)
            if (const double value = arriving(scene, scene.lights[j], t); value > b.value) b = {value, j};
        if (b.value > 0 && std::isfinite(b.value)) brightest.push_back(b);
    }
    if (brightest.empty()) return;
    const auto middle = brightest.begin() + static_cast<std::ptrdiff_t>(brightest.size() / 2);
    std::nth_element(brightest.begin(), middle, brightest.end(),
                     [](const Brightest& a, const Brightest& b) { return a.value < b.value; });
    const std::string reference = scene.lights[middle->light].name;
    const double visible        = kInvisible * middle->value;

    const auto warn = [&](const std::string& what, double share) {
        scene.warnings.push_back(fmt::format(
            "{} cannot be seen: it adds at most {:.2g} % of what light \"{}\" gives at the middle of the scene.", what,
            100 * share / middle->value, reference));
    };
    for (const Light& light : scene.lights) {
        if (light.diffuse == vec3(0) && light.specular == vec3(0)) continue;  // switched off
        double most = largest(light.ambient);
        for (const TriangleId t : samples) most = std::max(most, at_most(scene, light, t));
        if (most < visible) warn(fmt::format("Light \"{}\"", light.name), most);
    }
    if (const double ambient = largest(scene.ambient); ambient > 0 && ambient < visible)
        warn(fmt::format("The ambient light of {:g}", ambient), ambient);
}

}  // namespace umbra
