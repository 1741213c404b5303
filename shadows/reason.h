// Why a method gave one answer: which triangle blocks the point, where, by how much, and the values that it compared.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

enum class PointVerdict : std::uint8_t { lit, penumbra, umbra, on_boundary, undefined };
[[nodiscard]] std::string_view to_string(PointVerdict verdict);  ///< "lit", "penumbra", ...

/// One thing that a method looked at, by its name in the field: "texel", "stored depth", "samples hit".
struct Evidence {
    std::string name;
    std::variant<double, std::string> value;
    std::string unit{};  ///< of a number: "world", "texels", "samples"; empty for a pure one
};

/// A point's answer, as `visibility` wrote it.
struct Given {
    float s       = 0;
    Answer answer = Answer::given;
};

/// A sample of a light with an area that the answer counts.
struct LightSample {
    dvec3 at;  ///< world space, on the light; of a sphere on the disk that the point sees of it
    bool seen = false;
};

struct Reason {
    PointVerdict verdict = PointVerdict::lit;
    TriangleId blocker   = kNoTriangle;  ///< one that blocks; none where the point is lit, or none can be named
    std::optional<double> at{};          ///< where the segment from the point (0) to `towards` (1) meets the blocker
    dvec3 towards{0};    ///< a point of the light, world space. For a directional light where the segment
                         ///< leaves the scene
    double margin = 0;   ///< distance of the answer from the opposite one: > 0 lit, < 0 umbra; of a
                         ///< penumbra the sign of S_j - 1/2
    std::string unit{};  ///< of the margin: "world", "texels", "layers", "samples", "of the light"
    std::vector<Evidence> evidence{};
    std::vector<LightSample> samples{};  ///< empty where none were taken
    std::vector<std::array<dvec3, 2>>
        silhouette{};            ///< edges from which the blocker's object extrudes the sides of its
                                 ///< volumes, world space; empty where it names none
    std::vector<dvec3> texel{};  ///< corners of the map's texel on the plane of the point, in turn, world space; empty
                                 ///< where no texel was compared
};

[[nodiscard]] PointVerdict verdict_of(Given given);

/// The end of the segment from p to the light, world space: its position, the centre of an area light; of a directional
/// light the position where the segment leaves the scene.
[[nodiscard]] dvec3 segment_end(const Scene& scene, const Light& light, dvec3 p);

/// Where the segment from p to q passes through the triangle, in (0, 1); in double.
[[nodiscard]] std::optional<double> crossing(const Scene& scene, TriangleId t, dvec3 p, dvec3 q);

/// The reason that geometry alone gives for the answer at point i, which asks for the light; `blocker` as the method
/// names it. The margin of a hard light is a length in the world: where lit, the least distance of the segment from
/// triangles that block and that do not touch the point's own; where blocked, the distance of the crossing from the
/// blocker's nearest edge. Elsewhere it is S_j - 1/2, of the light.
[[nodiscard]] Reason reason_by_geometry(const Scene& scene, const PointBatch& points, std::size_t i, LightId light,
                                        Given given, TriangleId blocker);

/// Adds the samples of a light that the answer counts; their fraction is S_j. The margin becomes the number of samples
/// seen beyond half of them.
void add_samples(Reason& reason, int samples, Given given);

}  // namespace umbra
