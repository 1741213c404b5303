#include "umbra/bench/lab/prepare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "umbra/bench/lab/antialias.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/memory.h"
#include "umbra/core/base/number_from.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/off_pixel.h"
#include "umbra/core/scene/view_facts.h"

namespace umbra {
namespace {

constexpr long kMaxArea = 1L << 26;

void warn_of_points_off_their_pixels(Scene& scene, const PointBatch& points) {
    const OffPixel off = off_pixel(scene, points);
    if (off.points == 0) return;
    const auto surface = points.size() - static_cast<std::size_t>(std::ranges::count(points.triangle, kNoTriangle));
    scene.warnings.push_back(
        fmt::format("{} of {} surface points lie more than half a pixel off their pixels, up to {:.3g} pixels: their "
                    "triangles are so large that the floats that name a point on them step over pixels. All methods "
                    "answer for the same points, but edge bands and displacements in pixels are not to be trusted.",
                    off.points, surface, off.worst));
}

/// Some point of the picture is reached by the light, if nothing occludes it.
bool adds_anything(const Light& light, LightId id, const PointBatch& points) {
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points.faces(id, i) && falloff(light, points.position(i)) > 0) return true;
    return false;
}

/// What only a picture shows: a camera that sees nothing, and lights for which S_j is computed in vain.
void warn_of_picture(Scene& scene, const PointBatch& points) {
    const auto& seen = points.triangle;
    const bool empty = std::all_of(seen.begin(), seen.end(), [](TriangleId t) { return t == kNoTriangle; });
    if (empty) scene.warnings.emplace_back("the camera sees nothing: no primary ray meets a surface");
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        const Light& light = scene.lights[j];
        if (light.diffuse == vec3(0) && light.specular == vec3(0))
            scene.warnings.push_back(fmt::format(
                "Light \"{}\" has intensity 0: it adds nothing, and S_j is computed for it as for the others.",
                light.name));
        else if (!empty && !adds_anything(light, j, points))
            scene.warnings.push_back(
                fmt::format("Light \"{}\" adds nothing to this picture: no surface point that the camera sees faces it "
                            "within its range and cone.",
                            light.name));
    }
}

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

/// About the most that rendering or comparing holds at one time, bytes, for a picture of `pixels` with `samples` points
/// each.
double memory_needed(const Scene& scene, double pixels, int samples, Work work) {
    const Terms& t      = work == Work::picture ? kPicture : kComparison;
    const double lights = static_cast<double>(scene.lights.size());
    const double points = samples > 1 ? pixels * samples : 0;
    return kProgram + t.triangle * static_cast<double>(scene.triangles.size()) +
           pixels * (t.pixel + t.pixel_light * lights) + points * (t.sample + t.sample_light * lights);
}

}  // namespace

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

void pass_warnings(const Scene& scene, const std::function<void(const std::string&)>& receive) {
    if (!receive) return;
    for (const std::string& warning : scene.warnings) receive(fmt::format("{}: {}", scene.name, warning));
}

Size parse_size(const std::string& text) {
    const auto [width, height] = two_numbers_from<int>(text, "x").value_or(std::pair(0, 0));
    if (std::min(width, height) < 1 || std::max(width, height) > kMaxPictureSide ||
        static_cast<long>(width) * height > kMaxArea)
        throw UsageError(fmt::format(
            "--size {}: not a size, expected WIDTHxHEIGHT, each 1 to {}, at most {} pixels, whose comparison takes "
            "{:.0f} GB",
            text, kMaxPictureSide, kMaxArea, memory_needed({}, double(kMaxArea), 1, Work::comparison) / 1e9));
    return {width, height};
}

PreparedScene prepare_scene(const std::filesystem::path& file, Size size, int pixel_samples, Work work) {
    static_cast<void>(samples_along_side(pixel_samples));  // a wrong number is no reason to read a mesh
    Scene scene;
    const double load_ms = timed_ms([&] { scene = load_scene(file); });
    PreparedScene p      = prepare_scene(std::move(scene), file, size, pixel_samples, work);
    p.load_ms            = load_ms;
    return p;
}

PreparedScene prepare_scene(Scene scene, const std::filesystem::path& file, Size size, int pixel_samples, Work work,
                            const KnownGeometry* known) {
    PreparedScene p;
    p.pixel_side = samples_along_side(pixel_samples);
    p.scene      = std::move(scene);
    if (size.width == 0) size = {p.scene.width, p.scene.height};
    if (static_cast<long>(size.width) * size.height > kMaxArea)
        throw InputError(fmt::format("{}: the picture is {} x {}, expected at most {} pixels (set --size)",
                                     file.string(), size.width, size.height, kMaxArea));
    check_memory(p.scene, file, size.width, size.height, pixel_samples, work);
    p.facts_ms = timed_ms([&] {
        p.facts = known != nullptr ? known->facts : find_facts(p.scene);
        if (known != nullptr) update_view_facts(p.scene, p.facts);
    });
    std::optional<RayScene> built;
    if (known == nullptr) p.rays_build_ms = timed_ms([&] { built.emplace(p.scene); });
    const RayScene& rays = known != nullptr ? known->rays : *built;
    p.gbuffer_ms = timed_ms([&] { p.points = primary_points(rays, p.scene, p.scene.camera, size.width, size.height); });
    if (p.pixel_side > 1) p.subpixels = subpixel_points(rays, p.scene, size.width, size.height, p.pixel_side);
    warn_of_picture(p.scene, p.points);
    warn_of_points_off_their_pixels(p.scene, p.points);
    return p;
}

}  // namespace umbra
