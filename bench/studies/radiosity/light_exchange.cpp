#include "umbra/bench/studies/radiosity/light_exchange.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/lab/at_work.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/render/shade.h"
#include "umbra/shadows/radiosity/exchange.h"
#include "umbra/shadows/radiosity/radiosity.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

constexpr vec3 kNoSurface = vec3(24, 24, 32) / 255.0f;
constexpr double kLeast   = 1e-6;  ///< of form factors, in their picture

/// R G B of each point with a surface.
template <class Colour>
Image picture(const PointBatch& points, vec3 elsewhere, const Colour& colour) {
    Image image(points.raster->width, points.raster->height, {"R", "G", "B"});
    for (std::size_t i = 0; i < points.size(); ++i) {
        const vec3 c = points.triangle[i] == kNoTriangle ? elsewhere : vec3(colour(i));
        for (int k = 0; k < 3; ++k) image.at(i, static_cast<std::size_t>(k)) = c[k];
    }
    return image;
}

/// Neighbours have colours that differ.
vec3 colour_of(std::uint64_t name) {
    name = (name ^ (name >> 31)) * 0x9e3779b97f4a7c15u;
    name ^= name >> 29;
    const auto part = [&](int shift) { return 0.35f + 0.6f * static_cast<float>(name >> shift & 255) / 255; };
    return {part(8), part(24), part(40)};
}

void write_light(const PreparedScene& prepared, const Exchange& exchange, const fs::path& folder) {
    const Scene& scene             = prepared.scene;
    const PointBatch& points       = prepared.points;
    const std::vector<vec3> bounce = exchange.indirect_at(points);
    const Image direct =
        picture(points, scene.background, [&](std::size_t i) { return exchange.direct(exchange.side_at(points, i)); });
    const Image added = picture(points, vec3(0), [&](std::size_t i) { return bounce[i]; });
    Image both        = direct;
    for (std::size_t k = 0; k < both.data.size(); ++k) both.data[k] += added.data[k];
    const auto write = [&](const char* name, const Image& linear) {
        write_image(folder / name, displayed(linear, scene.tone, scene.exposure));
    };
    write("direct.png", direct), write("indirect.png", added), write("both.png", both);
}

/// The elements of S_j of each light, as bright as it is.
std::vector<LightElementsRecord> write_elements(const PreparedScene& prepared, const ExchangeOptions& options,
                                                const fs::path& folder) {
    const Scene& scene       = prepared.scene;
    const PointBatch& points = prepared.points;
    MethodChoice choice(find_method("radiosity"));
    choice.settings.set("size", options.size);
    choice.settings.set("samples", options.light_samples);
    MethodAtWork radiosity(choice, scene, prepared.facts);
    radiosity.look(points);
    std::vector<LightElementsRecord> written;
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        VisibilityPlane plane(points.size());
        radiosity.visibility(light, plane.out());
        const auto& elements   = as<RadiosityElements>(radiosity.aimed(light));
        const std::string file = fmt::format("elements_{}.png", light + 1);
        write_image(folder / file, picture(points, kNoSurface, [&](std::size_t i) {
                        const auto [patch, leaf] = elements.element(points, i);
                        return (0.25f + 0.75f * plane.s[i]) * colour_of(std::uint64_t{patch} << 32 | leaf);
                    }));
        written.push_back({scene.lights[light].name, file});
    }
    return written;
}

}  // namespace

ExchangeRecord exchange_light(const PreparedScene& prepared, const ExchangeOptions& options, const fs::path& folder) {
    const PointBatch& points = prepared.points;
    ExchangeRecord record{.head = head_record(options.command), .scene = scene_record(prepared.scene)};
    Exchange exchange(prepared.scene, {options.size, options.light_samples});
    record.patch_size = options.size, record.patches = exchange.patches();
    record.unshot          = {exchange.unshot()};
    Exchange::SideId first = 0;
    int steps              = 0;
    while (steps < options.steps && exchange.unshot() > options.until) {
        const Exchange::SideId from = exchange.shoot();
        if (steps == 0) first = from;
        record.unshot.push_back(exchange.unshot());
        if (++steps % 16 == 0 && options.progress)
            options.progress(
                fmt::format("{} of at most {} steps, {:.1f} % unshot", steps, options.steps, 100 * exchange.unshot()));
    }
    record.steps = static_cast<std::uint64_t>(steps), record.arrived = exchange.arrived();
    write_light(prepared, exchange, folder);
    write_image(folder / "patches.png",
                picture(points, kNoSurface, [&](std::size_t i) { return colour_of(exchange.side_at(points, i)); }));
    write_image(folder / "form_factors.png", picture(points, kNoSurface, [&](std::size_t i) {
                    const Exchange::SideId here = exchange.side_at(points, i);
                    if (here / 2 == first / 2) return vec3(1, 0.6f, 0);
                    const double factor = exchange.form_factor(here, first);
                    return vec3(factor > kLeast ? static_cast<float>(1 - std::log10(factor) / std::log10(kLeast)) : 0);
                }));
    record.pictures = {"direct.png", "indirect.png", "both.png", "patches.png", "form_factors.png"};
    record.elements = write_elements(prepared, options, folder);
    return record;
}

}  // namespace umbra
