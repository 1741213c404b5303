// Exact visibility of hard lights: the segment from the exact surface point to the light against every triangle but its
// own.
//
// All decisions are signs of determinants. Each is evaluated in double with a bound on its error; where that cannot
// tell, in rationals. Nothing is rounded in what is asked: vertices, barycentrics and light are the floats of the
// scene.
//
// This work is based on:
// Jonathan Shewchuk. Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates. 1997
// Rafael Segura, Francisco Feito. Algorithms to Test Ray-Triangle Intersection. Comparative Study. 2001
#include <CGAL/Gmpq.h>
#include <fmt/format.h>

#include <array>
#include <optional>

#include "core/parallel.h"
#include "core/topology.h"
#include "shadows/method.h"
#include "shadows/triangle_tree.h"

namespace umbra {
namespace {

using Rational  = CGAL::Gmpq;
using Rational3 = std::array<Rational, 3>;

constexpr double kUnit = 0x1p-53;  ///< half an ulp of 1 in double

Rational3 rational(vec3 v) { return {Rational(double(v.x)), Rational(double(v.y)), Rational(double(v.z))}; }
Rational3 operator-(const Rational3& a, const Rational3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

int sign_of_determinant(const Rational3& a, const Rational3& b, const Rational3& c) {
    return static_cast<int>(CGAL::sign(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                                       a[2] * (b[0] * c[1] - b[1] * c[0])));
}

double largest(dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// The segment from a named surface point to a hard light. The end is a position, or a direction at infinity.
class Segment {
public:
    Segment(const Scene& scene, const Light& light, TriangleId t, float u, float v)
        : a_(scene.vertex(t, 0)), b_(scene.vertex(t, 1)), c_(scene.vertex(t, 2)), u_(u), v_(v) {
        const dvec3 a(a_), b(b_), c(c_);
        from_ = a + static_cast<double>(u) * (b - a) + static_cast<double>(v) * (c - a);
        // Differences, products, sums: at most 6 roundings of numbers no larger than 4 times the largest coordinate.
        slack_    = 24 * kUnit * std::max({largest(a), largest(b), largest(c)});
        infinite_ = light.kind == LightKind::directional;
        end_      = infinite_ ? -light.direction : light.position;
        to_       = infinite_ ? dvec3(end_) : dvec3(end_) - from_;
        to_error_ = infinite_ ? 0 : slack_ + kUnit * largest(to_);
    }

    [[nodiscard]] TriangleTree::Piece piece() const {
        return {from_, to_, infinite_ ? double(kInfinity) : 1.0, 2 * slack_};
    }

    /// Sign of the volume that the start and the plane of (x, y, z) span: the side of the plane that the start is on.
    [[nodiscard]] int start_side(vec3 x, vec3 y, vec3 z) const {
        const int s = sign(difference(x), difference(y), difference(z));
        return s != kUnsure ? s
                            : sign_of_determinant(rational(x) - start(), rational(y) - start(), rational(z) - start());
    }

    /// The same for the end. A direction has the side that it runs to.
    [[nodiscard]] int end_side(vec3 x, vec3 y, vec3 z) const {
        const dvec3 p = dvec3(y) - dvec3(x), q = dvec3(z) - dvec3(x);
        const dvec3 r = infinite_ ? dvec3(end_) : dvec3(end_) - dvec3(x);
        const Entries P{p, kUnit * largest(p)}, Q{q, kUnit * largest(q)}, R{r, infinite_ ? 0 : kUnit * largest(r)};
        const int s        = sign(P, Q, R);
        const int positive = s != kUnsure
                                 ? s
                                 : sign_of_determinant(rational(y) - rational(x), rational(z) - rational(x),
                                                       infinite_ ? rational(end_) : rational(end_) - rational(x));
        // det(x - q, y - q, z - q) = -det(y - x, z - x, q - x): the sign that start_side would give for q.
        return -positive;
    }

    /// On which side the line through start and end passes the edge from x to y; kUnsure where doubles cannot tell.
    [[nodiscard]] int quick_edge_side(vec3 x, vec3 y) const {
        return sign(difference(x), difference(y), Entries{to_, to_error_});
    }
    [[nodiscard]] int edge_side(vec3 x, vec3 y) const {
        const int s = quick_edge_side(x, y);
        return s != kUnsure ? s
                            : sign_of_determinant(rational(x) - start(), rational(y) - start(),
                                                  infinite_ ? rational(end_) : rational(end_) - start());
    }

    /// Start and end (or direction) in rationals.
    [[nodiscard]] const Rational3& start() const {
        if (!start_) {
            const Rational u{double(u_)}, v{double(v_)};
            const Rational3 a = rational(a_), ab = rational(b_) - a, ac = rational(c_) - a;
            start_.emplace(
                Rational3{a[0] + u * ab[0] + v * ac[0], a[1] + u * ab[1] + v * ac[1], a[2] + u * ab[2] + v * ac[2]});
        }
        return *start_;
    }
    [[nodiscard]] Rational3 end() const { return rational(end_); }
    [[nodiscard]] bool infinite() const { return infinite_; }

    static constexpr int kUnsure = 2;

private:
    /// A vector in double, and how far each component may be off.
    struct Entries {
        dvec3 value;
        double error;
    };

    [[nodiscard]] Entries difference(vec3 x) const {
        const dvec3 d = dvec3(x) - from_;
        return {d, slack_ + kUnit * largest(d)};
    }

    /// Sign of det(p, q, r), or kUnsure. With P, Q, R the largest magnitudes and e, f, g the errors, each of the six
    /// products is off by at most (P+e)(Q+f)(R+g) - PQR from its entries, and the evaluation by less than 8 roundings
    /// of it.
    static int sign(const Entries& p, const Entries& q, const Entries& r) {
        const dvec3 &a = p.value, &b = q.value, &c = r.value;
        const double det =
            a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
        const double P = largest(a), Q = largest(b), R = largest(c);
        const double spread = (P + p.error) * (Q + q.error) * (R + r.error);
        const double from_entries =
            p.error * (Q + q.error) * (R + r.error) + P * (q.error * (R + r.error) + Q * r.error);
        const double bound = 6.01 * (from_entries + 8 * kUnit * spread);
        // Entries may underflow where scenes are tiny: then the bound is no bound, and rationals decide.
        if (std::abs(det) > bound && bound > 1e-290) return det > 0 ? 1 : -1;
        return kUnsure;
    }

    vec3 a_, b_, c_;
    float u_, v_;
    dvec3 from_{0}, to_{0};
    double slack_ = 0, to_error_ = 0;
    bool infinite_ = false;
    vec3 end_{0};
    mutable std::optional<Rational3> start_;
};

enum class Meeting : std::uint8_t { none, touches, crosses };

/// A segment in the plane of a triangle: the light sees the triangle edge-on, so the segment may touch it but not cross
/// it. Rare, so in rationals throughout: in the two coordinates other than `axis`, is there a line between segment and
/// triangle?
Meeting meeting_in_plane(const Segment& segment, vec3 x, vec3 y, vec3 z) {
    const dvec3 n  = glm::abs(glm::cross(dvec3(y) - dvec3(x), dvec3(z) - dvec3(x)));
    const int axis = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
    const auto i = static_cast<std::size_t>((axis + 1) % 3), j = static_cast<std::size_t>((axis + 2) % 3);

    const std::array<Rational3, 3> corner = {rational(x), rational(y), rational(z)};
    const Rational3& start                = segment.start();
    Rational3 end                         = segment.end();
    if (segment.infinite()) {  // far enough along the direction to have passed every corner
        Rational reach = 1;
        for (const Rational3& c : corner)
            for (const std::size_t k : {i, j})
                if (end[k] != 0) reach = std::max(reach, CGAL::abs(Rational((c[k] - start[k]) / end[k])) + 1);
        for (std::size_t k = 0; k < 3; ++k) end[k] = start[k] + reach * end[k];
    }
    const auto side = [&](const Rational3& p, const Rational3& q, const Rational3& r) {
        return static_cast<int>(CGAL::sign((q[i] - p[i]) * (r[j] - p[j]) - (q[j] - p[j]) * (r[i] - p[i])));
    };
    const int a = side(start, end, corner[0]), b = side(start, end, corner[1]), c = side(start, end, corner[2]);
    if ((a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0)) return Meeting::none;
    for (std::size_t e = 0; e < 3; ++e) {
        const Rational3 &p = corner[e], &q = corner[(e + 1) % 3], &r = corner[(e + 2) % 3];
        const int inside = side(p, q, r);
        if (inside * side(p, q, start) < 0 && inside * side(p, q, end) < 0) return Meeting::none;
    }
    return Meeting::touches;
}

Meeting meeting(const Segment& segment, vec3 x, vec3 y, vec3 z) {
    // Most lines pass the triangle by, and doubles see it. Asked first, since a neighbour in the plane of the point's
    // own triangle (a floor of two triangles) would otherwise cost rationals at every point.
    const int q0 = segment.quick_edge_side(x, y), q1 = segment.quick_edge_side(y, z),
              q2           = segment.quick_edge_side(z, x);
    const bool surely_left = q0 == 1 || q1 == 1 || q2 == 1, surely_right = q0 == -1 || q1 == -1 || q2 == -1;
    if (surely_left && surely_right) return Meeting::none;

    const int end = segment.end_side(x, y, z), start = segment.start_side(x, y, z);
    if (start == 0 && end == 0) return meeting_in_plane(segment, x, y, z);
    // A segment that begins or ends on the triangle's plane does not pass through it: nothing lies on both of its
    // sides.
    if (start == 0 || end == 0 || start == end) return Meeting::none;
    const int e0         = q0 != Segment::kUnsure ? q0 : segment.edge_side(x, y);
    const int e1         = q1 != Segment::kUnsure ? q1 : segment.edge_side(y, z);
    const int e2         = q2 != Segment::kUnsure ? q2 : segment.edge_side(z, x);
    const bool some_left = e0 > 0 || e1 > 0 || e2 > 0, some_right = e0 < 0 || e1 < 0 || e2 < 0;
    if (some_left && some_right) return Meeting::none;
    return e0 != 0 && e1 != 0 && e2 != 0 ? Meeting::crosses : Meeting::touches;
}

class Exact final : public Method {
public:
    explicit Exact(const Settings& /*none*/) {}

    Service serves(const SceneFacts& facts) const override {
        for (const LightFacts& light : facts.lights)
            if (!light.hard())
                return {
                    How::not_at_all,
                    fmt::format("light \"{}\" has an area: only lights without one are decided exactly", light.name)};
        return {How::exactly, "Every sign is proven: no rounding in what is decided."};
    }

    void build(const Scene& scene, const SceneFacts& /*facts*/) override {
        scene_ = &scene;
        tree_.emplace(scene);
        // A triangle without area is no surface: it has no inside to cross and bounds no shadow.
        no_area_.resize(scene.triangles.size());
        parallel_ranges(no_area_.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                const auto id = static_cast<TriangleId>(t);
                no_area_[t]   = is_degenerate(scene.vertex(id, 0), scene.vertex(id, 1), scene.vertex(id, 2));
            }
        });
    }

    void aim(LightId /*light*/) override {}  // nothing depends on the light alone

    void visibility(const PointBatch& points, LightId light, std::span<float> s,
                    std::span<std::uint8_t> defined) override {
        parallel_ranges(points.size(), 256, [&](std::size_t begin, std::size_t end) {
            TriangleId last = kNoTriangle;  // what blocked a point often blocks its neighbour
            for (std::size_t i = begin; i < end; ++i) {
                if (points.facing[light][i] != Facing::front) continue;
                const Segment segment(*scene_, scene_->lights[light], points.triangle[i], points.u[i], points.v[i]);
                const Meeting met = first_meeting(segment, points.triangle[i], last);
                s[i]              = met == Meeting::crosses ? 0.0f : 1.0f;
                defined[i]        = met == Meeting::touches ? kOnBoundary : kDefined;
            }
        });
    }

    /// The nearest of the triangles that the way to the light crosses.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> who) override {
        parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                who[i] = kNoTriangle;
                if (points.facing[light][i] != Facing::front) continue;
                const Segment segment(*scene_, scene_->lights[light], points.triangle[i], points.u[i], points.v[i]);
                who[i] = nearest_crossed(segment, points.triangle[i]);
            }
        });
    }

    std::size_t memory_bytes() const override { return (tree_ ? tree_->memory_bytes() : 0) + no_area_.size(); }

private:
    /// `crosses` as soon as one triangle is crossed; else `touches` if any is touched. `last` is tried first.
    Meeting first_meeting(const Segment& segment, TriangleId own, TriangleId& last) const {
        const auto with = [&](TriangleId t) {
            return t == own || no_area_[t]
                       ? Meeting::none
                       : meeting(segment, scene_->vertex(t, 0), scene_->vertex(t, 1), scene_->vertex(t, 2));
        };
        if (last != kNoTriangle && with(last) == Meeting::crosses) return Meeting::crosses;
        Meeting met = Meeting::none;
        tree_->visit(segment.piece(), [&](TriangleId t) {
            const Meeting m = with(t);
            if (m == Meeting::crosses) last = t;
            met = std::max(met, m);
            return m != Meeting::crosses;
        });
        return met;
    }

    /// What is crossed is decided exactly, and which of that is nearest in double.
    TriangleId nearest_crossed(const Segment& segment, TriangleId own) const {
        const TriangleTree::Piece piece = segment.piece();
        TriangleId nearest              = kNoTriangle;
        double least                    = std::numeric_limits<double>::infinity();
        tree_->visit(piece, [&](TriangleId t) {
            const vec3 x = scene_->vertex(t, 0), y = scene_->vertex(t, 1), z = scene_->vertex(t, 2);
            if (t == own || no_area_[t] || meeting(segment, x, y, z) != Meeting::crosses) return true;
            const dvec3 n    = glm::cross(dvec3(y) - dvec3(x), dvec3(z) - dvec3(x));
            const double way = std::abs(glm::dot(n, dvec3(x) - piece.from) / glm::dot(n, piece.direction));
            if (way < least || (way == least && t < nearest)) least = way, nearest = t;
            return true;
        });
        return nearest;
    }

    const Scene* scene_ = nullptr;
    std::optional<TriangleTree> tree_;
    std::vector<std::uint8_t> no_area_;  ///< one a triangle
};

}  // namespace

const MethodInfo exact{
    .name  = "exact",
    .title = "Exact visibility",
    .paper =
        "Predicates after Jonathan Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust "
        "Geometric Predicates, 1997",
    .summary =
        "The segment from the exact surface point to the light against every triangle but its own, decided "
        "by signs that are proven in floating point or computed in rationals. The reference of the others.",
    .parameters = {},
    .make       = make_method<Exact>};

}  // namespace umbra
