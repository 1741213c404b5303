#include "umbra/bench/compare/pictures.h"

#include <algorithm>
#include <array>

#include "umbra/bench/pages/error_palette.h"

namespace umbra {
namespace {

constexpr vec3 kNoSurface = vec3(24, 24, 32) / 255.0f;

vec3 hatched(std::size_t x, std::size_t y) {
    return (x + y) / 4 % 2 ? vec3(0.42f, 0.45f, 0.55f) : vec3(0.30f, 0.33f, 0.42f);
}

/// Piecewise linear through evenly spaced colours, t in [0, 1].
template <std::size_t N>
vec3 ramp(const std::array<vec3, N>& colours, float t) {
    const float x       = std::clamp(t, 0.0f, 1.0f) * (N - 1);
    const std::size_t k = std::min<std::size_t>(static_cast<std::size_t>(x), N - 2);
    return glm::mix(colours[k], colours[k + 1], x - static_cast<float>(k));
}

constexpr std::array<vec3, 5> kDifference = {vec3(0x05, 0x30, 0x61) / 255.0f, vec3(0x43, 0x93, 0xc3) / 255.0f,
                                             vec3(0xf7, 0xf7, 0xf7) / 255.0f, vec3(0xd6, 0x60, 0x4d) / 255.0f,
                                             vec3(0x67, 0x00, 0x1f) / 255.0f};
constexpr std::array<vec3, 5> kError      = {vec3(0, 0, 0.02f), vec3(0.32f, 0.07f, 0.49f), vec3(0.72f, 0.21f, 0.47f),
                                             vec3(0.99f, 0.54f, 0.38f), vec3(0.99f, 0.99f, 0.75f)};

// The ground on which wrong points show: greys that no class has.
constexpr vec3 kAway       = vec3(0x30, 0x30, 0x34) / 255.0f;
constexpr vec3 kRightUmbra = vec3(0x6e, 0x6e, 0x72) / 255.0f;
constexpr vec3 kRightLit   = vec3(0xf2, 0xf2, 0xf2) / 255.0f;

constexpr int hex_digit(char c) { return c <= '9' ? c - '0' : c - 'a' + 10; }

/// "#rrggbb" of the palette, sRGB as pictures are written.
vec3 colour_of(ErrorClass c) {
    vec3 rgb(1, 0, 1);
    for (const ErrorColour& entry : kErrorPalette)
        if (entry.error_class == c)
            for (std::size_t k = 0; k < 3; ++k)
                rgb[static_cast<int>(k)] =
                    static_cast<float>(16 * hex_digit(entry.srgb[1 + 2 * k]) + hex_digit(entry.srgb[2 + 2 * k])) / 255;
    return rgb;
}

/// One colour a pixel.
template <class Colour>
Image picture(int width, int height, const Colour& colour) {
    Image image(width, height, {"R", "G", "B"});
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const vec3 c = colour(i, i % static_cast<std::size_t>(width), i / static_cast<std::size_t>(width));
        for (int k = 0; k < 3; ++k) image.at(i, static_cast<std::size_t>(k)) = c[k];
    }
    return image;
}

}  // namespace

Image visibility_picture(const PointBatch& points, const VisibilityPlane& plane) {
    return picture(points.raster->width, points.raster->height, [&](std::size_t i, std::size_t x, std::size_t y) {
        if (points.triangle[i] == kNoTriangle) return kNoSurface;
        return plane.defined(i) ? vec3(plane.s[i]) : hatched(x, y);
    });
}

Image difference_picture(const PointBatch& points, LightId light, const VisibilityPlane& plane,
                         const VisibilityPlane& reference) {
    return picture(points.raster->width, points.raster->height, [&](std::size_t i, std::size_t x, std::size_t y) {
        if (points.facing[light][i] == Facing::none) return kNoSurface;
        if (!plane.defined(i) || !reference.defined(i)) return hatched(x, y);
        return ramp(kDifference, 0.5f + 0.5f * (plane.s[i] - reference.s[i]));
    });
}

Image class_picture(const PointBatch& points, const ClassPlane& classes, const VisibilityPlane& reference) {
    return picture(points.raster->width, points.raster->height, [&](std::size_t i, std::size_t x, std::size_t y) {
        switch (classes[i]) {
            case ErrorClass::no_surface: return kNoSurface;
            case ErrorClass::undefined: return hatched(x, y);
            case ErrorClass::away:
            case ErrorClass::terminator_away: return kAway;
            case ErrorClass::unshadowed: return kRightLit;
            case ErrorClass::not_judged: return 0.6f * glm::mix(kRightUmbra, kRightLit, reference.s[i]);
            case ErrorClass::right:
            case ErrorClass::terminator: return glm::mix(kRightUmbra, kRightLit, reference.s[i]);
            default: return colour_of(classes[i]);
        }
    });
}

Image flip_picture(const PointBatch& points, std::span<const VisibilityPlane> planes, std::span<const float> map) {
    return picture(points.raster->width, points.raster->height, [&](std::size_t i, std::size_t x, std::size_t y) {
        const bool answered = std::all_of(planes.begin(), planes.end(), [&](const auto& p) { return p.defined(i); });
        return answered || points.triangle[i] == kNoTriangle ? ramp(kError, map[i]) : hatched(x, y);
    });
}

}  // namespace umbra
