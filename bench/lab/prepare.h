// A scene made ready for methods: loaded, its facts found, its surface points determined, each step timed.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "umbra/core/render/points.h"
#include "umbra/core/render/ray.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

enum class Work : std::uint8_t { picture, comparison };

/// Throws InputError where rendering or comparing a picture with `samples` points a pixel needs about more memory than
/// this process may hold: what it is for, how much, and what there is. docs/memory.md states the terms and how they were
/// measured.
void check_memory(const Scene& scene, const std::filesystem::path& file, int width, int height, int samples, Work work);

/// How long `work` takes, wall clock, milliseconds.
template <class Work>
double timed_ms(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    std::forward<Work>(work)();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Everything about a scene that all methods share, made once: facts, the G-buffer, and what each step cost.
struct PreparedScene {
    Scene scene;
    SceneFacts facts;
    PointBatch points;
    PointBatch subpixels{};  ///< pixel_side x pixel_side points a pixel, for the picture alone; none where that is 1
    int pixel_side = 1;
    double load_ms = 0, facts_ms = 0, rays_build_ms = 0, gbuffer_ms = 0;
};

/// "SCENE: warning" of loading and preparing, one after the other; `receive` may be empty.
void pass_warnings(const Scene& scene, const std::function<void(const std::string&)>& receive);

struct Size {
    int width = 0, height = 0;  ///< 0: the scene's own
};
/// "WIDTHxHEIGHT". Throws UsageError.
[[nodiscard]] Size parse_size(const std::string& text);

/// `pixel_samples`: surface points a pixel for pictures (see antialias.h). Throws InputError, and UsageError for a
/// number of samples that cannot be had. InputError where `work` on it needs more memory than there is.
[[nodiscard]] PreparedScene prepare_scene(const std::filesystem::path& file, Size size, int pixel_samples = 1,
                                          Work work = Work::comparison);

/// Of a scene that has the same triangles and materials, and lights of the same kinds.
struct KnownGeometry {
    const SceneFacts& facts;
    const RayScene& rays;
};

/// The same for a scene that is there already; `file` names it in messages. What `known` has is not found again.
[[nodiscard]] PreparedScene prepare_scene(Scene scene, const std::filesystem::path& file, Size size,
                                          int pixel_samples = 1, Work work = Work::comparison,
                                          const KnownGeometry* known = nullptr);

}  // namespace umbra
