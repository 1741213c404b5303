#include <gtest/gtest.h>

#include <fmt/format.h>
#include <rapidjson/document.h>
#include <rapidjson/schema.h>
#include <rapidjson/stringbuffer.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <type_traits>

#include "made_cell.h"
#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/sweep/bounds.h"
#include "umbra/bench/sweep/content_key.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/bench/sweep/recommend/recommend.h"
#include "umbra/bench/sweep/sweep.h"
#include "umbra/bench/sweep/sweep_record.h"
#include "umbra/bench/sweep/truth_file.h"
#include "umbra/bench/sweep/views.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/scene/photometry.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

fs::path scene_file(const std::string& name) { return fs::path(UMBRA_SCENES) / (name + ".json"); }

using Change = std::function<void(Scene&)>;

/// A change of what `of` finds in a scene: of a vector, one of each of its coordinates.
template <class Of>
void change_each(std::vector<Change>& changes, const Of& of) {
    using Value = std::remove_reference_t<decltype(of(std::declval<Scene&>()))>;
    if constexpr (std::is_same_v<Value, vec3>)
        for (int k = 0; k < 3; ++k) changes.push_back([=](Scene& s) { of(s)[k] += 1; });
    else if constexpr (std::is_same_v<Value, std::string>)
        changes.push_back([=](Scene& s) { of(s) += "x"; });
    else if constexpr (std::is_same_v<Value, bool>)
        changes.push_back([=](Scene& s) { of(s) = !of(s); });
    else if constexpr (std::is_enum_v<Value>)
        changes.push_back([=](Scene& s) { of(s) = static_cast<Value>(of(s) == Value{} ? 1 : 0); });
    else
        changes.push_back([=](Scene& s) { of(s) += Value{1}; });
}

/// The same of members of what `of` finds.
template <class Of, class... Members>
void change_members(std::vector<Change>& changes, const Of& of, Members... members) {
    (change_each(
         changes, [=](Scene & s) -> auto& { return of(s).*members; }),
     ...);
}

/// Every field that there is, one at a time, in a scene that has something in every list.
TEST(SceneKey, ChangesWithEverythingThatAnAnswerDependsOn) {
    Scene scene = load_scene(scene_file("umbra_penumbra"));
    ASSERT_FALSE(scene.lights.empty());
    scene.materials[0].lobes.emplace_back();
    const Photometry table{.type = {}, .vertical = {0, 90}, .horizontal = {0}, .candela = {1, 2}};
    scene.lights[0].photometry  = std::make_shared<const Photometry>(table);
    scene.lights[0].except      = {"a", "b"};
    scene.lights[0].camera_pose = pose_of(scene.lights[0]);

    std::vector<Change> changes;
    const auto whole = [](Scene& s) -> Scene& { return s; };
    change_members(changes, whole, &Scene::name, &Scene::title, &Scene::shows, &Scene::width, &Scene::height,
                   &Scene::ambient, &Scene::background, &Scene::tone, &Scene::exposure, &Scene::local_viewer,
                   &Scene::light_ambient, &Scene::specular_colour, &Scene::ambient_coefficient, &Scene::transparent);
    const auto camera = [](Scene& s) -> Camera& { return s.camera; };
    change_members(changes, camera, &Camera::projection, &Camera::eye, &Camera::target, &Camera::up, &Camera::fov_y,
                   &Camera::height);
    const auto fog = [](Scene& s) -> Fog& { return s.fog; };
    change_members(changes, fog, &Fog::law, &Fog::distance, &Fog::colour, &Fog::density, &Fog::start, &Fog::end,
                   &Fog::near_share, &Fog::far_share, &Fog::dims_lights);
    const auto object = [](Scene& s) -> Object& { return s.objects[0]; };
    change_members(changes, object, &Object::name, &Object::first_triangle, &Object::triangle_count, &Object::material);
    const auto switches = [](Scene& s) -> ObjectSwitches& { return s.objects[0].switches; };
    change_members(changes, switches, &ObjectSwitches::casts_shadows, &ObjectSwitches::receives_shadows,
                   &ObjectSwitches::seen_by_camera);
    const auto material = [](Scene& s) -> Material& { return s.materials[0]; };
    change_members(changes, material, &Material::name, &Material::k_a, &Material::k_d, &Material::k_s, &Material::O_d,
                   &Material::O_s, &Material::emission, &Material::shininess, &Material::lobe, &Material::two_sided,
                   &Material::cutout, &Material::opacity, &Material::reflect, &Material::transmit,
                   &Material::transmit_colour, &Material::index_of_refraction, &Material::tangent);
    for (std::size_t row = 0; row < 3; ++row)
        change_each(changes, [=](Scene& s) -> vec3& { return s.materials[0].lobes[0].rows[row]; });
    const auto lobe = [](Scene& s) -> LafortuneLobe& { return s.materials[0].lobes[0]; };
    change_members(changes, lobe, &LafortuneLobe::k_s, &LafortuneLobe::shininess);
    const auto light = [](Scene& s) -> Light& { return s.lights[0]; };
    change_members(changes, light, &Light::name, &Light::kind, &Light::position, &Light::direction, &Light::edge_u,
                   &Light::edge_v, &Light::radius, &Light::range, &Light::ambient, &Light::diffuse, &Light::specular,
                   &Light::along);
    const auto attenuation = [](Scene& s) -> Attenuation& { return s.lights[0].attenuation; };
    change_members(changes, attenuation, &Attenuation::c1, &Attenuation::c2, &Attenuation::c3, &Attenuation::clamp);
    const auto spot = [](Scene& s) -> Spot& { return s.lights[0].spot; };
    change_members(changes, spot, &Spot::falloff, &Spot::exponent, &Spot::cutoff, &Spot::inner);
    const auto pose = [](Scene& s) -> LightPose& { return *s.lights[0].camera_pose; };
    change_members(changes, pose, &LightPose::position, &LightPose::direction, &LightPose::edge_u, &LightPose::edge_v,
                   &LightPose::along);
    const auto photometry = [&](const std::function<void(Photometry&)>& change) {
        changes.push_back([=](Scene& s) {
            Photometry other = table;
            change(other);
            s.lights[0].photometry = std::make_shared<const Photometry>(other);
        });
    };
    photometry([](Photometry& p) { p.type = PhotometricType::B; });
    photometry([](Photometry& p) { p.vertical[1] = 80; });
    photometry([](Photometry& p) { p.horizontal[0] = 1; });
    photometry([](Photometry& p) { p.candela[1] = 3; });
    const std::vector<Change> lists = {
        [](Scene& s) { s.lights[0].photometry.reset(); },
        [](Scene& s) { s.lights[0].camera_pose.reset(); },
        [](Scene& s) { s.lights[0].except[1] += "x"; },
        [](Scene& s) {
            s.lights[0].except = {"ab"}; },
        [](Scene& s) { s.lights[0].except.clear(); },
        [](Scene& s) { s.materials[0].lobes.clear(); },
        [](Scene& s) { s.materials[0].lobes.emplace_back(); },
        [](Scene& s) { s.materials.push_back(s.materials[0]); },
        [](Scene& s) { s.lights.push_back(s.lights[0]); },
        [](Scene& s) { s.lights.pop_back(); },
        [](Scene& s) { s.objects.push_back(s.objects[0]); },
        [](Scene& s) { s.positions.back().z += 1; },
        [](Scene& s) { s.normals[0] = -s.normals[0]; },
        [](Scene& s) { std::swap(s.triangles[0].x, s.triangles[0].y); },
        [](Scene& s) { s.triangle_object.back() += 1; },
    };
    changes.insert(changes.end(), lists.begin(), lists.end());

    std::map<std::string, std::size_t> keys = {{scene_key(scene), changes.size()}};
    for (std::size_t k = 0; k < changes.size(); ++k) {
        Scene other = scene;
        changes[k](other);
        const auto [at, is_new] = keys.emplace(scene_key(other), k);
        EXPECT_TRUE(is_new) << "change " << k << " has the key of change " << at->second << " of " << changes.size();
    }
    Scene moved    = scene;
    moved.source   = "elsewhere.json";
    moved.warnings = {"a warning"};
    EXPECT_EQ(scene_key(moved), scene_key(scene));
}

/// Everything that a cell is asked for, one at a time: the view, both sides of the picture, the reference, its points,
/// and each parameter of the method. The key of the record of the reference is none of them.
TEST(CellKey, ChangesWithEverythingThatIsAskedFor) {
    const auto own = std::make_shared<OwnScene>(load_scene(scene_file("umbra_penumbra")));
    const TemporaryFolder folder;
    std::map<std::string, std::string> keys;
    const auto add = [&](const char* what, int view, const CellOptions& options, const char* setting) {
        const CellView cell(own, scene_file("umbra_penumbra"), view, options, folder.path());
        for (const std::string& key : {cell.key(parse_method(setting)), cell.reference_key() + setting}) {
            const auto [at, is_new] = keys.emplace(key, what);
            EXPECT_TRUE(is_new) << what << " has the key of " << at->second;
        }
    };
    const char* const plain = "shadow_zbuffer";
    add("the own view", 0, {.size = {48, 27}}, plain);
    add("another view", 1, {.size = {48, 27}}, plain);
    add("a third view", 2, {.size = {48, 27}}, plain);
    add("another width", 0, {.size = {50, 27}}, plain);
    add("another height", 0, {.size = {48, 28}}, plain);
    add("sides exchanged", 0, {.size = {27, 48}}, plain);
    add("a reference", 0, {.size = {48, 27}, .reference = "exact"}, plain);
    add("another reference", 0, {.size = {48, 27}, .reference = "ray_traced:samples=256"}, plain);
    add("its other setting", 0, {.size = {48, 27}, .reference = "ray_traced:samples=64"}, plain);
    add("points", 0, {.size = {48, 27}, .points = 100}, plain);
    add("more points", 0, {.size = {48, 27}, .points = 1000}, plain);
    const MethodInfo& info = *parse_method(plain).info;
    std::set<std::string> taken;
    for (const Parameter& p : info.parameters)
        for (const std::string& value :
             {std::string("0"), std::string("1"), std::string("2"), std::string("false"), std::string("true"),
              std::string("512"), std::string("nearest"), std::string("pcf")}) {
            MethodChoice choice(info);
            try {
                choice = parse_method(fmt::format("{}:{}={}", plain, p.name, value));
            } catch (const UsageError&) {
                continue;  // no value of this parameter
            }
            if (choice.settings == MethodChoice(info).settings || !taken.insert(choice.text()).second) continue;
            add(p.name.data(), 0, {.size = {48, 27}}, choice.text().c_str());
        }
    EXPECT_GE(taken.size(), 5u);
    add("another method", 0, {.size = {48, 27}}, "ray_traced");
}

/// A brief cell has the same values of all metrics that need no whole one, and none of the others. It is kept apart; a
/// whole one is taken in its place.
TEST(Cell, BrieflyHasTheSameOfWhatItHas) {
    const TemporaryFolder folder;
    const CellStore store(folder.path() / "cells");
    SceneLab brief(scene_file("umbra_penumbra"), {.size = {96, 54}, .brief = true}, store);
    SceneLab whole(scene_file("umbra_penumbra"), {.size = {96, 54}}, store);
    for (const char* text : {"ray_traced:samples=4", "shadow_zbuffer", "shadow_volumes"}) {
        const MethodChoice choice = parse_method(text);
        const Cell less           = brief.cell(choice, 0);
        EXPECT_TRUE(brief.has_cell(choice, 0));
        EXPECT_FALSE(whole.has_cell(choice, 0));
        const Cell more = whole.cell(choice, 0);
        EXPECT_NE(less.key, more.key);
        std::size_t known = 0, other = 0;
        for (const Metric& metric : metrics()) {
            const auto of_less = metric_value(metric, less), of_more = metric_value(metric, more);
            if (needs_whole_cell(metric)) {
                EXPECT_FALSE(of_less) << metric.name;
                other += of_more && *of_more > 0;
            } else {
                EXPECT_EQ(of_less, of_more) << metric.name;
                known += of_less && *of_less > 0;
            }
        }
        EXPECT_GE(known, 5u) << text;
        EXPECT_GE(other, 2u) << text;
        SceneLab later(scene_file("umbra_penumbra"), {.size = {96, 54}, .brief = true}, store);
        EXPECT_EQ(later.cell(choice, 0).key, more.key);
        EXPECT_EQ(later.computed(), 0u);
    }
}

/// Of this machine's own: a time is no price, and with other threads it is another one.
TEST(MachineKey, ChangesWithWhatATimeDependsOn) {
    const TemporaryFolder folder;
    const CellStore store(folder.path() / "cells");
    SceneLab lab(scene_file("umbra_penumbra"), {.size = {48, 27}}, store);
    const MethodChoice rays = parse_method("ray_traced"), more = parse_method("ray_traced:samples=64");
    const std::string key = lab.machine_key("time", rays);
    EXPECT_EQ(lab.machine_key("time", rays), key);
    EXPECT_NE(lab.machine_key("price", rays), key);
    EXPECT_NE(lab.machine_key("time", more), key);
    EXPECT_NE(lab.view(0).key(rays), key);
    if (thread_count() == 1) GTEST_SKIP() << "one thread is all there is";
    const ThreadLimit one(1);
    EXPECT_NE(lab.machine_key("time", rays), key);
}

TEST(CodeKey, DiffersFromMethodToMethod) {
    std::vector<std::string> keys;
    for (const MethodInfo* info : methods()) keys.push_back(code_key(*info));
    for (const std::string& key : keys) EXPECT_EQ(key.size(), 32u);
    std::ranges::sort(keys);
    EXPECT_TRUE(std::ranges::adjacent_find(keys) == keys.end());
    EXPECT_NE(combined_key({"ab", "c"}), combined_key({"a", "bc"}));
    EXPECT_NE(combined_key({"ab"}), combined_key({"ab", ""}));
}

TEST(Views, MoveCameraAndLightsALittleAndAlwaysTheSame) {
    for (const char* name : {"six_lights", "umbra_penumbra", "light_inside_view"}) {
        if (!fs::exists(scene_file(name))) continue;
        const Scene scene = load_scene(scene_file(name));
        EXPECT_EQ(scene_key(view_of(scene, 0)), scene_key(scene));
        const double arm = glm::length(dvec3(scene.camera.eye) - dvec3(scene.camera.target));
        std::vector<std::string> keys;
        for (int v = 1; v <= 6; ++v) {
            const Scene moved = view_of(scene, v);
            keys.push_back(scene_key(moved));
            EXPECT_EQ(keys.back(), scene_key(view_of(scene, v)));
            EXPECT_EQ(moved.positions, scene.positions);
            EXPECT_NEAR(glm::length(dvec3(moved.camera.eye) - dvec3(moved.camera.target)), arm, 1e-5 * arm);
            const double chord = glm::length(dvec3(moved.camera.eye) - dvec3(scene.camera.eye));
            EXPECT_LE(chord, arm * glm::radians(kJitterYaw + kJitterPitch));
            for (std::size_t j = 0; j < scene.lights.size(); ++j) {
                EXPECT_EQ(moved.lights[j].kind, scene.lights[j].kind);
                EXPECT_NEAR(glm::length(moved.lights[j].direction), glm::length(scene.lights[j].direction), 1e-5);
            }
        }
        std::ranges::sort(keys);
        EXPECT_TRUE(std::ranges::adjacent_find(keys) == keys.end()) << name;
    }
}

/// The least and largest of 200 draws and their mean distance from 0, over what they may be at most: drawn evenly, they
/// come within a tenth of both ends, and are half of it apart from 0 on average.
void expect_even(const std::vector<double>& values, double most, const char* what) {
    const auto [least, largest] = std::ranges::minmax(values);
    EXPECT_GE(least, -most * 1.001) << what;
    EXPECT_LE(largest, most * 1.001) << what;
    EXPECT_LT(least, -0.9 * most) << what;
    EXPECT_GT(largest, 0.9 * most) << what;
    double sum = 0;
    for (const double v : values) sum += std::abs(v) / double(values.size());
    EXPECT_NEAR(sum / most, 0.5, 0.1) << what;
}

TEST(Views, MoveEvenlyAsFarAsIsSaidInAllDirections) {
    Scene scene;
    scene.materials.resize(1);
    add_object(scene, "patch", {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    scene.camera.eye = {0, 0, 10};
    Light lamp, sun;
    lamp.name = "lamp", lamp.position = {0, 10, 0};
    sun.name = "sun", sun.kind = LightKind::directional, sun.direction = {0, -1, 0};
    scene.lights = {lamp, sun};
    std::vector<double> yaw, pitch, sideways;
    std::array<std::vector<double>, 3> light;
    for (int v = 1; v <= 200; ++v) {
        const Scene view = view_of(scene, v);
        const dvec3 eye(view.camera.eye), lamp_moved = dvec3(view.lights[0].position) - dvec3(0, 10, 0);
        yaw.push_back(glm::degrees(std::atan2(eye.x, eye.z)));
        pitch.push_back(glm::degrees(std::asin(eye.y / 10)));
        for (int k = 0; k < 3; ++k) light[std::size_t(k)].push_back(lamp_moved[k]);
        const double turn = glm::degrees(std::acos(-double(view.lights[1].direction.y)));
        sideways.push_back(v % 2 == 0 ? turn : -turn);
    }
    expect_even(yaw, kJitterYaw, "yaw");
    expect_even(pitch, kJitterPitch, "pitch");
    for (const std::vector<double>& axis : light) expect_even(axis, 10 * kJitterLight, "light");
    expect_even(sideways, kJitterSun, "sun");
}

/// A closed box around a point, whose walls are `half` away.
void add_walls(Scene& scene, vec3 middle, float half) {
    std::vector<vec3> corners;
    for (int k = 0; k < 8; ++k) corners.push_back(middle + half * vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
    add_object(scene, "walls", corners, {},
               {{0, 1, 3},
                {0, 3, 2},
                {4, 6, 7},
                {4, 7, 5},
                {0, 4, 5},
                {0, 5, 1},
                {2, 3, 7},
                {2, 7, 6},
                {0, 2, 6},
                {0, 6, 4},
                {1, 5, 7},
                {1, 7, 3}},
               0);
}

TEST(Views, StayWithinWalls) {
    Scene scene = load_scene(scene_file("umbra_penumbra"));
    scene.lights.resize(1);
    const vec3 light = scene.lights[0].position, eye = scene.camera.eye;
    int moved = 0;
    for (int v = 1; v <= 20; ++v) moved += view_of(scene, v).lights[0].position != light;
    EXPECT_EQ(moved, 20);
    const float half = 0.01f * glm::length(eye - scene.camera.target);
    add_walls(scene, light, half);
    add_walls(scene, eye, half);
    const auto inside = [&](vec3 p, vec3 middle) {
        const vec3 d = glm::abs(p - middle);
        return std::max({d.x, d.y, d.z}) < half;
    };
    for (int v = 1; v <= 20; ++v) {
        const Scene view = view_of(scene, v);
        EXPECT_TRUE(inside(view.lights[0].position, light)) << v;
        EXPECT_TRUE(inside(view.camera.eye, eye)) << v;
    }
}

TEST(Views, KeepLightsAtTheCameraThatAreFixedToIt) {
    const Scene scene = load_scene(scene_file("warnock"));
    for (int v = 1; v <= 5; ++v) {
        const Scene view = view_of(scene, v);
        EXPECT_NE(view.camera.eye, scene.camera.eye);
        EXPECT_EQ(view.lights[0].position, view.camera.eye);
    }
}

TEST(CellView, HasRandomNumbersOfItsOwn) {
    const TemporaryFolder folder;
    const auto own = std::make_shared<OwnScene>(load_scene(scene_file("umbra_penumbra")));
    CellView view(own, scene_file("umbra_penumbra"), 2, {.size = {48, 27}}, folder.path());
    const PreparedScene& p   = view.prepared();
    const ReferenceRun truth = run_reference(default_reference(p.facts), p.scene, p.facts, p.points, std::nullopt);
    const auto rmse          = [&](const char* text) {
        const MethodRun run = run_method(parse_method(text), p.scene, p.facts, p.points);
        return explain(p.scene, p.points, 0, run, truth.run).error.rmse;
    };
    const double found = view.compute(parse_method("ray_traced:samples=1")).method.errors[0].rmse.value();
    EXPECT_NE(found, rmse("ray_traced:samples=1"));
    EXPECT_EQ(found, rmse("ray_traced:samples=1,seed=15838"));
}

/// What methods and references build for one view of brief cells serves the others, in any order.
TEST(CellView, ServesOtherViewsWithWhatItBuilt) {
    for (const char* scene : {"umbra_penumbra", "stairs"}) {
        const TemporaryFolder together, apart;
        const fs::path file = scene_file(scene);
        const auto own      = std::make_shared<OwnScene>(load_scene(file));
        const CellOptions options{.size = {24, 14}, .brief = true};
        std::vector<CellView> views, alone;
        for (int v = 0; v < 3; ++v) {
            views.emplace_back(own, file, v, options, together.path());
            alone.emplace_back(std::make_shared<OwnScene>(own->scene()), file, v, options, apart.path());
        }
        std::set<double> errors;
        for (const MethodInfo* info : methods()) {
            if (!info->is_shown()) continue;
            for (const std::size_t v : {0, 1, 0, 2, 1}) {
                const Cell cell = views[v].compute(MethodChoice(*info));
                EXPECT_EQ(to_record(cell), to_record(alone[v].compute(MethodChoice(*info)))) << scene << ", view " << v;
                for (const ErrorRecord& error : cell.method.errors) errors.insert(error.rmse.value_or(0));
            }
        }
        EXPECT_GE(errors.size(), 6u) << scene;
    }
}

TEST(CellView, ComparesWithTheTruthOfTheMethodsOwnMeasure) {
    const TemporaryFolder folder;
    const auto own = std::make_shared<OwnScene>(load_scene(scene_file("umbra_penumbra")));
    CellView view(own, scene_file("umbra_penumbra"), 0, {.size = {32, 18}}, folder.path());
    const MethodRecord area       = view.compute(parse_method("ray_traced")).method,
                       irradiance = view.compute(parse_method("ray_traced:measure=irradiance")).method;
    EXPECT_EQ(area.measures, "area");
    EXPECT_EQ(irradiance.measures, "irradiance");
    EXPECT_NE(area.compared_with, irradiance.compared_with);
}

/// A cell's picture is that of a comparison, colours of filters included.
TEST(CellView, HasColouredShadows) {
    const TemporaryFolder folder;
    const auto file = folder.write("stained.json", R"({
        "camera": {"eye": [0, 4, 4], "target": [0, 0, 0]}, "transparent_occluders": "multiply",
        "materials": {"glass": {"opacity": 0.5, "transmit_colour": [1, 0.5, 0.25]}},
        "lights": [{"type": "directional", "direction": [0.2, -1, 0]}],
        "objects": [{"type": "plane", "size": [8, 8]},
                    {"type": "plane", "size": [2, 1], "material": "glass", "transform": [{"translate": [0, 1, 0]}]}]})");
    const auto own  = std::make_shared<OwnScene>(load_scene(file));
    CellView view(own, file, 0, {.size = {48, 27}}, folder.path());
    const MethodChoice choice = parse_method("brute_force");
    const Cell cell           = view.compute(choice);
    const PreparedScene& p    = view.prepared();
    const MethodRun run       = run_method(choice, p.scene, p.facts, p.points);
    const MethodRun truth     = run_reference(default_reference(p.facts), p.scene, p.facts, p.points, std::nullopt).run;
    ASSERT_TRUE(run.planes.size() == 1 && !run.planes[0].colour.empty()) << run.service.why;
    EXPECT_EQ(to_record(cell.method.image),
              to_record(image_figures(run.planes, render_planes(p.scene, p.points, run.planes),
                                      render_planes(p.scene, p.points, truth.planes))
                            .figures));
}

/// Coloured shadows, which three channels of S_j make.
TEST(TruthFile, KeepsColours) {
    const TemporaryFolder folder;
    const PreparedScene p     = prepare_scene(folder.write("stained.json", R"({
        "camera": {"eye": [0, 4, 4], "target": [0, 0, 0]}, "transparent_occluders": "multiply",
        "materials": {"glass": {"opacity": 0.5, "transmit_colour": [1, 0.5, 0.25]}},
        "lights": [{"type": "rectangle", "position": [1, 5, 0], "direction": [0, -1, 0], "size": [1, 1]},
                   {"type": "directional", "direction": [0.2, -1, 0]}],
        "objects": [{"type": "plane", "size": [8, 8]},
                    {"type": "plane", "size": [2, 1], "material": "glass", "transform": [{"translate": [0, 1, 0]}]}]})"),
                                              {48, 27});
    const Reference reference = default_reference(p.facts);
    EXPECT_EQ(reference.choice.info->name, "exact");
    // Ten points are asked for, but no other method serves such a scene: all of them are the reference's.
    const ReferenceRun ran = run_reference(reference, p.scene, p.facts, p.points, std::uint64_t{10});
    EXPECT_EQ(ran.judged, ran.of);
    ASSERT_EQ(ran.run.planes.size(), 2u);
    write_truth(folder.path() / "truth.exr", ran, 48, 27);
    ReferenceRun read{MethodRun{reference.choice}, 0, 0, {}};
    ASSERT_TRUE(read_truth(folder.path() / "truth.exr", 2, p.points.size(), read));
    for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_EQ(read.run.planes[j].s, ran.run.planes[j].s);
        EXPECT_EQ(read.run.planes[j].colour, ran.run.planes[j].colour);
        EXPECT_TRUE(std::ranges::any_of(read.run.planes[j].colour, [](vec3 s) { return s.r > s.b && s.b > 0; }));
    }
}

TEST(TruthFile, KeepsEveryBit) {
    const TemporaryFolder folder;
    PreparedScene p           = prepare_scene(scene_file("light_sizes"), {48, 27});
    const Reference reference = default_reference(p.facts);
    for (const std::optional<std::uint64_t> points :
         {std::optional<std::uint64_t>{}, std::optional<std::uint64_t>{200}}) {
        ReferenceRun ran            = run_reference(reference, p.scene, p.facts, p.points, points);
        ran.run.planes[0].answer[3] = Answer::on_boundary;
        ran.run.planes[0].answer[4] = Answer::undefined;
        const fs::path file         = folder.path() / "truth.exr";
        write_truth(file, ran, 48, 27);
        ReferenceRun read{MethodRun{reference.choice}, 0, 0, {}};
        ASSERT_TRUE(read_truth(file, p.scene.lights.size(), p.points.size(), read));
        ASSERT_EQ(read.run.planes.size(), ran.run.planes.size());
        for (std::size_t j = 0; j < ran.run.planes.size(); ++j) {
            EXPECT_EQ(read.run.planes[j].s, ran.run.planes[j].s);
            EXPECT_EQ(read.run.planes[j].answer, ran.run.planes[j].answer);
            EXPECT_EQ(read.run.planes[j].half_width, ran.run.planes[j].half_width);
        }
        EXPECT_EQ(read.run.judged, ran.run.judged);
        EXPECT_EQ(read.judged, ran.judged);
        EXPECT_EQ(read.of, ran.of);
        EXPECT_EQ(read.stand_in, ran.stand_in);
        EXPECT_FALSE(read_truth(file, p.scene.lights.size() + 1, p.points.size(), read));
        EXPECT_FALSE(read_truth(file, p.scene.lights.size(), p.points.size() - 1, read));
    }
    std::ofstream(folder.path() / "truth.exr") << "cut";
    ReferenceRun read{MethodRun{reference.choice}, 0, 0, {}};
    EXPECT_FALSE(read_truth(folder.path() / "truth.exr", p.scene.lights.size(), p.points.size(), read));
}

SweepOptions small_sweep(const fs::path& out) {
    SweepOptions o;
    o.plan       = {.scenes   = {scene_file("umbra_penumbra")},
                    .settings = {"ray_traced:samples=1|16", "shadow_zbuffer:resolution=128|512,filter=nearest|pcf",
                                 "planar_projection:light_samples=4"},
                    .views    = 2,
                    .size     = {48, 27}};
    o.out        = out;
    o.times      = false;
    o.most_noise = std::numeric_limits<double>::infinity();
    return o;
}

std::vector<Json> records_of(const SweepDone& done) {
    std::vector<Json> all;
    for (const SweepResults& record : done.records) all.push_back(to_record(record));
    return all;
}

Json settings_of(const SweepDone& done) { return records_of(done).at(0).at("sweep").at("settings"); }

TEST(Sweep, ComputesEveryCellOnceAndSharingABuildChangesNothing) {
    const TemporaryFolder folder;
    const SweepDone first = sweep(small_sweep(folder.path() / "a"));
    EXPECT_EQ(first.cells, 14u);
    EXPECT_EQ(first.computed, 14u);
    const SweepDone again = sweep(small_sweep(folder.path() / "a"));
    EXPECT_EQ(again.computed, 0u);
    EXPECT_EQ(records_of(again), records_of(first));

    // Each setting alone, in a folder of its own.
    std::size_t k = 0;
    for (const Json& together : settings_of(first)) {
        SweepOptions alone  = small_sweep(folder.path() / fmt::format("alone-{}", k++));
        alone.plan.settings = {together.at("text").get<std::string>()};
        const SweepDone one = sweep(alone);
        EXPECT_EQ(settings_of(one).at(0), together);
    }

    // A further setting costs its own cells; a cell that is cut off is computed again.
    SweepOptions more = small_sweep(folder.path() / "a");
    more.plan.settings.emplace_back("shadow_volumes");
    EXPECT_EQ(sweep(more).computed, 2u);
    const auto is_cell = [](const fs::directory_entry& entry) {
        if (entry.path().extension() != ".json") return false;
        std::ifstream in(entry.path());
        return Json::parse(in).contains("errors");
    };
    const fs::directory_iterator files(folder.path() / "a/cells");
    const auto cell = std::find_if(begin(files), end(files), is_cell);
    ASSERT_NE(cell, end(files));
    fs::resize_file(cell->path(), fs::file_size(cell->path()) / 2);
    EXPECT_EQ(sweep(more).computed, 1u);
}

TEST(Sweep, MergedPacksAreTheUnbrokenRun) {
    const TemporaryFolder folder;
    const SweepDone whole = sweep(small_sweep(folder.path() / "whole"));
    std::vector<fs::path> parts;
    std::size_t computed = 0;
    std::vector<std::string> failed;
    for (std::size_t k = 1; k <= 3; ++k) {
        parts.push_back(folder.path() / fmt::format("part-{}", k));
        computed += sweep_pack(small_sweep(parts.back()), {k, 3}, failed);
    }
    EXPECT_EQ(computed, 14u);
    EXPECT_TRUE(failed.empty());
    SweepOptions merged      = small_sweep(folder.path() / "merged");
    merged.plan              = merged_plan(parts, merged.out);
    const SweepDone together = sweep(merged);
    EXPECT_EQ(together.computed, 0u);
    EXPECT_EQ(records_of(together), records_of(whole));

    // Two of three parts are not the whole, and parts of another plan do not fit.
    const auto error = [&](const std::vector<fs::path>& folders, const char* out) -> std::string {
        try {
            static_cast<void>(merged_plan(folders, folder.path() / out));
        } catch (const InputError& e) {
            return e.what();
        }
        return "no error";
    };
    EXPECT_NE(error({parts[0], parts[1]}, "two").find("4 cells are missing"), std::string::npos);
    SweepOptions other = small_sweep(folder.path() / "other");
    other.plan.views   = 1;
    static_cast<void>(sweep_pack(other, {1, 1}, failed));
    EXPECT_NE(error({parts[0], other.out}, "mixed").find("its plan is not that of"), std::string::npos);
    EXPECT_NE(error({folder.path() / "nothing"}, "none").find("plan.json"), std::string::npos);
}

TEST(Sweep, FrontsHoldWhatNothingBeats) {
    const auto swept = [](const char* text, double ms, double rmse, double undefined) {
        Json e            = {{"light", "l"}, {"points", 1000}, {"rmse", rmse}, {"bracket", nullptr}};
        Json c            = {{"text", text},
                             {"name", "ray_traced"},
                             {"title", "t"},
                             {"parameters", Json::object()},
                             {"view", 0},
                             {"key", "k"},
                             {"serves", {{"how", "approximately"}, {"why", "."}}},
                             {"undefined", undefined},
                             {"errors", {e}}};
        const auto timing = [](double median) { return TimingRecord{.median = median}; };
        return MeasuredSetting{
            parse_method(text), {cell_from(c)}, TurnTimesRecord{{timing(100), timing(10), timing(3), timing(ms)}}};
    };
    const std::vector<MeasuredSetting> settings = {
        swept("ray_traced:samples=1", 1, 0.1, 0), swept("ray_traced:samples=2", 2, 0.2, 0),
        swept("ray_traced:samples=4", 3, 0, 0), swept("ray_traced:samples=8", 0.5, 0, 0.5)};
    const Json record = to_record(sweep_record(settings, 1, {60, 0, 0}, {}));
    EXPECT_EQ(record["fronts"]["rmse"], (Json{"ray_traced:samples=1", "ray_traced:samples=4"}));
    EXPECT_EQ(record["settings"][0]["cost_ms"], 3 + 1);
    EXPECT_EQ(record["settings"][3]["excluded"], "it leaves 50 % of a view's points undefined");
    EXPECT_TRUE(record["settings"][0]["excluded"].is_null());
    // Half of the frames have a light that moved: aim is paid in half of them.
    EXPECT_NEAR(sweep_record(settings, 1, {60, 30, 0}, {}).settings[1].cost_ms.value(), 3 + 2 + 0.5 * 10, 1e-12);
    EXPECT_NEAR(sweep_record(settings, 1, {60, 30, 60}, {}).settings[1].cost_ms.value(), 3 + 2 + 10 + 100, 1e-12);

    // In words, the front is ranked where times can tell: the second setting is beaten, the last one is unfit.
    const auto words = [&](const std::optional<SweptTurnsRecord>& turns) {
        return front_in_words("court", sweep_record(settings, 1, {60, 0, 0}, turns));
    };
    const std::string head = "court: cost of a frame, S_j error (rmse), its upper bound; ",
                      one  = "      4.000 ms  0.1        -          ray_traced:samples=1\n",
                      two  = "      5.000 ms  0.2        -          ray_traced:samples=2\n",
                      four = "      6.000 ms  0          -          ray_traced:samples=4\n";
    EXPECT_EQ(words({}), head + "settings that no other beats in both:\n" + one + four);
    EXPECT_EQ(words(SweptTurnsRecord{.noise_bar = 0.042}),
              head +
                  "settings that no other beats in both, costs that differ by less "
                  "than 5 % are not told apart:\n" +
                  one + four);
    EXPECT_EQ(words(SweptTurnsRecord{.noise_bar = 0.31}),
              head + "not ranked, as times vary by 31 %:\n" + one + two + four);
    EXPECT_EQ(words(SweptTurnsRecord{}),
              head + "not ranked, as times are of fewer than six rounds:\n" + one + two + four);
}

/// What a sweep says of a setting is its error in the view that is hardest for it.
TEST(Sweep, ValuesAreThoseOfTheWorstView) {
    const auto cell = [](int view, double rmse) {
        return cell_from({{"text", "ray_traced:samples=1"},
                          {"name", "ray_traced"},
                          {"title", "t"},
                          {"parameters", Json::object()},
                          {"view", view},
                          {"key", "k"},
                          {"serves", {{"how", "approximately"}, {"why", "."}}},
                          {"undefined", 0},
                          {"errors", {{{"light", "l"}, {"points", 1000}, {"rmse", rmse}, {"bracket", nullptr}}}}});
    };
    const MeasuredSetting setting{parse_method("ray_traced:samples=1"), {cell(0, 0.1), cell(1, 0.3), cell(2, 0.2)}, {}};
    const Json record = to_record(sweep_record({{setting}}, 3, {60, 0, 0}, {}));
    EXPECT_EQ(record["settings"][0]["values"]["rmse"], 0.3);
    EXPECT_EQ(record["settings"][0]["views"][2]["metrics"]["rmse"], 0.2);
}

TEST(SweepRecord, NamesTheFiguresThatMayBeLarger) {
    const auto cell = [](int view, int unmatched) {
        Json one      = {{"text", "ray_traced"}, {"name", "ray_traced"},
                         {"title", "t"},         {"parameters", Json::object()},
                         {"view", view},         {"serves", {{"how", "approximately"}, {"why", "."}}},
                         {"undefined", 0}};
        one["errors"] = {
            {{"light", "l"},
             {"points", 1000},
             {"edge_displacement_px",
              {{"mean", 0.5}, {"p95", 1}, {"max", 2}, {"pieces", 100}, {"unmatched", unmatched}, {"reach", 8}}}}};
        return cell_from(one);
    };
    const MeasuredSetting setting{parse_method("ray_traced"), {cell(0, 0), cell(1, 1), cell(2, 50)}, {}};
    const Json record = to_record(sweep_record({{setting}}, 3, {60, 0, 0}, {}));
    const Json& views = record["settings"][0]["views"];
    EXPECT_FALSE(views[0].contains("at_least"));
    // One of 100 pieces is in the mean and is the farthest, but is not among the first 95.
    EXPECT_EQ(views[1]["at_least"], (Json{"edge_displacement_px.mean", "edge_displacement_px.max"}));
    EXPECT_EQ(views[2]["at_least"],
              (Json{"edge_displacement_px.mean", "edge_displacement_px.p95", "edge_displacement_px.max"}));
}

TEST(Sweep, WritesWhatItsSchemaSays) {
    const TemporaryFolder folder;
    SweepOptions o       = small_sweep(folder.path() / "a");
    o.plan.scenes        = {scene_file("self_shadow"), scene_file("umbra_penumbra")};
    o.plan.settings      = {"ray_traced:samples=4", "shadow_zbuffer@fast", "planar_projection", "exact"};
    o.times              = true;
    o.turns              = {.rounds = 2, .budget_ms = 1e6};  // both rounds, however slow the machine
    const SweepDone done = sweep(o);
    rapidjson::Document schema_document;
    schema_document.Parse(schema_of<SweepResults>("").dump().c_str());
    ASSERT_FALSE(schema_document.HasParseError());
    const rapidjson::SchemaDocument schema(schema_document);
    const auto invalid_at = [&](const Json& record) -> std::string {
        rapidjson::Document document;
        document.Parse(json_text(record).c_str());
        rapidjson::SchemaValidator valid(schema);
        if (document.Accept(valid)) return "nowhere";
        rapidjson::StringBuffer where;
        valid.GetInvalidDocumentPointer().StringifyUriFragment(where);
        return where.GetString();
    };
    ASSERT_EQ(done.records.size(), 2u);
    for (const Json& record : records_of(done)) EXPECT_EQ(invalid_at(record), "nowhere");
    Json bad                               = records_of(done)[0];
    bad["sweep"]["settings"][0]["cost_ms"] = "1";
    EXPECT_EQ(invalid_at(bad), "#/sweep/settings/0/cost_ms");
    bad = records_of(done)[0];
    bad["sweep"]["settings"][0].erase("bounds");
    EXPECT_EQ(invalid_at(bad), "#/sweep/settings/0");

    for (const Json& record : records_of(done)) {
        EXPECT_EQ(record["sweep"]["turns"]["calibration_ms"].size(), 2u);
        for (const Json& s : record["sweep"]["settings"])
            EXPECT_TRUE(s["times"]["build_ms"]["samples"].is_array()) << s["text"];
    }

    // Times are this machine's, and are found again, also those of some of the settings; for a further one all of them
    // take turns again.
    EXPECT_EQ(records_of(sweep(o)), records_of(done));
    const auto turns_of = [](const SweepDone& d) { return records_of(d).at(1).at("sweep").at("turns"); };
    SweepOptions fewer  = o;
    fewer.plan.settings = {"ray_traced:samples=4", "exact"};
    EXPECT_EQ(turns_of(sweep(fewer)), turns_of(done));
    SweepOptions further = o;
    further.plan.settings.emplace_back("shadow_volumes");
    const SweepDone later = sweep(further);
    EXPECT_NE(turns_of(later), turns_of(done));
    EXPECT_EQ(turns_of(sweep(o)), turns_of(later));
    SweepOptions other  = o;
    other.plan.settings = {"ray_traced:samples=4", "ray_traced:samples=8"};
    const Json apart = turns_of(sweep(other)), again = turns_of(sweep(o));
    EXPECT_NE(again, turns_of(later));
    EXPECT_NE(again, apart);
}

TEST(Recommend, TakesTheCheapestWithinTheLimits) {
    const TemporaryFolder folder;
    const CellStore store(folder.path() / "cells");
    SceneLab lab(scene_file("umbra_penumbra"), {.size = {48, 27}}, store);
    RecommendOptions o;
    o.choices    = expand_settings("ray_traced:samples=1|4|16|64|256");
    o.views      = 3;
    o.held_out   = 1;
    o.turns      = {.rounds = 3, .budget_ms = 200};
    o.most_noise = std::numeric_limits<double>::infinity();

    o.limits               = {parse_limit("rmse=0.9")};
    const Recommendation r = recommend(lab, lab, o);
    ASSERT_TRUE(r.chosen.has_value());
    for (const Candidate& c : r.candidates) {
        ASSERT_TRUE(c.cost.has_value());
        if (c.within()) {
            EXPECT_LE(*r.candidates[*r.chosen].cost, *c.cost);
        }
    }
    EXPECT_LT(r.candidates.size(), 5u);
    EXPECT_EQ(r.held_out.size(), 1u);
    const Json json = to_record(recommendation_record(r, o));
    EXPECT_EQ(json["settings"], (Json{{"looked_at", r.candidates.size()}, {"of", 5}}));
    EXPECT_EQ(json["recommendation"]["method"], r.candidates[*r.chosen].choice.text());
    EXPECT_LE(json["recommendation"]["errors"]["rmse"]["bound"].get<double>(), 0.9);
    EXPECT_GE(json["recommendation"]["errors"]["rmse"]["bound"].get<double>(),
              json["recommendation"]["errors"]["rmse"]["largest"].get<double>());
    EXPECT_EQ(json["cheapest"]["method"].is_string(), true);

    // Errors fall with the samples: a tighter limit asks for more of them.
    const auto bound_of = [&](int samples) {
        std::vector<Cell> views;
        const MethodChoice choice = parse_method(fmt::format("ray_traced:samples={}", samples));
        for (int v = 0; v < 3; ++v) views.push_back(lab.cell(choice, v));
        return *upper_bound(find_metric("rmse"), views);
    };
    o.limits                   = {{&find_metric("rmse"), 0.5 * (bound_of(16) + bound_of(64))}};
    const Recommendation tight = recommend(lab, lab, o);
    ASSERT_TRUE(tight.chosen.has_value());
    EXPECT_GE(tight.candidates[*tight.chosen].choice.settings.value("samples"), 64);
    double least = 1;
    for (const Candidate& c : tight.candidates)
        if (c.cost && c.bound(0)) least = std::min(least, *c.bound(0));
    ASSERT_FALSE(tight.staircase.empty());
    EXPECT_EQ(tight.staircase.back().error, least);
    for (std::size_t k = 1; k < tight.staircase.size(); ++k) {
        EXPECT_LT(tight.staircase[k].error, tight.staircase[k - 1].error);
        EXPECT_GE(*tight.candidates[tight.staircase[k].candidate].cost,
                  *tight.candidates[tight.staircase[k - 1].candidate].cost);
    }

    // Nothing sampled is exact.
    o.limits                  = {parse_limit("rmse=0")};
    const Recommendation none = recommend(lab, lab, o);
    EXPECT_FALSE(none.chosen.has_value());
    ASSERT_TRUE(none.nearest.has_value());
    EXPECT_TRUE(to_record(recommendation_record(none, o))["recommendation"].is_null());
    EXPECT_NE(recommendation_text(none, o).find("No setting stays within the limits."), std::string::npos);
}

/// Of what costs far more than a setting within the limits, one run is enough to know: it is not the answer.
TEST(Recommend, PassesOverWhatTheReferenceOutdoes) {
    const TemporaryFolder folder;
    const CellStore store(folder.path() / "cells");
    SceneLab lab(scene_file("sun_on_plane"), {.size = {48, 27}}, store);
    RecommendOptions o;
    o.choices  = {parse_method("ray_traced"), parse_method("shadow_zbuffer:resolution=8192"), parse_method("exact")};
    o.views    = 2;
    o.held_out = 0;
    o.turns    = {.rounds = 1, .budget_ms = 50};
    o.workload = parse_workload("light=1");  // a map is drawn in every frame: 67 million samples for 1296 points
    o.limits   = {parse_limit("interior=0.9")};
    const Recommendation r = recommend(lab, lab, o);
    ASSERT_TRUE(r.chosen.has_value());
    ASSERT_EQ(r.passed_over.size(), 1u);
    EXPECT_EQ(r.passed_over[0].choice.text(), "shadow_zbuffer:resolution=8192");
    EXPECT_EQ(r.candidates[r.passed_over[0].candidate].choice.text(), "exact");
    EXPECT_GT(r.passed_over[0].ratio, 5);
    EXPECT_EQ(r.candidates.size(), 2u);
    EXPECT_FALSE(lab.has_cell(o.choices[1], 0));
    const Json json = to_record(recommendation_record(r, o));
    EXPECT_EQ(json["settings"], (Json{{"looked_at", 2}, {"of", 3}}));
    EXPECT_EQ(json["passed_over"].at(0).at("method"), "shadow_zbuffer:resolution=8192");
    EXPECT_EQ(json["passed_over"].at(0).at("cheaper"), "exact");
    EXPECT_NE(recommendation_text(r, o).find("shadow_zbuffer:resolution=8192  not looked at: one run costs "),
              std::string::npos);
    EXPECT_NE(recommendation_text(r, o).find("2 of 3 settings were looked at, in up to 2 views of 48 x 27 pixels each; "
                                             "others cost more than one within the limits.\n"),
              std::string::npos);

    // The price is paid once.
    const auto price = lab.price(o.choices[1]);
    ASSERT_TRUE(price.has_value());
    EXPECT_EQ(price->all(), lab.price(o.choices[1])->all());

    // Where the reference is over the limit, and where memory is asked for, it says nothing of others.
    o.limits = {parse_limit("memory_mb=1000")};
    EXPECT_TRUE(recommend(lab, lab, o).passed_over.empty());
    o.limits = {parse_limit("rmse=0.9"), parse_limit("memory_mb=0")};
    EXPECT_TRUE(recommend(lab, lab, o).passed_over.empty());
}

TEST(Recommend, LeavesOutWhatLeavesPointsUndefined) {
    const TemporaryFolder folder;
    const CellStore store(folder.path() / "cells");
    SceneLab lab(scene_file("self_shadow"), {.size = {48, 27}}, store);
    RecommendOptions o;
    o.choices = expand_settings("planar_projection");
    o.choices.push_back(parse_method("shadow_volumes"));
    o.views                = 2;
    o.held_out             = 0;
    o.turns                = {.rounds = 1, .budget_ms = 50};
    o.limits               = {parse_limit("interior=0.5")};
    const Recommendation r = recommend(lab, lab, o);
    ASSERT_TRUE(r.chosen.has_value());
    EXPECT_EQ(r.candidates[*r.chosen].choice.text(), "shadow_volumes");
    const auto planar = std::ranges::find_if(
        r.candidates, [](const Candidate& c) { return c.choice.info->name == "planar_projection"; });
    ASSERT_NE(planar, r.candidates.end());
    EXPECT_FALSE(planar->unfit.empty());
}

}  // namespace
}  // namespace umbra
