#include "umbra/shadows/exact/viewpoint.h"

#include <algorithm>

#include "umbra/core/base/predicates.h"

namespace umbra::exact_visibility {

bool Viewpoint::surely_coplanar(TriangleId t) const {
    return coplanar_.own == own_ && std::any_of(coplanar_.known.begin(), coplanar_.known.end(),
                                                [&](const auto& other) { return other == std::pair(t, true); });
}

int Viewpoint::side_of(TriangleId t) const {
    if (t == own_) return 0;
    const vec3 a = scene_.vertex(t, 0), b = scene_.vertex(t, 1), c = scene_.vertex(t, 2);
    if (const Filtered<int> s = point_.quick_side(a, b, c)) return *s;
    // Most often t lies in the plane of the point's own triangle, and does so for all its points.
    if (coplanar_.own != own_) {
        coplanar_.own = own_;
        coplanar_.known.clear();
    }
    for (const auto& [other, coplanar] : coplanar_.known)
        if (other == t) return coplanar ? 0 : point_.exact_side(a, b, c);
    const vec3 x = scene_.vertex(own_, 0), y = scene_.vertex(own_, 1), z = scene_.vertex(own_, 2);
    const bool coplanar =
        side_of_plane(x, y, z, a) == 0 && side_of_plane(x, y, z, b) == 0 && side_of_plane(x, y, z, c) == 0;
    coplanar_.known.emplace_back(t, coplanar);
    return coplanar ? 0 : point_.exact_side(a, b, c);
}

}  // namespace umbra::exact_visibility
