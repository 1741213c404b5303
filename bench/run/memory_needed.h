// How much memory a run takes, before it takes it.
#pragma once

#include <cstdint>
#include <filesystem>

#include "umbra/core/scene/scene.h"

namespace umbra {

enum class Work : std::uint8_t { picture, comparison };

/// About the most that rendering or comparing holds at one time, bytes, for a picture of `pixels` with `samples` points
/// each. docs/memory.md states the terms and how they were measured.
[[nodiscard]] double memory_needed(const Scene& scene, double pixels, int samples, Work work);

/// Throws InputError where that is more than this process may hold: what it is for, how much, and what there is.
void check_memory(const Scene& scene, const std::filesystem::path& file, int width, int height, int samples, Work work);

}  // namespace umbra
