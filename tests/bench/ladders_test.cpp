// The truth on the rungs of the ladders over meshes, occluders, volumes and the sum: `exact` against closed forms and
// against what must not change.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "umbra/bench/ladders/ladder_run.h"
#include "umbra/core/render/shade.h"
#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

const Ladder& ladder(const char* name) { return find_ladder(name); }

/// What a closed form says: lit, dark, or too close to a boundary for doubles.
enum class Says : std::uint8_t { dark, lit, nothing };

Says lit_where(double positive) {
    if (std::abs(positive) < 1e-14) return Says::nothing;
    return positive > 0 ? Says::lit : Says::dark;
}
Says both(Says a, Says b) {
    if (a == Says::dark || b == Says::dark) return Says::dark;
    return a == Says::lit && b == Says::lit ? Says::lit : Says::nothing;
}

/// Distance of q, seen from above, from the line a b: positive on its right-hand side, where x is to the right and z
/// down.
double beside(dvec3 a, dvec3 b, dvec3 q) {
    const dvec3 d = b - a, e = q - a;
    return (d.x * e.z - d.z * e.x) / std::hypot(d.x, d.z);
}

/// The vertex of an object, counted in its own mesh.
dvec3 vertex(const Scene& scene, std::size_t object, std::size_t k) {
    std::size_t first = scene.positions.size();
    for (std::uint32_t t = 0; t < scene.objects[object].triangle_count; ++t)
        for (int c = 0; c < 3; ++c)
            first = std::min<std::size_t>(first, scene.triangles[scene.objects[object].first_triangle + t][c]);
    return dvec3(scene.positions[first + k]);
}

/// Where the way from p to the light passes this height.
dvec3 passes(dvec3 p, dvec3 light, double height) { return p + (light - p) * ((height - p.y) / (light.y - p.y)); }

/// Holds exact against the formula on every rung.
void expect_formula(const Ladder& l, const std::function<Says(const Scene&, dvec3)>& formula) {
    for (const double rung : l.rungs) {
        const auto stage_set   = set_stage(l.scene(rung));
        const RungStage& stage = *stage_set;
        ASSERT_EQ(stage.truth.choice.text(), "exact");
        std::size_t compared = 0, wrong = 0;
        for (std::size_t i = 0; i < stage.points.size(); ++i) {
            if (!is_open(stage.points, 0, i) || stage.truth.planes[0].answer[i] != Answer::given) continue;
            const Says says = formula(stage.scene, place(stage.scene, stage.points, i));
            if (says == Says::nothing) continue;
            ++compared;
            wrong += (stage.truth.planes[0].s[i] == 1) != (says == Says::lit);
        }
        EXPECT_EQ(wrong, 0u) << l.name << " " << rung;
        EXPECT_GT(compared, stage.points.size() * 9 / 10) << l.name << " " << rung;
    }
}

TEST(LadderTruth, CrackLetsAStripeThroughWhereItsEdgesSay) {
    expect_formula(ladder("crack"), [](const Scene& scene, dvec3 p) {
        const dvec3 q          = passes(p, dvec3(scene.lights[0].position), 1);
        const double from_near = beside(vertex(scene, 1, 0), vertex(scene, 1, 3), q);
        const double from_far  = beside(vertex(scene, 1, 4), vertex(scene, 1, 5), q);
        return both(lit_where(from_near), lit_where(-from_far));
    });
}

TEST(LadderTruth, CrackIsAsWideAsItsShadowIsTwice) {
    for (const double width : {1e-2, 1e-4, 1e-6}) {
        const auto stage_set   = set_stage(ladder("crack").scene(width));
        const RungStage& stage = *stage_set;
        // Along the stripe's own direction the picture is constant: the share of light in a column that it crosses.
        std::size_t lit = 0;
        double extent   = 0;
        const auto& f   = *stage.points.raster;
        const auto at   = [&](int y) { return static_cast<std::size_t>(y) * f.width + f.width / 2; };
        for (int y = 0; y < f.height; ++y) lit += stage.truth.planes[0].s[at(y)] == 1;
        extent = std::abs(
            glm::dot(place(stage.scene, stage.points, at(f.height - 1)) - place(stage.scene, stage.points, at(0)),
                     dvec3(-5, 0, 12) / 13.0));
        const double measured = extent * static_cast<double>(lit) / (f.height - 1);
        EXPECT_NEAR(measured, 2 * width, 0.1 * width + 1e-7) << width;
    }
}

TEST(LadderTruth, TJunctionIsOpenInItsSlitAlone) {
    expect_formula(ladder("t_junction"), [](const Scene& scene, dvec3 p) {
        const dvec3 q = passes(p, dvec3(scene.lights[0].position), 1);
        const dvec3 a = vertex(scene, 1, 0), b = vertex(scene, 1, 1), m = vertex(scene, 1, 2);
        const double turn = beside(a, b, m) > 0 ? 1 : -1;
        return both(lit_where(turn * beside(a, b, q)),
                    both(lit_where(turn * beside(b, m, q)), lit_where(turn * beside(m, a, q))));
    });
}

TEST(LadderTruth, LightFallsBetweenSolidsWhereBothEndsOfTheGapLetIt) {
    expect_formula(ladder("touching_solids"), [](const Scene& scene, dvec3 p) {
        Says says = Says::lit;
        for (const std::size_t upper : {0u, 2u}) {  // corners of the facing sides, at the bottom and at the top
            const dvec3 near0 = vertex(scene, 1, 4 + upper), near1 = vertex(scene, 1, 5 + upper);
            const dvec3 far0 = vertex(scene, 2, upper), far1 = vertex(scene, 2, 1 + upper);
            const dvec3 q = passes(p, dvec3(scene.lights[0].position), near0.y);
            says          = both(says, both(lit_where(beside(near0, near1, q)), lit_where(-beside(far0, far1, q))));
        }
        return says;
    });
}

TEST(LadderTruth, SliversCoverWhatTheSheetInOnePieceCovers) {
    // The light is straight above the sheet's end at x = 0.
    expect_formula(ladder("sliver_occluder"), [](const Scene&, dvec3 p) { return lit_where(p.x); });
}

TEST(LadderTruth, TheEdgeOfAShadowRunsStraightOverSlivers) {
    expect_formula(ladder("sliver_receiver"), [](const Scene& scene, dvec3 p) {
        return lit_where(
            -beside(vertex(scene, 1, 0), vertex(scene, 1, 1), passes(p, dvec3(scene.lights[0].position), 1)));
    });
}

TEST(LadderTruth, NeedlesShadowIsTheHullOfTheirCornersShadows) {
    expect_formula(ladder("needles"), [](const Scene& scene, dvec3 p) {
        const dvec3 light(scene.lights[0].position);
        bool near = false;
        for (std::size_t rod = 1; rod < scene.objects.size(); ++rod) {
            std::array<dvec3, 8> shadow;
            for (std::size_t k = 0; k < 8; ++k) {
                const dvec3 v = vertex(scene, rod, k);
                shadow[k]     = v + (v - light) * (v.y / (light.y - v.y));
            }
            // A point is in the hull where it is in a triangle of three of the corners.
            for (std::size_t i = 0; i < 8; ++i)
                for (std::size_t j = i + 1; j < 8; ++j)
                    for (std::size_t k = j + 1; k < 8; ++k) {
                        const double area = beside(shadow[i], shadow[j], shadow[k]);
                        if (std::abs(area) < 1e-13) continue;
                        const double turn = area > 0 ? 1 : -1;
                        const double in =
                            std::min({turn * beside(shadow[i], shadow[j], p), turn * beside(shadow[j], shadow[k], p),
                                      turn * beside(shadow[k], shadow[i], p)});
                        if (in > 1e-14) return Says::dark;
                        near |= in > -1e-14;
                    }
        }
        return near ? Says::nothing : Says::lit;
    });
}

TEST(LadderTruth, SheetsHideWhatAnyOfThemHides) {
    const Ladder& l = ladder("depth_complexity");
    for (const double rung : {1.0, 100.0, 256.0}) {
        const auto stage_set   = set_stage(l.scene(rung));
        const RungStage& stage = *stage_set;
        std::size_t wrong = 0, compared = 0;
        for (std::size_t i = 0; i < stage.points.size(); ++i) {
            const dvec3 p = is_open(stage.points, 0, i) ? place(stage.scene, stage.points, i) : dvec3(1);
            if (p.y != 0) continue;
            Says says = Says::lit;
            for (std::size_t sheet = 0; sheet < static_cast<std::size_t>(rung) && says != Says::dark; ++sheet) {
                std::array<dvec3, 4> v;
                for (std::size_t k = 0; k < 4; ++k) v[k] = dvec3(stage.scene.positions[4 + 4 * sheet + k]);
                const dvec3 q = passes(p, dvec3(stage.scene.lights[0].position), v[0].y);
                double out    = -1;
                for (std::size_t k = 0; k < 4; ++k) out = std::max(out, beside(v[k], v[(k + 1) % 4], q));
                says = both(says, lit_where(out));
            }
            if (says == Says::nothing || stage.truth.planes[0].answer[i] != Answer::given) continue;
            ++compared;
            wrong += (stage.truth.planes[0].s[i] == 1) != (says == Says::lit);
        }
        EXPECT_EQ(wrong, 0u) << rung;
        EXPECT_GT(compared, 5000u) << rung;
    }
}

TEST(LadderTruth, NoSunComesThroughWallsOfAnyThickness) {
    for (const double rung : ladder("thin_walls").rungs) {
        const auto stage_set   = set_stage(ladder("thin_walls").scene(rung));
        const RungStage& stage = *stage_set;
        std::size_t asked = 0, lit = 0;
        for (std::size_t i = 0; i < stage.points.size(); ++i) {
            if (!is_open(stage.points, 0, i)) continue;
            ++asked;
            lit += stage.truth.planes[0].s[i] != 0 && stage.truth.planes[0].answer[i] == Answer::given;
        }
        EXPECT_EQ(lit, 0u) << rung;
        EXPECT_GT(asked, 5000u) << rung;
    }
}

TEST(LadderTruth, NoLightComesThroughTheLatticeBesideItsVertices) {
    for (const double rung : ladder("beside_edges").rungs) {
        const auto stage_set   = set_stage(ladder("beside_edges").scene(rung));
        const RungStage& stage = *stage_set;
        std::size_t within = 0, lit = 0, on_boundary = 0;
        for (std::size_t i = 0; i < stage.points.size(); ++i) {
            const dvec3 p = place(stage.scene, stage.points, i);
            if (std::max(std::abs(p.x), std::abs(p.z)) > 0.9) continue;  // the lattice reaches to 0.94
            ++within;
            on_boundary += stage.truth.planes[0].answer[i] == Answer::on_boundary;
            lit += stage.truth.planes[0].answer[i] == Answer::given && stage.truth.planes[0].s[i] != 0;
        }
        EXPECT_EQ(lit, 0u) << rung;
        EXPECT_GT(within, 3000u) << rung;
        EXPECT_LT(on_boundary, within / 20) << rung << ": floats hardly ever meet a vertex";
    }
}

/// Points that both pictures show at the same pixel and position have the same S_j.
void expect_same(const RungStage& a, const RungStage& b, double rung) {
    ASSERT_EQ(a.points.size(), b.points.size());
    std::size_t same_place = 0, differ = 0;
    for (std::size_t i = 0; i < a.points.size(); ++i) {
        if (!is_open(a.points, 0, i) || !is_open(b.points, 0, i)) continue;
        if (a.points.position(i) != b.points.position(i)) continue;
        if (a.truth.planes[0].answer[i] != Answer::given || b.truth.planes[0].answer[i] != Answer::given) continue;
        ++same_place;
        differ += a.truth.planes[0].s[i] != b.truth.planes[0].s[i];
    }
    EXPECT_EQ(differ, 0u) << rung;
    EXPECT_GT(same_place, 3000u) << rung;
}

TEST(LadderTruth, TrianglesWithoutAreaChangeNothing) {
    const auto without_set   = set_stage(ladder("zero_area").scene(0));
    const RungStage& without = *without_set;
    for (const double rung : {10.0, 1e4}) expect_same(*set_stage(ladder("zero_area").scene(rung)), without, rung);
}

TEST(LadderTruth, DuplicatesChangeNothing) {
    const auto once_set   = set_stage(ladder("duplicate_faces").scene(1));
    const RungStage& once = *once_set;
    for (const double rung : {2.0, 20.0}) expect_same(*set_stage(ladder("duplicate_faces").scene(rung)), once, rung);
}

TEST(LadderTruth, AConvexBallDoesNotShadowItself) {
    for (const double rung : {8.0, 64.0}) {
        const auto stage_set   = set_stage(ladder("sphere_tessellation").scene(rung));
        const RungStage& stage = *stage_set;
        std::size_t asked = 0, dark = 0;
        for (std::size_t i = 0; i < stage.points.size(); ++i) {
            if (!is_open(stage.points, 0, i) || stage.scene.triangle_object[stage.points.triangle[i]] != 1) continue;
            ++asked;
            dark += stage.truth.planes[0].s[i] != 1;
        }
        EXPECT_GT(asked, 100u);
        EXPECT_EQ(dark, 0u) << rung;
    }
}

TEST(LadderTruth, IsWhatEveryTriangleTriedInDoublesSays) {
    // Where no part is so thin that the rounding which brute force allows for hides it.
    const std::pair<const char*, std::vector<double>> cases[] = {{"edge_on_slivers", {1e-1, 1e-2, 0}},
                                                                 {"sunken_slab", {1e-1, 1e-4}},
                                                                 {"interpenetrating_solids", {10, 200}},
                                                                 {"shared_edge", {1, 3, 30, 300}},
                                                                 {"large_floor", {1, 1e2, 1e4}},
                                                                 {"silhouette_edges", {30, 1000}},
                                                                 {"zero_area", {100}}};
    for (const auto& [name, rungs] : cases)
        for (const double rung : rungs) {
            const auto stage_set        = set_stage(ladder(name).scene(rung));
            const RungStage& stage      = *stage_set;
            const VisibilityPlane force = brute_force(stage.scene, stage.points, 0);
            std::size_t compared = 0, wrong = 0;
            for (std::size_t i = 0; i < stage.points.size(); ++i) {
                if (!is_open(stage.points, 0, i) || !force.defined(i) ||
                    stage.truth.planes[0].answer[i] != Answer::given)
                    continue;
                ++compared;
                wrong += stage.truth.planes[0].s[i] != force.s[i];
            }
            EXPECT_EQ(wrong, 0u) << name << " " << rung;
            EXPECT_GT(compared, 3000u) << name << " " << rung;
        }
}

TEST(LadderTruth, WhoServesExactlyHoldsOnEveryRung) {
    // Every error counts here, also those in the edge band.
    for (const char* name : {"crack", "t_junction", "beside_edges", "sliver_occluder", "sliver_receiver",
                             "touching_solids", "shared_edge", "large_floor", "needles", "depth_complexity"})
        for (const double rung : ladder(name).rungs) {
            const auto stage_set   = set_stage(ladder(name).scene(rung));
            const RungStage& stage = *stage_set;
            for (const char* method : {"planar_projection", "shadow_volumes"}) {
                const RungOutcome o = outcome(stage, parse_method(method));
                if (o.service.how != How::exactly) continue;
                EXPECT_EQ(o.interior() + o.false_shadow.edge + o.false_light.edge, 0u)
                    << method << " on " << name << " " << rung;
            }
        }
}

// ---- the sum --------------------------------------------------------------------------------------------------------

Image sum_of(const RungStage& stage) { return shade(stage.scene, stage.points, stage.truth.planes); }

/// Largest difference from a formula, as a share of the largest value.
double off_formula(const char* name, double rung, const std::function<double(const Scene&, dvec3 p)>& formula) {
    const auto stage_set   = set_stage(ladder(name).scene(rung));
    const RungStage& stage = *stage_set;
    const Image picture    = sum_of(stage);
    double largest = 0, off = 0;
    for (std::size_t i = 0; i < stage.points.size(); ++i) {
        const double right = formula(stage.scene, dvec3(stage.points.position(i)));
        largest            = std::max(largest, right);
        off                = std::max(off, std::abs(static_cast<double>(picture.at(i, 0)) - right));
    }
    return off / largest;
}

TEST(LadderSum, HighlightsFollowTheirFormula) {
    for (const double n : ladder("shininess").rungs)
        EXPECT_LT(off_formula("shininess", n,
                              [n](const Scene& scene, dvec3 p) {
                                  const dvec3 l = glm::normalize(dvec3(scene.lights[0].position) - p);
                                  const dvec3 v = glm::normalize(dvec3(scene.camera.eye) - p);
                                  return 0.75 * std::pow(std::max(0.0, -l.x * v.x + l.y * v.y - l.z * v.z), n);
                              }),
                  1e-4)
            << n;
}

TEST(LadderSum, SpotLightsFollowTheirFormula) {
    for (const double n : ladder("spot_exponent").rungs)
        EXPECT_LT(off_formula("spot_exponent", n,
                              [n](const Scene& scene, dvec3 p) {
                                  const Light& spot   = scene.lights[0];
                                  const dvec3 from    = glm::normalize(p - dvec3(spot.position));
                                  const double angle  = glm::dot(from, glm::normalize(dvec3(spot.direction)));
                                  const double facing = glm::dot(-from, glm::normalize(dvec3(2, 4, 1)));
                                  return angle < std::cos(static_cast<double>(spot.spot.cutoff))
                                             ? 0.0
                                             : 0.75 * facing * std::pow(angle, n);
                              }),
                  1e-3)
            << n;
}

TEST(LadderSum, AttenuationFollowsItsFormulaUntilItIsLimited) {
    for (const double h : ladder("attenuation_distance").rungs)
        EXPECT_LT(off_formula("attenuation_distance", h,
                              [](const Scene& scene, dvec3 p) {
                                  const dvec3 to = dvec3(scene.lights[0].position) - p;
                                  return 0.75 * to.y / std::pow(glm::length(to), 3);
                              }),
                  1e-5)
            << h;
    for (const double c : ladder("attenuation_coefficients").rungs)
        EXPECT_LT(off_formula("attenuation_coefficients", c,
                              [c](const Scene& scene, dvec3 p) {
                                  const dvec3 to = dvec3(scene.lights[0].position) - p;
                                  const double d = glm::length(to);
                                  return 0.75 * to.y / d * std::min(1e30, 1 / (c * (1 + d + d * d)));
                              }),
                  1e-5)
            << c;
}

TEST(LadderSum, APictureThatRisesFromItsMiddleIsFound) {
    const Ladder& l        = ladder("shininess");
    const auto stage_set   = set_stage(l.scene(100));
    const RungStage& stage = *stage_set;
    Image picture          = sum_of(stage);
    EXPECT_EQ(l.wrong_sum(100, stage.scene, picture), "");
    const std::size_t middle  = picture.pixels() / 2;
    picture.at(middle + 8, 0) = 1.001f * picture.at(middle + 7, 0);
    EXPECT_NE(l.wrong_sum(100, stage.scene, picture), "");
    picture.at(middle + 8, 0) = picture.at(middle + 7, 0);
    EXPECT_NE(l.wrong_sum(100, stage.scene, picture), "") << "a highlight has no steps";
    picture.at(middle + 8, 0) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(l.wrong_sum(100, stage.scene, picture), "");
}

}  // namespace
}  // namespace umbra
