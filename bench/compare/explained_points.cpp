#include "umbra/bench/compare/explained_points.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "umbra/bench/pages/error_palette.h"
#include "umbra/core/scene/camera.h"

namespace umbra {
namespace {

/// How many points of the class there are in the 7 x 7 pixels around a point.
int neighbours(const ClassPlane& classes, const CameraFrame& picture, std::size_t i) {
    const int width = picture.width, x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
    int count = 0;
    for (int row = std::max(0, y - 3); row <= std::min(picture.height - 1, y + 3); ++row)
        for (int column = std::max(0, x - 3); column <= std::min(width - 1, x + 3); ++column)
            if (classes[static_cast<std::size_t>(row * width + column)] == classes[i]) ++count;
    return count;
}

/// Nothing where no point is of the class.
std::optional<std::size_t> telling_point(const CameraFrame& picture, const VisibilityPlane& s,
                                         const VisibilityPlane& truth, const ClassPlane& classes, ErrorClass of) {
    std::optional<std::size_t> best;
    float most = 0;
    int around = 0;
    for (std::size_t i = 0; i < classes.size(); ++i) {
        if (classes[i] != of) continue;
        const float error = std::abs(s.s[i] - truth.s[i]);
        if (best && error < most) continue;
        const int count = neighbours(classes, picture, i);
        if (best && error == most && count <= around) continue;
        best = i, most = error, around = count;
    }
    return best;
}

/// A polygon as the picture shows it, pixels; what lies behind a perspective eye is cut off.
std::vector<std::vector<double>> seen(const CameraFrame& picture, std::span<const dvec3> corners, double nearest) {
    const auto depth = [&](dvec3 p) { return glm::dot(p - picture.eye, picture.forward); };
    const bool cut   = picture.projection == Projection::perspective;
    std::vector<std::vector<double>> places;
    const auto add = [&](dvec3 p) {
        const dvec3 at = picture.project(p);
        places.push_back({0.01 * std::round(100 * at.x), 0.01 * std::round(100 * at.y)});
    };
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const dvec3 a = corners[k], b = corners[(k + 1) % corners.size()];
        const double before = depth(a) - nearest, after = depth(b) - nearest;
        if (!cut || before >= 0) add(a);
        if (cut && (before < 0) != (after < 0)) add(a + before / (before - after) * (b - a));
    }
    return places;
}

}  // namespace

std::vector<ExplainedPointRecord> explained_points(const Scene& scene, const PointBatch& points, LightId light,
                                                   const MethodRun& method, const MethodRun& truth,
                                                   const ClassPlane& classes) {
    std::vector<ExplainedPointRecord> all;
    const CameraFrame& picture = *points.raster;
    for (const ErrorColour& row : kErrorPalette) {
        if (!row.interior) continue;
        const auto found = telling_point(picture, method.planes[light], truth.planes[light], classes, row.error_class);
        if (!found) continue;
        const std::size_t i = *found;
        ExplainedPointRecord record{.error_class = std::string(row.key),
                                    .pixel = {static_cast<int>(i) % picture.width, static_cast<int>(i) / picture.width},
                                    .on    = triangle_record(scene, points.triangle[i]),
                                    .method = answer_record(*method.work, points, i, light),
                                    .truth  = answer_record(*truth.work, points, i, light)};
        add_difference(record.method, record.truth, scene, points, i, light);
        const dvec3 p        = exact_position(scene, points, i);
        const double nearest = 1e-3 * glm::dot(p - picture.eye, picture.forward);
        const auto triangle  = [&](const AnswerRecord& answer) {
            if (!answer.blocker) return std::vector<std::vector<double>>{};
            const TriangleId t = answer.blocker->triangle;
            return seen(picture,
                         std::array{dvec3(scene.vertex(t, 0)), dvec3(scene.vertex(t, 1)), dvec3(scene.vertex(t, 2))},
                         nearest);
        };
        const auto place = [](const std::vector<double>& v) { return dvec3(v[0], v[1], v[2]); };
        if (record.truth.answered) record.segment = seen(picture, std::array{p, place(record.truth.towards)}, nearest);
        record.method_blocker = triangle(record.method);
        record.truth_blocker  = triangle(record.truth);
        std::vector<dvec3> texel;
        for (const auto& corner : record.method.texel) texel.push_back(place(corner));
        record.texel = seen(picture, texel, nearest);
        // Thousands of numbers, which `umbra why` and `umbra view` show.
        for (AnswerRecord* answer : {&record.method, &record.truth})
            answer->samples.clear(), answer->silhouette.clear();
        all.push_back(std::move(record));
    }
    return all;
}

}  // namespace umbra
