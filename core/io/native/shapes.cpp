#include "umbra/core/io/native/shapes.h"

#include <cmath>

#include <fmt/format.h>

#include "umbra/core/io/reading.h"

namespace umbra {
namespace {

float length(const JsonFields& f, std::string_view key, double fallback) {
    return static_cast<float>(f.number(key, kPositive, fallback));
}

int segments(const JsonFields& f) { return f.integer("segments", 3, kMaxSegments, 64); }

Mesh read_plane(const JsonText& json, const JsonFields& f) {
    vec2 size(1);
    if (const JsonValue* s = f.find("size")) {
        if (const auto* list = std::get_if<JsonArray>(&s->data)) {
            if (list->size() != 2) json.wrong_type(*s, "size", "one number or two, [x, z]");
            size = {static_cast<float>(json.number((*list)[0], "size", kPositive)),
                    static_cast<float>(json.number((*list)[1], "size", kPositive))};
        } else {
            size = vec2(static_cast<float>(json.number(*s, "size", kPositive)));
        }
    }
    return make_plane(size.x, size.y, f.integer("divisions", 1, kMaxSteps, 1));
}

Mesh read_box(const JsonText& json, const JsonFields& f) {
    const JsonValue* s = f.find("size");
    const bool list    = s && std::holds_alternative<JsonArray>(s->data);
    return make_box(list ? vec3(json.vector(*s, "size", kPositive)) : vec3(length(f, "size", 1)));
}

Mesh read_sphere(const JsonText&, const JsonFields& f) {
    return make_sphere(length(f, "radius", 1), f.integer("longitudes", 3, kMaxSteps, 64),
                       f.integer("latitudes", 2, kMaxSteps, 32));
}

Mesh read_cylinder(const JsonText&, const JsonFields& f) {
    return make_cylinder(length(f, "radius", 1), length(f, "height", 2), segments(f));
}

Mesh read_cone(const JsonText&, const JsonFields& f) {
    return make_cone(length(f, "radius", 1), length(f, "height", 2), segments(f));
}

Mesh read_torus(const JsonText& json, const JsonFields& f) {
    const float major = length(f, "major", 1), minor = length(f, "minor", 0.25);
    if (minor >= major)
        json.fail(f.value(),
                  fmt::format("a torus of minor radius {:g} and major radius {:g} cuts itself, expected minor "
                              "below major",
                              minor, major));
    return make_torus(major, minor, f.integer("around", 3, kMaxSteps, 96), f.integer("tube", 3, kMaxSteps, 32));
}

Mesh read_disk(const JsonText&, const JsonFields& f) { return make_disk(length(f, "radius", 1), segments(f)); }

uvec3 read_triangle(const JsonText& json, const JsonValue& v, std::size_t positions) {
    constexpr std::string_view expected = "three indices [a, b, c]";
    const auto& corners                 = json.array(v, "a triangle", expected);
    if (corners.size() != 3) json.wrong_type(v, "a triangle", expected);
    uvec3 t;
    for (int k = 0; k < 3; ++k) {
        const JsonValue& corner = corners[static_cast<std::size_t>(k)];
        const double i          = json.number(corner, "an index", kAnyNumber);
        if (i != std::floor(i) || i < 0 || i >= static_cast<double>(positions))
            json.fail(corner,
                      fmt::format("a triangle names position {:g} (there are {}, counted from 0)", i, positions));
        t[k] = static_cast<std::uint32_t>(i);
    }
    return t;
}

/// A body that is made around (0, 0, 0).
template <Mesh (*make)(const JsonText&, const JsonFields&)>
Mesh at_origin(const JsonText& json, const JsonFields& f, dvec3& origin) {
    origin = dvec3(0);
    return make(json, f);
}

/// The origin of a mesh by itself: before its transform, a mesh may be far from the scene.
dvec3 origin_of(const std::vector<dvec3>& positions) {
    if (positions.empty()) return dvec3(0);
    dvec3 low = positions.front(), high = low;
    for (const dvec3& p : positions) low = glm::min(low, p), high = glm::max(high, p);
    return local_origin(low, high);
}

Mesh read_triangles(const JsonText& json, const JsonFields& f, dvec3& origin) {
    Mesh mesh;
    std::vector<dvec3> positions;
    for (const JsonValue& v : json.array(f.require("positions"), "positions", "a list of [x, y, z]"))
        positions.push_back(json.vector(v, "a position", kAnyNumber));
    if (f.find("transform") != nullptr) origin = origin_of(positions);
    for (const dvec3& p : positions) mesh.positions.emplace_back(p - origin);
    if (const JsonValue* normals = f.find("normals")) {
        for (const JsonValue& v : json.array(*normals, "normals", "a list of [x, y, z]"))
            mesh.normals.emplace_back(json.vector(v, "a normal", kAnyNumber));  // zero: the face's own
        if (mesh.normals.size() != mesh.positions.size())
            json.fail(*normals, fmt::format("{} normals for {} positions, expected one each", mesh.normals.size(),
                                            mesh.positions.size()));
    }
    for (const JsonValue& v : json.array(f.require("triangles"), "triangles", "a list of [a, b, c]"))
        mesh.triangles.push_back(read_triangle(json, v, mesh.positions.size()));
    if (mesh.triangles.empty())
        json.fail(f.require("triangles"), "the list of triangles is empty, expected at least one");
    return mesh;
}

}  // namespace

const std::vector<Shape>& shapes() {
    static const std::vector<Shape> all{{"plane", {"size", "divisions"}, at_origin<read_plane>},
                                        {"box", {"size"}, at_origin<read_box>},
                                        {"sphere", {"radius", "longitudes", "latitudes"}, at_origin<read_sphere>},
                                        {"cylinder", {"radius", "height", "segments"}, at_origin<read_cylinder>},
                                        {"cone", {"radius", "height", "segments"}, at_origin<read_cone>},
                                        {"torus", {"major", "minor", "around", "tube"}, at_origin<read_torus>},
                                        {"disk", {"radius", "segments"}, at_origin<read_disk>},
                                        {"triangles", {"positions", "triangles", "normals"}, read_triangles}};
    return all;
}

}  // namespace umbra
