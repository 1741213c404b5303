#include "umbra/tests/support/adversarial_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "umbra/core/base/random_bits.h"

namespace umbra {
namespace {

class Dice {
public:
    explicit Dice(std::uint64_t seed) : state_(mixed_bits(seed)) {}

    int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }
    int from_to(int low, int high) { return low + below(high - low + 1); }
    bool one_in(int n) { return below(n) == 0; }
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }  ///< [0, 1)
    double real(double low, double high) { return low + (high - low) * unit(); }
    template <class T>
    T any(std::initializer_list<T> list) {
        return list.begin()[below(static_cast<int>(list.size()))];
    }
    dvec3 grid(int reach) {
        const int x = from_to(-reach, reach), y = from_to(-reach, reach), z = from_to(-reach, reach);
        return {x, y, z};
    }
    dvec3 cloud(double reach) {
        const double x = real(-reach, reach), y = real(-reach, reach), z = real(-reach, reach);
        return {x, y, z};
    }
    dvec3 axis() {
        dvec3 d(0);
        d[below(3)] = any({-1.0, 1.0});
        return d;
    }
    /// One of these lengths along a direction.
    dvec3 step(std::initializer_list<double> lengths) {
        const double length = any(lengths);
        return length * direction();
    }
    /// Not zero.
    dvec3 direction() {
        const int kind = below(3);
        if (kind == 0) return axis();
        for (;;) {
            const dvec3 d = kind == 1 ? grid(2) : cloud(1);
            if (d != dvec3(0)) return d;
        }
    }

private:
    std::uint64_t bits() { return mixed_bits(state_++); }
    std::uint64_t state_;
};

/// In a space of its own, in which coordinates are small whole numbers as far as they can be.
struct Corners {
    dvec3 a, b, c;
};
using Soup = std::vector<Corners>;

void add_quad(Soup& soup, dvec3 a, dvec3 b, dvec3 c, dvec3 d) {
    soup.push_back({a, b, c});
    soup.push_back({a, c, d});
}

void add_floor(Soup& soup, Dice& dice) {
    const double s = dice.any({2.0, 4.0, 4.0, 1e3, 1e8});
    if (dice.one_in(2))
        add_quad(soup, {-s, 0, s}, {s, 0, s}, {s, 0, -s}, {-s, 0, -s});
    else
        add_quad(soup, {s, 0, s}, {s, 0, -s}, {-s, 0, -s}, {-s, 0, s});
}

void add_box(Soup& soup, Dice& dice) {
    // In braces, here and below: in them arguments are evaluated from left to right.
    const dvec3 low{double(dice.from_to(-2, 1)), dice.any({0.0, 0.0, 1.0, 0x1p-20}), double(dice.from_to(-2, 1))};
    const dvec3 size{double(dice.from_to(1, 2)), double(dice.from_to(1, 2)), double(dice.from_to(1, 2))};
    const dvec3 high = low + size;
    const auto at    = [&](int k) {
        return dvec3(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
    };
    const int faces      = dice.one_in(3) ? 5 : 6;  // open or closed
    const int side[6][4] = {{0, 1, 5, 4}, {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 2, 3, 1}, {4, 5, 7, 6}, {2, 6, 7, 3}};
    for (int f = 0; f < faces; ++f) add_quad(soup, at(side[f][0]), at(side[f][1]), at(side[f][2]), at(side[f][3]));
}

/// Sheets that stand on y = 0, lie above it, or follow one another by an ulp.
void add_sheets(Soup& soup, Dice& dice) {
    const int sheets = dice.from_to(1, 3);
    for (int k = 0; k < sheets; ++k) {
        const double x = dice.from_to(-1, 1), top = dice.from_to(1, 2);
        switch (dice.below(4)) {
            case 0: add_quad(soup, {x, 0, -1}, {x, 0, 1}, {x, top, 1}, {x, top, -1}); break;
            case 1: add_quad(soup, {-1, top, x}, {1, top, x}, {1, top, x + 1}, {-1, top, x + 1}); break;
            case 2: {  // two sheets with a crack of an ulp, or an overlap
                const double seam = dice.any({1.0, 1.0 + 0x1p-23, 1.0 - 0x1p-24, 1.0 + 0x1p-20});
                add_quad(soup, {-1, top, -1}, {1, top, -1}, {1, top, 1}, {-1, top, 1});
                add_quad(soup, {seam, top, -1}, {3, top, -1}, {3, top, 1}, {seam, top, 1});
                break;
            }
            default: {  // one over the other
                const double gap = dice.any({0x1p-23, 0x1p-22, 0x1p-10, 0x1p-40});
                add_quad(soup, {-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1});
                add_quad(soup, {-1, 1 + gap, -1}, {1, 1 + gap, -1}, {1, 1 + gap, 1}, {-1, 1 + gap, 1});
            }
        }
    }
}

void add_grid_triangles(Soup& soup, Dice& dice) {
    const int count = dice.from_to(1, 6), reach = dice.from_to(1, 4);
    for (int k = 0; k < count; ++k) {
        const dvec3 a = dice.grid(reach), b = dice.grid(reach), c = dice.grid(reach);
        soup.push_back({a, b, c});
    }
}

void add_cloud_triangles(Soup& soup, Dice& dice) {
    const int count = dice.from_to(1, 6);
    for (int k = 0; k < count; ++k) {
        const dvec3 a = dice.cloud(4), b = dice.cloud(4), c = dice.cloud(4);
        soup.push_back({a, b, c});
    }
}

constexpr std::initializer_list<double> kTiny = {1e-17, 1e-14, 1e-12, 1e-9, 3e-8, 1e-7, 1e-6, 1e-4, 1e-2};

/// Slivers at an edge of a triangle that is there: folded over it, continuing it, or beside it.
void add_slivers(Soup& soup, Dice& dice) {
    if (soup.empty()) add_grid_triangles(soup, dice);
    const int count = dice.from_to(1, 3);
    for (int k = 0; k < count; ++k) {
        const Corners t   = soup[static_cast<std::size_t>(dice.below(static_cast<int>(soup.size())))];
        const dvec3 along = t.b - t.a, inside = t.c - t.a;
        const double at   = dice.any({0.5, 0.25, 0.3, 1e-3, 2.0});
        const double side = dice.any({-1.0, 1.0}), way = dice.any(kTiny);
        const dvec3 off = dice.one_in(2) ? way * dice.direction() : side * way * inside;
        const Corners sliver{t.a, t.b, t.a + at * along + off};
        soup.push_back(dice.one_in(2) ? sliver : Corners{sliver.b, sliver.a, sliver.c});
    }
}

void add_needles(Soup& soup, Dice& dice) {
    const int count = dice.from_to(1, 3);
    for (int k = 0; k < count; ++k) {
        const dvec3 a = dice.one_in(2) ? dice.grid(2) : dice.cloud(2);
        const dvec3 b = a + dice.step({4.0, 1.0, 1e-6});
        soup.push_back({a, b, a + dice.step(kTiny)});
    }
}

/// The same triangle again, turned over, or without area.
void add_repeats(Soup& soup, Dice& dice) {
    if (soup.empty()) add_grid_triangles(soup, dice);
    const Corners t = soup[static_cast<std::size_t>(dice.below(static_cast<int>(soup.size())))];
    switch (dice.below(4)) {
        case 0: soup.push_back(t); break;
        case 1: soup.push_back({t.b, t.a, t.c}); break;
        case 2: soup.push_back({t.a, t.b, t.a + 0.5 * (t.b - t.a)}); break;
        default: soup.push_back({t.a, t.a, t.c});
    }
}

/// Around one vertex, open or closed, flat or a cone.
void add_fan(Soup& soup, Dice& dice) {
    const dvec3 rim[] = {{2, 0, 0}, {1, 0, 2}, {-1, 0, 2}, {-2, 0, 0}, {-1, 0, -2}, {1, 0, -2}};
    const dvec3 lift{double(dice.from_to(-1, 1)), double(dice.from_to(1, 2)), 0},
        tip(0, dice.any({0.0, 1.0, -1.0, 0x1p-24}), 0);
    const int count = dice.from_to(2, 6);
    for (int k = 0; k < count; ++k) soup.push_back({lift + tip, lift + rim[k], lift + rim[(k + 1) % 6]});
}

/// A sliver that is folded onto its triangle, continues it or leaves its plane, by as little as rotations leave of a
/// zero: a corner is moved by 1e-17 where its coordinate is 0. Either may be turned over.
void add_folds(Soup& soup, Dice& dice) {
    const double e = dice.any({1e-17, 1e-19, 1e-24});
    dvec3 a, b, c, d;
    if (dice.one_in(2)) {  // both in y = 1
        const double s = dice.any({1.0, 2.0}), sign = dice.any({-1.0, 1.0}), at = dice.any({0.5, 0.25});
        a = {0, 1, dice.any({-1.0, 1.0}) * e}, b = {s, 1, 0.5 * s}, c = {s, 1, sign * s};
        d = at * dvec3(s, 0, 0.5 * s) + dvec3(0, 1, 0);
    } else {  // the sliver's corner is beside the middle of the edge, the origin
        do a = dice.grid(2), c = dice.grid(2);
        while (glm::cross(a, c) == dvec3(0));
        b = -a, d = e * dice.grid(1);
    }
    soup.push_back(dice.one_in(2) ? Corners{a, b, c} : Corners{b, a, c});
    soup.push_back(dice.one_in(2) ? Corners{a, b, d} : Corners{b, a, d});
}

/// What rotations leave of zeros, along one axis or all: equal corners stay equal.
void smear_zeros(Soup& soup, Dice& dice) {
    const int axis     = dice.below(4);  // 3: all
    const double least = dice.any({1e-17, 1e-19, 1e-24});
    std::vector<std::pair<dvec3, dvec3>> moved;
    for (Corners& t : soup)
        for (dvec3* corner : {&t.a, &t.b, &t.c}) {
            auto known = std::ranges::find(moved, *corner, [](const auto& pair) { return pair.first; });
            if (known == moved.end()) {
                dvec3 to = *corner;
                for (int k = 0; k < 3; ++k)
                    if (to[k] == 0 && (axis == k || axis == 3)) to[k] = least * dice.any({-1.0, 0.0, 1.0, 3.0});
                known = moved.emplace(moved.end(), *corner, to);
            }
            *corner = known->second;
        }
}

/// A surface that has seams: closed, or a sheet of many triangles.
void add_surface(Soup& soup, Dice& dice) {
    const dvec3 low{double(dice.from_to(-2, 1)), double(dice.from_to(1, 2)), double(dice.from_to(-2, 1))};
    const auto add_cuboid = [&](dvec3 corner, dvec3 size) {
        const auto at        = [&](int k) { return corner + size * dvec3(k & 1, k >> 1 & 1, k >> 2); };
        const int side[6][4] = {{0, 1, 5, 4}, {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 2, 3, 1}, {4, 5, 7, 6}, {2, 6, 7, 3}};
        for (const auto& f : side) add_quad(soup, at(f[0]), at(f[1]), at(f[2]), at(f[3]));
    };
    switch (dice.below(6)) {
        case 0: add_cuboid(low, dvec3(1)); break;
        case 1:  // side by side
            add_cuboid(low, dvec3(1));
            add_cuboid(low + dvec3(1, 0, 0), dvec3(1, dice.any({1.0, 2.0}), 1));
            break;
        case 2: {  // a sheet over the lattice, its diagonals either way
            double height[4][4];
            const int rough = dice.below(2);
            for (auto& row : height)
                for (double& y : row) y = low.y + dice.from_to(0, rough);
            for (int x = 0; x < 3; ++x)
                for (int z = 0; z < 3; ++z) {
                    const auto at = [&](int i, int k) {
                        return dvec3(low.x + x + i, height[x + i][z + k], low.z + z + k);
                    };
                    if (dice.one_in(2))
                        add_quad(soup, at(0, 0), at(1, 0), at(1, 1), at(0, 1));
                    else
                        add_quad(soup, at(1, 0), at(1, 1), at(0, 1), at(0, 0));
                }
            break;
        }
        case 3: {  // two pyramids, base to base
            const dvec3 rim[] = {{1, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 0, -1}};
            for (int k = 0; k < 4; ++k)
                for (const double tip : {1.0, -1.0})
                    soup.push_back({low + dvec3(0, tip, 0), low + rim[k], low + rim[(k + 1) % 4]});
            break;
        }
        case 4: {  // around one corner, closed or with a gap
            const dvec3 rim[] = {{2, 0, 0}, {1, 0, 2}, {-1, 0, 2}, {-2, 0, 0}, {-1, 0, -2}, {1, 0, -2}};
            const dvec3 tip{0, double(dice.from_to(-1, 1)), 0};
            const int count = dice.from_to(4, 6);
            for (int k = 0; k < count; ++k) soup.push_back({low + tip, low + rim[k], low + rim[(k + 1) % 6]});
            break;
        }
        default: {  // twins, one of them turned over
            const dvec3 a = low, b = low + dvec3(2, 0, 0), c = low + dvec3(2, 0, 2), d = low + dvec3(0, 0, 2);
            add_quad(soup, a, b, c, d);
            add_quad(soup, b, a, d, c);
        }
    }
}

struct Part {
    const char* name;
    void (*add)(Soup&, Dice&);
};
constexpr Part kParts[] = {{"floor", add_floor},
                           {"box", add_box},
                           {"sheets", add_sheets},
                           {"grid", add_grid_triangles},
                           {"cloud", add_cloud_triangles},
                           {"slivers", add_slivers},
                           {"needles", add_needles},
                           {"repeats", add_repeats},
                           {"fan", add_fan},
                           {"folds", add_folds}};

/// From the small space into the world.
struct Placement {
    bool turned  = false;  ///< by the angle of 3, 4, 5, whose sine is no float
    double scale = 1;
    dvec3 base{0};

    [[nodiscard]] dvec3 turn(dvec3 d) const {
        return turned ? dvec3(0.6 * d.x - 0.8 * d.y, 0.8 * d.x + 0.6 * d.y, d.z) : d;
    }
    [[nodiscard]] vec3 position(dvec3 p) const { return vec3(base + scale * turn(p)); }
    [[nodiscard]] vec3 vector(dvec3 d) const { return vec3(scale * turn(d)); }
};

Placement any_placement(Dice& dice, bool area) {
    Placement place;
    place.turned = dice.one_in(4);
    if (dice.one_in(3)) {
        // The limits of what readers accept are 1e-18 and 1e18; lights with an area have a size that must keep them.
        place.scale = std::ldexp(1.0, area ? dice.from_to(-40, 40) : dice.from_to(-130, 48));
        if (dice.one_in(3)) place.scale *= dice.real(1, 2);
    }
    if (dice.one_in(4)) {
        // So far from the origin that a unit is a few ulps of the coordinates, or many.
        const double away = place.scale * std::ldexp(1.0, dice.from_to(4, 22));
        place.base        = away * dice.grid(1);
        if (glm::length(place.base) > 1e17) place.base = dvec3(0);
    }
    return place;
}

/// A point of a triangle by its barycentrics: inside, on edges, in corners, beside them.
vec2 any_name(Dice& dice) {
    const auto share = [&] {
        switch (dice.below(4)) {
            case 0: return static_cast<float>(dice.from_to(0, 8)) / 8;
            case 1: return std::ldexp(1.0f, -dice.from_to(1, 70));
            default: return static_cast<float>(dice.unit());
        }
    };
    switch (dice.below(8)) {
        case 0: return {0, share()};
        case 1: return {share(), 0};
        case 2: {
            const float u = share();
            return {u, 1 - u};
        }
        default: {
            float u = share(), v = share();
            if (u + v > 1) u = 1 - u, v = 1 - v;
            return {u, v};
        }
    }
}

/// Eighths: what is named so is a float, and doubles hold what is computed from it.
vec2 lattice_name(Dice& dice) {
    const int u = dice.from_to(0, 8), v = dice.from_to(0, 8 - u);
    return vec2(u, v) / 8.0f;
}

class Lighting {
public:
    Lighting(const Soup& soup, Dice& dice) : soup_(soup), dice_(dice) {}

    Light hard(const Placement& place);
    Light behind_a_seam();
    Light area(const Placement& place, bool round);

    /// The point that the last light was aimed from, if it was.
    struct Aimed {
        std::size_t triangle;
        vec2 name;
    };
    [[nodiscard]] const std::optional<Aimed>& aimed() const { return aimed_; }

private:
    const Corners& any_triangle() {
        return soup_[static_cast<std::size_t>(dice_.below(static_cast<int>(soup_.size())))];
    }
    static dvec3 corner(const Corners& t, int k) { return k == 0 ? t.a : k == 1 ? t.b : t.c; }
    dvec3 position();
    dvec3 beside_an_edge(double past, bool on_lattice = false);

    const Soup& soup_;
    Dice& dice_;
    std::optional<Aimed> aimed_;
};

dvec3 Lighting::position() {
    const Corners& t = any_triangle();
    const dvec3 ab = t.b - t.a, ac = t.c - t.a;
    switch (dice_.below(9)) {
        case 0: return corner(t, dice_.below(3));
        case 1: return t.a + 0.5 * ab;
        case 2: return t.a + 0.25 * ab + 0.25 * ac;
        case 3: {  // in its plane
            const double along_b = dice_.from_to(-3, 4), along_c = dice_.from_to(-3, 4);
            return t.a + along_b * ab + along_c * ac;
        }
        case 4: {  // beyond one corner as another one sees it
            const Corners& other = any_triangle();
            const dvec3 from     = corner(other, dice_.below(3));
            const double past    = dice_.any({2.0, 3.0, 1.5});
            return from + past * (corner(t, dice_.below(3)) - from);
        }
        case 5: return t.a + 0.25 * ab + 0.25 * ac + dice_.step({1e-7, 1e-4, 1e-2});
        case 6: return dice_.step({1e2, 1e5, 1e9, 1e13});
        case 7: return dice_.grid(4);
        default: return dice_.cloud(4);
    }
}

/// Behind an edge of the scene, as some point of it sees that edge.
dvec3 Lighting::beside_an_edge(double past, bool on_lattice) {
    const auto own       = static_cast<std::size_t>(dice_.below(static_cast<int>(soup_.size())));
    const vec2 name      = on_lattice ? lattice_name(dice_) : any_name(dice_);
    const Corners& t     = soup_[own];
    const Corners& other = any_triangle();
    const dvec3 from     = t.a + double(name.x) * (t.b - t.a) + double(name.y) * (t.c - t.a);
    const int k          = dice_.below(3);
    const dvec3 start = corner(other, k), end = corner(other, (k + 1) % 3);
    const dvec3 edge =
        start + (on_lattice ? dice_.any({0.0, 0.5, 0.5, 0.25}) : dice_.any({0.0, 0.5, 0.3, 0.8})) * (end - start);
    aimed_ = Aimed{own, name};
    return from + past * (edge - from);
}

Light Lighting::hard(const Placement& place) {
    Light light;
    aimed_.reset();
    if (dice_.one_in(3)) {
        light.kind       = LightKind::directional;
        const Corners& t = any_triangle();
        dvec3 d          = dice_.direction();
        if (dice_.one_in(3)) d = t.b - t.a;
        if (dice_.one_in(6)) d = any_triangle().a - t.b;
        if (dice_.one_in(6)) d = t.b - t.a + dice_.step(kTiny);
        light.direction = vec3(place.turn(d));
        if (light.direction == vec3(0)) light.direction = vec3(0, -1, 0);
        return light;
    }
    light.kind     = LightKind::point;
    light.position = place.position(dice_.one_in(4) ? beside_an_edge(dice_.any({1.0, 1.5, 2.0})) : position());
    return light;
}

Light Lighting::behind_a_seam() {
    Light light;
    const bool infinite = dice_.one_in(2);
    const double past   = infinite ? 1.0 : dice_.any({1.5, 2.0, 3.0});
    light.position      = vec3(beside_an_edge(past, true));
    if (!infinite) return light;
    const Corners& own = soup_[aimed_->triangle];
    const dvec3 from   = own.a + double(aimed_->name.x) * (own.b - own.a) + double(aimed_->name.y) * (own.c - own.a);
    light.kind         = LightKind::directional;
    light.direction    = vec3(from - dvec3(light.position));
    if (light.direction == vec3(0)) light.direction = vec3(0, -1, 0);
    light.position = vec3(0);
    return light;
}

Light Lighting::area(const Placement& place, bool round) {
    Light light;
    aimed_.reset();
    const int kind = round ? dice_.from_to(1, 2) : dice_.below(3);
    light.kind     = kind == 0 ? LightKind::rectangle : kind == 1 ? LightKind::disk : LightKind::sphere;
    double size    = dice_.any({2.0, 1.0, 1.0, 0.5, 0.25, 0.1, 0.01});
    if (dice_.one_in(round ? 2 : 6)) size = dice_.any({1e-3, 1e-6, 1e-9, 1e-14, 1e-17, 1e2, 1e4, 1e9, 1e15});
    const bool beside = !dice_.one_in(round ? 3 : 6);
    dvec3 centre      = beside ? beside_an_edge(dice_.any({1.1, 1.5, 2.0, 3.0})) : position();

    const Corners& t   = any_triangle();
    const dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
    const double tall  = glm::length(normal);
    if (dice_.one_in(round ? 3 : 12) && tall > 0)  // touches the triangle, or is flush with it
        centre =
            t.a + 0.25 * (t.b - t.a) + 0.25 * (t.c - t.a) + dice_.any({0.0, 1.0, 1.0, -1.0}) * size / tall * normal;
    light.position = place.position(centre);

    const bool along = dice_.one_in(3);  // in the plane of the triangle, and parallel to its sides
    dvec3 u = dice_.axis(), v = dice_.axis();
    while (v == u || v == -u) v = dice_.axis();
    if (along && tall > 1e-6) u = t.b - t.a, v = t.c - t.a;
    if (dice_.one_in(4)) u = dice_.direction(), v = dice_.direction();
    if (glm::length(glm::cross(u, v)) < 1e-3 * glm::length(u) * glm::length(v)) u = {1, 0, 0}, v = {0, 1, 0};
    light.edge_u    = place.vector(size * u);
    light.edge_v    = place.vector(size * dice_.any({1.0, 1.0, 0.5, 1e-3}) * v);
    light.radius    = static_cast<float>(std::clamp(place.scale * size, 1e-18, 1e18));
    const dvec3 d   = place.turn(along && tall > 0 ? normal / tall : dice_.direction());
    light.direction = vec3(glm::normalize(d));
    if (light.kind == LightKind::rectangle) light.direction = vec3(glm::normalize(place.turn(glm::cross(u, v))));
    return light;
}

}  // namespace

AdversarialScene adversarial_scene(std::uint64_t seed, LightsWanted wanted, int lights, int points) {
    Dice dice(seed);
    AdversarialScene made;
    Soup soup;
    const bool on_lattice = wanted == LightsWanted::seams;
    if (on_lattice) {
        add_quad(soup, {-8, 0, 8}, {8, 0, 8}, {8, 0, -8}, {-8, 0, -8});
        add_surface(soup, dice);
        if (dice.one_in(2)) add_surface(soup, dice);
        made.pattern = "seams";
    } else {
        if (!dice.one_in(3)) {
            add_floor(soup, dice);
            made.pattern = "floor";
        }
        const int parts = dice.from_to(1, 3);
        for (int k = 0; k < parts; ++k) {
            const Part& part = kParts[dice.below(static_cast<int>(std::size(kParts)))];
            part.add(soup, dice);
            made.pattern += fmt::format("{}{}", made.pattern.empty() ? "" : " ", part.name);
        }
        if (dice.one_in(4)) {
            smear_zeros(soup, dice);
            made.pattern += " smeared";
        }
    }
    const Placement place = on_lattice ? Placement{} : any_placement(dice, wanted != LightsWanted::hard);
    made.pattern +=
        fmt::format(" x{:.3g}{}{}", place.scale, place.base == dvec3(0) ? "" : " far", place.turned ? " turned" : "");

    Scene& scene = made.scene;
    scene.name   = fmt::format("adversarial_{}", seed);
    scene.title  = scene.name;
    scene.shows  = made.pattern;
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (const Corners& t : soup) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (const dvec3 corner : {t.a, t.b, t.c}) positions.push_back(place.position(corner));
        triangles.emplace_back(first, first + 1, first + 2);
    }
    scene.materials.resize(1);
    scene.materials[0].name      = "paint";
    scene.materials[0].two_sided = on_lattice || !dice.one_in(4);
    add_object(scene, "soup", positions, {}, triangles, 0);

    const dvec3 far = dice.step({8.0}), eye = far + dice.cloud(1);
    scene.camera.eye    = place.position(eye);
    scene.camera.target = place.position(dvec3(0));
    if (std::abs(glm::dot(glm::normalize(place.turn(eye)), dvec3(0, 1, 0))) > 0.9) scene.camera.up = vec3(1, 0, 0);
    made.points.eye = scene.camera.eye;
    made.points.resize(static_cast<std::size_t>(points));

    Lighting lighting(soup, dice);
    std::size_t next = 0;
    for (int k = 0; k < lights; ++k) {
        scene.lights.push_back(on_lattice                     ? lighting.behind_a_seam()
                               : wanted == LightsWanted::hard ? lighting.hard(place)
                                                              : lighting.area(place, wanted == LightsWanted::round));
        scene.lights.back().name = fmt::format("light_{}", k);
        const auto aimed         = lighting.aimed();
        if (aimed && next < made.points.size())
            set_point(made.points, next++, scene, static_cast<TriangleId>(aimed->triangle), aimed->name.x,
                      aimed->name.y);
    }
    for (; next < made.points.size(); ++next) {
        const vec2 name = on_lattice ? lattice_name(dice) : any_name(dice);
        set_point(made.points, next, scene, static_cast<TriangleId>(dice.below(static_cast<int>(soup.size()))), name.x,
                  name.y);
    }
    face_lights(made.points, scene);
    return made;
}

}  // namespace umbra
