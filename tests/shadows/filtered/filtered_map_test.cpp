// Filterable shadow maps against what is known of them without a reference: inequalities of moments, scenes of two
// depths whose filtered fraction is worked out by hand, and PCF of the same map.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/shadows/filtered/moment_map.h"
#include "umbra/shadows/maps/answers.h"
#include "umbra/shadows/maps/depth_lookup.h"
#include "umbra/tests/support/drawn_views.h"
#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/map_scenes.h"
#include "umbra/tests/support/method_case.h"
#include "umbra/tests/support/phase_values.h"

namespace umbra {
namespace {

constexpr const char* kKinds[] = {"vsm", "esm", "evsm2", "evsm4", "msm"};

// ---- scenes --------------------------------------------------------------------------------------------------------

/// The sheet x0 <= x <= x1, |z| <= 4 at height y.
void add_sheet(Scene& scene, const char* name, float x0, float x1, float y) {
    add_mesh(scene, name, make_plane(x1 - x0, 8), {0.5f * (x0 + x1), y, 0});
}

Scene floor_under(const Light& light) {
    Scene scene;
    add_sheet(scene, "floor", -4, 4, 0);
    scene.lights     = {light};
    scene.camera.eye = {0, 10, 0};
    return scene;
}

VisibilityPlane look_up(const Scene& scene, const PointBatch& points, const std::string& settings) {
    MethodCase run("filtered_map:" + settings, scene);
    EXPECT_EQ(run.serves().how, How::approximately);
    run.prepare(0);
    return run.visibility(points, 0);
}

/// The views that filtered_map makes of light 0.
DrawnViews drawn_views(const Scene& scene, int resolution, int radius, bool fit_to_casters, double constant = 0) {
    return DrawnViews(scene,
                      {.resolution = resolution,
                       .border     = radius + 2.0,
                       .headroom   = std::max(0.25 * resolution, kMostAutomatic * (4 * radius + 2)) + constant},
                      fit_to_casters);
}

/// PCF with the kernel that filtered_map has: a box of 2 radius + 1 samples that moves with the point.
std::vector<float> pcf(const Scene& scene, const PointBatch& points, const DrawnViews& views, int radius,
                       double constant) {
    std::vector<float> s(points.size(), 1);
    const Bias bias{.mode = BiasMode::manual, .constant = constant};
    for_each_facet(scene, points, 0, [&](std::size_t i, const Facet& facet, dvec3 p) {
        for (const MapView& view : views.views())
            if (const auto receiver = receive(view, facet, p, bias, {radius, true})) {
                s[i] = lit_share(view, *receiver, BiasMode::manual, {radius, true});
                return;
            }
    });
    return s;
}

/// Share of the moving box about world position x whose samples lie beyond x = 0, in a view straight down.
double share_beyond(const MapView& view, double x, int radius) {
    const LightFrame& f = view.frame;
    const bool across   = std::abs(f.x.x) > 0.5;  // the map's columns or its rows run along x
    EXPECT_NEAR(std::abs(across ? f.x.x : f.y.x), 1, 1e-12);
    const dvec3 q     = f.light_space({x, 0, 0});
    const int samples = across ? view.map.width() : view.map.height();
    const double half = across ? f.half.x : f.half.y, centre = across ? f.centre.x : f.centre.y;
    const double at   = (((across ? q.x : q.y) - centre) / half + 1) * 0.5 * samples;
    const double sign = across ? f.x.x : f.y.x;
    const double zero = at - x * sign * samples / (2 * half);  // where x = 0 lies
    double share      = 0;
    for (int k = static_cast<int>(at) - radius - 2; k <= static_cast<int>(at) + radius + 2; ++k) {
        const double weight = std::clamp(radius + 1 - std::abs(k + 0.5 - at), 0.0, 1.0);
        if ((k + 0.5 - zero) * sign > 0) share += weight / (2 * radius + 1);
    }
    return share;
}

// ---- moments -------------------------------------------------------------------------------------------------------

TEST(Moments, ChebyshevByHand) {
    // Values 1/4 and 3/4 alike often: mean 1/2, variance 1/16.
    const double square = 0.5 * (1.0 / 16 + 9.0 / 16);
    EXPECT_EQ(chebyshev(0.5, square, 0.5, 0), 1);
    EXPECT_EQ(chebyshev(0.5, square, 0.25, 0), 1);
    EXPECT_DOUBLE_EQ(chebyshev(0.5, square, 0.75, 0), 0.5);  // exact at the larger of two values
    EXPECT_DOUBLE_EQ(chebyshev(0.5, square, 1, 0), 0.2);     // (1/16) / (1/16 + 1/4)
    EXPECT_DOUBLE_EQ(chebyshev(0.5, square, 1, 0.75), 0.75);
    EXPECT_EQ(chebyshev(0.5, 0.25, 0.75, 0), 0);
    EXPECT_EQ(chebyshev(0.5, 0.24, 0.75, 0), 0);  // rounded below what is possible
}

TEST(Moments, HamburgerByHand) {
    // -1/2 once in four, 1/2 else.
    const Moments two{0.25, 0.25, 0.0625, 0.0625};
    EXPECT_EQ(hamburger(two, -0.6), 0);
    EXPECT_NEAR(hamburger(two, -0.4), 0.25, 1e-12);
    EXPECT_NEAR(hamburger(two, 0.4), 0.25, 1e-12);
    EXPECT_NEAR(hamburger(two, 0.6), 1, 1e-12);
    // -1, 0, 1: a quarter, a half, a quarter.
    const Moments three{0, 0.5, 0, 0.5};
    EXPECT_NEAR(hamburger(three, 0), 0.25, 1e-12);
    EXPECT_NEAR(hamburger(three, 1), 0.75, 1e-12);
    EXPECT_NEAR(hamburger(three, -1), 0, 1e-12);
    // Even over -1 to 1: at 0 the nodes are those of Gauss and Legendre, with 5/18 of the mass on either side.
    EXPECT_NEAR(hamburger({0, 1.0 / 3, 0, 0.2}, 0), 5.0 / 18, 1e-12);
    // One value.
    EXPECT_EQ(hamburger({0.5, 0.25, 0.125, 0.0625}, 0.5), 0);
    EXPECT_EQ(hamburger({0.5, 0.25, 0.125, 0.0625}, 0.51), 1);
    // At -1/s of s = 2, where the quadratic has one root: variance 1, skewness 3/2.
    EXPECT_NEAR(hamburger({0, 1, 1.5, 4}, 2), 0.8, 1e-12);
}

struct Values {
    std::vector<double> z, weight;
    [[nodiscard]] double least_gap(double at) const {
        double gap = 1;
        for (const double v : z) gap = std::min(gap, std::abs(v - at));
        return gap;
    }
    [[nodiscard]] double from(double at) const {
        double p = 0;
        for (std::size_t i = 0; i < z.size(); ++i) p += z[i] >= at ? weight[i] : 0;
        return p;
    }
    [[nodiscard]] Moments means(const MomentBound& bound) const {
        Moments m{};
        for (std::size_t i = 0; i < z.size(); ++i) {
            const Moments of = moments_of(bound, z[i]);
            for (std::size_t k = 0; k < m.size(); ++k) m[k] += weight[i] * of[k];
        }
        return m;
    }
};

Values random_values(std::mt19937& random, std::size_t n) {
    std::uniform_real_distribution<double> uniform(0, 1);
    Values v;
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
        v.z.push_back(uniform(random));
        v.weight.push_back(0.01 + uniform(random));
        sum += v.weight.back();
    }
    for (double& w : v.weight) w /= sum;
    return v;
}

MomentBound bound_of(MomentKind kind) { return {kind, 40, 5, 0, 0}; }
constexpr MomentKind kAllKinds[] = {MomentKind::vsm, MomentKind::esm, MomentKind::evsm2, MomentKind::evsm4,
                                    MomentKind::msm};

TEST(Moments, NoBoundIsBelowTheFractionThatIsLit) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::array<int, 5> tight{};
    for (int trial = 0; trial < 40000; ++trial) {
        const Values v = random_values(random, 2 + trial % 24);
        const double z = uniform(random);
        // Next to one of few values the bound of msm jumps, and rounding says on which side.
        if (v.least_gap(z) < 1e-4) continue;
        for (std::size_t k = 0; k < 5; ++k) {
            const MomentBound bound = bound_of(kAllKinds[k]);
            const double s          = lit_bound(bound, v.means(bound), z);
            // Rounding of sums in double, over a spread of 0.01 to the fourth power.
            ASSERT_GE(s, v.from(z) - 1e-7) << static_cast<int>(k) << ' ' << trial;
            ASSERT_LE(s, 1) << static_cast<int>(k) << ' ' << trial;
            tight[k] += s < v.from(z) + 0.1;
        }
    }
    // A bound that always says lit would pass the above.
    for (std::size_t k = 0; k < 5; ++k) EXPECT_GT(tight[k], 5000) << k;
    EXPECT_GT(tight[4], tight[0]);
}

TEST(Moments, ChebyshevIsExactAtTheFartherOfTwoDepthsAndHamburgerAtAnyOfTwo) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int trial = 0; trial < 2000; ++trial) {
        Values v = random_values(random, 2);
        if (std::abs(v.z[0] - v.z[1]) < 0.02) continue;
        const double far = std::max(v.z[0], v.z[1]), near = std::min(v.z[0], v.z[1]);
        for (const MomentKind kind : {MomentKind::vsm, MomentKind::evsm2, MomentKind::evsm4}) {
            const MomentBound bound = bound_of(kind);
            ASSERT_NEAR(lit_bound(bound, v.means(bound), far), v.from(far), 1e-6) << static_cast<int>(kind);
        }
        const MomentBound msm = bound_of(MomentKind::msm);
        for (const double z : {0.5 * near, near + 0.01 * (far - near), far - 0.01 * (far - near), 0.5 * (far + 1)})
            ASSERT_NEAR(lit_bound(msm, v.means(msm), z), v.from(z), 1e-6) << z;
    }
}

TEST(Moments, HamburgerIsExactAtOneOfThreeValues) {
    std::mt19937 random(5);
    for (int trial = 0; trial < 2000; ++trial) {
        const Values v = random_values(random, 3);
        if (std::min({std::abs(v.z[0] - v.z[1]), std::abs(v.z[1] - v.z[2]), std::abs(v.z[0] - v.z[2])}) < 0.05)
            continue;
        const MomentBound msm = bound_of(MomentKind::msm);
        for (const double z : v.z) ASSERT_NEAR(1 - hamburger(v.means(msm), 2 * z - 1), v.from(z), 1e-5);
    }
}

TEST(Moments, SquaresOfExponentialsAreNormalFloatsUpToTheLimit) {
    for (const double z : {0.0, 0.25, 0.5, 1.0})
        for (const double moment : moments_of({MomentKind::evsm4, 42, 42, 0, 0}, z))
            EXPECT_TRUE(std::isnormal(static_cast<float>(moment))) << z;
    for (const double z : {0.0, 1.0})
        for (const double moment : moments_of({MomentKind::evsm4, 350, 350, 0, 0}, z))
            EXPECT_TRUE(std::isnormal(moment)) << z;
}

TEST(Moments, AFloorAndABiasActAsStated) {
    // All at depth 1/2, asked at 3/4: a variance of 1/16 in z is a bound of one half.
    const auto lit = [](MomentBound bound) { return lit_bound(bound, moments_of(bound, 0.5), 0.75); };
    EXPECT_EQ(lit({MomentKind::vsm, 40, 5, 0, 0}), 0);
    EXPECT_DOUBLE_EQ(lit({MomentKind::vsm, 40, 5, 1.0 / 16, 0}), 0.5);
    // exp(x) is 1 at depth 1/2 and e^(1/2) at 3/4, where it changes by 2 e^(1/2) a unit of z.
    const double value = std::exp(0.5), floor = 4 * value * value / 100, beyond = value - 1;
    EXPECT_DOUBLE_EQ(lit({MomentKind::evsm2, 1, 1, 0.01, 0}), floor / (floor + beyond * beyond));
    // -exp(-x): -1 and -e^(-1/2); the least of both counts.
    const double other = 1 - std::exp(-0.5), other_floor = 4 * std::exp(-1.0) / 100;
    EXPECT_DOUBLE_EQ(lit({MomentKind::evsm4, 1, 1, 0.01, 0}),
                     std::min(floor / (floor + beyond * beyond), other_floor / (other_floor + other * other)));
    EXPECT_DOUBLE_EQ(lit({MomentKind::esm, 2, 5, 0, 0}), std::exp(-1.0));
    // All of the other moments: 0, 3/8, 0, 3/8 are those of -1, 0, 1 with weights 3/16, 10/16, 3/16.
    EXPECT_NEAR(lit({MomentKind::msm, 40, 5, 0, 1}), 1 - hamburger({0, 0.375, 0, 0.375}, 0.5), 1e-5);
}

// ---- against PCF of the same map ----------------------------------------------------------------------------------

/// A ball, a box and a leaning sheet over a floor: many depths in one filter.
Scene clutter(const Light& light) {
    Scene scene = floor_under(light);
    add_mesh(scene, "ball", make_sphere(0.7f, 24, 12), {0.2f, 1.1f, 0.3f});
    add_mesh(scene, "box", make_box({0.8f, 1.4f, 0.5f}), {-1.1f, 0.7f, -0.4f});
    const mat4 leaning(0.8f, 0.6f, 0, 0, -0.6f, 0.8f, 0, 0, 0, 0, 1, 0, 0.9f, 1.8f, -0.6f, 1);
    add_mesh(scene, "sheet", transformed(make_plane(1.5f, 1), leaning));
    return scene;
}

const Light kLights[] = {directional_light({0, -1, 0}), directional_light({0.3f, -1, 0.2f}),
                         point_light({0.5f, 4, 0.6f}), point_light({-0.3f, 1.2f, 0.9f}),
                         spot_light({1, 4, 0}, {-0.3f, -1, 0}, 40)};

TEST(FilteredMap, OnlyLetsLightThroughAgainstPcfOfTheSameMap) {
    // In double, with the same depth to compare: a 100th of a texel in front of the surface, so that whether the
    // surface's own texels lie before the point is not left to rounding. What remains is the rounding of four powers of
    // depth; the floor is for filters of one depth and can only raise a bound.
    for (const Light& light : kLights)
        for (const int radius : {0, 1, 3})
            for (const char* fit : {"casters", "scene"}) {
                const Scene scene      = clutter(light);
                const DrawnViews views = drawn_views(scene, 128, radius, std::string_view(fit) == "casters", 0.01);
                for (const char* empty : {"far", "apart"})
                    for (const char* kind : kKinds) {
                        const std::string settings = fmt::format(
                            "kind={},radius={},fit={},empty={},resolution=128,bleed=0,bias=manual,constant=0.01,min_"
                            "variance="
                            "1e-"
                            "12,moment_bias=0,precision=double",
                            kind, radius, fit, empty);
                        std::size_t darker = 0, leaks = 0, shadow = 0;
                        double worst = 0;
                        for (std::uint32_t object = 0; object < scene.objects.size(); ++object) {
                            const PointBatch points       = points_on(scene, object, object == 0 ? 100 : 3);
                            const VisibilityPlane got     = look_up(scene, points, settings);
                            const std::vector<float> want = pcf(scene, points, views, radius, 0.01);
                            for (std::size_t i = 0; i < points.size(); ++i) {
                                if (!is_open(points, 0, i)) continue;
                                const double below = static_cast<double>(want[i]) - static_cast<double>(got.s[i]);
                                worst              = std::max(worst, below);
                                darker += below > 1e-4;
                                leaks += below < -1e-4;
                                shadow += got.s[i] < 0.5f;
                            }
                        }
                        if (std::string_view(kind) == "msm") {
                            // Where a filter's depths differ by a 1e-5th of the range, doubles no longer hold their
                            // third moment.
                            EXPECT_LT(darker, 20u) << settings << ' ' << to_string(light.kind);
                            EXPECT_LT(worst, 0.05) << settings << ' ' << to_string(light.kind);
                        } else {
                            EXPECT_EQ(darker, 0u) << settings << ' ' << to_string(light.kind) << ": " << worst;
                        }
                        EXPECT_GT(shadow, 300u) << settings;
                        if (radius == 3) {
                            EXPECT_GT(leaks, 10u) << settings;
                        }
                    }
            }
}

// ---- scenes of two depths -----------------------------------------------------------------------------------------

constexpr int kRadius = 3, kResolution = 128;

/// Points of the floor about x = 0, with z near 0.
PointBatch line_across(const Scene& scene, int n = 401) {
    PointBatch points;
    points.eye = {0, 10, 0};
    points.resize(static_cast<std::size_t>(n));
    const dvec3 a(scene.vertex(0, 0)), ab = dvec3(scene.vertex(0, 1)) - a, ac = dvec3(scene.vertex(0, 2)) - a;
    for (int i = 0; i < n; ++i) {
        // In triangle 0 of the floor: whose side of the diagonal has z > 0 or < 0 at x = 0 its corners tell.
        const dvec3 p(-0.8 + 1.6 * i / (n - 1), 0, 0);
        dvec3 middle = a + (ab + ac) / 3.0;
        const dvec3 at(p.x, 0, middle.z);
        const double aa = glm::dot(ab, ab), bb = glm::dot(ac, ac), cross = glm::dot(ab, ac);
        const double pa = glm::dot(at - a, ab), pb = glm::dot(at - a, ac), det = aa * bb - cross * cross;
        const auto u = static_cast<float>((pa * bb - pb * cross) / det);
        const auto v = static_cast<float>((pb * aa - pa * cross) / det);
        EXPECT_TRUE(u > 0 && v > 0 && u + v < 1);
        set_point(points, static_cast<std::size_t>(i), scene, 0, u, v);
    }
    face_lights(points, scene);
    return points;
}

/// A sheet that hides x < 0 from the light above, one unit over the floor.
Scene half_plane() {
    Scene scene = floor_under(directional_light({0, -1, 0}));
    add_sheet(scene, "sheet", -4, 0, 1);
    return scene;
}

TEST(FilteredMap, IsTheBoxFiltersShareBehindOneOccluder) {
    const Scene scene       = half_plane();
    const PointBatch points = line_across(scene);
    for (const char* fit : {"scene", "casters"}) {
        const DrawnViews views = drawn_views(scene, kResolution, kRadius, std::string_view(fit) == "casters");
        const MapView& view    = views.views().at(0);
        for (const char* empty : {"far", "apart"})
            for (const char* kind : {"vsm", "esm", "evsm2", "evsm4", "msm"}) {
                // Only msm has to ask before the floor, at whose depth its bound jumps.
                const bool msm = std::string_view(kind) == "msm", is_esm = std::string_view(kind) == "esm";
                const VisibilityPlane s = look_up(
                    scene, points,
                    fmt::format(
                        "kind={},radius={},resolution={},fit={},empty={},bleed=0,bias=manual,constant={},min_variance="
                        "1e-10,moment_bias=0,precision=double,positive_exponent={}",
                        kind, kRadius, kResolution, fit, empty, msm ? 0.1 : 0.0, is_esm ? 350 : 40));
                int between = 0;
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const double share = share_beyond(view, double(points.px[i]), kRadius);
                    // Depth is kept in float, 2^-24, times the exponent of esm. As the far plane, empty texels lie a
                    // hundredth of the depth range behind the sheet, where that is all that is drawn.
                    const bool is_close =
                        is_esm && std::string_view(fit) == "casters" && std::string_view(empty) == "far";
                    EXPECT_NEAR(s.s[i], share, is_close ? 1.1e-3 : 1e-4)
                        << kind << ' ' << fit << ' ' << empty << ' ' << points.px[i];
                    between += share > 0.01 && share < 0.99;
                }
                EXPECT_GT(between, 50);
            }
    }
}

TEST(FilteredMap, ExponentialsLeakByTheirExponent) {
    // E exp(2 c (z - z_floor)) = share + (1 - share) exp(-2 c D), with D the sheet's height in depths of the map.
    const Scene scene       = half_plane();
    const PointBatch points = line_across(scene);
    const DrawnViews views  = drawn_views(scene, kResolution, kRadius, false);
    const MapView& view     = views.views().at(0);
    const double height     = 1 / (view.frame.far - view.frame.near);
    for (const double c : {0.5, 2.0}) {
        const VisibilityPlane s =
            look_up(scene, points,
                    fmt::format("kind=esm,radius={},resolution={},fit=scene,bleed=0,bias=manual,positive_exponent={}",
                                kRadius, kResolution, c));
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double share = share_beyond(view, double(points.px[i]), kRadius);
            EXPECT_NEAR(s.s[i], share + (1 - share) * std::exp(-2 * c * height), 2e-5) << c << ' ' << points.px[i];
        }
    }
}

TEST(FilteredMap, EmptyTexelsTakeNoLightFromWhatIsDrawnAndGiveNone) {
    // The floor is not drawn, and a block far down the light's way makes the map deeper than the floor here: as the far
    // plane, empty texels lie behind the floor, and the mean depth with them.
    Scene scene = floor_under(directional_light(glm::normalize(vec3(0, -1, 1))));
    add_sheet(scene, "sheet", -4, 0, 1);
    add_mesh(scene, "block", make_box({0.4f, 0.4f, 0.4f}), {3, 0.2f, 3.5f});
    const PointBatch points = line_across(scene);
    const DrawnViews views  = drawn_views(scene, kResolution, kRadius, true);
    const auto want         = pcf(scene, points, views, kRadius, 0.1);
    for (const char* kind : kKinds) {
        const auto error = [&](const char* empty) {
            const VisibilityPlane s = look_up(
                scene, points,
                fmt::format(
                    "kind={},radius={},resolution={},empty={},bleed=0,bias=manual,constant=0.1,precision=double,"
                    "moment_bias=0",
                    kind, kRadius, kResolution, empty));
            double most = 0;
            for (std::size_t i = 0; i < points.size(); ++i) most = std::max(most, double(s.s[i]) - double(want[i]));
            return most;
        };
        EXPECT_LT(error("apart"), 0.02) << kind;
        if (std::string_view(kind) != "msm") {
            EXPECT_GT(error("far"), 0.1) << kind;
        }
    }
}

// ---- light leaks --------------------------------------------------------------------------------------------------

/// Sheets at heights 3, over x < 0, and 1, over all: the floor sees nothing of the light.
Scene two_occluders() {
    Scene scene = floor_under(directional_light({0, -1, 0}));
    add_sheet(scene, "upper", -4, 0, 3);
    add_sheet(scene, "lower", -4, 4, 1);
    return scene;
}

TEST(FilteredMap, VarianceLeaksBehindTwoOccludersByTheFormula) {
    const Scene scene       = two_occluders();
    const PointBatch points = line_across(scene);
    const DrawnViews views  = drawn_views(scene, kResolution, kRadius, false);
    const MapView& view     = views.views().at(0);
    const auto lit          = [&](const char* settings) {
        return look_up(scene, points,
                                fmt::format("radius={},resolution={},fit=scene,bias=manual,min_variance=0,{}", kRadius,
                                            kResolution, settings));
    };
    const VisibilityPlane vsm = lit("kind=vsm,bleed=0"), cut = lit("kind=vsm,bleed=0.2"),
                          all_cut = lit("kind=vsm,bleed=0.26");
    float most                    = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        // Depths below the upper sheet: 0 where it is, 2 beside it, 3 on the floor.
        const double beside = share_beyond(view, double(points.px[i]), kRadius);
        const double mean = 2 * beside, variance = 4 * beside - mean * mean;
        const double leak = variance / (variance + (3 - mean) * (3 - mean));
        EXPECT_NEAR(vsm.s[i], leak, 1e-4) << points.px[i];
        EXPECT_NEAR(cut.s[i], std::max(0.0, (leak - 0.2) / 0.8), 1e-4) << points.px[i];
        EXPECT_EQ(all_cut.s[i], 0) << points.px[i];
        most = std::max(most, vsm.s[i]);
    }
    EXPECT_NEAR(most, 0.25, 0.005);  // where a quarter of the filter shows the upper sheet
    const auto most_of = [&](const char* settings) {
        const VisibilityPlane plane = lit(settings);
        return *std::ranges::max_element(plane.s);
    };
    // The lower sheet is one unit over the floor.
    EXPECT_LT(most_of("kind=esm,bleed=0"), 1.01 * std::exp(-80 / (view.frame.far - view.frame.near)));
    EXPECT_LT(most_of("kind=evsm2,bleed=0"), 0.001f);
    EXPECT_LT(most_of("kind=evsm4,bleed=0"), 0.001f);
    EXPECT_LT(most_of("kind=msm,bleed=0"), 0.01f);
    EXPECT_GT(most_of("kind=evsm4,positive_exponent=1,negative_exponent=1,bleed=0"), 0.03f);
}

// ---- numbers ------------------------------------------------------------------------------------------------------

TEST(FilteredMap, NumbersStayWithinRangeAtExtremes) {
    for (const float size : {1.0f, 1e6f, 1e-6f})
        for (const Light& light : {directional_light({0.3f, -1, 0.2f}), point_light({-0.3f, 1.2f, 0.9f}),
                                   point_light({0.3e9f, 1e9f, 0.2e9f})}) {
            Scene scene = clutter(light);
            for (vec3& p : scene.positions) p *= size;
            scene.lights[0].position *= size;
            scene.camera.eye *= size;
            const PointBatch points = points_on(scene, 0, 50), ball = points_on(scene, 1, 4);
            for (const char* kind : kKinds)
                for (const char* numbers :
                     {"positive_exponent=42,negative_exponent=42,radius=12",
                      "positive_exponent=350,negative_exponent=350,precision=double,radius=12",
                      "min_variance=0,moment_bias=0,radius=2,empty=far", "min_variance=0,moment_bias=0,radius=0"}) {
                    const std::string settings = fmt::format("kind={},resolution=96,{}", kind, numbers);
                    int shadow                 = 0;
                    for (const PointBatch* batch : {&points, &ball})
                        for (const float s : look_up(scene, *batch, settings).s) {
                            ASSERT_GE(s, 0) << settings << ' ' << size;  // and is a number
                            ASSERT_LE(s, 1) << settings << ' ' << size;
                            shadow += s < 0.5f;
                        }
                    EXPECT_GT(shadow, 30) << settings << ' ' << size;
                }
        }
}

TEST(FilteredMap, ExponentsAreCutOnlyWhereFloatsNeedIt) {
    const Scene scene       = clutter(directional_light({0.3f, -1, 0.2f}));
    const PointBatch points = points_on(scene, 0, 100);
    const auto s            = [&](const char* settings) {
        return look_up(scene, points, fmt::format("resolution=128,radius=3,bleed=0,{}", settings)).s;
    };
    EXPECT_EQ(s("positive_exponent=42"), s("positive_exponent=200"));
    EXPECT_EQ(s("negative_exponent=42"), s("negative_exponent=200"));
    EXPECT_NE(s("positive_exponent=41"), s("positive_exponent=42"));
    EXPECT_NE(s("positive_exponent=42,precision=double"), s("positive_exponent=200,precision=double"));
}

TEST(FilteredMap, SameForAnyNumberOfThreads) {
    const Scene scene       = clutter(point_light({-0.3f, 1.2f, 0.9f}));
    const PointBatch points = points_on(scene, 0, 100);
    for (const char* kind : kKinds) {
        std::vector<float> expected;
        for (const int threads : {1, 3, 8}) {
            const ThreadLimit limit(threads);
            const VisibilityPlane plane = look_up(scene, points, fmt::format("kind={},resolution=300,radius=2", kind));
            if (expected.empty()) expected = plane.s;
            EXPECT_EQ(plane.s, expected) << kind;
        }
    }
}

// ---- the map ------------------------------------------------------------------------------------------------------

TEST(MomentMap, SamplesAreMeansOverTheirBox) {
    // Against sums over the depth map, sample by sample, across borders of tiles and of the map.
    const Scene scene      = clutter(directional_light({0.3f, -1, 0.2f}));
    const DrawnViews views = drawn_views(scene, 200, 3, true);
    const MapView& view    = views.views().at(0);
    const MomentBound vsm{MomentKind::vsm};
    const MomentMap far(view, vsm, 3, EmptySamples::far, MomentPrecision::twofold),
        apart(view, vsm, 3, EmptySamples::apart, MomentPrecision::twofold);
    int mixed = 0;
    for (int y = -1; y <= 200; ++y)
        for (int x = -1; x <= 200; ++x) {
            double drawn = 0, sum = 0, squares = 0;
            for (int j = y - 3; j <= y + 3; ++j)
                for (int i = x - 3; i <= x + 3; ++i) {
                    if (x < 0 || y < 0 || x > 199 || y > 199) continue;
                    if (i < 0 || j < 0 || i > 199 || j > 199 || view.map.is_empty(i, j)) continue;
                    const double depth = view.frame.depth(view.map.nearness(i, j));
                    const double z     = (depth - view.frame.near) / (view.frame.far - view.frame.near);
                    drawn += 1, sum += 2 * z - 1, squares += (2 * z - 1) * (2 * z - 1);
                }
            const FilteredDepth of_drawn = apart.at(x + 0.5, y + 0.5), of_all = far.at(x + 0.5, y + 0.5);
            ASSERT_NEAR(of_drawn.drawn, drawn / 49, 1e-12) << x << ' ' << y;
            if (drawn > 0) {
                ASSERT_NEAR(of_drawn.moments[0], sum / drawn, 1e-12) << x << ' ' << y;
                ASSERT_NEAR(of_drawn.moments[1], squares / drawn, 1e-12) << x << ' ' << y;
            }
            ASSERT_EQ(of_all.drawn, 1);
            ASSERT_NEAR(of_all.moments[0], (sum + 49 - drawn) / 49, 1e-12) << x << ' ' << y;
            ASSERT_NEAR(of_all.moments[1], (squares + 49 - drawn) / 49, 1e-12) << x << ' ' << y;
            mixed += drawn > 0 && drawn < 49;
        }
    EXPECT_GT(mixed, 500);
    // Between samples: bilinear.
    const auto at = [&](double x, double y) { return far.at(x, y).moments[0]; };
    EXPECT_NEAR(
        at(90.75, 80.9),
        0.75 * (0.6 * at(90.5, 80.5) + 0.4 * at(90.5, 81.5)) + 0.25 * (0.6 * at(91.5, 80.5) + 0.4 * at(91.5, 81.5)),
        1e-12);
}

TEST(MomentMap, DepthIsLinearAndEndsAtTheFrame) {
    LightFrame frame;
    frame.near = 2, frame.far = 10;
    for (const bool perspective : {false, true}) {
        frame.perspective = perspective;
        for (const double depth : {2.0, 3.0, 6.0, 10.0})
            EXPECT_NEAR(linear_depth(frame, frame.nearness(depth)), (depth - 2) / 8, 1e-15);
        EXPECT_NEAR(linear_depth(frame, frame.nearness(18)), 2, 1e-14);
        EXPECT_EQ(linear_depth(frame, frame.nearness(1e30)), 1e6);
        EXPECT_EQ(linear_depth(frame, frame.nearness(1)), 0);
    }
}

// ---- the method ---------------------------------------------------------------------------------------------------

TEST(FilteredMap, NothingLeaksThroughACubesSeams) {
    Scene scene;
    add_mesh(scene, "room", make_box({8, 8, 8}));
    add_mesh(scene, "shade", make_sphere(1, 48, 24));
    scene.lights          = {point_light({0.2f, 0.1f, -0.15f})};
    scene.camera.eye      = scene.lights[0].position;  // two-sided materials turn inwards
    const PointBatch room = points_on(scene, 0, 100), ball = points_on(scene, 1, 6);
    for (const char* kind : kKinds)
        for (const char* settings : {"radius=1", "radius=3,fit=scene", "radius=6,normal_offset=2"}) {
            const std::string choice      = fmt::format("kind={},resolution=256,{}", kind, settings);
            const VisibilityPlane outside = look_up(scene, room, choice), inside = look_up(scene, ball, choice);
            EXPECT_LT(*std::ranges::max_element(outside.s), 0.02f) << choice;
            EXPECT_GT(*std::ranges::min_element(inside.s), 0.98f) << choice;
        }
}

TEST(FilteredMap, AFloorAloneIsLit) {
    Scene scene = floor_under(directional_light({0, -1, 0}));
    for (const Light& light : kLights)
        for (const char* kind : kKinds)
            for (const char* fit : {"casters", "scene"}) {
                scene.lights            = {light};
                const PointBatch points = points_on(scene, 0, 40);
                const VisibilityPlane s =
                    look_up(scene, points, fmt::format("kind={},fit={},resolution=512,radius=2", kind, fit));
                EXPECT_GT(*std::ranges::min_element(s.s), 0.999f) << kind << ' ' << fit;
            }
}

TEST(FilteredMap, BiasesMoveThePointTowardsTheLight) {
    // Deep in the shadow of a sheet that hangs 40 texels over the floor: each bias beyond that lights it.
    Scene scene = floor_under(directional_light(glm::normalize(vec3(1, -1, 0))));
    add_sheet(scene, "sheet", -1, 1, 0.5f);
    const PointBatch points = line_across(scene);
    const DrawnViews views  = drawn_views(scene, 512, 1, false);
    const LightFrame& frame = views.views().at(0).frame;
    const double width      = 2 * std::max(frame.half.x, frame.half.y) / 512;
    const double away       = 0.5 * std::sqrt(2.0) / width;  // along the light, in widths of a texel
    const auto lit          = [&](const std::string& bias) {
        const VisibilityPlane s = look_up(scene, points, "fit=scene,resolution=512,bias=manual," + bias);
        return std::ranges::count_if(s.s, [](float v) { return v > 0.9f; });
    };
    ASSERT_LT(away, 60);
    const auto before = lit("constant=0.5");
    // Where the sheet is only in a part of the filter, a smaller difference of depths lights a few more points.
    const auto few = before + std::ssize(points.px) / 20;
    EXPECT_LT(before, std::ssize(points.px) / 2);
    EXPECT_LT(lit(fmt::format("constant={}", 0.9 * away)), few);
    EXPECT_EQ(lit(fmt::format("constant={}", 1.1 * away)), std::ssize(points.px));
    // A gradient is a texel's width here or less: light falls at 45 degrees.
    EXPECT_LT(lit(fmt::format("slope={}", 0.5 * away)), few);
    EXPECT_EQ(lit(fmt::format("slope={}", 3 * away)), std::ssize(points.px));
    // Along the normal, times the sine of 45 degrees. The map reaches over its window by as much and has wider texels.
    EXPECT_LT(lit(fmt::format("constant=0.5,normal_offset={}", 0.6 * away)), few);
    EXPECT_EQ(lit(fmt::format("constant=0.5,normal_offset={}", 1.1 * away)), std::ssize(points.px));
}

TEST(FilteredMap, ParametersRepeatThePhasesThatTheyName) {
    const Scene scene       = clutter(spot_light({1, 4, 0}, {-0.3f, -1, 0}, 25));
    const PointBatch points = points_on(scene, 0, 80);
    for (const char* kind : kKinds)
        for (const char* change :
             {"kind=msm", "kind=vsm", "resolution=128", "radius=3", "positive_exponent=3", "negative_exponent=1",
              "bleed=0.3", "min_variance=0.01", "moment_bias=0.1", "empty=far", "precision=double", "bias=manual",
              "constant=30", "slope=20", "normal_offset=5", "fit=scene", "surround=0.1", "surround=0"}) {
            const MethodChoice from = parse_method(fmt::format("filtered_map:resolution=200,kind={}", kind));
            MethodChoice to         = from;
            const std::string_view text(change);
            to.settings.set(text.substr(0, text.find('=')), text.substr(text.find('=') + 1));
            const SceneFacts facts = find_facts(scene);
            const PhaseInput input{scene, facts, points};
            const Phase first       = first_changed_phase(from.settings, to.settings);
            const PhaseAnswer again = answer_from(to, input, first, make_values(*from.make(), input));
            const PhaseAnswer once  = answer_from(to, input);
            EXPECT_EQ(again.plane.s, once.plane.s) << kind << ' ' << change;
            EXPECT_EQ(again.plane.answer, once.plane.answer) << kind << ' ' << change;
            EXPECT_EQ(again.memory_bytes, once.memory_bytes) << kind << ' ' << change;
        }
}

TEST(FilteredMap, CountsMomentsAndTheDepthThatItKeeps) {
    const Scene scene = half_plane();
    const auto bytes  = [&](const char* settings) {
        MethodCase run(fmt::format("filtered_map:resolution=64,fit=scene,{}", settings), scene);
        run.prepare(0);
        return run.memory_bytes();
    };
    const std::size_t texels = 64 * 64, depth = drawn_views(scene, 64, 1, false).memory_bytes();
    EXPECT_EQ(bytes("kind=vsm,empty=far"), depth + texels * 2 * 4);
    EXPECT_EQ(bytes("kind=esm,empty=far"), depth + texels * 1 * 4);
    EXPECT_EQ(bytes("kind=evsm2,empty=apart"), depth + texels * 3 * 4);
    EXPECT_EQ(bytes("kind=evsm4,empty=apart"), depth + texels * 5 * 4);
    EXPECT_EQ(bytes("kind=msm,empty=far,precision=double"), depth + texels * 4 * 8);
}

TEST(FilteredMap, BlamesTheNearestTexelThatBlocks) {
    const Scene scene = two_occluders();
    MethodCase run(fmt::format("filtered_map:resolution={},radius={},fit=scene", kResolution, kRadius), scene);
    run.prepare(0);
    const PointBatch points = line_across(scene);
    std::vector<TriangleId> who(points.size(), 12345);
    run.blame(points, 0, who);
    for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_NE(who[i], kNoTriangle);
        if (std::abs(points.px[i]) < 0.1f) continue;
        EXPECT_EQ(scene.objects[scene.triangle_object[who[i]]].name, points.px[i] < 0 ? "upper" : "lower");
    }
    // Nothing to blame where nothing blocks, though the floor's own texels lie before points between them.
    Scene open      = floor_under(directional_light({1, -1, 0.4f}));
    const auto lone = points_on(open, 0, 40);
    MethodCase lit("filtered_map:resolution=128,radius=2,fit=scene", open);
    lit.prepare(0);
    who.assign(lone.size(), 12345);
    lit.blame(lone, 0, who);
    EXPECT_EQ(std::ranges::count(who, kNoTriangle), std::ssize(who));
    MethodCase bare("filtered_map:resolution=128,radius=2,fit=scene,bias=manual", open);
    bare.prepare(0);
    bare.blame(lone, 0, who);
    EXPECT_LT(std::ranges::count(who, kNoTriangle), std::ssize(who) / 10);
}

TEST(FilteredMap, SaysThatPenumbraeAreMissing) {
    const Scene hard        = half_plane();
    Scene soft              = hard;
    soft.lights[0].kind     = LightKind::disk;
    soft.lights[0].radius   = 0.5f;
    soft.lights[0].position = {0, 5, 0};
    EXPECT_EQ(MethodCase("filtered_map", hard).serves().why.find("penumbrae"), std::string::npos);
    EXPECT_NE(MethodCase("filtered_map", soft).serves().why.find("penumbrae are missing"), std::string::npos);
}

TEST(FilteredMap, FiltersWiderThanAQuarterOfTheMapAreRefused) {
    const auto make = [](const char* choice) { return parse_method(choice).make(); };
    EXPECT_THROW(make("filtered_map:resolution=16,radius=3"), UsageError);
    EXPECT_NO_THROW(make("filtered_map:resolution=16,radius=2"));
    EXPECT_THROW(make("filtered_map:resolution=64,radius=1,normal_offset=14"), UsageError);
    try {
        make("filtered_map:resolution=100,radius=30");
        FAIL() << "a filter as wide as half of the map";
    } catch (const UsageError& e) {
        EXPECT_NE(std::string(e.what()).find("at least 128"), std::string::npos) << e.what();
    }
}

}  // namespace
}  // namespace umbra
