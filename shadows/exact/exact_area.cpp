// The share of an area light that a point sees is the part of the light over which no triangle lies, seen from the
// point, over the whole: a covering of the light's plane by projected triangles (shadows/covering.h).
//
// Where the covering changes is at silhouettes: edges whose triangles, each with the sign of its orientation as seen
// from the point, do not cancel. These signs are exact. So is the number of layers at one place of the light, which is
// counted with a ray. In between stands a chain of edges that closes whatever the rounding of its corners, since each
// corner is projected by itself alone.
//
// How wrong the area is where corners are projected in double. Move the corners from where they belong to where they
// came to lie: the number of layers over a place changes only while an edge passes over it. An edge whose ends move by
// at most delta in x and in y passes over less than 3 delta length + 8 delta^2. (Ends that are cut off around the light
// move along their edge, too, but out there.) The sweep rounds a width a few times for each edge in each row. Where the
// sum is not below kTrusted of the light's area, or a sign remains open, the point is done in rationals.
//
// This work is based on:
// Samuli Laine et al. Soft Shadow Volumes for Ray Tracing. 2005
#include "umbra/shadows/exact/exact_area.h"

#include <cmath>
#include <numeric>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/render/sampling.h"

namespace umbra {
namespace {

constexpr double kTrusted =
    0x1p-28;  ///< in area, of a light of 4: below 1e-9 of it, and far below half an ulp of a float

constexpr double kCut    = 1.0625;  ///< edges are cut off where |x| or |y| exceeds this, ...
constexpr double kGather = 1.125;   ///< ... and looked for up to here

// A disk lies between its inscribed polygon of kChords corners and the circle. Chord k and the circle enclose cap k.
// Where no edge comes near a cap, the light there is seen or hidden as it is along the chord; all others are left open.
constexpr int kChords = 128;
const double kCapArea = (kPi - kChords / 2.0 * std::sin(2 * kPi / kChords)) / kChords;

template <class T>
std::vector<LightCorner<T>> square_corners() {
    return {{T(-1), T(-1)}, {T(1), T(-1)}, {T(1), T(1)}, {T(-1), T(1)}};
}

template <class T>
const std::vector<LightCorner<T>>& whole_light(bool round) {
    static const std::vector<LightCorner<T>> square = square_corners<T>();
    static const std::vector<LightCorner<T>> disk   = [] {
        std::vector<LightCorner<T>> corners;
        for (int k = 0; k < kChords; ++k) {
            const double angle = 2 * kPi * k / kChords, inside = 1 - 0x1p-50;
            corners.push_back({T(inside * std::cos(angle)), T(inside * std::sin(angle)), k});
        }
        return corners;
    }();
    return round ? disk : square;
}

/// Marks the caps of the unit disk that the way from (x0, y0) to (x1, y1) may pass.
void mark_caps(double x0, double y0, double x1, double y1, std::vector<std::uint8_t>& open) {
    constexpr double kSlack = 1e-6;
    const double inner = std::cos(kPi / kChords) - kSlack, outer = 1 + kSlack, step = 2 * kPi / kChords;
    const double dx = x1 - x0, dy = y1 - y0, dd = dx * dx + dy * dy;
    if (!(dd > 0)) return;
    // (x0, y0) + t (dx, dy) is at distance r from the centre where dd t^2 + 2 b t + c - r^2 = 0.
    const double b = x0 * dx + y0 * dy, nearest = std::abs(x0 * dy - y0 * dx) / std::sqrt(dd);
    if (nearest >= outer) return;
    const auto half_chord = [&](double r) { return std::sqrt(std::max(0.0, r * r - nearest * nearest) / dd); };
    const double foot = -b / dd, out = half_chord(outer), in = nearest < inner ? half_chord(inner) : 0;
    const auto mark = [&](double from, double to) {
        from = std::max(from, 0.0), to = std::min(to, 1.0);
        if (!(from <= to)) return;
        const double first = std::atan2(y0 + from * dy, x0 + from * dx);
        double turn        = std::atan2(y0 + to * dy, x0 + to * dx) - first;
        if (turn > kPi) turn -= 2 * kPi;
        if (turn < -kPi) turn += 2 * kPi;
        const int lowest  = static_cast<int>(std::floor((first + std::min(turn, 0.0) - kSlack) / step));
        const int highest = static_cast<int>(std::floor((first + std::max(turn, 0.0) + kSlack) / step));
        for (int k = lowest; k <= highest; ++k) open[static_cast<std::size_t>((k + 2 * kChords) % kChords)] = 1;
    };
    if (in > 0) {
        mark(foot - out, foot - in);
        mark(foot + in, foot + out);
    } else {
        mark(foot - out, foot + out);
    }
}

int sign_of(const Numerators<double>& a, const Numerators<double>& b, const Numerators<double>& c) {
    return sign_of_determinant(Entries{dvec3(a.x, a.y, a.w), a.error}, Entries{dvec3(b.x, b.y, b.w), b.error},
                               Entries{dvec3(c.x, c.y, c.w), c.error});
}
int sign_of(const Numerators<Rational>& a, const Numerators<Rational>& b, const Numerators<Rational>& c) {
    return sign_of_determinant(Rational3{a.x, a.y, a.w}, Rational3{b.x, b.y, b.w}, Rational3{c.x, c.y, c.w});
}
Numerators<double> operator-(const Numerators<double>& a, const Numerators<double>& b) {
    const Numerators<double> d{a.x - b.x, a.y - b.y, a.w - b.w, 0};
    return {d.x, d.y, d.w, a.error + b.error + kUnit * largest(dvec3(d.x, d.y, d.w))};
}
Numerators<Rational> operator-(const Numerators<Rational>& a, const Numerators<Rational>& b) {
    return {a.x - b.x, a.y - b.y, a.w - b.w, 0};
}

/// a + t (b - a), 0 <= t <= 1.
template <class T>
Numerators<T> between(const Numerators<T>& a, const Numerators<T>& b, const T& t) {
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.w + t * (b.w - a.w), std::max(a.error, b.error)};
}

/// Where the way from a, before the light's plane, to b, in or beyond it or the other way round, meets the plane.
Numerators<double> at_plane(const Numerators<double>& a, const Numerators<double>& b, double height) {
    const double rise = b.w - a.w, error = std::max(a.error, b.error);
    Numerators<double> cut = between(a, b, std::clamp((height - a.w) / rise, 0.0, 1.0));
    cut.w                  = height;
    // An error of the heights moves the cut along the way.
    const double length = std::max(std::abs(b.x - a.x), std::abs(b.y - a.y));
    cut.error = std::abs(rise) > 8 * error ? 2 * error + 4 * error * length / std::abs(rise) + 8 * kUnit * length
                                           : double(kInfinity);
    return cut;
}
Numerators<Rational> at_plane(const Numerators<Rational>& a, const Numerators<Rational>& b, const Rational& height) {
    return between(a, b, Rational((height - a.w) / (b.w - a.w)));
}

/// Places to count layers at, spread over the square without a pattern that a scene could share.
std::pair<double, double> place(int k) {
    const double x = (k + 1) * 0.7548776662466927, y = (k + 1) * 0.5698402909980532;
    return {1.9 * (x - std::floor(x)) - 0.95, 1.9 * (y - std::floor(y)) - 0.95};
}

}  // namespace

/// One point, and what is known of it whatever the arithmetic.
struct ExactArea::Query {
    const ExactPoint& point;
    TriangleId own;
    bool partly;
    int turn;
    const LightPlane& frame;
    Workspace& work;
};

/// Sign of det(a - p, b - p, c - p) of triangle t: the side of it that p is on. Exact.
int ExactArea::face_sign(const Query& query, TriangleId t) const {
    if (t == query.own) return 0;
    const vec3 a = scene_->vertex(t, 0), b = scene_->vertex(t, 1), c = scene_->vertex(t, 2);
    const int s = sign_of_determinant(query.point.to(a), query.point.to(b), query.point.to(c));
    if (s != kUnsure) return s;
    // Most often t lies in the plane of the point's own triangle, and does so for all its points.
    Workspace& work = query.work;
    if (work.own != query.own) {
        work.own = query.own;
        work.in_plane.clear();
    }
    for (const auto& [other, coplanar] : work.in_plane)
        if (other == t) return coplanar ? 0 : query.point.exact_side(a, b, c);
    const vec3 x = scene_->vertex(query.own, 0), y = scene_->vertex(query.own, 1), z = scene_->vertex(query.own, 2);
    const bool coplanar =
        side_of_plane(x, y, z, a) == 0 && side_of_plane(x, y, z, b) == 0 && side_of_plane(x, y, z, c) == 0;
    work.in_plane.emplace_back(t, coplanar);
    return coplanar ? 0 : query.point.exact_side(a, b, c);
}

/// How many more triangles lie to the left of the edge from a to b than to its right, seen from p with the world's
/// orientation.
int ExactArea::change_at(const Query& query, const CastEdge& edge) const {
    int change      = 0;
    const Entries d = query.point.to(at(edge.a));
    // A rounded unit normal is off by less than 2^-22 in each component.
    const double sure = 0x1p-20 * largest(d.value) + 4 * d.error;
    for (std::uint32_t k = 0; k < edge.count; ++k) {
        const EdgeUse& use = uses_[edge.first + k];
        const double over  = edge.count == 2 ? glm::dot(d.value, dvec3(edge.normal[k])) : 0;
        const int side     = use.triangle == query.own ? 0
                             : std::abs(over) > sure   ? (over > 0 ? 1 : -1)
                                                       : face_sign(query, use.triangle);
        change += use.forward ? side : -side;
    }
    return change;
}

ExactArea::Cone ExactArea::cone_of(vec3 axis, float half_angle) {
    return {axis, half_angle, std::sin(half_angle), std::cos(half_angle)};
}

ExactArea::Cone ExactArea::joined(const Cone& a, const Cone& b) {
    const vec3 sum     = a.axis + b.axis;
    const float length = glm::length(sum);
    if (a.half_angle > 1.5f || b.half_angle > 1.5f || length < 0.1f) return {};
    const vec3 axis  = sum / length;
    const auto reach = [&](const Cone& c) { return std::acos(std::min(1.0f, glm::dot(axis, c.axis))) + c.half_angle; };
    return cone_of(axis, std::max(reach(a), reach(b)) + 0x1p-20f);
}

ExactArea::Cone ExactArea::cone_of(const CastEdge& edge) const {
    const vec3 &n = edge.normal[0], &m = edge.normal[1];
    if (edge.count != 2 || n == vec3(0) || m == vec3(0)) return {};
    const bool alike = uses_[edge.first].forward != uses_[edge.first + 1].forward;
    return joined(cone_of(n, 0), cone_of(alike ? m : -m, 0));
}

/// Whether p surely is on one side of all triangles in the box: seen from there, none of their edges is a silhouette.
/// [Pedro Sander et al., Silhouette Clipping, 2000]
bool ExactArea::all_alike(const Cone& cone, const Box& box, dvec3 p) {
    if (cone.half_angle > 1.5f) return false;
    const dvec3 lo(box.min), hi(box.max);
    const dvec3 way       = 0.5 * (lo + hi) - p;
    const double distance = glm::length(way), radius = 0.5 * glm::length(hi - lo);
    if (!(distance > radius)) return false;
    // The ways to all places of the box, against the axis: within angle -+ (half_angle + asin(radius / distance)).
    const double sine = radius / distance, cosine = std::sqrt(1 - sine * sine);
    if (!(cosine > cone.sine)) return false;  // together a right angle or more
    const double beside = cone.sine * cosine + cone.cosine * sine;
    return std::abs(glm::dot(dvec3(cone.axis), way)) > (beside + 1e-5) * distance;
}

/// All edges that may lie over the light and before it, and where the covering changes.
void ExactArea::gather(const Query& query, const FloatSpace& space) const {
    query.work.changes.clear();
    const auto take = [&](std::uint32_t e) {
        const int change = change_at(query, edges_[e]);
        if (change != 0) query.work.changes.push_back({e, change});
        return true;
    };
    if (space.orientation() == kUnsure) {  // next to nothing is known of directions
        for (std::uint32_t e = 0; e < edges_.size(); ++e) take(e);
        return;
    }
    BoxTree::Region region;
    const dvec3 gx = space.gx(), gy = space.gy(), gw = space.gw() * kGather;
    region.planes = {
        {{gw + gx, 0}, {gw - gx, 0}, {gw + gy, 0}, {gw - gy, 0}, {-space.gw(), space.height() + space.height_error()}}};
    region.from      = query.point.rounded();
    region.slack     = 2 * query.point.slack();
    region.tilt      = 3 * space.g_error();
    const auto enter = [&](std::uint32_t node, const Box& box) { return !all_alike(cones_[node], box, region.from); };
    edge_tree_.front().visit(region, enter, take);
}

/// The share of the light that one point sees, in one arithmetic.
template <class Space>
class ExactArea::Share {
public:
    using T = typename Space::Number;

    Share(const ExactArea& area, const Query& query, const Space& space, Covering<T>& covering)
        : area_(area),
          query_(query),
          space_(space),
          covering_(covering),
          round_(area.light_.kind != LightKind::rectangle) {}

    /// Whether triangle t surely hides the whole light.
    [[nodiscard]] bool covers_all(TriangleId t) const;

    /// Nothing where doubles cannot tell.
    std::optional<Answer> find();

private:
    enum class Over : std::uint8_t { no, yes, unsure };

    [[nodiscard]] int beyond(std::uint32_t vertex, const Numerators<T>& q) const;
    [[nodiscard]] Over lies_over(TriangleId t, double x, double y, bool whole_triangle) const;
    [[nodiscard]] std::optional<int> layers_at(double x, double y) const;
    void cut_light(std::vector<LightCorner<T>>& corners);
    void add(const CastEdge& edge, int change);
    void add_chord(TriangleId t);
    void clip(const Numerators<T>& a, const Numerators<T>& b, int change);
    void count_error(double delta, double length);
    [[nodiscard]] bool is_clear(double x, double y) const;
    [[nodiscard]] std::optional<int> base_layers() const;
    [[nodiscard]] Answer answer(double open, double left_open, double error) const;

    const ExactArea& area_;
    const Query& query_;
    const Space& space_;
    Covering<T>& covering_;
    const bool round_;
    bool sure_     = true;
    double swept_  = 0;  ///< area that edges pass over as their ends move by what they are off
    double widest_ = 0;  ///< the most that an end is off
};

/// 1 where the vertex stands in or beyond the light's plane, 0 before it.
template <class Space>
int ExactArea::Share<Space>::beyond(std::uint32_t vertex, const Numerators<T>& q) const {
    if (!area_.plane_side_.empty()) return area_.plane_side_[vertex] * space_.orientation() >= 0 ? 1 : 0;
    return space_.beyond(q);
}

/// Whether the way from the point to the place (x, y) of the light passes through triangle t.
template <class Space>
typename ExactArea::Share<Space>::Over ExactArea::Share<Space>::lies_over(TriangleId t, double x, double y,
                                                                          bool whole_triangle) const {
    const Numerators<T> way{T(x), T(y), T(1), 0};
    const uvec3 vertex           = area_.topology_.triangles[t];
    const Numerators<T> corner[] = {space_.project(area_.at(vertex[0])), space_.project(area_.at(vertex[1])),
                                    space_.project(area_.at(vertex[2]))};
    // Three signs, of the way and two corners each: all must be as that of the three corners.
    int signs[3];
    for (int k = 0; k < 3; ++k) signs[k] = sign_of(way, corner[k], corner[(k + 1) % 3]);
    const auto one_is = [&](int s) { return signs[0] == s || signs[1] == s || signs[2] == s; };
    if (one_is(1) && one_is(-1)) return Over::no;
    const int side = space_.orientation() * area_.face_sign(query_, t);
    if (side == 0 || one_is(-side)) return Over::no;
    if (one_is(kUnsure) || one_is(0)) return Over::unsure;

    int before = 0;
    for (int k = 0; k < 3; ++k) {
        const int far = beyond(vertex[k], corner[k]);
        if (far == kUnsure) return Over::unsure;
        before += far == 0;
    }
    if (before == 3) return Over::yes;
    if (before == 0 || whole_triangle) return Over::no;
    // The way ends on the light's plane, and has passed the triangle where the two ends are on two sides of it.
    const Numerators<T> end{T(x) * space_.height(), T(y) * space_.height(), T(space_.height()), [&] {
                                if constexpr (std::is_same_v<T, double>)
                                    return space_.height_error() + 2 * kUnit * space_.height();
                                return 0.0;
                            }()};
    const int end_side = sign_of(corner[0] - end, corner[1] - end, corner[2] - end);
    return end_side == kUnsure || end_side == 0 ? Over::unsure : end_side == -side ? Over::yes : Over::no;
}

template <class Space>
bool ExactArea::Share<Space>::covers_all(TriangleId t) const {
    for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0})
            if (lies_over(t, x, y, true) != Over::yes) return false;
    return true;
}

/// How many triangles lie over the place (x, y) of the light. Remembers one that covers the light whole.
template <class Space>
std::optional<int> ExactArea::Share<Space>::layers_at(double x, double y) const {
    const ExactPoint& p      = query_.point;
    const Entries centre     = p.to(query_.frame.centre_from_corner);
    const dvec3 across       = x * query_.frame.u + y * query_.frame.v;
    const BoxTree::Piece way = {p.rounded(), centre.value + across, 1.0,
                                2 * p.slack() + centre.error + 8 * kUnit * (largest(centre.value) + largest(across))};
    int layers               = 0;
    bool sure                = true;
    area_.triangles_->visit(way, [&](TriangleId t) {
        if (t == query_.own || area_.topology_.degenerate[t]) return true;
        const Over over = lies_over(t, x, y, false);
        sure            = over != Over::unsure;
        layers += over == Over::yes;
        if (over == Over::yes && std::is_same_v<T, double> && covers_all(t)) query_.work.last = t;
        return sure;
    });
    return sure ? std::optional(layers) : std::nullopt;
}

/// Cuts off what lies behind the plane of the point's triangle.
template <class Space>
void ExactArea::Share<Space>::cut_light(std::vector<LightCorner<T>>& corners) {
    // Over the place (x, y) the light stands at height lx x + ly y + l over that plane.
    const Scene& scene = *area_.scene_;
    const vec3 a = scene.vertex(query_.own, 0), b = scene.vertex(query_.own, 1), c = scene.vertex(query_.own, 2);
    T lx, ly, l;
    double off = 0;
    if constexpr (std::is_same_v<T, double>) {
        const dvec3 ab = dvec3(b) - dvec3(a), ac = dvec3(c) - dvec3(a);
        const dvec3 m = glm::cross(ab, ac) * static_cast<double>(query_.turn);
        const dvec3 u = query_.frame.u, v = query_.frame.v;
        const Entries& centre = query_.frame.centre_from_corner;
        lx = glm::dot(m, u), ly = glm::dot(m, v), l = glm::dot(m, centre.value);
        const double m_size = largest(m), m_error = 10 * kUnit * largest(ab) * largest(ac);
        const double reach = largest(u) + largest(v) + largest(centre.value);
        const double error = 3 * (m_error * reach + m_size * centre.error) + 15 * kUnit * m_size * reach;
        const double slope = std::hypot(lx, ly);
        off                = slope > 0 ? 4 * error / slope : double(kInfinity);
    } else {
        const Rational3 centre = query_.frame.exact_centre ? *query_.frame.exact_centre - rational(a)
                                                           : rational(query_.frame.centre_from_corner.value);
        const Rational3 m      = cross(rational(b) - rational(a), rational(c) - rational(a));
        const T turn(query_.turn);
        lx = turn * dot(m, rational(query_.frame.u)), ly = turn * dot(m, rational(query_.frame.v));
        l = turn * dot(m, centre);
    }
    const auto height = [&](const LightCorner<T>& p) { return T(lx * p.x + ly * p.y + l); };
    std::vector<LightCorner<T>> kept;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const LightCorner<T>&p = corners[k], &q = corners[(k + 1) % corners.size()];
        const T hp = height(p), hq = height(q);
        if (hp > 0) kept.push_back(p);
        if ((hp > 0) == (hq > 0)) continue;
        const T t = hp / (hp - hq);
        // On the way out the plane's line begins, on the way in the rest of the light's own side.
        kept.push_back({T(p.x + t * (q.x - p.x)), T(p.y + t * (q.y - p.y)), hp > 0 ? -1 : p.cap});
    }
    corners = std::move(kept);

    const double x = as_double(lx), y = as_double(ly), slope = std::hypot(x, y);
    if (slope > 0) {
        const double distance = -as_double(l) / slope, nx = x / slope, ny = y / slope;
        if (round_)
            mark_caps(distance * nx - 2 * ny, distance * ny + 2 * nx, distance * nx + 2 * ny, distance * ny - 2 * nx,
                      query_.work.cap_open);
    }
    count_error(off + 2 * query_.frame.rounding, 3);
}

template <class Space>
void ExactArea::Share<Space>::count_error(double delta, double length) {
    swept_ += 3 * delta * length + 8 * delta * delta;
    widest_ = std::max(widest_, delta);
}

/// The part of an edge that stands before the light's plane.
template <class Space>
void ExactArea::Share<Space>::add(const CastEdge& edge, int change) {
    Numerators<T> a = space_.project(area_.at(edge.a)), b = space_.project(area_.at(edge.b));
    const int a_beyond = beyond(edge.a, a), b_beyond = beyond(edge.b, b);
    if (a_beyond == kUnsure || b_beyond == kUnsure) {
        sure_ = false;
        return;
    }
    if (a_beyond && b_beyond) return;
    if (a_beyond != b_beyond) (a_beyond ? a : b) = at_plane(a, b, space_.height());
    clip(a, b, change);
}

/// Where a triangle passes through the light's plane, its part before the plane ends with an edge in the plane.
template <class Space>
void ExactArea::Share<Space>::add_chord(TriangleId t) {
    const uvec3 vertex      = area_.topology_.triangles[t];
    const Numerators<T> q[] = {space_.project(area_.at(vertex[0])), space_.project(area_.at(vertex[1])),
                               space_.project(area_.at(vertex[2]))};
    int far[3];
    for (int k = 0; k < 3; ++k) far[k] = beyond(vertex[k], q[k]);
    if (far[0] == kUnsure || far[1] == kUnsure || far[2] == kUnsure) {
        sure_ = false;
        return;
    }
    if (far[0] == far[1] && far[1] == far[2]) return;
    const int side = space_.orientation() * area_.face_sign(query_, t);
    if (side == 0) return;
    Numerators<T> leaves{}, comes_back{};
    for (int k = 0; k < 3; ++k) {
        const int n = (k + 1) % 3;
        if (far[k] == far[n]) continue;
        // As the edge itself is cut, from its lower vertex, so that the ends are the same to the bit.
        const bool forward             = vertex[k] < vertex[n];
        (far[n] ? leaves : comes_back) = at_plane(forward ? q[k] : q[n], forward ? q[n] : q[k], space_.height());
    }
    clip(leaves, comes_back, side);
}

/// Cuts an edge off around the light and adds what is left.
template <class Space>
void ExactArea::Share<Space>::clip(const Numerators<T>& a, const Numerators<T>& b, int change) {
    const T reach(kCut);
    const T inside_a[] = {a.x + reach * a.w, reach * a.w - a.x, a.y + reach * a.w, reach * a.w - a.y};
    const T inside_b[] = {b.x + reach * b.w, reach * b.w - b.x, b.y + reach * b.w, reach * b.w - b.y};
    T from(0), to(1);
    int cut_from = -1, cut_to = -1;
    for (int k = 0; k < 4; ++k) {
        const bool out_a = inside_a[k] <= 0, out_b = inside_b[k] <= 0;
        if (out_a && out_b) return;
        if (!out_a && !out_b) continue;
        const T t = inside_a[k] / (inside_a[k] - inside_b[k]);
        if (out_a && t >= from) from = t, cut_from = k;
        if (out_b && t <= to) to = t, cut_to = k;
    }
    if (from >= to) return;
    const Numerators<T> low  = cut_from < 0 ? a : between(a, b, from);
    const Numerators<T> high = cut_to < 0 ? b : between(a, b, to);
    double delta             = 2 * query_.frame.rounding;
    if constexpr (std::is_same_v<T, double>) {
        // |x|, |y| <= kCut: a quotient is off by less than 3 errors over w; an end that is cut, by its cut, too.
        const double size =
            std::max({std::abs(a.x), std::abs(a.y), std::abs(a.w), std::abs(b.x), std::abs(b.y), std::abs(b.w)});
        const double error = std::max(a.error, b.error) + 8 * kUnit * size, w = std::min(low.w, high.w);
        if (!(w > 16 * error)) {
            sure_ = false;
            return;
        }
        delta += 8 * error / w + 2 * kUnit;
    } else {
        if (low.w == 0 || high.w == 0) return;  // through the point itself: seen as one place
    }
    const typename Covering<T>::Point p{low.x / low.w, low.y / low.w}, q{high.x / high.w, high.y / high.w};
    const double px = as_double(p.x), py = as_double(p.y), qx = as_double(q.x), qy = as_double(q.y);
    count_error(delta, std::hypot(qx - px, qy - py));
    if (round_) mark_caps(px, py, qx, qy, query_.work.cap_open);
    covering_.add(p, q, change, cut_from == 0, cut_to == 0);
}

/// Whether no edge lies so close to the place that its rounding could put it on the other side.
template <class Space>
bool ExactArea::Share<Space>::is_clear(double x, double y) const {
    const double near = 4 * widest_ + 0x1p-40;
    bool clear        = true;
    covering_.each_edge([&](const auto& low, const auto& high) {
        const double x0 = as_double(low.x), y0 = as_double(low.y), dx = as_double(high.x) - x0,
                     dy = as_double(high.y) - y0, length = std::hypot(dx, dy);
        const double t = length > 0 ? std::clamp(((x - x0) * dx + (y - y0) * dy) / (length * length), 0.0, 1.0) : 0;
        if (std::hypot(x0 + t * dx - x, y0 + t * dy - y) < near) clear = false;
    });
    return clear;
}

/// Layers at the far left of the lowest row: counted somewhere, and followed from there.
template <class Space>
std::optional<int> ExactArea::Share<Space>::base_layers() const {
    const int tries = std::is_same_v<T, double> ? 8 : 256;
    for (int k = 0; k < tries; ++k) {
        const auto [x, y] = place(k);
        if (!is_clear(x, y)) continue;
        if (const auto layers = layers_at(x, y)) return *layers - covering_.relative_layers({T(x), T(y)});
    }
    return std::nullopt;
}

template <class Space>
ExactArea::Answer ExactArea::Share<Space>::answer(double open, double left_open, double error) const {
    const double whole = round_ ? kPi : 4;
    const double low = std::max(0.0, (open - error) / whole), high = std::min(1.0, (open + left_open + error) / whole);
    const double unsure = 2 * error / whole;
    if (high <= unsure) return {0, round_ ? static_cast<float>(high) : 0};
    if (low >= 1 - unsure) return {1, round_ ? static_cast<float>(1 - low) : 0};
    // Half an ulp of the answer belongs to what it may be off.
    const auto half = static_cast<float>((high - low) / 2 * (1 + 0x1p-22) + 0x1p-25);
    return {static_cast<float>((low + high) / 2), round_ ? half : 0};
}

template <class Space>
std::optional<ExactArea::Answer> ExactArea::Share<Space>::find() {
    Workspace& work = query_.work;
    work.last       = kNoTriangle;
    work.cap_lit.assign(kChords, 2);
    work.cap_open.assign(kChords, 0);
    covering_.clear();
    for (const auto& [edge, change] : work.changes) {
        add(area_.edges_[edge], change * space_.orientation());
        if (!sure_) return std::nullopt;
    }
    for (const TriangleId t : area_.across_light_)
        if (t != query_.own) add_chord(t);
    if (!sure_) return std::nullopt;

    const std::optional<int> base = base_layers();
    if (!base) return std::nullopt;
    if (work.last != kNoTriangle) return Answer{};
    if (covering_.empty() && *base > 0) return Answer{};
    if (covering_.empty() && !query_.partly) return Answer{1, 0};

    std::vector<LightCorner<T>> light = whole_light<T>(round_);
    if (query_.partly) cut_light(light);
    const auto [area, rounded] =
        light.size() < 3 ? std::pair(0.0, 0.0) : covering_.uncovered(light, *base, work.cap_lit);
    const double error = swept_ + 16 * kUnit * (rounded + 4);
    if (std::is_same_v<T, double> && !(error <= kTrusted)) return std::nullopt;

    double open = area, left_open = 0;
    for (std::size_t k = 0; k < kChords && round_; ++k) {
        // Where the plane of the point's triangle takes a chord away, it takes the cap or has left it open.
        if (work.cap_open[k]) {
            left_open += kCapArea;
        } else if (work.cap_lit[k] == 1) {
            open += kCapArea;
        }
    }
    return answer(open, left_open, error);
}

/// False where p is within a sphere light.
bool ExactArea::frame_of(const ExactPoint& p, LightPlane& frame) const {
    const dvec3 centre       = dvec3(light_.position) - dvec3(p.corner());
    frame.centre_from_corner = {centre, kUnit * largest(centre)};
    if (light_.kind != LightKind::sphere) {
        frame.u            = half_u_;
        frame.v            = half_v_;
        frame.exact_centre = rational(light_.position);
        frame.rounding     = light_.kind == LightKind::disk ? 16 * kUnit : 0;
        return true;
    }
    const double r = light_.radius;
    TangentDisk disk;
    if (!tangent_disk(p.from_corner().value, centre, r, disk)) return false;
    frame.u                  = disk.axis_u;
    frame.v                  = disk.axis_v;
    frame.centre_from_corner = {disk.centre, 0};
    // The disk hangs on d, the way from p to the sphere's centre. What d is off moves its centre, and its radius
    // r sqrt(d^2 - r^2) / d.
    const Entries to = p.to(Entries{centre, kUnit * largest(centre)});
    const double d = glm::length(to.value), off = 2 * to.error + 16 * kUnit * (d + r);
    frame.rounding = off * (1 + r * d / ((d - r) * (d + r))) / glm::length(disk.axis_u);
    return true;
}

ExactArea::Answer ExactArea::seen(TriangleId own, float u, float v, bool partly, int turn, Workspace& work) const {
    const ExactPoint point(*scene_, own, u, v);
    LightPlane frame;
    if (!frame_of(point, frame)) return {1, 0};
    const Query query{point, own, partly, turn, frame, work};
    const FloatSpace space(point, frame);
    const bool filtered = arithmetic_ == Arithmetic::filtered && space.orientation() != kUnsure;
    // What hid the whole light of the point before often hides it from this one.
    if (filtered && work.last != kNoTriangle && work.last != own &&
        Share<FloatSpace>(*this, query, space, work.in_double).covers_all(work.last))
        return {};
    gather(query, space);
    if (filtered)
        if (const auto answer = Share<FloatSpace>(*this, query, space, work.in_double).find()) return *answer;

    const RationalSpace exact_space(point, frame);
    if (exact_space.orientation() == 0) return {.edge_on = true};
    ++work.rational_points;
    const auto answer = Share<RationalSpace>(*this, query, exact_space, work.in_rationals).find();
    return answer.value();
}

void ExactArea::build(const Scene& scene, const BoxTree& triangles) {
    scene_     = &scene;
    triangles_ = &triangles;
    topology_  = find_topology(scene, 0, static_cast<std::uint32_t>(scene.triangles.size()));
    uses_.clear();
    edges_.clear();
    const auto corner = [&](TriangleId t, int k) { return scene.vertex(t, k); };
    for (const Edge& e : topology_.edges) {
        CastEdge edge{e.a, e.b, static_cast<std::uint32_t>(uses_.size()), 0};
        for (std::uint32_t k = e.first; k < e.first + e.count; ++k)
            if (!topology_.degenerate[topology_.uses[k].triangle]) uses_.push_back(topology_.uses[k]);
        edge.count = static_cast<std::uint32_t>(uses_.size()) - edge.first;
        if (edge.count == 2) {
            dvec3 normal[2];
            for (std::size_t k = 0; k < 2; ++k) {
                const TriangleId t = uses_[edge.first + k].triangle;
                const dvec3 x      = dvec3(corner(t, 1)) - dvec3(corner(t, 0)),
                            y      = dvec3(corner(t, 2)) - dvec3(corner(t, 0));
                normal[k]          = glm::cross(x, y);
                // In a thin triangle the difference of products is lost in their rounding.
                const double size = glm::length(normal[k]);
                if (size > 1e-6 * glm::length(x) * glm::length(y) && size > 1e-290)
                    edge.normal[k] = vec3(normal[k] / size);
            }
            // Two triangles that continue each other in one plane cancel wherever they are seen from.
            const EdgeUse &first = uses_[edge.first], &second = uses_[edge.first + 1];
            const vec3 a = corner(first.triangle, 0), b = corner(first.triangle, 1), c = corner(first.triangle, 2);
            const bool even = glm::dot(normal[0], normal[1]) > 0;
            if (even == (first.forward != second.forward) &&
                side_of_plane(a, b, c, corner(second.triangle, (second.side + 2) % 3)) == 0)
                edge.count = 0;
        }
        if (edge.count == 0)
            uses_.resize(edge.first);
        else
            edges_.push_back(edge);
    }
    std::vector<Box> boxes(edges_.size());
    for (std::size_t e = 0; e < edges_.size(); ++e) boxes[e] = extend(extend(Box{}, at(edges_[e].a)), at(edges_[e].b));
    edge_tree_.clear();
    edge_tree_.emplace_back(std::move(boxes));
    cones_ = edge_tree_.front().summaries([&](std::uint32_t e) { return cone_of(edges_[e]); }, joined);
}

void ExactArea::aim(const Light& light) {
    light_ = light;
    plane_side_.clear();
    across_light_.clear();
    const dvec3 centre(light.position);
    dvec3 reach(1.6 * static_cast<double>(light.radius));
    if (light.kind != LightKind::sphere) {
        half_u_ = dvec3(light.edge_u) * 0.5;
        half_v_ = dvec3(light.edge_v) * 0.5;
        if (light.kind == LightKind::disk) {
            const DiskAxes axes = disk_axes(light);
            half_u_             = axes.u;
            half_v_             = axes.v;
        }
        reach = 1.2 * (glm::abs(half_u_) + glm::abs(half_v_));
        plane_side_.resize(topology_.position.size());
        const Entries u{half_u_, 0}, v{half_v_, 0};
        parallel_ranges(plane_side_.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const vec3 q   = at(static_cast<std::uint32_t>(k));
                const dvec3 d  = dvec3(q) - centre;
                const int s    = sign_of_determinant(u, v, Entries{d, kUnit * largest(d)});
                plane_side_[k] = static_cast<std::int8_t>(
                    s != kUnsure ? s
                                 : sign_of_determinant(rational(half_u_), rational(half_v_),
                                                       rational(q) - rational(light.position)));
            }
        });
    }
    for (TriangleId t = 0; t < scene_->triangles.size(); ++t) {
        const uvec3 v = topology_.triangles[t];
        if (topology_.degenerate[t]) continue;
        if (!plane_side_.empty() && plane_side_[v[0]] == plane_side_[v[1]] && plane_side_[v[1]] == plane_side_[v[2]])
            continue;
        bool apart = false;
        for (int k = 0; k < 3; ++k) {
            const auto [lo, hi] = std::minmax({at(v[0])[k], at(v[1])[k], at(v[2])[k]});
            const double wide   = reach[k] + 1e-12 * (std::abs(centre[k]) + reach[k]);
            apart               = apart || hi < centre[k] - wide || lo > centre[k] + wide;
        }
        if (!apart) across_light_.push_back(t);
    }
}

std::size_t ExactArea::memory_bytes() const {
    const auto bytes = [](const auto& list) { return list.size() * sizeof(list[0]); };
    return bytes(topology_.triangles) + bytes(topology_.position) + bytes(topology_.edges) + bytes(topology_.uses) +
           bytes(topology_.degenerate) + bytes(uses_) + bytes(edges_) + bytes(cones_) + bytes(plane_side_) +
           bytes(across_light_) + (edge_tree_.empty() ? 0 : edge_tree_.front().memory_bytes());
}

}  // namespace umbra
