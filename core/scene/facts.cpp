#include "umbra/core/scene/facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "umbra/core/base/disjoint_sets.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/parallel_sort.h"
#include "umbra/core/scene/topology.h"
#include "umbra/core/scene/view_facts.h"
#include "umbra/core/scene/winding.h"

namespace umbra {
namespace {

void count_edges(const Topology& topology, ObjectFacts& facts) {
    for (const Edge& e : topology.edges) {
        if (e.count == 1) ++facts.boundary_edges;
        if (e.count > 2) ++facts.nonmanifold_edges;
        if (e.count == 2 && topology.uses[e.first].forward == topology.uses[e.first + 1].forward)
            ++facts.misoriented_edges;
    }
}

/// Two triangles at a vertex belong to one fan where they share an edge that ends there. Corners are numbered
/// 3 * triangle + corner.
std::uint32_t count_nonmanifold_vertices(const Topology& topology) {
    DisjointSets fans(3 * topology.triangles.size());
    for (const Edge& e : topology.edges) {
        // The use's triangle has edge end a at corner `side` where it runs forward, else at the next one.
        const auto corner = [&](const EdgeUse& use, bool at_a) {
            return 3 * use.triangle + (use.forward == at_a ? use.side : (use.side + 1u) % 3);
        };
        for (std::uint32_t u = e.first + 1; u < e.first + e.count; ++u) {
            fans.unite(corner(topology.uses[e.first], true), corner(topology.uses[u], true));
            fans.unite(corner(topology.uses[e.first], false), corner(topology.uses[u], false));
        }
    }
    std::vector<std::uint8_t> count(topology.position.size(), 0);  // fans; 2 means more than one
    for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
        if (topology.repeats_a_corner(t)) continue;
        for (std::uint32_t k = 0; k < 3; ++k)
            if (fans.root(3 * t + k) == 3 * t + k) {
                std::uint8_t& n = count[topology.triangles[t][static_cast<int>(k)]];
                n               = std::min<std::uint8_t>(2, n + 1);
            }
    }
    return static_cast<std::uint32_t>(std::count(count.begin(), count.end(), 2));
}

std::uint32_t count_duplicates(const Topology& topology) {
    std::vector<std::array<std::uint32_t, 3>> corners(topology.triangles.size());
    for (std::size_t t = 0; t < corners.size(); ++t) {
        const uvec3 v = topology.triangles[t];
        corners[t]    = {v.x, v.y, v.z};
        std::sort(corners[t].begin(), corners[t].end());
    }
    parallel_sort(corners.begin(), corners.end());
    const auto distinct = std::unique(corners.begin(), corners.end()) - corners.begin();
    return static_cast<std::uint32_t>(topology.triangles.size() - static_cast<std::size_t>(distinct));
}

/// Parts of the object that hang together over welded vertices.
DisjointSets connected_parts(const Topology& topology) {
    DisjointSets parts(topology.position.size());
    for (const uvec3 t : topology.triangles) {
        parts.unite(t.x, t.y);
        parts.unite(t.x, t.z);
    }
    return parts;
}

std::uint32_t count_roots(DisjointSets& parts, std::size_t vertices) {
    std::uint32_t n = 0;
    for (std::uint32_t v = 0; v < vertices; ++v) n += parts.root(v) == v;
    return n;
}

/// Whether each part of a manifold object has a volume that is certainly positive, by the divergence theorem. The parts
/// may cross themselves and one another; CGAL's is_outward_oriented and does_bound_a_volume require that none does.
bool bounds_solids(const Scene& scene, const Topology& topology, DisjointSets& parts) {
    std::vector<double> volume(topology.position.size(), 0), uncertainty(volume);
    for (const uvec3 t : topology.triangles) {
        const std::uint32_t part = parts.root(t[0]);
        const dvec3 base(scene.positions[topology.position[part]]);
        const auto corner = [&](int k) { return dvec3(scene.positions[topology.position[t[k]]]) - base; };
        const dvec3 a = corner(0), b = corner(1), c = corner(2);
        volume[part] += glm::dot(a, glm::cross(b, c));
        uncertainty[part] += 0x1p-30 * glm::length(a) * glm::length(b) * glm::length(c);  // far above rounding
    }
    for (std::uint32_t v = 0; v < volume.size(); ++v)
        if (parts.root(v) == v && !(volume[v] > uncertainty[v])) return false;
    return true;
}

ObjectFacts object_facts(const Scene& scene, const Object& object) {
    const Topology topology = find_topology(scene, object.first_triangle, object.triangle_count);
    ObjectFacts f;
    f.name      = object.name;
    f.triangles = object.triangle_count;
    f.switches  = object.switches;
    f.vertices  = static_cast<std::uint32_t>(topology.position.size());
    for (const std::uint32_t p : topology.position) f.box = extend(f.box, scene.positions[p]);

    count_edges(topology, f);
    f.nonmanifold_vertices = count_nonmanifold_vertices(topology);
    f.degenerate_triangles =
        static_cast<std::uint32_t>(std::count(topology.degenerate.begin(), topology.degenerate.end(), 1));
    f.duplicate_triangles = count_duplicates(topology);
    DisjointSets parts    = connected_parts(topology);
    f.components          = count_roots(parts, topology.position.size());
    const bool whole      = topology.uses.size() == 3 * topology.triangles.size();  // no corner is repeated
    f.manifold = f.triangles > 0 && whole && f.boundary_edges + f.nonmanifold_edges + f.misoriented_edges == 0 &&
                 f.nonmanifold_vertices == 0;
    f.closed = f.manifold && f.degenerate_triangles + f.duplicate_triangles == 0;

    // A closed body's volume does not depend on the origin; its own centre keeps the terms small.
    const dvec3 origin = f.closed ? dvec3(f.box.centre()) : dvec3(0);
    for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) {
        const dvec3 n = area_normal(scene, t);
        f.area += glm::length(n) / 2;
        f.volume += glm::dot(n, dvec3(scene.vertex(t, 0)) - origin) / 6;
    }
    f.outward = f.closed && f.volume > 0;
    f.solid   = f.manifold && bounds_solids(scene, topology, parts);
    f.planar  = common_plane(scene, object.first_triangle, object.triangle_count).has_value();
    return f;
}

bool holds(const Box& box, vec3 p) {
    return glm::all(glm::greaterThanEqual(p, box.min)) && glm::all(glm::lessThanEqual(p, box.max));
}

/// The position of an area light is its centre. The eye of an orthographic view is at infinity, as is a directional
/// light that shines along the view.
LightPlace place_of(const Light& light, const Scene& scene) {
    const CameraFrame view  = frame(scene.camera, std::max(1, scene.width), std::max(1, scene.height));
    const bool orthographic = view.projection == Projection::orthographic;
    if (light.kind == LightKind::directional) {
        const dvec3 d = glm::normalize(dvec3(light.direction));
        return orthographic && glm::length(d - view.forward) < 1e-6 ? LightPlace::at_eye : LightPlace::at_infinity;
    }
    // The rounding of a position that was computed, not typed.
    const double near_enough = 1e-6 * std::max<double>(glm::length(view.eye), bounds(scene).diagonal());
    if (!orthographic && glm::distance(dvec3(light.position), view.eye) <= near_enough) return LightPlace::at_eye;
    const dvec3 pixel = view.project(dvec3(light.position));
    const bool seen   = pixel.z > 0 && pixel.x >= 0 && pixel.x <= view.width && pixel.y >= 0 && pixel.y <= view.height;
    return seen ? LightPlace::inside_view : LightPlace::outside_view;
}

bool any(vec3 v) { return v != vec3(0); }

/// Only terms that something in the scene uses: materials of objects with triangles.
void find_terms(const Scene& scene, SceneFacts& facts) {
    const bool ambient_light = any(scene.ambient) || std::any_of(scene.lights.begin(), scene.lights.end(),
                                                                 [](const Light& light) { return any(light.ambient); });
    const bool specular_light =
        std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) { return any(light.specular); });
    facts.has_fog        = scene.fog.law != FogLaw::none;
    const auto k_ambient = [&](const Material& m) {
        return scene.ambient_coefficient == AmbientCoefficient::k_d ? m.k_d : m.k_a;
    };
    const auto O_specular = [&](const Material& m) {
        return scene.specular_colour == SpecularColour::O_d ? m.O_d : m.O_s;
    };
    for (const Object& object : scene.objects) {
        if (object.triangle_count == 0) continue;
        const Material& m = scene.materials[object.material];
        facts.has_ambient |= ambient_light && any(k_ambient(m) * m.O_d);
        facts.has_specular |= specular_light && any(m.k_s * O_specular(m));
        facts.has_lobes |= specular_light && !m.lobes.empty();
        facts.has_emission |= any(m.emission);
        facts.has_transparency |= transmittance(m) > 0;
        facts.has_filters |= scene.transparent == TransparentOccluders::multiply && transmittance(m) > 0 &&
                             object.switches.casts_shadows;
        facts.has_mirrors |= m.reflect > 0;
        facts.has_one_sided |= !m.two_sided;
        facts.has_cutouts |= m.cutout;
    }
    facts.has_coloured_filters = has_coloured_filters(scene);
    for (const Light& light : scene.lights) {
        const Attenuation& a = light.attenuation;
        const bool constant  = a.c1 == 1 && a.c2 == 0 && a.c3 == 0;
        facts.has_goniometric |= light.photometry != nullptr;
        facts.has_fixed_light |= light.camera_pose.has_value();
        facts.has_exceptions |= !light.except.empty();
        facts.has_attenuated_ambient |= scene.light_ambient == LightAmbient::attenuated && any(light.ambient);
        facts.has_attenuation |= light.kind != LightKind::directional && (!constant || light.range > 0);
    }
}

/// "3 point lights", "1 point light", or nothing.
std::string counted(std::size_t n, std::string_view what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

std::size_t count_lights(const SceneFacts& facts, LightKind kind) {
    return static_cast<std::size_t>(std::count_if(facts.lights.begin(), facts.lights.end(),
                                                  [&](const LightFacts& light) { return light.kind == kind; }));
}

std::size_t count_places(const SceneFacts& facts, LightPlace place) {
    return static_cast<std::size_t>(std::count_if(facts.lights.begin(), facts.lights.end(),
                                                  [&](const LightFacts& light) { return light.place == place; }));
}

constexpr std::array kLightKinds = {LightKind::directional, LightKind::point, LightKind::spot,
                                    LightKind::rectangle,   LightKind::disk,  LightKind::sphere};

/// A term of the sum, or another trait that a scene either has or does without.
struct Trait {
    bool present;
    std::string_view what;
};

std::vector<Trait> traits(const SceneFacts& facts) {
    return {
        {facts.has_ambient, "ambient term"},
        {facts.has_specular, "specular term"},
        {facts.has_emission, "emission"},
        {facts.has_attenuation, "attenuation with distance"},
        {facts.has_one_sided, "one-sided lighting"},
        {facts.has_goniometric, "goniometric lights"},
        {facts.has_fixed_light, "lights fixed to the camera"},
        {facts.has_exceptions, "lights that leave out objects"},
        {facts.has_attenuated_ambient, "attenuated ambient terms of lights"},
        {facts.has_lobes, "Lafortune lobes"},
        {facts.has_fog, "fog"},
        {facts.has_transparency, "transparency"},
        {facts.has_filters, "shadows of what lets a part of the light through"},
        {facts.has_cutouts, "outlines cut by a texture"},
        {facts.has_mirrors, "mirrors"},
        {!facts.hard_lights_only, "penumbra (area light)"},
        {facts.open_objects + facts.nonmanifold_objects + facts.misoriented_objects > 0,
         "shadow volumes of open, non-manifold or inconsistently oriented meshes"},
        {count_places(facts, LightPlace::inside_view) > 0, "shadows in all directions around a light inside the view"},
        {facts.eye_inside_closed_object, "eye inside a closed object"},
        {facts.degenerate_triangles + facts.duplicate_triangles > 0, "degenerate or duplicate triangles"},
    };
}

}  // namespace

std::string_view to_string(LightPlace place) {
    switch (place) {
        case LightPlace::at_infinity: return "at infinity";
        case LightPlace::outside_view: return "outside the view";
        case LightPlace::inside_view: return "inside the view";
        case LightPlace::at_eye: return "at the eye";
    }
    return "";
}

std::vector<ObjectFacts> find_object_facts(const Scene& scene) {
    std::vector<ObjectFacts> facts(scene.objects.size());
    parallel_ranges(facts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) facts[i] = object_facts(scene, scene.objects[i]);
    });
    return facts;
}

void update_view_facts(const Scene& scene, SceneFacts& facts) {
    const dvec3 eye(scene.camera.eye);
    facts.eye_inside_closed_object = false;
    for (std::size_t i = 0; i < scene.objects.size() && !facts.eye_inside_closed_object; ++i) {
        const ObjectFacts& f = facts.objects[i];
        facts.eye_inside_closed_object =
            f.closed && holds(f.box, scene.camera.eye) && std::abs(winding_number(scene, scene.objects[i], eye)) > 0.5;
    }
    for (std::size_t j = 0; j < scene.lights.size(); ++j) facts.lights[j].place = place_of(scene.lights[j], scene);
}

SceneFacts find_facts(const Scene& scene) {
    SceneFacts facts;
    facts.triangles = scene.triangles.size();
    facts.box       = bounds(scene);

    facts.objects = find_object_facts(scene);
    double area   = 0;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const ObjectFacts& f = facts.objects[i];
        area += f.area;
        facts.closed_objects += f.closed;
        facts.open_objects += f.boundary_edges > 0;
        facts.nonmanifold_objects += f.nonmanifold_edges + f.nonmanifold_vertices > 0;
        facts.misoriented_objects += f.misoriented_edges > 0;
        facts.degenerate_triangles += f.degenerate_triangles;
        facts.duplicate_triangles += f.duplicate_triangles;
    }

    facts.planes       = find_planes(scene, kPlanarShare);
    double planar_area = 0;
    for (const PlanarReceiver& p : facts.planes) planar_area += p.area;
    facts.planar_area_share = area > 0 ? std::min(1.0, planar_area / area) : 0;

    for (const Light& light : scene.lights) {
        facts.lights.push_back({light.name, light.kind, {}});
        facts.hard_lights_only = facts.hard_lights_only && !is_area(light.kind);
    }
    update_view_facts(scene, facts);
    find_terms(scene, facts);
    facts.uncomputed = find_uncomputed(scene);
    return facts;
}

std::vector<std::string> requires_list(const SceneFacts& facts) {
    std::vector<std::string> list;
    for (const LightKind kind : kLightKinds) {
        if (const std::size_t n = count_lights(facts, kind); n > 0)
            list.push_back(counted(n, fmt::format("{} light", to_string(kind))));
    }
    for (const LightFacts& light : facts.lights)
        list.push_back(fmt::format("light {} {}", light.name, to_string(light.place)));
    if (!facts.planes.empty())
        list.push_back(fmt::format("{} with {:.3g} % of the area", counted(facts.planes.size(), "planar receiver"),
                                   100 * facts.planar_area_share));
    if (facts.planar_area_share < 1 - 1e-9)
        list.push_back(
            fmt::format("non-planar receivers with {:.3g} % of the area", 100 * (1 - facts.planar_area_share)));
    if (facts.closed_objects > 0) list.push_back(counted(facts.closed_objects, "closed occluder"));
    if (facts.open_objects > 0) list.push_back(counted(facts.open_objects, "open occluder"));
    if (facts.nonmanifold_objects > 0) list.push_back(counted(facts.nonmanifold_objects, "non-manifold occluder"));
    if (facts.misoriented_objects > 0)
        list.push_back(counted(facts.misoriented_objects, "inconsistently oriented occluder"));
    for (const Trait& trait : traits(facts))
        if (trait.present) list.emplace_back(trait.what);
    return list;
}

std::vector<std::string> not_required_list(const SceneFacts& facts) {
    std::vector<std::string> list;
    for (const LightKind kind : kLightKinds)
        if (count_lights(facts, kind) == 0) list.push_back(fmt::format("{} lights", to_string(kind)));
    if (facts.planes.empty()) list.emplace_back("planar receivers");
    for (const Trait& trait : traits(facts))
        if (!trait.present) list.emplace_back(trait.what);
    return list;
}

}  // namespace umbra
