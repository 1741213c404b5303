#include "umbra/shadows/geometry/exact_sight.h"

#include "umbra/shadows/geometry/exact_contacts.h"

namespace umbra {

using exact_visibility::Contacts;
using exact_visibility::ExactPoint;
using exact_visibility::Segment;

bool ExactSight::is_lit(const PointBatch& points, std::size_t i, const Light& light) const {
    const TriangleId own = points.triangle[i];
    const int side       = side_of_light(scene_, light, own);
    if (points.flipped[i] ? side >= 0 : side <= 0) return false;

    const ExactPoint point(scene_, points, i);
    const Segment segment(point, light);
    std::optional<Contacts> touched;
    bool is_crossed = false;
    visit_met(
        tree(), scene_, segment, [&](TriangleId t) { return t != own && occludes(scene_, t); },
        [&](TriangleId t, Segment::Meeting met) {
            is_crossed = met == Segment::Meeting::crosses;
            if (!is_crossed) add_contact(touched, segment, scene_, t);
            return !is_crossed;
        });
    return !is_crossed && (!touched || touched->together().passed != vec3(0));
}

const TriangleTree& ExactSight::tree() const {
    const std::lock_guard lock(mutex_);
    if (!tree_) tree_.emplace(scene_);
    return *tree_;
}

std::size_t ExactSight::memory_bytes() const {
    const std::lock_guard lock(mutex_);
    return tree_ ? tree_->memory_bytes() : 0;
}

}  // namespace umbra
