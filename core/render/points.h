// Surface points: where S_j is asked for. One batch is one list, structure of arrays.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "umbra/core/scene/camera.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// Which part of light j lies in front of the plane of the point's triangle (on the side of the batch's normal).
enum class Facing : std::uint8_t {
    none,       ///< no surface point here (the eye ray met nothing)
    away,       ///< the whole light is behind, or exactly in the plane: S_j = 0 for every method
    partly,     ///< an area light that the plane cuts
    front,      ///< all of the light is in front
    unshadowed  ///< some of the light is in front, and the object receives no shadows or the point lies in a sphere
                ///< light: S_j = 1 for every method
};

/// Whether methods are asked for S_j.
[[nodiscard]] constexpr bool is_asked(Facing facing) { return facing == Facing::partly || facing == Facing::front; }

/// Surface points. Triangle id and barycentrics name a point *exactly*: (1-u-v) a + u b + v c with u, v as stored,
/// u, v >= 0 and u + v <= 1 in exact arithmetic. The position is that point rounded to float once.
/// With a raster, point i is pixel (i % width, i / width) counted from the top left, and pixels that see nothing have
/// triangle == kNoTriangle; a batch without a raster may hold such entries too.
struct PointBatch {
    std::vector<TriangleId> triangle;
    std::vector<float> u, v;            ///< weights of the triangle's second and third vertex
    std::vector<float> px, py, pz;      ///< world position; 0 where there is no triangle
    std::vector<float> nx, ny, nz;      ///< unit geometric normal, turned towards the eye if the material is two-sided
    std::vector<std::uint8_t> flipped;  ///< 1 where that normal is against the triangle's winding
    std::optional<CameraFrame> raster;  ///< set for the primary batch
    vec3 eye{0};                        ///< where V points to, also for batches without a raster
    std::vector<std::vector<Facing>> facing;  ///< [light][point]; filled by face_lights
    std::vector<std::size_t> numbers;         ///< of a picked batch, see number(); else empty

    [[nodiscard]] std::size_t size() const { return triangle.size(); }
    /// The index of point i in the batch that it was picked from, or its own: what random numbers of the point depend
    /// on, so that it has the same ones whoever else is asked.
    [[nodiscard]] std::size_t number(std::size_t i) const { return numbers.empty() ? i : numbers[i]; }
    /// Whether S_j is asked of point i: some of the light is in front of its plane, and no rule makes it unshadowed.
    [[nodiscard]] bool asks(LightId light, std::size_t i) const { return is_asked(facing[light][i]); }
    /// S_j of point i for every method, where it is not asked.
    [[nodiscard]] float decided(LightId light, std::size_t i) const {
        return facing[light][i] == Facing::unshadowed ? 1.0f : 0.0f;
    }
    /// Whether some of the light is in front of the plane of point i.
    [[nodiscard]] bool faces(LightId light, std::size_t i) const { return facing[light][i] >= Facing::partly; }
    [[nodiscard]] vec3 position(std::size_t i) const { return {px[i], py[i], pz[i]}; }
    [[nodiscard]] vec3 normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
    void resize(std::size_t n);
};

/// Writes point i from its name: position, normal (if two-sided towards `batch.eye`, or against the view direction of
/// an orthographic raster). Clamps u, v into the triangle first. A degenerate triangle gives kNoTriangle.
void set_point(PointBatch& batch, std::size_t i, const Scene& scene, TriangleId t, float u, float v);

/// Point i from its name in double, world space: rounded from the exact point a few times, where position() is rounded
/// to float.
[[nodiscard]] dvec3 exact_position(const Scene& scene, const PointBatch& points, std::size_t i);

/// Some points of a batch, as they are, as a batch without a raster.
[[nodiscard]] PointBatch pick(const PointBatch& from, std::span<const std::uint32_t> which);

/// Fills batch.facing for all lights of the scene (or for one, where a light moved). Signs are exact: decided in
/// floating point with a proven bound, else in rationals. A light in the plane of the triangle is `away`.
void face_lights(PointBatch& batch, const Scene& scene);
void face_light(PointBatch& batch, const Scene& scene, LightId light);

}  // namespace umbra
