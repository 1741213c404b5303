// A scene made ready for methods: loaded, its facts found, its surface points determined, each step timed.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <utility>

#include "umbra/bench/run/memory_needed.h"
#include "umbra/core/render/points.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

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

struct Size {
    int width = 0, height = 0;  ///< 0: the scene's own
};
/// "WIDTHxHEIGHT". Throws UsageError.
[[nodiscard]] Size parse_size(const std::string& text);

/// `pixel_samples`: surface points a pixel for pictures (see antialias.h). Throws InputError, and UsageError for a
/// number of samples that cannot be had. InputError where `work` on it needs more memory than there is.
[[nodiscard]] PreparedScene prepare_scene(const std::filesystem::path& file, Size size, int pixel_samples = 1,
                                          Work work = Work::comparison);

/// The same for a scene that is there already; `file` names it in messages.
[[nodiscard]] PreparedScene prepare_scene(Scene scene, const std::filesystem::path& file, Size size,
                                          int pixel_samples = 1, Work work = Work::comparison);

}  // namespace umbra
