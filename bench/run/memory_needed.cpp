#include "umbra/bench/run/memory_needed.h"

#include <fmt/format.h>

#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/core/base/memory.h"
#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

/// Bytes, measured.
struct Terms {
    double triangle, pixel, pixel_light, sample, sample_light;
};
constexpr Terms kPicture{200, 130, 30, 55, 11}, kComparison{300, 260, 55, 70, 20};
constexpr double kProgram  = 1.5e8;                         ///< libraries and what is always there
constexpr double kReserved = 4e8, kReservedByThread = 1e8;  ///< address space beyond what is used

std::string in_units(double bytes) {
    return bytes < 0.95e9 ? fmt::format("{:.0f} MB", std::ceil(bytes / 1e6)) : fmt::format("{:.1f} GB", bytes / 1e9);
}

}  // namespace

double memory_needed(const Scene& scene, double pixels, int samples, Work work) {
    const Terms& t      = work == Work::picture ? kPicture : kComparison;
    const double lights = static_cast<double>(scene.lights.size());
    const double points = samples > 1 ? pixels * samples : 0;
    return kProgram + t.triangle * static_cast<double>(scene.triangles.size()) +
           pixels * (t.pixel + t.pixel_light * lights) + points * (t.sample + t.sample_light * lights);
}

void check_memory(const Scene& scene, const std::filesystem::path& file, int width, int height, int samples,
                  Work work) {
    const double reserved = std::isinf(address_space_limit()) ? 0 : kReserved + kReservedByThread * thread_count();
    const double needed   = memory_needed(scene, double(width) * height, samples, work) + reserved;
    const double usable   = usable_memory();
    if (needed <= usable) return;
    throw InputError(fmt::format(
        "{}: {} x {} pixels with {} samples each, {} lights and {} triangles need about {} of memory, and {} may be "
        "used; a smaller --size or fewer --pixel-samples need less",
        file.string(), width, height, samples, scene.lights.size(), scene.triangles.size(), in_units(needed),
        in_units(usable)));
}

}  // namespace umbra
