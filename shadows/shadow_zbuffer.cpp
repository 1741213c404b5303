// Shadow z-buffer: draw depth from the light, then compare every surface point with it.
//
// This work is based on:
// Lance Williams. Casting Curved Shadows on Curved Surfaces. 1978
// William Reeves, David Salesin, Robert Cook. Rendering Antialiased Shadows with Depth Maps. 1987 (PCF)
// Yulan Wang, Steven Molnar. Second-Depth Shadow Mapping. 1994 (faces=back)
// Christian Schueler. Eliminating Surface Acne with Gradient Shadow Mapping. 2005 (the receiver's plane as bias)
// Daniel Holbert. Saying Goodbye to Shadow Acne. 2011 (normal offset)
//
// The directions that a light sees are covered by *views*, each with a map of its own:
//   directional     one orthographic view, fitted to the scene, in the roll about the light's direction of least area
//   point, area     one perspective view fitted to the scene where that fits into a cone of 50 degrees; else six faces
//                   of a cube. Area lights stand in their centres
//   spot            one view of the cone, shrunk to the scene, and where the scene reaches out of it six faces at
//                   `surround` of the resolution: the spot's factor in the sum is 0 there, S_j is not
// Maps reach over their view's border by as much as the filter does, so that no filter ever crosses a cube's seam.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/error.h"
#include "core/parallel.h"
#include "shadows/depth_map.h"
#include "shadows/method.h"

namespace umbra {
namespace {

constexpr int kRolls         = 16;          // orientations of the map tried about the light's direction
constexpr double kWide       = 1.19175359;  // tan 50 degrees: beyond this one map wastes more than six
constexpr double kWideCone   = 1.7320509;   // tan 60 degrees, for a spot's own cone
constexpr double kFloatNear  = 1e-6;        // near / far; reversed floats resolve any such ratio evenly
constexpr std::size_t kGrain = 4096;

// ---- views ---------------------------------------------------------------------------------------------------------

/// An interval of numbers, empty at first.
struct Range {
    double min = +std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();
    void add(double v) { min = std::min(min, v), max = std::max(max, v); }
    void add(const Range& r) { min = std::min(min, r.min), max = std::max(max, r.max); }
    [[nodiscard]] double centre() const { return 0.5 * (min + max); }
    [[nodiscard]] double half() const { return 0.5 * (max - min); }
};

/// Where a view looks from and what it shows, before there is a map. Light space: x right, y down, z away from the
/// light, right-handed, about `origin`. The window is in x/z and y/z (perspective) or in x and y (orthographic).
struct Frame {
    bool perspective = true;
    dvec3 origin{0};
    dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    dvec2 centre{0}, half{1};
    double near = 0, far = 1;
    double reach = 1;  ///< points are looked up here where |X|, |Y| <= reach W

    [[nodiscard]] dvec3 light_space(dvec3 p) const {
        const dvec3 v = p - origin;
        return {glm::dot(x, v), glm::dot(y, v), glm::dot(z, v)};
    }
    [[nodiscard]] double nearness(double depth) const {
        return perspective ? near * (far - depth) / (depth * (far - near)) : (far - depth) / (far - near);
    }
    /// How fast nearness falls with depth.
    [[nodiscard]] double nearness_per_depth(double depth) const {
        return perspective ? near * far / (depth * depth * (far - near)) : 1 / (far - near);
    }
    /// See DepthMap::draw; W is z / far, or 1.
    [[nodiscard]] dmat4 clip_from_world() const {
        dvec4 X, Y, R, W;
        if (perspective) {
            X = dvec4((x - centre.x * z) / half.x, 0) / far;
            Y = dvec4((y - centre.y * z) / half.y, 0) / far;
            R = dvec4(-near * z, near * far) / ((far - near) * far);
            W = dvec4(z, 0) / far;
        } else {
            X = dvec4(x, -centre.x) / half.x;
            Y = dvec4(y, -centre.y) / half.y;
            R = dvec4(-z, far) / (far - near);
            W = dvec4(0, 0, 0, 1);
        }
        for (dvec4* row : {&X, &Y, &R, &W}) row->w -= glm::dot(dvec3(*row), origin);
        return glm::transpose(dmat4(X, Y, R, W));
    }
};

struct View {
    Frame frame;
    DepthMap map;
};

/// Any right-handed frame that looks along `z`.
Frame looking_along(dvec3 origin, dvec3 z, bool perspective) {
    Frame frame;
    frame.perspective = perspective;
    frame.origin      = origin;
    frame.z           = glm::normalize(z);
    const dvec3 a     = glm::abs(frame.z);
    const dvec3 aside = a.x <= a.y && a.x <= a.z ? dvec3(1, 0, 0) : a.y <= a.z ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
    frame.x           = glm::normalize(glm::cross(aside, frame.z));
    frame.y           = glm::cross(frame.z, frame.x);
    return frame;
}

double distance_to_triangle(dvec3 p, dvec3 a, dvec3 b, dvec3 c) {
    const dvec3 n     = glm::cross(b - a, c - a);
    const auto within = [&](dvec3 from, dvec3 to) { return glm::dot(glm::cross(to - from, p - from), n) >= 0; };
    if (glm::dot(n, n) > 0 && within(a, b) && within(b, c) && within(c, a))
        return std::abs(glm::dot(p - a, n)) / glm::length(n);
    const auto to_segment = [&](dvec3 from, dvec3 to) {
        const dvec3 d       = to - from;
        const double length = glm::dot(d, d);
        const double t      = length > 0 ? std::clamp(glm::dot(p - from, d) / length, 0.0, 1.0) : 0.0;
        return glm::length(from + t * d - p);
    };
    return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

// ---- the scene as seen from a light --------------------------------------------------------------------------------

/// What can cast a shadow, and where it lies.
///
/// Scenes stand on floors and between walls that reach far beyond all else, and a map fitted to those wastes its
/// samples. What such planes do, seen from a light:
///   - Where the whole scene lies on the light's side of a plane, it blocks nothing: no segment between two points of a
///     closed half-space crosses its border. It is not drawn.
///   - A set of planes, each with the others on the light's side, blocks nothing of these planes. All else that they
///     or other triangles block lies where other triangles lie, or behind those: the map's window need only hold
///     triangles outside the set. What is not in the window is lit.
class Casters {
public:
    Casters(const Scene& scene, const SceneFacts& facts, bool leave_out)
        : scene_(&scene), planes_of_position_(scene.positions.size(), 0) {
        std::vector<std::uint8_t> plane_of_triangle(scene.triangles.size(), kMaxPlanes);
        if (leave_out) find_planes(facts, plane_of_triangle);
        for (std::size_t t = 0; t < scene.triangles.size(); ++t)
            for (int k = 0; k < 3; ++k)
                planes_of_position_[scene.triangles[t][k]] |= std::uint64_t{1} << plane_of_triangle[t];
        for (const Object& object : scene.objects)
            for (std::uint32_t i = 0; i < object.triangle_count; ++i) {
                const TriangleId t = object.first_triangle + i;
                if (i == 0 || plane_of_triangle[t] != parts_.back().plane)
                    parts_.push_back({t, 0, plane_of_triangle[t], {}});
                parts_.back().count += 1;
                for (int k = 0; k < 3; ++k) parts_.back().box = extend(parts_.back().box, scene.vertex(t, k));
            }
        find_sides();
    }

    /// Leaves out what need not be drawn, or not be fitted to, as seen from `light`.
    void select(const Light& light) {
        const bool infinite = light.kind == LightKind::directional;
        std::vector<std::size_t> set;
        std::vector<int> side(planes_.size());
        drawn_  = ~std::uint64_t{0};
        fitted_ = ~std::uint64_t{0};
        for (std::size_t i = 0; i < planes_.size(); ++i) {
            const Plane& plane    = planes_[i];
            const double distance = infinite ? -glm::dot(plane.normal, glm::normalize(dvec3(light.direction)))
                                             : glm::dot(plane.normal, dvec3(light.position)) - plane.offset;
            const double least    = infinite ? kGrazing : plane.tolerance;
            side[i]               = distance > least ? 1 : distance < -least ? -1 : 0;
            if (side[i] == 0) continue;
            if (plane.has_on_side(plane.scene, side[i])) drawn_ &= ~(std::uint64_t{1} << i);
            if (std::ranges::all_of(set, [&](std::size_t j) {
                    return plane.has_on_side(plane.others[j], side[i]) &&
                           planes_[j].has_on_side(planes_[j].others[i], side[j]);
                })) {
                set.push_back(i);
                fitted_ &= ~(std::uint64_t{1} << i);
            }
        }
        box_ = {};
        for (const Part& part : parts_)
            if (has(fitted_, part)) box_ = extend(box_, part.box);
    }

    [[nodiscard]] const Scene& scene() const { return *scene_; }
    [[nodiscard]] const Box& box() const { return box_; }  ///< of what is fitted to
    [[nodiscard]] std::size_t memory_bytes() const {
        return planes_of_position_.size() * sizeof(std::uint64_t) + parts_.size() * sizeof(Part);
    }

    /// Range of each of the n values that `values` gives for a position, over all that is fitted to.
    template <std::size_t n, class Values>
    [[nodiscard]] std::array<Range, n> ranges(const Values& values) const {
        return reduce<n>(planes_of_position_.size(), [&](std::size_t i, std::array<Range, n>& all) {
            if ((planes_of_position_[i] & fitted_) == 0) return;
            const std::array<double, n> v = values(dvec3(scene_->positions[i]));
            for (std::size_t k = 0; k < n; ++k) all[k].add(v[k]);
        });
    }

    /// From p to the nearest point of what is fitted to.
    [[nodiscard]] double distance(dvec3 p) const {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Part& part : parts_) {
            if (!has(fitted_, part)) continue;
            const dvec3 to_box = glm::max(glm::max(dvec3(part.box.min) - p, p - dvec3(part.box.max)), 0.0);
            if (glm::length(to_box) >= nearest) continue;
            const std::array<Range, 1> range = reduce<1>(part.count, [&](std::size_t i, std::array<Range, 1>& all) {
                const auto t = static_cast<TriangleId>(part.first + i);
                all[0].add(distance_to_triangle(p, dvec3(scene_->vertex(t, 0)), dvec3(scene_->vertex(t, 1)),
                                                dvec3(scene_->vertex(t, 2))));
            });
            nearest                          = std::min(nearest, range[0].min);
        }
        return nearest;
    }

    /// Those triangles that are drawn, but for parts whose boxes lie wholly beyond one side of the view.
    [[nodiscard]] std::vector<std::span<const uvec3>> seen_by(const dmat4& clip_from_world) const {
        std::vector<std::span<const uvec3>> runs;
        for (const Part& part : parts_) {
            if (!has(drawn_, part)) continue;
            std::array<int, 5> outside{};
            for (int corner = 0; corner < 8; ++corner) {
                const dvec4 c = clip_from_world * dvec4(corner & 1 ? part.box.max.x : part.box.min.x,
                                                        corner & 2 ? part.box.max.y : part.box.min.y,
                                                        corner & 4 ? part.box.max.z : part.box.min.z, 1);
                const std::array<bool, 5> is_outside{c.w <= 0, c.x > c.w, c.x<-c.w, c.y> c.w, c.y < -c.w};
                for (int side = 0; side < 5; ++side) outside[side] += is_outside[side];
            }
            if (std::ranges::find(outside, 8) == outside.end())
                runs.push_back(std::span(scene_->triangles).subspan(part.first, part.count));
        }
        return runs;
    }

private:
    static constexpr std::uint8_t kMaxPlanes = 63;       ///< as many may be left out; also says "in none of them"
    static constexpr double kRounding        = 0x1p-22;  ///< of a corner that was computed in float, relative
    static constexpr double kGrazing         = 1e-6;     ///< sine: flatter light may as well lie in the plane

    struct Plane {
        dvec3 normal;
        double offset;
        double tolerance;           ///< how far corners that mean to lie in it, or to touch it, may miss it
        Range scene;                ///< distances of the whole scene
        std::vector<Range> others;  ///< distances of the other planes' triangles

        [[nodiscard]] bool has_on_side(const Range& distances, int side) const {
            return side > 0 ? distances.min >= -tolerance : distances.max <= tolerance;
        }
    };
    /// Consecutive triangles of one object that lie in one of planes_ together, or in none.
    struct Part {
        TriangleId first;
        std::uint32_t count;
        std::uint8_t plane;
        Box box;
    };

    [[nodiscard]] static bool has(std::uint64_t planes, const Part& part) { return (planes >> part.plane & 1) != 0; }

    void find_planes(const SceneFacts& facts, std::vector<std::uint8_t>& plane_of_triangle) {
        const vec3 corner    = glm::max(glm::abs(facts.box.min), glm::abs(facts.box.max));
        const double largest = std::max({corner.x, corner.y, corner.z});
        for (const PlanarReceiver& plane : facts.planes) {
            if (planes_.size() == kMaxPlanes) break;
            for (TriangleId t : plane.triangles) plane_of_triangle[t] = static_cast<std::uint8_t>(planes_.size());
            planes_.push_back({plane.normal, plane.offset, plane.tolerance + kRounding * largest, {}, {}});
        }
    }

    /// Where each plane has the others, and the scene.
    void find_sides() {
        const std::size_t n = planes_.size();
        parallel_ranges(n, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                Plane& plane = planes_[i];
                plane.others.resize(n);
                for (std::size_t p = 0; p < planes_of_position_.size(); ++p) {
                    const std::uint64_t in = planes_of_position_[p];
                    if (in == 0) continue;
                    const double distance = glm::dot(plane.normal, dvec3(scene_->positions[p])) - plane.offset;
                    plane.scene.add(distance);
                    for (std::uint64_t rest = in & ~(std::uint64_t{1} << kMaxPlanes); rest != 0; rest &= rest - 1)
                        plane.others[std::countr_zero(rest)].add(distance);
                }
            }
        });
    }

    /// Ranges over `add(i, ranges)` for all i below `count`, in parallel.
    template <std::size_t n, class Add>
    [[nodiscard]] static std::array<Range, n> reduce(std::size_t count, const Add& add) {
        const std::size_t blocks = (count + kGrain - 1) / kGrain;
        std::vector<std::array<Range, n>> partial(blocks);
        parallel_ranges(blocks, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t block = begin; block < end; ++block)
                for (std::size_t i = block * kGrain; i < std::min((block + 1) * kGrain, count); ++i)
                    add(i, partial[block]);
        });
        std::array<Range, n> all;
        for (const auto& p : partial)
            for (std::size_t k = 0; k < n; ++k) all[k].add(p[k]);
        return all;
    }

    const Scene* scene_;
    std::vector<Plane> planes_;
    std::vector<std::uint64_t> planes_of_position_;  ///< bit i: corner of a triangle in planes_[i]; kMaxPlanes: in none
    std::vector<Part> parts_;
    std::uint64_t drawn_ = 0, fitted_ = 0;  ///< bits as in planes_of_position_
    Box box_;
};

/// Rolls the frame about its z and sets window, near and far so that it just holds the scene. False, with the frame as
/// it was, where a perspective window would reach further than `widest` from the middle or behind the light.
bool fit_to_scene(Frame& frame, const Casters& casters, double widest) {
    // The scene's own axes make good edges of the window (floors, walls); the other rolls are spread evenly.
    std::array<double, kRolls> angles;
    for (int i = 0; i < 3; ++i) angles[i] = std::atan2(frame.y[i], frame.x[i]);
    for (int i = 3; i < kRolls; ++i) angles[i] = (i - 3) * (kPi / 2) / (kRolls - 3);
    std::array<dvec2, kRolls> rolls;
    for (int i = 0; i < kRolls; ++i) rolls[i] = {std::cos(angles[i]), std::sin(angles[i])};

    const auto ranges = casters.ranges<2 * kRolls + 1>([&](dvec3 p) {
        std::array<double, 2 * kRolls + 1> values;
        dvec3 v            = frame.light_space(p);
        values[2 * kRolls] = v.z;
        if (frame.perspective) v /= v.z;
        for (int i = 0; i < kRolls; ++i) {
            values[2 * i]     = rolls[i].x * v.x + rolls[i].y * v.y;
            values[2 * i + 1] = rolls[i].x * v.y - rolls[i].y * v.x;
        }
        return values;
    });
    const Range depth = ranges.back();
    int best          = 0;
    const auto area   = [&](int i) { return ranges[2 * i].half() * ranges[2 * i + 1].half(); };
    for (int i = 1; i < kRolls; ++i)
        if (area(i) < area(best)) best = i;
    if (frame.perspective) {
        if (!(depth.min > 0)) return false;
        for (const Range& r : {ranges[2 * best], ranges[2 * best + 1]})
            if (std::max(-r.min, r.max) > widest) return false;
    }

    const dvec3 x = frame.x;
    frame.x       = rolls[best].x * x + rolls[best].y * frame.y;
    frame.y       = rolls[best].x * frame.y - rolls[best].y * x;
    frame.centre  = {ranges[2 * best].centre(), ranges[2 * best + 1].centre()};
    frame.half    = {ranges[2 * best].half(), ranges[2 * best + 1].half()};
    frame.near    = depth.min;
    frame.far     = depth.max;
    frame.reach   = kInfinity;
    // Scenes that the light sees edge-on have no area, those that it sees flat no depth.
    frame.half = glm::max(frame.half, dvec2(1e-6 * std::max(frame.half.x, frame.half.y)));
    return true;
}

// ---- comparing -----------------------------------------------------------------------------------------------------

enum class Bias : std::uint8_t { automatic, receiver_plane, manual };

struct Options {
    int resolution;
    DepthFormat format;
    Bias bias;
    double constant, slope, normal_offset;
    int radius;  ///< of the PCF kernel; 0 with `nearest`
    bool bilinear;
    Faces faces;
    bool fit_to_casters;
    double surround;
};

/// A surface point's triangle, exact in double.
struct Facet {
    dvec3 a, ab, ac;
    dvec3 normal;  ///< unit, on the side of the batch's normal
};

/// The receiver in one map: where the point lies, and its triangle's plane r(x, y) there.
struct Receiver {
    double x, y;      ///< samples
    double r;         ///< nearness of the point
    double r_x, r_y;  ///< nearness of its plane, a sample
    double bias;      ///< nearness added to all comparisons
};

/// The receiver in a view, or nothing where the view does not cover it.
std::optional<Receiver> receive(const View& view, const Facet& facet, dvec3 p, const Options& options) {
    const Frame& f = view.frame;
    dvec3 v        = f.light_space(p);
    const dvec3 n{glm::dot(f.x, facet.normal), glm::dot(f.y, facet.normal), glm::dot(f.z, facet.normal)};
    const auto ndc = [&](dvec3 q) { return (dvec2(q) / (f.perspective ? q.z : 1.0) - f.centre) / f.half; };
    if (f.perspective && v.z <= 0) return {};
    if (const dvec2 at = glm::abs(ndc(v)); at.x > f.reach || at.y > f.reach) return {};

    const dvec2 sample = 2.0 * f.half / dvec2(view.map.width(), view.map.height());   // in window units
    const double width = std::max(sample.x, sample.y) * (f.perspective ? v.z : 1.0);  // in world units
    if (options.normal_offset > 0) {
        // A plane seen head-on needs no offset, a grazing one all of it.
        const double cosine = f.perspective ? glm::dot(n, v) / glm::length(v) : n.z;
        v += options.normal_offset * width * std::sqrt(std::max(0.0, 1 - cosine * cosine)) * n;
        if (f.perspective && v.z <= 0) return {};
    }

    Receiver receiver;
    const dvec2 at = ndc(v);
    receiver.x     = (at.x + 1) * 0.5 * view.map.width();
    receiver.y     = (at.y + 1) * 0.5 * view.map.height();
    receiver.r     = f.nearness(v.z);

    // dot(n, v) = d is, with s = x/z and t = y/z, 1/z = (n.x s + n.y t + n.z) / d, and nearness is affine in 1/z.
    // Orthographic: z = (d - n.x x - n.y y) / n.z.
    const double scale =
        f.perspective ? f.near * f.far / ((f.far - f.near) * glm::dot(n, v)) : 1 / ((f.far - f.near) * n.z);
    receiver.r_x = std::isfinite(scale) ? scale * n.x * sample.x : 0;
    receiver.r_y = std::isfinite(scale) ? scale * n.y * sample.y : 0;

    // Between the point and a sample, a hollow surface rises above the point's plane: by as much as the sample lies off
    // where it turns by 45 degrees, and the more the flatter the light falls: half a gradient more was enough for
    // nearly all points of scanned meshes.
    const double off      = options.bias == Bias::automatic ? options.radius + 0.5 : 0.0;
    const double gradient = std::max(std::abs(receiver.r_x), std::abs(receiver.r_y));
    receiver.bias =
        (options.constant + off) * width * f.nearness_per_depth(v.z) + (options.slope + 0.5 * off) * gradient;
    // The map's values are rounded and its corners snapped.
    if (options.bias != Bias::manual)
        receiver.bias +=
            view.map.quantum(receiver.r) + (std::abs(receiver.r_x) + std::abs(receiver.r_y)) / DepthMap::kSnap;
    return receiver;
}

/// Does the map show anything nearer than the receiver at sample (i, j)?
bool is_blocked(const DepthMap& map, const Receiver& p, int i, int j, Bias bias) {
    if (i < 0 || j < 0 || i >= map.width() || j >= map.height()) return false;
    double r = p.r;
    if (bias != Bias::manual) {
        const double plane = p.r + p.r_x * (i + 0.5 - p.x) + p.r_y * (j + 0.5 - p.y);
        r                  = bias == Bias::automatic ? std::max(r, plane) : plane;
    }
    return map.nearness(i, j) > std::max(r + p.bias, 0.0);  // behind all that casts, r is negative
}

/// PCF: the share of the samples about the point that are not blocked, never a comparison with filtered depth.
float lit_share(const DepthMap& map, const Receiver& p, const Options& options) {
    const int radius = options.radius;
    if (!options.bilinear) {
        const int x = static_cast<int>(std::floor(p.x));
        const int y = static_cast<int>(std::floor(p.y));
        if (radius == 0) return is_blocked(map, p, x, y, options.bias) ? 0.0f : 1.0f;
        int lit = 0;
        for (int j = -radius; j <= radius; ++j)
            for (int i = -radius; i <= radius; ++i) lit += !is_blocked(map, p, x + i, y + j, options.bias);
        return static_cast<float>(lit) / static_cast<float>((2 * radius + 1) * (2 * radius + 1));
    }
    // A box of 2 radius + 1 samples that moves with the point: its border samples count by how much of them it covers.
    const int x     = static_cast<int>(std::floor(p.x - 0.5));
    const int y     = static_cast<int>(std::floor(p.y - 0.5));
    const double fx = p.x - 0.5 - x;
    const double fy = p.y - 0.5 - y;
    double lit      = 0;
    for (int j = -radius; j <= radius + 1; ++j)
        for (int i = -radius; i <= radius + 1; ++i) {
            if (is_blocked(map, p, x + i, y + j, options.bias)) continue;
            const double wx = i == -radius ? 1 - fx : i == radius + 1 ? fx : 1;
            const double wy = j == -radius ? 1 - fy : j == radius + 1 ? fy : 1;
            lit += wx * wy;
        }
    return static_cast<float>(std::clamp(lit / ((2 * radius + 1) * (2 * radius + 1)), 0.0, 1.0));
}

// ---- the method ----------------------------------------------------------------------------------------------------

constexpr Parameter kParameters[] = {
    {"resolution",
     Parameter::Type::integer,
     "2048",
     "samples along each side of a map (a cube has six)",
     16,
     16384,
     {}},
    {"depth", Parameter::Type::choice, "float", "bits of a depth value; float is kept reversed", 0, 0,
     "16|24|32|float"},
    {"bias", Parameter::Type::choice, "auto",
     "what a sample is compared with: manual: the point; receiver_plane: the point's plane at the sample, nearer by "
     "what "
     "rounding costs; auto: the nearer of the two, by half a sample's width and gradient nearer still",
     0, 0, "auto|receiver_plane|manual"},
    {"constant",
     Parameter::Type::real,
     "0",
     "moves the point towards the light, in widths of a sample there",
     0,
     1e6,
     {}},
    {"slope",
     Parameter::Type::real,
     "0",
     "moves the point towards the light, in times its plane's depth gradient a sample",
     0,
     1e6,
     {}},
    {"normal_offset",
     Parameter::Type::real,
     "0",
     "moves the point along its normal, in widths of a sample times the sine of the light's angle",
     0,
     64,
     {}},
    {"filter", Parameter::Type::choice, "nearest", "nearest: one comparison; pcf: the mean of those about the point", 0,
     0, "nearest|pcf"},
    {"radius", Parameter::Type::integer, "1", "pcf: takes (2 radius + 1)^2 samples", 0, 16, {}},
    {"bilinear",
     Parameter::Type::boolean,
     "true",
     "pcf: weights samples by how much of them the moving kernel covers",
     0,
     0,
     {}},
    {"faces", Parameter::Type::choice, "all",
     "which side of triangles casts; back (second depth) and front want closed, outward occluders", 0, 0,
     "all|front|back"},
    {"fit", Parameter::Type::choice, "casters",
     "what maps are fitted to: scene: all of it; casters: what can block the light, without planes behind all else", 0,
     0, "casters|scene"},
    {"surround",
     Parameter::Type::real,
     "0.5",
     "spot lights: resolution of the maps around the cone, in times the cone's own; 0: no maps, points undefined there",
     0,
     1,
     {}},
};

Options read(const Settings& s) {
    Options o;
    o.resolution         = s.integer("resolution");
    const std::string& d = s.choice("depth");
    o.format             = d == "16"   ? DepthFormat::unorm16
                           : d == "24" ? DepthFormat::unorm24
                           : d == "32" ? DepthFormat::unorm32
                                       : DepthFormat::float32;
    const std::string& b = s.choice("bias");
    o.bias               = b == "auto" ? Bias::automatic : b == "manual" ? Bias::manual : Bias::receiver_plane;
    o.constant           = s.real("constant");
    o.slope              = s.real("slope");
    o.normal_offset      = s.real("normal_offset");
    const bool pcf       = s.choice("filter") == "pcf";
    o.radius             = pcf ? s.integer("radius") : 0;
    o.bilinear           = pcf && s.boolean("bilinear");
    const std::string& f = s.choice("faces");
    o.faces              = f == "front" ? Faces::front : f == "back" ? Faces::back : Faces::all;
    o.fit_to_casters     = s.choice("fit") == "casters";
    o.surround           = s.real("surround");
    return o;
}

class ShadowZBuffer final : public Method {
public:
    explicit ShadowZBuffer(const Settings& settings) : options_(read(settings)) {
        if (4 * border() > options_.resolution)
            throw UsageError(
                fmt::format("radius={} and normal_offset={} reach over a quarter of resolution={} "
                            "(choose a resolution of at least {})",
                            options_.radius, options_.normal_offset, options_.resolution, std::ceil(4 * border())));
    }

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        std::string why = "any triangles and lights, through a map that samples depth";
        if (!facts.hard_lights_only) why += "; area lights stand in their centres, so that penumbrae are missing";
        if (options_.faces != Faces::all && (facts.open_objects > 0 || facts.nonmanifold_objects > 0))
            why += "; open meshes cast with one side only";
        return {How::approximately, why + "."};
    }

    void build(const Scene& scene, const SceneFacts& facts) override {
        views_.clear();
        casters_.emplace(scene, facts, options_.fit_to_casters);
    }

    void aim(LightId light) override {
        views_.clear();
        covers_all_    = true;
        const Light& l = casters_->scene().lights[light];
        casters_->select(l);
        if (casters_->box().empty()) return;
        if (l.kind == LightKind::directional)
            aim_directional(dvec3(l.direction));
        else
            aim_around(l);
        for (View& view : views_) {
            const dmat4 clip_from_world = view.frame.clip_from_world();
            view.map.draw(clip_from_world, casters_->scene().positions, casters_->seen_by(clip_from_world),
                          options_.faces);
        }
    }

    void visibility(const PointBatch& points, LightId light, std::span<float> s,
                    std::span<std::uint8_t> defined) override {
        const std::vector<Facing>& facing = points.facing[light];
        parallel_ranges(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            Facet facet{};
            TriangleId facet_of = kNoTriangle;
            bool facet_flipped  = false;
            for (std::size_t i = begin; i < end; ++i) {
                if (facing[i] == Facing::none || facing[i] == Facing::away) continue;
                if (points.triangle[i] != facet_of || (points.flipped[i] != 0) != facet_flipped) {
                    facet_of      = points.triangle[i];
                    facet_flipped = points.flipped[i] != 0;
                    facet         = make_facet(facet_of, facet_flipped);
                }
                const dvec3 p =
                    facet.a + static_cast<double>(points.u[i]) * facet.ab + static_cast<double>(points.v[i]) * facet.ac;
                defined[i] = look_up(facet, p, facing[i], casters_->scene().lights[light], s[i]);
            }
        });
    }

    [[nodiscard]] std::size_t memory_bytes() const override {
        std::size_t bytes = casters_ ? casters_->memory_bytes() : 0;
        for (const View& view : views_) bytes += view.map.memory_bytes();
        return bytes;
    }

private:
    /// Samples by which a map reaches over its view: what the filter and the offset may ask for, and a rounding.
    [[nodiscard]] double border() const { return options_.radius + options_.normal_offset + 2; }

    void add_view(Frame frame, int resolution) {
        const double inner = 1 - 2 * border() / resolution;
        frame.half /= inner;
        if (std::isfinite(frame.reach)) frame.reach = inner + 1e-3 / resolution;
        if (frame.perspective) {
            // Of unorm depth, a step at `far` must not exceed a sample's width there: near bounds that step.
            const double floor = options_.format == DepthFormat::float32
                                     ? kFloatNear
                                     : resolution * DepthMap(1, 1, options_.format).quantum(1) / 2;
            frame.near         = std::min(std::max(frame.near, floor * frame.far), 0.5 * frame.far);
        } else {
            frame.near = std::min(frame.near, frame.far - 1e-6 * std::max(frame.half.x, frame.half.y));
        }
        // The scene's last depth is not nearness 0, where the steps of floats no longer tell how far they are rounded.
        frame.far += 0.01 * (frame.far - frame.near);
        if (casters_->seen_by(frame.clip_from_world()).empty()) return;
        const double bytes = 4.0 * resolution * resolution;
        const double physical =
            static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
        if (static_cast<double>(memory_bytes()) + bytes > 0.5 * physical)
            throw UsageError(
                fmt::format("shadow_zbuffer: resolution={} takes more than half of the machine's memory "
                            "({:.0f} MiB a map, {} of them as yet; choose a smaller one)",
                            options_.resolution, bytes / (1 << 20), views_.size()));
        views_.push_back({frame, DepthMap(resolution, resolution, options_.format)});
    }

    void aim_directional(dvec3 direction) {
        Frame frame = looking_along(dvec3(casters_->box().centre()), direction, false);
        fit_to_scene(frame, *casters_, kInfinity);
        add_view(frame, options_.resolution);
    }

    void aim_around(const Light& light) {
        const dvec3 origin(light.position);
        // Reversed floats resolve any distance from the light as well as any other, unorm depth does not.
        const double nearest = options_.format == DepthFormat::float32 ? 0 : casters_->distance(origin);
        Frame cube =
            looking_along(origin, light.kind == LightKind::spot ? dvec3(light.direction) : dvec3(0, 0, 1), true);
        int resolution = options_.resolution;
        if (light.kind == LightKind::spot) {
            const double rim = std::tan(static_cast<double>(light.spot.cutoff));
            Frame cone       = cube;
            if (rim > 0 && fit_to_scene(cone, *casters_, std::min(rim, kWideCone))) return add_view(cone, resolution);
            if (rim > 0 && rim <= kWideCone) {
                cone.half = dvec2(rim);
                set_depth(cone, nearest);
                add_view(cone, resolution);
                covers_all_ = options_.surround > 0;
                if (!covers_all_) return;
                resolution = static_cast<int>(std::ceil(std::max(options_.surround * resolution, 4 * border())));
            }
        }
        const dvec3 to_scene = dvec3(casters_->box().centre()) - origin;
        if (views_.empty() && glm::length(to_scene) > 0) {
            Frame whole = looking_along(origin, to_scene, true);
            if (fit_to_scene(whole, *casters_, kWide)) return add_view(whole, resolution);
        }
        // Sides of the cube as even permutations and turns of one right-handed frame.
        const std::array<dvec3, 3> axes{cube.x, cube.y, cube.z};
        for (int k = 0; k < 3; ++k)
            for (double sign : {1.0, -1.0}) {
                Frame side = cube;
                side.x     = sign * axes[(k + 1) % 3];
                side.y     = axes[(k + 2) % 3];
                side.z     = sign * axes[k];
                set_depth(side, nearest);
                add_view(side, resolution);
            }
    }

    /// Depth limits of a perspective window about the axis, with no geometry nearer to the light than `nearest`.
    void set_depth(Frame& frame, double nearest) const {
        const auto depth = casters_->ranges<1>([&](dvec3 p) { return std::array{frame.light_space(p).z}; });
        frame.far        = depth[0].max > 0 ? depth[0].max : 1;
        frame.near       = std::max(depth[0].min, nearest / std::sqrt(1 + glm::dot(frame.half, frame.half)));
    }

    [[nodiscard]] Facet make_facet(TriangleId t, bool flipped) const {
        const Scene& scene = casters_->scene();
        const dvec3 a(scene.vertex(t, 0));
        Facet facet{a, dvec3(scene.vertex(t, 1)) - a, dvec3(scene.vertex(t, 2)) - a, {}};
        facet.normal = glm::normalize(glm::cross(facet.ab, facet.ac)) * (flipped ? -1.0 : 1.0);
        return facet;
    }

    /// Writes S_j of one point; false where no view covers it.
    bool look_up(const Facet& facet, dvec3 p, Facing facing, const Light& light, float& s) const {
        // An area light that the receiver's plane cuts may have its centre behind.
        if (facing == Facing::partly && glm::dot(facet.normal, dvec3(light.position) - p) <= 0) {
            s = 0;
            return true;
        }
        for (const View& view : views_)
            if (const std::optional<Receiver> receiver = receive(view, facet, p, options_)) {
                s = lit_share(view.map, *receiver, options_);
                return true;
            }
        s = 1;  // nothing that casts lies where no view looks
        return covers_all_;
    }

    Options options_;
    std::optional<Casters> casters_;
    std::vector<View> views_;
    bool covers_all_ = true;  ///< false: what lies outside a spot's cone was left out
};

}  // namespace

extern const MethodInfo shadow_zbuffer;
const MethodInfo shadow_zbuffer{
    "shadow_zbuffer",
    "Shadow z-buffer",
    "Lance Williams, Casting Curved Shadows on Curved Surfaces, 1978",
    "Draws the depth of what the light sees into a map, then compares each surface point with it. Serves any geometry; "
    "errs by the map's samples along shadow edges and where surfaces are seen at a grazing angle from the light.",
    kParameters,
    make_method<ShadowZBuffer>,
};

}  // namespace umbra
