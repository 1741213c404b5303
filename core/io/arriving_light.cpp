#include "umbra/core/io/arriving_light.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace umbra {
namespace {

double largest(vec3 c) { return static_cast<double>(std::max({c.r, c.g, c.b})); }

vec3 centre_of(const Scene& scene, TriangleId t) {
    return scene.vertex(t, 0) / 3.0f + scene.vertex(t, 1) / 3.0f + scene.vertex(t, 2) / 3.0f;
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

}  // namespace umbra
