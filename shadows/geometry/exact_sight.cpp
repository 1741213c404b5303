#include "umbra/shadows/geometry/exact_sight.h"

#include "umbra/core/render/facing.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/geometry/exact_contacts.h"
#include "umbra/shadows/geometry/exact_segment.h"

namespace umbra {

using exact_visibility::Contacts;
using exact_visibility::ExactPoint;
using exact_visibility::Segment;

bool ExactSight::is_lit(const PointBatch& points, std::size_t i, const Light& light) const {
    const TriangleId own = points.triangle[i];
    const int side       = side_of_light(light, scene_.vertex(own, 0), scene_.vertex(own, 1), scene_.vertex(own, 2));
    if (points.flipped[i] ? side >= 0 : side <= 0) return false;

    const ExactPoint point(scene_, own, points.u[i], points.v[i]);
    const Segment segment(point, light);
    std::optional<Contacts> touched;
    bool is_crossed = false;
    tree().visit(segment.piece(), [&](TriangleId t) {
        if (t == own || !scene_.blocks(t)) return true;
        const vec3 a = scene_.vertex(t, 0), b = scene_.vertex(t, 1), c = scene_.vertex(t, 2);
        if (is_degenerate(a, b, c)) return true;
        const Segment::Meeting meeting = segment.meeting(a, b, c);
        is_crossed |= meeting == Segment::Meeting::crosses;
        if (meeting == Segment::Meeting::touches) {
            if (!touched) touched.emplace(segment);
            touched->add(a, b, c, vec3(0));
        }
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
