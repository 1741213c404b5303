// The native scene format: JSON written by hand. scenes/README.md describes every key; this file follows its order.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "umbra/core/base/error.h"
#include "umbra/core/image/image.h"
#include "umbra/core/io/json_text.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

using std::filesystem::path;
using Keys = std::vector<std::string_view>;

constexpr std::size_t kMaxFile = std::size_t{32} << 20;
constexpr int kMaxSegments     = 4096;  ///< along one circle
constexpr int kMaxSteps        = 1024;  ///< along each of two directions: two million triangles at most

constexpr Range kAny{-kMaxCoordinate, kMaxCoordinate, false, "a number from -1e18 to 1e18"};
constexpr Range kPositive{1e-18, kMaxCoordinate, false, "a number above 0, from 1e-18 to 1e18"};
constexpr Range kAtLeastZero{0, kMaxCoordinate, false, "a number of at least 0, up to 1e18"};
constexpr Range kShare{0, 1, false, "a number from 0 to 1"};
constexpr Range kAngle{-1e6, 1e6, false, "an angle in degrees"};
constexpr Range kFieldOfView{0.001, 179.9, false, "an angle in degrees, from 0.001 to 179.9"};
constexpr Range kConeAngle{0.001, 90, false, "an angle in degrees, above 0 and at most 90"};

constexpr std::array<std::string_view, 6> kMeshEndings{".obj", ".ply", ".off", ".stl", ".gltf", ".glb"};

/// One body under construction: what becomes an object of the scene.
struct Part {
    std::string name;
    Mesh mesh;
    std::uint32_t material = 0;
};

class NativeReader {
public:
    explicit NativeReader(const path& file) : folder_(file.parent_path()), text_(read_text(file, kMaxFile)) {}
    SceneFile read();

private:
    // Values.
    vec3 direction(const JsonValue& v, std::string_view what) const;
    vec3 colour(const JsonValue& v, std::string_view what) const;
    vec3 colour(const JsonFields& f, std::string_view key, vec3 fallback) const;
    vec3 towards(const JsonFields& f, vec3 position, std::optional<vec3> fallback) const;

    // Sections.
    void read_camera(const JsonValue& v);
    std::uint32_t read_material(const JsonValue& v, const std::string& name);
    void read_light(const JsonValue& v);
    void read_rectangle(const JsonFields& f, Light& light) const;
    void read_object(const JsonValue& v);

    // Objects.
    std::uint32_t material_of(const JsonFields& f, const std::string& object);
    std::vector<Part> read_mesh_file(const JsonValue& v, const std::string& name, bool own_material);
    Mesh read_triangles(const JsonFields& f) const;
    dmat4 read_transform(const JsonValue& v, const std::vector<Part>& parts) const;
    dmat4 read_step(const JsonMember& step, const dmat4& before, const std::vector<Part>& parts) const;
    dmat4 fit(const JsonValue& v, const dmat4& before, const std::vector<Part>& parts) const;
    dmat4 matrix(const JsonValue& v) const;

    path folder_;
    JsonText text_;
    SceneFile out_;
    std::map<std::string, std::uint32_t> materials_;  ///< by name
    std::optional<std::uint32_t> default_material_;   ///< there once an object asked for it
    std::map<std::string, SceneFile> mesh_files_;     ///< by path as written: a file that is placed twice is read once
};

vec3 NativeReader::direction(const JsonValue& v, std::string_view what) const {
    const vec3 d(text_.vector(v, what, kAny));
    if (d == vec3(0)) text_.fail(v, fmt::format("{} is (0, 0, 0) (a vector with a direction would be right)", what));
    return d;
}

vec3 NativeReader::colour(const JsonValue& v, std::string_view what) const {
    if (std::holds_alternative<double>(v.data)) return vec3(float(text_.number(v, what, kAtLeastZero)));
    if (const auto* s = std::get_if<std::string>(&v.data)) {
        const bool hex =
            s->size() == 7 && (*s)[0] == '#' && s->find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
        if (hex) {
            vec3 c;
            for (int k = 0; k < 3; ++k)
                c[k] = linear_from_srgb(float(std::stoi(s->substr(std::size_t(1 + 2 * k), 2), nullptr, 16)) / 255);
            return c;
        }
    }
    if (!std::holds_alternative<JsonArray>(v.data)) text_.wrong_type(v, what, "a number, [r, g, b] or \"#rrggbb\"");
    return vec3(text_.vector(v, what, kAtLeastZero));
}

vec3 NativeReader::colour(const JsonFields& f, std::string_view key, vec3 fallback) const {
    const JsonValue* v = f.find(key);
    return v ? colour(*v, key) : fallback;
}

/// `direction`, or the one from `position` to `target`.
vec3 NativeReader::towards(const JsonFields& f, vec3 position, std::optional<vec3> fallback) const {
    f.exclude("direction", "target");
    if (const JsonValue* t = f.find("target")) {
        const dvec3 d = text_.vector(*t, "target", kAny) - dvec3(position);
        if (vec3(d) == vec3(0)) text_.fail(*t, "target is the same point as position (another one would be right)");
        return vec3(d);
    }
    if (fallback && !f.find("direction")) return *fallback;
    return direction(f.require("direction"), "direction");
}

void NativeReader::read_camera(const JsonValue& v) {
    const JsonFields f(text_, v, "the camera", {"eye", "target", "up", "fov", "height"});
    Camera& camera = out_.scene.camera;
    camera.eye     = vec3(text_.vector(f.require("eye"), "eye", kAny));
    camera.target  = vec3(text_.vector(f.require("target"), "target", kAny));
    if (camera.eye == camera.target)
        text_.fail(*f.find("target"), "target is the same point as eye (another one would be right)");
    const JsonValue* up = f.find("up");
    if (up) camera.up = direction(*up, "up");
    const dvec3 view = dvec3(camera.target) - dvec3(camera.eye);
    if (glm::length(glm::cross(glm::normalize(view), glm::normalize(dvec3(camera.up)))) < 1e-5)
        text_.fail(up ? *up : v,
                   fmt::format("up ({:g}, {:g}, {:g}) is parallel to the view from eye to target (one across "
                               "it would be right, such as [0, 0, -1] for a view from above)",
                               camera.up.x, camera.up.y, camera.up.z));
    f.exclude("fov", "height");
    camera.fov_y = float(f.number("fov", kFieldOfView, double(camera.fov_y)));
    if (f.find("height")) camera.projection = Projection::orthographic;
    camera.height   = float(f.number("height", kPositive, double(camera.height)));
    out_.has_camera = true;
}

std::uint32_t NativeReader::read_material(const JsonValue& v, const std::string& name) {
    const JsonFields f(text_, v, "a material",
                       {"k_a", "k_d", "k_s", "O_d", "O_s", "emission", "shininess", "lobe", "two_sided", "opacity",
                        "reflect", "transmit", "index_of_refraction"});
    Material m;
    m.name     = name;
    m.k_a      = colour(f, "k_a", m.k_a);
    m.k_d      = colour(f, "k_d", m.k_d);
    m.k_s      = colour(f, "k_s", m.k_s);
    m.O_d      = colour(f, "O_d", m.O_d);
    m.O_s      = colour(f, "O_s", m.O_s);
    m.emission = colour(f, "emission", m.emission);
    if (const JsonValue* lobe = f.find("lobe"))
        m.lobe = text_.choice(*lobe, "lobe", {"phong", "blinn_phong"}) == 0 ? Lobe::phong : Lobe::blinn_phong;
    m.shininess           = float(f.number("shininess", kAtLeastZero, double(m.shininess)));
    m.two_sided           = f.boolean("two_sided", m.two_sided);
    m.opacity             = float(f.number("opacity", kShare, double(m.opacity)));
    m.reflect             = float(f.number("reflect", kShare, double(m.reflect)));
    m.transmit            = float(f.number("transmit", kShare, double(m.transmit)));
    m.index_of_refraction = float(f.number("index_of_refraction", kPositive, double(m.index_of_refraction)));
    out_.scene.materials.push_back(std::move(m));
    return static_cast<std::uint32_t>(out_.scene.materials.size() - 1);
}

/// Two edges, or a size and where it faces.
void NativeReader::read_rectangle(const JsonFields& f, Light& light) const {
    for (const std::string_view other : {"size", "direction", "target", "up"}) f.exclude("edge_u", other);
    if (f.find("edge_u") || f.find("edge_v")) {
        light.edge_u  = direction(f.require("edge_u"), "edge_u");
        light.edge_v  = direction(f.require("edge_v"), "edge_v");
        const dvec3 u = glm::normalize(dvec3(light.edge_u)), v = glm::normalize(dvec3(light.edge_v));
        if (std::abs(glm::dot(u, v)) > 1e-4)
            text_.fail(*f.find("edge_v"), "edge_v is not perpendicular to edge_u (a rectangle's edges are)");
        return;
    }
    const JsonValue& v = f.require("size");
    const auto& size   = text_.array(v, "size", "two numbers [width, height]");
    if (size.size() != 2) text_.wrong_type(v, "size", "two numbers [width, height]");
    const dvec3 axis = glm::normalize(dvec3(towards(f, light.position, vec3(0, -1, 0))));
    dvec3 up{0, 1, 0};
    if (const JsonValue* given = f.find("up")) {
        up = glm::normalize(dvec3(direction(*given, "up")));
        if (glm::length(glm::cross(up, axis)) < 1e-5) text_.fail(*given, "up is parallel to where the light faces");
    } else if (glm::length(glm::cross(up, axis)) < 1e-5) {
        up = {0, 0, 1};
    }
    const dvec3 u = glm::normalize(glm::cross(up, axis));
    light.edge_u  = vec3(text_.number(size[0], "width", kPositive) * u);
    light.edge_v  = vec3(text_.number(size[1], "height", kPositive) * glm::cross(axis, u));
}

void NativeReader::read_light(const JsonValue& v) {
    static constexpr std::array kinds{LightKind::directional, LightKind::point, LightKind::spot,
                                      LightKind::rectangle,   LightKind::disk,  LightKind::sphere};
    Keys known{"type", "name", "colour", "intensity", "diffuse", "specular", "ambient"};
    const auto& members = text_.object(v, "a light");
    const auto type = std::find_if(members.begin(), members.end(), [](const JsonMember& m) { return m.key == "type"; });
    if (type == members.end()) text_.fail(v, "a light has no \"type\" (it needs one)");
    Light light;
    light.kind =
        kinds[text_.choice(type->value, "light type", {"directional", "point", "spot", "rectangle", "disk", "sphere"})];
    const auto add = [&](const Keys& more) { known.insert(known.end(), more.begin(), more.end()); };
    if (light.kind != LightKind::directional) add({"position", "attenuation", "clamp", "range"});
    switch (light.kind) {
        case LightKind::directional: add({"direction"}); break;
        case LightKind::point: break;
        case LightKind::spot: add({"direction", "target", "falloff", "exponent", "cutoff", "inner"}); break;
        case LightKind::rectangle: add({"size", "direction", "target", "up", "edge_u", "edge_v"}); break;
        case LightKind::disk: add({"direction", "target", "radius"}); break;
        case LightKind::sphere: add({"radius"}); break;
    }
    const JsonFields f(text_, v, fmt::format("a {} light", to_string(light.kind)), known);

    light.name            = f.string("name", "");
    const vec3 base       = colour(f, "colour", vec3(1));
    const float intensity = float(f.number("intensity", kAtLeastZero, 1));
    f.exclude("colour", "diffuse");
    light.diffuse  = intensity * colour(f, "diffuse", base);
    light.specular = intensity * colour(f, "specular", base);
    light.ambient  = colour(f, "ambient", vec3(0));

    if (light.kind == LightKind::directional) {
        light.direction = direction(f.require("direction"), "direction");
    } else {
        light.position = vec3(text_.vector(f.require("position"), "position", kAny));
        light.range    = float(f.number("range", kPositive, 0));
        if (const JsonValue* a = f.find("attenuation")) {
            const vec3 c(text_.vector(*a, "attenuation", kAtLeastZero));
            if (c == vec3(0))
                text_.fail(
                    *a,
                    "attenuation is [0, 0, 0], which divides by zero (f = 1 / (c1 + c2 d + c3 d^2): at least one "
                    "of the three above 0 would be right)");
            light.attenuation = {c.x, c.y, c.z, true};
        }
        light.attenuation.clamp = f.boolean("clamp", true);
    }
    if (light.kind == LightKind::spot) {
        light.direction = towards(f, light.position, std::nullopt);
        if (const JsonValue* falloff = f.find("falloff"))
            light.spot.falloff =
                std::array{SpotFalloff::cosine, SpotFalloff::zachmann,
                           SpotFalloff::smooth}[text_.choice(*falloff, "falloff", {"cosine", "zachmann", "smooth"})];
        light.spot.exponent = float(f.number("exponent", kAtLeastZero, double(light.spot.exponent)));
        const double cutoff = f.number("cutoff", kConeAngle, 45);
        const double inner  = f.number("inner", {0, 90, false, "an angle in degrees, from 0 to 90"}, 0);
        if (inner >= cutoff)
            text_.fail(
                *f.find("inner"),
                fmt::format("inner is {:g} degrees, cutoff {:g} (less than cutoff would be right)", inner, cutoff));
        light.spot.cutoff = float(glm::radians(cutoff));
        light.spot.inner  = float(glm::radians(inner));
    }
    if (light.kind == LightKind::rectangle) read_rectangle(f, light);
    if (light.kind == LightKind::disk) light.direction = towards(f, light.position, vec3(0, -1, 0));
    if (light.kind == LightKind::disk || light.kind == LightKind::sphere)
        light.radius = float(text_.number(f.require("radius"), "radius", kPositive));
    if (out_.scene.lights.size() >= kMaxLights) text_.fail(v, fmt::format("more than {} lights", kMaxLights));
    out_.scene.lights.push_back(std::move(light));
}

/// The material that the object names or describes; the default one otherwise.
std::uint32_t NativeReader::material_of(const JsonFields& f, const std::string& object) {
    const JsonValue* v = f.find("material");
    if (v && std::holds_alternative<JsonObject>(v->data)) return read_material(*v, object);
    if (v) {
        const std::string& name = text_.string(*v, "material");
        const auto found        = materials_.find(name);
        if (found != materials_.end()) return found->second;
        Keys known;
        for (const auto& [known_name, index] : materials_) known.push_back(known_name);
        text_.unknown(v->offset, "material", name, known);
    }
    if (!default_material_) {
        default_material_ = static_cast<std::uint32_t>(out_.scene.materials.size());
        out_.scene.materials.push_back({.name = "default"});
    }
    return *default_material_;
}

std::vector<Part> NativeReader::read_mesh_file(const JsonValue& v, const std::string& name, bool own_material) {
    const std::string& written = text_.string(v, "file");
    auto found                 = mesh_files_.find(written);
    if (found == mesh_files_.end()) {
        SceneFile read;
        try {
            read = read_by_ending(folder_ / written, {kMeshEndings.begin(), kMeshEndings.end()});
        } catch (const InputError& e) {
            try {
                text_.fail(v, fmt::format("the mesh cannot be read: {}", e.what()));
            } catch (const InputError& with_place) {
                if (!std::filesystem::exists(folder_ / written)) throw MissingMesh(with_place.what());
                throw;
            }
        }
        if (read.scene.triangles.empty()) text_.fail(v, fmt::format("the mesh \"{}\" has no triangles", written));
        for (const std::string& w : read.scene.warnings)
            out_.scene.warnings.push_back(fmt::format("{}: {}", written, w));
        found = mesh_files_.emplace(written, std::move(read)).first;
    }
    const Scene& scene = found->second.scene;

    const auto first_material = static_cast<std::uint32_t>(out_.scene.materials.size());
    if (!own_material)
        out_.scene.materials.insert(out_.scene.materials.end(), scene.materials.begin(), scene.materials.end());
    std::vector<Part> parts;
    std::vector<std::uint32_t> index(scene.positions.size(), kNoTriangle);  // of a position in its part
    for (const Object& o : scene.objects) {
        Part part{
            scene.objects.size() == 1 ? name : fmt::format("{}/{}", name, o.name), {}, first_material + o.material};
        std::vector<std::uint32_t> used;
        for (std::uint32_t t = o.first_triangle; t < o.first_triangle + o.triangle_count; ++t) {
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t p = scene.triangles[t][k];
                if (index[p] != kNoTriangle) continue;
                index[p] = static_cast<std::uint32_t>(used.size());
                used.push_back(p);
            }
            const uvec3 t3 = scene.triangles[t];
            part.mesh.triangles.emplace_back(index[t3.x], index[t3.y], index[t3.z]);
        }
        for (const std::uint32_t p : used) {
            part.mesh.positions.push_back(scene.positions[p]);
            part.mesh.normals.push_back(scene.normals[p]);
            index[p] = kNoTriangle;
        }
        parts.push_back(std::move(part));
    }
    return parts;
}

Mesh NativeReader::read_triangles(const JsonFields& f) const {
    Mesh mesh;
    for (const JsonValue& v : text_.array(f.require("positions"), "positions", "a list of [x, y, z]"))
        mesh.positions.emplace_back(text_.vector(v, "a position", kAny));
    if (const JsonValue* normals = f.find("normals")) {
        for (const JsonValue& v : text_.array(*normals, "normals", "a list of [x, y, z]"))
            mesh.normals.emplace_back(text_.vector(v, "a normal", kAny));  // zero: the face's own
        if (mesh.normals.size() != mesh.positions.size())
            text_.fail(*normals, fmt::format("{} normals for {} positions (one each would be right)",
                                             mesh.normals.size(), mesh.positions.size()));
    }
    for (const JsonValue& v : text_.array(f.require("triangles"), "triangles", "a list of [a, b, c]")) {
        const auto& corners = text_.array(v, "a triangle", "three indices [a, b, c]");
        if (corners.size() != 3) text_.wrong_type(v, "a triangle", "three indices [a, b, c]");
        uvec3 t;
        for (int k = 0; k < 3; ++k) {
            const JsonValue& corner = corners[std::size_t(k)];
            const double i          = text_.number(corner, "an index", kAny);
            if (i != std::floor(i) || i < 0 || i >= double(mesh.positions.size()))
                text_.fail(corner, fmt::format("a triangle names position {:g} (there are {}, counted from 0)", i,
                                               mesh.positions.size()));
            t[k] = static_cast<std::uint32_t>(i);
        }
        mesh.triangles.push_back(t);
    }
    if (mesh.triangles.empty())
        text_.fail(f.require("triangles"), "the list of triangles is empty (at least one is needed)");
    return mesh;
}

dmat4 NativeReader::matrix(const JsonValue& v) const {
    constexpr std::string_view right = "three or four rows of four numbers";
    const auto& rows                 = text_.array(v, "matrix", right);
    if (rows.size() != 3 && rows.size() != 4) text_.wrong_type(v, "matrix", right);
    dmat4 m(1);
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const auto& row = text_.array(rows[r], "a row of the matrix", "four numbers");
        if (row.size() != 4) text_.wrong_type(rows[r], "a row of the matrix", "four numbers");
        for (std::size_t c = 0; c < 4; ++c) m[int(c)][int(r)] = text_.number(row[c], "an entry", kAny);
    }
    if (dvec4(m[0][3], m[1][3], m[2][3], m[3][3]) != dvec4(0, 0, 0, 1))
        text_.fail(rows[3], "the last row of the matrix is not [0, 0, 0, 1] (it would have to be)");
    if (glm::determinant(dmat3(m)) == 0) text_.fail(v, "the matrix flattens what it transforms: its determinant is 0");
    return m;
}

/// Scales evenly to an extent, then stands the body on the ground, y = 0, with its box's centre over the origin.
dmat4 NativeReader::fit(const JsonValue& v, const dmat4& before, const std::vector<Part>& parts) const {
    dvec3 low(kInfinity), high(-kInfinity);
    for (const Part& part : parts)
        for (const vec3 p : part.mesh.positions) {
            const dvec3 q(before * dvec4(dvec3(p), 1));
            low = glm::min(low, q), high = glm::max(high, q);
        }
    const dvec3 extent = high - low;
    double has         = std::max({extent.x, extent.y, extent.z});
    double wanted      = 0;
    if (std::holds_alternative<JsonObject>(v.data)) {
        const JsonFields f(text_, v, "fit", {"size", "width", "height", "depth"});
        if (text_.object(v, "fit").size() != 1) text_.fail(v, "fit names one of size, width, height, depth");
        for (const auto& [key, along] :
             {std::pair{"size", has}, {"width", extent.x}, {"height", extent.y}, {"depth", extent.z}})
            if (const JsonValue* given = f.find(key)) wanted = text_.number(*given, key, kPositive), has = along;
    } else {
        wanted = text_.number(v, "fit", kPositive);
    }
    if (!(has > 0)) text_.fail(v, "the body has no extent that could be fitted");
    const double s = wanted / has;
    return glm::scale(dmat4(1), dvec3(s)) *
           glm::translate(dmat4(1), -dvec3((low.x + high.x) / 2, low.y, (low.z + high.z) / 2));
}

dmat4 NativeReader::read_step(const JsonMember& step, const dmat4& before, const std::vector<Part>& parts) const {
    const JsonValue& v = step.value;
    if (step.key == "translate") return glm::translate(dmat4(1), text_.vector(v, "translate", kAny));
    if (step.key == "scale") {
        const bool even   = std::holds_alternative<double>(v.data);
        const dvec3 scale = even ? dvec3(text_.number(v, "scale", kAny)) : text_.vector(v, "scale", kAny);
        if (scale.x == 0 || scale.y == 0 || scale.z == 0)
            text_.fail(v, "scale is 0, which flattens (numbers other than 0 would be right)");
        return glm::scale(dmat4(1), scale);
    }
    if (step.key == "rotate_x" || step.key == "rotate_y" || step.key == "rotate_z") {
        dvec3 axis(0);
        axis[step.key.back() - 'x'] = 1;
        return glm::rotate(dmat4(1), glm::radians(text_.number(v, step.key, kAngle)), axis);
    }
    if (step.key == "rotate") {
        const JsonFields f(text_, v, "rotate", {"axis", "angle"});
        const dvec3 axis(direction(f.require("axis"), "axis"));
        return glm::rotate(dmat4(1), glm::radians(text_.number(f.require("angle"), "angle", kAngle)),
                           glm::normalize(axis));
    }
    if (step.key == "matrix") return matrix(v);
    if (step.key == "fit") return fit(v, before, parts);
    text_.unknown(step.offset, "transform", step.key,
                  {"translate", "scale", "rotate_x", "rotate_y", "rotate_z", "rotate", "matrix", "fit"});
}

/// A list of steps, each applied to what the ones before it made.
dmat4 NativeReader::read_transform(const JsonValue& v, const std::vector<Part>& parts) const {
    dmat4 m(1);
    for (const JsonValue& step :
         text_.array(v, "transform", "a list of steps such as [{\"scale\": 2}, {\"rotate_y\": 30}]")) {
        const auto& members = text_.object(step, "a step of the transform");
        if (members.size() != 1)
            text_.fail(step,
                       fmt::format("a step of the transform has {} keys (one each would be right, since their order "
                                   "matters)",
                                   members.size()));
        m = read_step(members[0], m, parts) * m;
    }
    return m;
}

void NativeReader::read_object(const JsonValue& v) {
    static const std::map<std::string_view, Keys> own_keys{{"plane", {"size", "divisions"}},
                                                           {"box", {"size"}},
                                                           {"sphere", {"radius", "longitudes", "latitudes"}},
                                                           {"cylinder", {"radius", "height", "segments"}},
                                                           {"cone", {"radius", "height", "segments"}},
                                                           {"torus", {"major", "minor", "around", "tube"}},
                                                           {"disk", {"radius", "segments"}},
                                                           {"triangles", {"positions", "triangles", "normals"}},
                                                           {"mesh", {"file"}}};
    const auto& members = text_.object(v, "an object");
    const auto type_from =
        std::find_if(members.begin(), members.end(), [](const JsonMember& m) { return m.key == "type"; });
    if (type_from == members.end()) text_.fail(v, "an object has no \"type\" (it needs one)");
    const std::string& type = text_.string(type_from->value, "object type");
    const auto own          = own_keys.find(type);
    if (own == own_keys.end())
        text_.unknown(type_from->value.offset, "object type", type,
                      {"plane", "box", "sphere", "cylinder", "cone", "torus", "disk", "triangles", "mesh"});
    Keys known{"type", "name", "material", "transform", "shading", "crease"};
    known.insert(known.end(), own->second.begin(), own->second.end());
    const JsonFields f(text_, v, fmt::format("a {}", type), known);
    const std::string name = f.string("name", type);

    const auto length = [&](std::string_view key, double fallback) {
        return float(f.number(key, kPositive, fallback));
    };
    const auto segments = [&] { return f.integer("segments", 3, kMaxSegments, 64); };
    std::vector<Part> parts(1);
    if (type == "mesh") {
        parts = read_mesh_file(f.require("file"), name, f.find("material") != nullptr);
    } else if (type == "plane") {
        vec2 size(1);
        if (const JsonValue* s = f.find("size")) {
            if (const auto* list = std::get_if<JsonArray>(&s->data)) {
                if (list->size() != 2) text_.wrong_type(*s, "size", "one number or two, [x, z]");
                size = {float(text_.number((*list)[0], "size", kPositive)),
                        float(text_.number((*list)[1], "size", kPositive))};
            } else {
                size = vec2(float(text_.number(*s, "size", kPositive)));
            }
        }
        parts[0].mesh = make_plane(size.x, size.y, f.integer("divisions", 1, kMaxSteps, 1));
    } else if (type == "box") {
        const JsonValue* s = f.find("size");
        const bool list    = s && std::holds_alternative<JsonArray>(s->data);
        parts[0].mesh      = make_box(list ? vec3(text_.vector(*s, "size", kPositive)) : vec3(length("size", 1)));
    } else if (type == "sphere") {
        parts[0].mesh = make_sphere(length("radius", 1), f.integer("longitudes", 3, kMaxSteps, 64),
                                    f.integer("latitudes", 2, kMaxSteps, 32));
    } else if (type == "cylinder") {
        parts[0].mesh = make_cylinder(length("radius", 1), length("height", 2), segments());
    } else if (type == "cone") {
        parts[0].mesh = make_cone(length("radius", 1), length("height", 2), segments());
    } else if (type == "torus") {
        const float major = length("major", 1), minor = length("minor", 0.25);
        if (minor >= major)
            text_.fail(
                v, fmt::format("a torus of minor radius {:g} and major radius {:g} cuts itself (minor less than major "
                               "would be right)",
                               minor, major));
        parts[0].mesh =
            make_torus(major, minor, f.integer("around", 3, kMaxSteps, 96), f.integer("tube", 3, kMaxSteps, 32));
    } else if (type == "disk") {
        parts[0].mesh = make_disk(length("radius", 1), segments());
    } else {
        parts[0].mesh = read_triangles(f);
    }
    if (type != "mesh") parts[0].name = name;
    if (type != "mesh" || f.find("material")) {
        const std::uint32_t material = material_of(f, name);
        for (Part& part : parts) part.material = material;
    }

    const JsonValue* shading = f.find("shading");
    const auto how           = shading ? text_.choice(*shading, "shading", {"given", "flat", "averaged"}) : 0;
    if (const JsonValue* crease = f.find("crease"); crease && how != 2)
        text_.fail(*crease, "crease is for \"shading\": \"averaged\" only");
    const float crease         = float(f.number("crease", {0, 180, false, "an angle in degrees, from 0 to 180"}, 180));
    const JsonValue* transform = f.find("transform");
    const mat4 m(transform ? read_transform(*transform, parts) : dmat4(1));
    for (Part& part : parts) {
        if (how == 1) part.mesh.normals.clear();
        if (how == 2) part.mesh = with_averaged_normals(part.mesh, crease);
        if (transform) part.mesh = transformed(std::move(part.mesh), m);
        for (const vec3 p : part.mesh.positions)
            if (!(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= float(kMaxCoordinate)))
                text_.fail(transform ? *transform : v,
                           fmt::format("puts a vertex at ({:g}, {:g}, {:g}) (coordinates of "
                                       "magnitude up to 1e18 would be right)",
                                       p.x, p.y, p.z));
        if (out_.scene.triangles.size() + part.mesh.triangles.size() > kMaxTriangles)
            text_.fail(v, fmt::format("more than {} triangles in one scene", kMaxTriangles));
        add_object(out_.scene, part.name, part.mesh.positions, part.mesh.normals, part.mesh.triangles, part.material);
    }
}

SceneFile NativeReader::read() {
    Scene& scene = out_.scene;
    const JsonFields f(text_, text_.root(), "a scene",
                       {"$schema", "title", "shows", "size", "camera", "ambient", "background", "tone", "exposure",
                        "viewer", "materials", "lights", "objects"});
    scene.title = f.string("title", "");
    scene.shows = f.string("shows", "");
    if (const JsonValue* size = f.find("size")) {
        const auto& sides = text_.array(*size, "size", "two whole numbers [width, height]");
        if (sides.size() != 2) text_.wrong_type(*size, "size", "two whole numbers [width, height]");
        scene.width  = text_.integer(sides[0], "width", 1, kMaxPictureSide);
        scene.height = text_.integer(sides[1], "height", 1, kMaxPictureSide);
    }
    if (const JsonValue* camera = f.find("camera")) read_camera(*camera);
    scene.ambient    = colour(f, "ambient", scene.ambient);
    scene.background = colour(f, "background", scene.background);
    if (const JsonValue* tone = f.find("tone"))
        scene.tone = std::array{ToneMap::clamp, ToneMap::divide,
                                ToneMap::hue}[text_.choice(*tone, "tone", {"clamp", "divide", "hue"})];
    scene.exposure = float(f.number("exposure", kPositive, double(scene.exposure)));
    if (const JsonValue* viewer = f.find("viewer"))
        scene.local_viewer = text_.choice(*viewer, "viewer", {"local", "infinite"}) == 0;
    if (const JsonValue* materials = f.find("materials"))
        for (const JsonMember& m : text_.object(*materials, "materials")) {
            if (m.key.empty()) text_.source().fail(m.offset, "a material has an empty name");
            materials_[m.key] = read_material(m.value, m.key);
        }
    if (const JsonValue* lights = f.find("lights")) {
        for (const JsonValue& light : text_.array(*lights, "lights", "a list of lights")) read_light(light);
        out_.may_be_dark = true;  // an empty list says that no light is meant
    }
    if (const JsonValue* objects = f.find("objects"))
        for (const JsonValue& object : text_.array(*objects, "objects", "a list of objects")) read_object(object);
    return std::move(out_);
}

}  // namespace

SceneFile read_native(const path& file) { return NativeReader(file).read(); }

}  // namespace umbra
