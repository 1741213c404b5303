#include "umbra/shadows/radiosity/patches.h"

#include <algorithm>
#include <cmath>

namespace umbra::patches {

Patches::Patches(const Scene& scene, double longest) {
    const std::size_t triangles = scene.triangles.size();
    for (TriangleId t = 0; t < triangles; ++t) {
        const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
        longest_.push_back(std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)}));
    }
    parts_.resize(triangles);
    for (std::size_t patches = kMost + triangles + 1; patches > kMost + triangles; longest *= 2) {
        patches = 0;
        for (std::size_t t = 0; t < triangles; ++t) {
            // Small enough that the sum cannot overflow.
            const double parts = longest > 0 ? std::clamp(std::ceil(longest_[t] / longest), 1.0, 4096.0) : 1;
            parts_[t]          = static_cast<std::uint32_t>(parts);
            patches += std::size_t{parts_[t]} * parts_[t];
        }
    }
    for (TriangleId t = 0; t < triangles; ++t) {
        first_.push_back(static_cast<PatchId>(triangle_.size()));
        triangle_.insert(triangle_.end(), std::size_t{parts_[t]} * parts_[t], t);
    }
}

// Rows of equal v: row j begins after those below it, of 2 (n - i) - 1 patches each: j (2 n - j) in all.
std::array<dvec2, 3> Patches::corners(PatchId patch) const {
    const TriangleId t    = triangle_[patch];
    const std::uint32_t n = parts_[t], k = patch - first_[t];
    std::uint32_t j = n - static_cast<std::uint32_t>(std::sqrt(static_cast<double>(n * n - k)));
    while (j > 0 && j * (2 * n - j) > k) --j;
    while ((j + 1) * (2 * n - j - 1) <= k) ++j;
    const std::uint32_t in_row = k - j * (2 * n - j), i = in_row / 2;
    const auto at = [&](std::uint32_t x, std::uint32_t y) { return dvec2(x, y) / static_cast<double>(n); };
    if (in_row % 2 == 0) return {at(i, j), at(i + 1, j), at(i, j + 1)};
    return {at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)};
}

InPatch Patches::find(TriangleId t, double u, double v) const {
    const std::uint32_t n = parts_[t];
    const auto along      = [](double x, std::uint32_t cells) {
        return static_cast<std::uint32_t>(std::clamp(x, 0.0, static_cast<double>(cells) - 1));
    };
    const std::uint32_t j = along(v * n, n), i = along(u * n, n - j);
    const double x = u * n - i, y = v * n - j;
    const bool upper    = x + y > 1 && i + j + 1 < n;
    const PatchId patch = first_[t] + j * (2 * n - j) + 2 * i + (upper ? 1 : 0);
    return upper ? InPatch{patch, 1 - x, 1 - y} : InPatch{patch, x, y};
}

std::size_t Patches::memory_bytes() const {
    return triangle_.size() * sizeof(TriangleId) + first_.size() * sizeof(PatchId) +
           parts_.size() * sizeof(std::uint32_t) + longest_.size() * sizeof(double);
}

}  // namespace umbra::patches
