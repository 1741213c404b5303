// How wrong the visible area is where the corners of edges are rounded.
//
//        b'----b         Move the ends of an edge from where they belong, a and b, to where they came to lie, a' and
//       /     /          b'. The number of layers over a point changes only while an edge passes over it, so the area
//      /     /           is wrong by no more than what all edges pass over. An edge whose ends move by at most delta
//     a'----a            in x and in y passes over less than 3 delta length + 8 delta^2. (Ends that are cut off around
//                        the light move along their edge, too, but out there.)
#pragma once

#include <algorithm>

namespace umbra::exact_visibility {

struct Displacement {
    double swept    = 0;  ///< area that the edges pass over
    double by_frame = 0;  ///< the part of it that no other arithmetic changes
    double widest   = 0;  ///< the most that an end moves by itself

    /// The ends move by `own` each by itself, and by `frame` since the light's plane itself is rounded. The layers are
    /// counted and the edges projected in that one plane, so that the two agree whatever `frame` is.
    void move_edge(double own, double frame, double length) {
        const double delta = own + frame;
        swept += 3 * delta * length + 8 * delta * delta;
        by_frame += 3 * frame * length + 8 * frame * frame;
        widest = std::max(widest, own);
    }
};

}  // namespace umbra::exact_visibility
