#include "umbra/bench/studies/motion/frame_errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "umbra/bench/lab/at_work.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/errors/error_causes.h"
#include "umbra/core/errors/visibility_error.h"

namespace umbra {

FrameTruth::FrameTruth(const Reference& reference, const Scene& scene, const SceneFacts& facts,
                       const PointBatch& points, std::uint64_t area_points)
    : scene_(&scene), points_(&points) {
    MethodAtWork work(reference.choice, scene, facts);
    PointBatch sampled;
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        const bool area = is_area(scene.lights[j].kind);
        if (area && !sampled_) {
            sampled_ = true;
            sample_  = stratified_sample(points, area_points);
            sampled  = pick(points, sample_);
        }
        const PointBatch& asked = area ? sampled : points;
        planes_.emplace_back(asked.size());
        if (!work.looks_at(asked)) work.look(asked);
        work.forget_aims();
        work.visibility(j, planes_.back().out());
        check_contract(reference.choice.info->name, planes_.back(), asked, j);
        terminator_.emplace_back(points.size(), ErrorClass::no_surface);
        for (std::size_t i = 0; i < points.size(); ++i)
            if (points.asks(j, i)) terminator_.back()[i] = ErrorClass::right;
        mark_terminator(terminator_.back(), scene, points, j);
    }
}

FrameErrors FrameTruth::errors(const std::vector<VisibilityPlane>& planes) const {
    FrameErrors errors;
    double squares = 0, most = 0;
    for (LightId j = 0; j < planes_.size(); ++j) {
        const bool area              = is_area(scene_->lights[j].kind);
        const VisibilityPlane &truth = planes_[j], &plane = planes.at(j);
        const float tolerance = visibility_tolerance(scene_->lights[j].kind);
        for (std::size_t k = 0; k < truth.size(); ++k) {
            const std::size_t i = area ? sample_[k] : k;
            if (!points_->asks(j, i) || truth.answer[k] != Answer::given) continue;
            if (!plane.defined(i)) {
                ++errors.undefined;
                continue;
            }
            const double difference = std::abs(static_cast<double>(plane.s[i]) - static_cast<double>(truth.s[k]));
            ++errors.points;
            squares += difference * difference;
            most = std::max(most, difference);
            errors.wrong += terminator_[j][i] == ErrorClass::right &&
                            difference > static_cast<double>(tolerance + truth.half_width[k]);
        }
    }
    if (errors.points > 0) errors.rmse = std::sqrt(squares / static_cast<double>(errors.points)), errors.max = most;
    if (!sampled_) {
        errors.interior = 0;
        for (LightId j = 0; j < planes_.size(); ++j) {
            ClassPlane classes =
                error_classes(*points_, j, planes.at(j), planes_[j], visibility_tolerance(scene_->lights[j].kind));
            mark_terminator(classes, *scene_, *points_, j);
            const VisibilityError e = count_errors(*points_, classes, planes.at(j), planes_[j]);
            *errors.interior += e.false_shadow.interior + e.false_light.interior;
        }
    }
    return errors;
}

}  // namespace umbra
