#include "umbra/tests/support/oracle.h"

#include <CGAL/Boolean_set_operations_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_set_2.h>

#include <array>
#include <cmath>
#include <utility>

namespace umbra::oracle {
namespace {

using Kernel   = CGAL::Exact_predicates_exact_constructions_kernel;
using Rational = Kernel::Exact_kernel::FT;

struct Vector {
    Rational x, y, z;
};
Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator*(const Rational& s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
Rational dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
bool is_zero(const Vector& a) { return a.x == 0 && a.y == 0 && a.z == 0; }
Vector vector(vec3 v) { return {Rational(double(v.x)), Rational(double(v.y)), Rational(double(v.z))}; }
double rounded(const Rational& r) { return CGAL::to_double(r); }

struct Triangle {
    Vector corner[3];
    Vector normal;     // (b - a) x (c - a)
    Vector inward[3];  // across each edge, in the triangle's plane, to its inside
    bool has_area = false;
};

/// A point of a light's plane, in the light's half axes.
struct Planar {
    Rational x, y;
};
using Polygon = std::vector<Planar>;

/// What is left of a convex polygon where `height`, which is linear, is not negative.
template <class Point, class Height, class Between>
std::vector<Point> clipped(const std::vector<Point>& polygon, const Height& height, const Between& between) {
    std::vector<Point> kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Point &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
        const Rational hp = height(p), hq = height(q);
        if (hp >= 0) kept.push_back(p);
        if ((hp > 0 && hq < 0) || (hp < 0 && hq > 0)) kept.push_back(between(p, q, Rational(hp / (hp - hq))));
    }
    return kept;
}

Vector between(const Vector& p, const Vector& q, const Rational& t) { return p + t * (q - p); }
Planar between_planar(const Planar& p, const Planar& q, const Rational& t) {
    return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
}

Rational twice_area(const Polygon& polygon) {
    Rational sum = 0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Planar &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
        sum += p.x * q.y - p.y * q.x;
    }
    return sum;
}

/// The light as one point sees it: a plane, its half axes, and the part that is before the point's own plane.
struct Target {
    Vector centre, u, v;

    bool round = false;
};

/// Half axes across `normal`, `squared_radius` long but for one rounding to double, which is stated.
Target round_target(const Vector& centre, const Vector& normal, const Rational& squared_radius) {
    const Vector size{CGAL::abs(normal.x), CGAL::abs(normal.y), CGAL::abs(normal.z)};
    const Vector helper = size.x <= size.y && size.x <= size.z ? Vector{1, 0, 0}
                          : size.y <= size.z                   ? Vector{0, 1, 0}
                                                               : Vector{0, 0, 1};
    const Vector u      = cross(helper, normal);
    const Vector v      = cross(normal, u);
    const auto scaled   = [&](const Vector& a) {
        return Rational(std::sqrt(rounded(Rational(squared_radius / dot(a, a))))) * a;
    };
    return {centre, scaled(u), scaled(v), true};
}

}  // namespace

namespace {

/// A triangle that the segment meets in these of its edges.
struct Touched {
    const Triangle* triangle;
    std::vector<int> edges;
};

/// Whether some of the lights beside this one, at the end of d, are blocked by what is touched, and some not. The light
/// moves by w, a little: the meeting with a plane moves by a multiple of w - (n w / n d) d, and enters the triangle
/// where it moves inwards from each edge that is met. Of the directions w between two edges as seen along d, which are
/// all alike, one is the sum of both, turned one way or the other.
std::pair<bool, bool> moved_lights(const std::vector<Touched>& touched, const Vector& d) {
    std::vector<Vector> along, ways;
    for (const Touched& t : touched)
        for (const int e : t.edges) {
            // Less what lies along d, so that sums lie between the two.
            const Vector edge = t.triangle->corner[(e + 1) % 3] - t.triangle->corner[e];
            along.push_back(edge - Rational(dot(edge, d) / dot(d, d)) * d);
        }
    for (std::size_t i = 0; i < along.size(); ++i) {
        ways.push_back(cross(along[i], d));
        for (std::size_t j = 0; j < i; ++j) {
            ways.push_back(along[i] + along[j]);
            ways.push_back(along[i] - along[j]);
        }
    }
    bool blocked = false, passed = false;
    for (const Vector& way : ways)
        for (const int sign : {-1, 1}) {
            const Vector w = Rational(sign) * way;
            bool is_hidden = false, is_between = true;
            for (const Touched& t : touched) {
                const Vector& n    = t.triangle->normal;
                const Vector moved = w - Rational(dot(n, w) / dot(n, d)) * d;
                bool enters        = true;
                for (const int e : t.edges) {
                    const Rational inwards = dot(t.triangle->inward[e], moved);
                    is_between             = is_between && inwards != 0;
                    enters                 = enters && inwards > 0;
                }
                is_hidden = is_hidden || enters;
            }
            if (is_between) (is_hidden ? blocked : passed) = true;
        }
    return {blocked, passed};
}

}  // namespace

double area_in_unit_disk(const std::vector<dvec2>& polygon) {
    // Of the triangle from the centre to each side: where the side is inside, the triangle, elsewhere the sector.
    const auto sector = [](dvec2 p, dvec2 q) { return 0.5 * std::atan2(p.x * q.y - p.y * q.x, glm::dot(p, q)); };
    double sum        = 0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const dvec2 p = polygon[k], q = polygon[(k + 1) % polygon.size()], d = q - p;
        const double dd = glm::dot(d, d);
        if (!(dd > 0)) continue;
        const double across = (p.x * d.y - p.y * d.x) / std::sqrt(dd), inside = 1 - across * across;
        if (inside <= 0) {
            sum += sector(p, q);
            continue;
        }
        const double foot = -glm::dot(p, d) / dd, half = std::sqrt(inside / dd);
        const double enters = std::clamp(foot - half, 0.0, 1.0), leaves = std::clamp(foot + half, 0.0, 1.0);
        const dvec2 in = p + enters * d, out = p + leaves * d;
        if (enters > 0) sum += sector(p, in);
        sum += 0.5 * (in.x * out.y - in.y * out.x);
        if (leaves < 1) sum += sector(out, q);
    }
    return sum;
}

struct Oracle::Model {
    explicit Model(const Scene& s);

    [[nodiscard]] Vector place(const SurfacePoint& point) const {
        const Triangle& own = triangles[point.triangle];
        return own.corner[0] + Rational(double(point.u)) * (own.corner[1] - own.corner[0]) +
               Rational(double(point.v)) * (own.corner[2] - own.corner[0]);
    }
    /// Height over the plane of the point's triangle, on the side that sees, in units of the normal's length.
    [[nodiscard]] Rational height(const SurfacePoint& point, const Vector& q) const {
        const Triangle& own = triangles[point.triangle];
        const Rational h    = dot(own.normal, q - own.corner[0]);
        return point.flipped ? Rational(-h) : h;
    }
    [[nodiscard]] bool rises(const SurfacePoint& point, const Triangle& t) const {
        return height(point, t.corner[0]) > 0 || height(point, t.corner[1]) > 0 || height(point, t.corner[2]) > 0;
    }
    [[nodiscard]] bool in_line(const Triangle& t, const Vector& p, const Vector& d, bool infinite) const;
    [[nodiscard]] std::optional<Target> target(const Light& light, const Vector& p) const;
    [[nodiscard]] Polygon shadow(const Triangle& t, const Target& target, const Vector& p) const;
    [[nodiscard]] double hidden(const std::vector<Polygon>& shadows, bool round) const;

    const Scene& scene;
    std::vector<Triangle> triangles;
};

Oracle::Model::Model(const Scene& s) : scene(s) {
    for (TriangleId t = 0; t < s.triangles.size(); ++t) {
        Triangle triangle;
        for (int k = 0; k < 3; ++k) triangle.corner[k] = vector(s.vertex(t, k));
        triangle.normal   = cross(triangle.corner[1] - triangle.corner[0], triangle.corner[2] - triangle.corner[0]);
        triangle.has_area = !is_zero(triangle.normal);
        for (int k = 0; k < 3; ++k)
            triangle.inward[k] = cross(triangle.normal, triangle.corner[(k + 1) % 3] - triangle.corner[k]);
        triangles.push_back(std::move(triangle));
    }
}

Oracle::Oracle(const Scene& scene) : model_(std::make_unique<Model>(scene)) {}
Oracle::~Oracle() = default;

std::optional<bool> Oracle::flipped(TriangleId triangle, vec3 eye) const {
    const Triangle& t = model_->triangles[triangle];
    const Rational h  = dot(t.normal, vector(eye) - t.corner[0]);
    if (h == 0) return std::nullopt;
    return h < 0;
}

Facing Oracle::facing(const SurfacePoint& point, const Light& light) const {
    const Triangle& own  = model_->triangles[point.triangle];
    const Vector centre  = vector(light.position);
    const auto of_height = [](const Rational& h) { return h > 0 ? Facing::front : Facing::away; };
    switch (light.kind) {
        case LightKind::directional: {
            const Rational h = dot(own.normal, vector(light.direction));
            return of_height(point.flipped ? h : Rational(-h));
        }
        case LightKind::point:
        case LightKind::spot: return of_height(model_->height(point, centre));
        case LightKind::rectangle: {
            const Vector u = Rational(0.5) * vector(light.edge_u), v = Rational(0.5) * vector(light.edge_v);
            int front = 0, behind = 0;
            for (const Vector& corner : {centre + u + v, centre + u - v, centre - u + v, centre - u - v}) {
                const Rational h = model_->height(point, corner);
                front += h > 0;
                behind += h < 0;
            }
            return front == 0 ? Facing::away : behind == 0 ? Facing::front : Facing::partly;
        }
        case LightKind::disk:
        case LightKind::sphere: break;
    }
    // The light reaches as far to both sides as `extent`; with the normal's length, squared.
    const Rational h = model_->height(point, centre), r(double(light.radius));
    Rational extent  = r * r * dot(own.normal, own.normal);
    if (light.kind == LightKind::disk) {
        const Vector axis  = vector(light.direction);
        const Vector slant = cross(own.normal, axis);
        extent             = r * r * dot(slant, slant) / dot(axis, axis);
    }
    if (h * h >= extent) return of_height(h);
    if (light.kind == LightKind::disk) return Facing::partly;
    const Vector to_centre = centre - model_->place(point);
    return dot(to_centre, to_centre) <= r * r ? Facing::unshadowed : Facing::partly;
}

/// Whether the line from p along d, d not included, meets the triangle in whose plane it lies.
bool Oracle::Model::in_line(const Triangle& t, const Vector& p, const Vector& d, bool infinite) const {
    Rational from = 0, to = 1;
    bool to_is_open = !infinite, unbounded = infinite;
    for (int k = 0; k < 3; ++k) {
        const Rational at = dot(t.inward[k], p - t.corner[k]), rise = dot(t.inward[k], d);  // at + s rise >= 0
        if (rise == 0) {
            if (at < 0) return false;
            continue;
        }
        const Rational s = -at / rise;
        if (rise > 0) {
            from = std::max(from, s);
        } else if (unbounded || s < to) {
            to         = s;
            to_is_open = unbounded = false;
        }
    }
    return unbounded || from < to || (from == to && !to_is_open);
}

Verdict Oracle::verdict(const SurfacePoint& point, const Light& light, bool* touched) const {
    const Vector p      = model_->place(point);
    const bool infinite = light.kind == LightKind::directional;
    const Vector d      = infinite ? Rational(-1) * vector(light.direction) : vector(light.position) - p;
    std::vector<Touched> between;
    bool others = false;
    if (touched != nullptr) *touched = false;
    for (TriangleId k = 0; k < model_->triangles.size(); ++k) {
        const Triangle& t = model_->triangles[k];
        if (k == point.triangle || !t.has_area) continue;
        const Rational above = dot(t.normal, t.corner[0] - p), rise = dot(t.normal, d);
        if (rise == 0) {
            others = others || (above == 0 && model_->rises(point, t) && model_->in_line(t, p, d, infinite));
            continue;
        }
        const Rational s = above / rise;  // of the segment
        if (s < 0 || (!infinite && s >= 1)) continue;
        const Vector meeting = p + s * d;
        Touched met{&t, {}};
        bool outside = false;
        for (int e = 0; e < 3; ++e) {
            const Rational depth = dot(t.inward[e], meeting - t.corner[e]);
            outside              = outside || depth < 0;
            if (depth == 0) met.edges.push_back(e);
        }
        if (outside) continue;
        if (s == 0)
            others = others || model_->rises(point, t);
        else if (met.edges.empty())
            return Verdict::umbra;
        else
            between.push_back(met);
    }
    if (touched != nullptr) *touched = others || !between.empty();
    const auto [blocked, passed] = moved_lights(between, d);
    if (!between.empty() && !passed) return Verdict::umbra;
    return blocked || others ? Verdict::on_boundary : Verdict::lit;
}

std::optional<Target> Oracle::Model::target(const Light& light, const Vector& p) const {
    const Vector centre = vector(light.position);
    const Rational r(double(light.radius)), half(0.5);
    Target target;
    if (light.kind == LightKind::rectangle) {
        target = {centre, half * vector(light.edge_u), half * vector(light.edge_v), false};
    } else if (light.kind == LightKind::disk) {
        target = round_target(centre, vector(light.direction), r * r);
    } else {
        // The circle in which the cone from p touches the sphere.
        const Vector n    = centre - p;
        const Rational dd = dot(n, n);
        if (dd <= r * r) return std::nullopt;
        const Rational share = r * r / dd;
        target               = round_target(centre - share * n, n, r * r * (Rational(1) - share));
    }
    if (dot(cross(target.u, target.v), target.centre - p) == 0) return std::nullopt;
    return target;
}

/// The part of the light's plane, around the light, that the triangle hides from p.
Polygon Oracle::Model::shadow(const Triangle& t, const Target& target, const Vector& p) const {
    // q - p = X u + Y v + W (centre - p), by Cramer's rule.
    const Vector to_centre = target.centre - p;
    const Rational whole   = dot(cross(target.u, target.v), to_centre);
    const Vector of_x = cross(target.v, to_centre), of_y = cross(to_centre, target.u), of_w = cross(target.u, target.v);
    std::vector<Vector> corners;
    bool before = false;
    for (const Vector& corner : t.corner) {
        const Vector q = corner - p;
        corners.push_back({dot(of_x, q) / whole, dot(of_y, q) / whole, dot(of_w, q) / whole});
        before = before || corners.back().z < 1;
    }
    if (!before) return {};
    // Within this many half axes: the light, and for a round one the rounding of its axes.
    const Rational around = target.round ? Rational(1.0078125) : Rational(1);
    corners               = clipped(
                      corners, [&](const Vector& q) { return Rational(Rational(1) - q.z); }, between);
    corners = clipped(
        corners, [&](const Vector& q) { return Rational(around * q.z - q.x); }, between);
    corners = clipped(
        corners, [&](const Vector& q) { return Rational(around * q.z + q.x); }, between);
    corners = clipped(
        corners, [&](const Vector& q) { return Rational(around * q.z - q.y); }, between);
    corners = clipped(
        corners, [&](const Vector& q) { return Rational(around * q.z + q.y); }, between);
    Polygon polygon;
    for (const Vector& q : corners) {
        if (q.z == 0) return {};  // p itself
        const Planar on_light{q.x / q.z, q.y / q.z};
        if (polygon.empty() || polygon.back().x != on_light.x || polygon.back().y != on_light.y)
            polygon.push_back(on_light);
    }
    while (polygon.size() > 1 && polygon.front().x == polygon.back().x && polygon.front().y == polygon.back().y)
        polygon.pop_back();
    return polygon;
}

/// Area of the union.
double Oracle::Model::hidden(const std::vector<Polygon>& shadows, bool round) const {
    using Polygon2 = CGAL::Polygon_2<Kernel>;
    std::vector<Polygon2> parts;
    for (const Polygon& shadow : shadows) {
        if (shadow.size() < 3) continue;
        const Rational area = twice_area(shadow);
        if (area == 0) continue;
        Polygon2 part;
        for (const Planar& p : shadow) part.push_back({Kernel::FT(p.x), Kernel::FT(p.y)});
        if (area < 0) part.reverse_orientation();
        parts.push_back(std::move(part));
    }
    if (parts.empty()) return 0;
    CGAL::Polygon_set_2<Kernel> all;
    all.join(parts.begin(), parts.end());
    std::vector<CGAL::Polygon_with_holes_2<Kernel>> pieces;
    all.polygons_with_holes(std::back_inserter(pieces));
    double sum      = 0;
    const auto area = [&](const Polygon2& outline) {
        std::vector<dvec2> corners;
        for (const auto& p : outline) corners.emplace_back(rounded(p.x().exact()), rounded(p.y().exact()));
        if (round) return area_in_unit_disk(corners);
        double twice = 0;
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const dvec2 p = corners[k], q = corners[(k + 1) % corners.size()];
            twice += p.x * q.y - p.y * q.x;
        }
        return twice / 2;
    };
    for (const auto& piece : pieces) {
        sum += area(piece.outer_boundary());
        for (auto hole = piece.holes_begin(); hole != piece.holes_end(); ++hole) sum += area(*hole);
    }
    return sum;
}

Fraction Oracle::fraction(const SurfacePoint& point, const Light& light) const {
    const Vector p                     = model_->place(point);
    const std::optional<Target> target = model_->target(light, p);
    if (!target) return {.undefined = true};

    // The part of the light that is before the point's own plane. The square around a round light, which is cut where
    // its area is taken.
    const Rational around = target->round ? Rational(1.0078125) : Rational(1);
    const Polygon square{{-around, -around}, {around, -around}, {around, around}, {-around, around}};
    const auto height = [&](const Planar& q) {
        return model_->height(point, target->centre + q.x * target->u + q.y * target->v);
    };
    const Polygon light_part = clipped(square, height, between_planar);

    Fraction fraction;
    std::vector<Polygon> shadows;
    for (TriangleId k = 0; k < model_->triangles.size(); ++k) {
        const Triangle& t = model_->triangles[k];
        if (k == point.triangle || !t.has_area) continue;
        if (dot(t.normal, t.corner[0] - p) == 0) {
            bool outside = false;
            for (int e = 0; e < 3; ++e) outside = outside || dot(t.inward[e], p - t.corner[e]) < 0;
            fraction.touched = fraction.touched || (!outside && model_->rises(point, t));
            continue;
        }
        const Polygon shadow = model_->shadow(t, *target, p);
        if (shadow.size() < 3) continue;
        Polygon before = clipped(shadow, height, between_planar);
        shadows.push_back(std::move(before));
    }
    const double whole = target->round ? kPi : 4;
    const double open  = model_->hidden({light_part}, target->round);
    fraction.visible   = (open - model_->hidden(shadows, target->round)) / whole;
    return fraction;
}

}  // namespace umbra::oracle
