// NFF, the Neutral File Format of the Standard Procedural Databases, version 3.1: view, lights, fills, polygons,
// patches, spheres, cones and cylinders. Read token by token, not by lines, as its own programs write it.
//
// Eric Haines. A Proposal for Standard Graphics Environments. 1987
//
//   NFF                   here
//   f r g b Kd Ks n T i   O_d = rgb, k_d = k_a = Kd, k_s = reflect = Ks, O_s = 1, shininess n, transmit T,
//                         index_of_refraction i; lit from behind only where T > 0. Shadow rays end at every surface
//   l x y z               a point light without attenuation. The format leaves intensity open: 1 / sqrt(lights) each
//   (no ambient light)    I_a = 0.1
//   s, c                  triangles with exact normals. Vertices lie on the surface. Their number around the axis is 8
//                         to 96, as many as keep the chord within an eighth of a pixel of the file's own view; twice
//                         that where the surface mirrors or is clear, since neighbours see it from nearby
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/file_normals.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/io/polygon.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/io/tokens.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

constexpr int kFewest = 8, kMost = 96;

// How wide a pixel is, seen from the eye: tessellation aims at edges of this length.
struct View {
    dvec3 eye{0};
    double pixel = 0;  ///< width of a pixel at distance 1; 0: no view in the file
};

// The sagitta of a chord, r (1 - cos(pi / n)), is about r/2 (pi / n)^2. A multiple of 4, so that a sphere has
// an equator.
int segments_around(const View& view, dvec3 centre, double reach, double radius, bool from_nearby) {
    const double finer = from_nearby ? 2 : 1;
    if (view.pixel == 0) return static_cast<int>(32 * finer);
    const double distance = std::max(glm::length(centre - view.eye) - reach, 1e-3 * reach);
    const double r_pixels = radius / (distance * view.pixel);
    const double n        = kPi * std::sqrt(r_pixels / (2 * 0.125));
    return 4 * int(std::ceil(finer * std::clamp(n, double(kFewest), double(kMost)) / 4));
}

struct Reader {
    const SourceText& source;
    const Reading& reading;
    Tokens tokens;
    SceneFile read;
    View view;
    std::vector<Mesh> meshes;  // one a material
    std::map<std::array<float, 8>, std::uint32_t> fills;
    std::uint32_t material    = 0xffffffffu;
    std::uint64_t triangles   = 0;
    std::size_t self_crossing = 0;  // polygons
    FileNormals normals;
    bool any_light_has_colour = false;

    Reader(const SourceText& text, const Reading& how) : source(text), reading(how), tokens(text) {}
    Scene& scene() { return read.scene; }
    vec3 position(std::string_view what) { return reading.position(tokens.point(what)); }

    void expect(std::string_view name) {
        const Token token = tokens.next();
        if (token.text != name)
            tokens.fail(token, fmt::format("found {}, expected {}",
                                           token ? in_quotes(token.text) : "the end of the file", in_quotes(name)));
    }

    void read_view() {
        Camera& camera = scene().camera;
        expect("from");
        camera.eye = position("a coordinate of the eye");
        expect("at");
        camera.target = position("a coordinate of the target");
        expect("up");
        camera.up = vec3(tokens.point("a component of up"));
        expect("angle");
        const std::size_t at_angle = tokens.offset();
        camera.fov_y               = tokens.real("the angle of view");
        if (!kFieldOfView.holds(camera.fov_y))
            source.fail(at_angle,
                        fmt::format("the angle of view is {:g}, expected {}", camera.fov_y, kFieldOfView.words));
        expect("hither");
        (void)tokens.real("the hither distance");
        expect("resolution");
        const auto side = [&](std::string_view what) {
            const Token token = tokens.next();
            const auto n      = tokens.as_integer(token, what);
            if (n < 1 || n > kMaxPictureSide)
                tokens.fail(token, fmt::format("{} is {}, expected 1 to {}", what, n, kMaxPictureSide));
            return int(n);
        };
        scene().width   = side("the resolution in x");
        scene().height  = side("the resolution in y");
        read.has_camera = true;
        view.eye        = dvec3(camera.eye);
        view.pixel      = 2 * std::tan(glm::radians(double(camera.fov_y)) / 2) / scene().height;
    }

    void read_light() {
        Light light;
        light.kind     = LightKind::point;
        light.name     = fmt::format("light_{}", scene().lights.size() + 1);
        light.position = position("a coordinate of the light");
        if (const Token red = tokens.next_on_line()) {
            light.diffuse.r      = tokens.as_real(red, "the light's red");
            light.diffuse.g      = tokens.real_on_line("the light's green");
            light.diffuse.b      = tokens.real_on_line("the light's blue");
            light.specular       = light.diffuse;
            any_light_has_colour = true;
        }
        scene().lights.push_back(light);
    }

    void read_fill(Token entity) {
        std::array<float, 8> f;
        constexpr std::array kNames = {"red", "green", "blue", "Kd", "Ks", "Shine", "T", "the index of refraction"};
        for (std::size_t i = 0; i < f.size(); ++i) {
            f[i] = tokens.real(kNames[i]);
            if (f[i] < 0) tokens.fail(entity, fmt::format("{} of this fill is negative", kNames[i]));
        }
        const auto [it, added] = fills.try_emplace(f, std::uint32_t(scene().materials.size()));
        material               = it->second;
        if (!added) return;
        Material m;
        m.name                = fmt::format("fill_{}", scene().materials.size() + 1);
        m.O_d                 = {f[0], f[1], f[2]};
        m.k_d                 = vec3(f[3]);
        m.k_a                 = m.k_d;
        m.k_s                 = vec3(f[4]);
        m.shininess           = f[5];
        m.transmit            = f[6];
        m.reflect             = std::min(f[4], 1.0f);
        m.index_of_refraction = f[7] > 0 ? f[7] : 1;
        m.two_sided           = f[6] > 0;
        if (m.transmit > 1) tokens.fail(entity, "T of this fill is above 1, expected 0 to 1");
        scene().materials.push_back(m);
        meshes.emplace_back();
    }

    Mesh& mesh() {
        if (material == 0xffffffffu) {
            scene().warnings.push_back(fmt::format("{}: surfaces before any fill \"f\" are grey.", source.file));
            material = std::uint32_t(scene().materials.size());
            Material m;
            m.name      = "default";
            m.k_a       = m.k_d;
            m.two_sided = false;
            scene().materials.push_back(m);
            meshes.emplace_back();
        }
        return meshes[material];
    }

    void append(const Mesh& part) {
        Mesh& all       = mesh();
        const auto base = std::uint32_t(all.positions.size());
        all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
        all.normals.insert(all.normals.end(), part.normals.begin(), part.normals.end());
        for (const uvec3& t : part.triangles) all.triangles.push_back(t + uvec3(base));
        triangles += part.triangles.size();
    }

    void read_polygon(Token entity, bool patch) {
        const Token count = tokens.next();
        const auto n      = tokens.as_integer(count, "the number of corners");
        if (n < 3) tokens.fail(count, fmt::format("a polygon of {} corners, expected at least 3", n));
        Mesh part;
        std::vector<std::uint32_t> polygon;
        for (std::int64_t i = 0; i < n; ++i) {
            if (tokens.at_end())
                tokens.fail(entity, fmt::format("the file ends after {} of this polygon's {} corners", i, n));
            part.positions.push_back(position("a corner's coordinate"));
            part.normals.push_back(patch ? normals.usable(tokens.normal()) : vec3(0));
            polygon.push_back(std::uint32_t(i));
        }
        if (!triangulate(part.positions, polygon, part.triangles)) ++self_crossing;
        append(part);
    }

    /// By other surfaces: mirrors are mostly among mirrors.
    bool is_seen_from_nearby() {
        if (material >= scene().materials.size()) return false;
        const Material& m = scene().materials[material];
        return m.reflect > 0 || m.transmit > 0;
    }

    void read_sphere(Token entity) {
        const vec3 centre  = position("a coordinate of the centre");
        const float radius = tokens.real("the radius");
        if (radius == 0) tokens.fail(entity, "a sphere of radius 0");
        const float size = std::abs(radius);
        const int around = segments_around(view, dvec3(centre), size, size, is_seen_from_nearby());
        Mesh part        = make_sphere(size, around, around / 2);
        for (vec3& p : part.positions) p += centre;
        if (radius < 0) turn_inside_out(part);
        append(part);
    }

    // A negative radius: seen from inside only.
    static void turn_inside_out(Mesh& mesh) {
        for (vec3& n : mesh.normals) n = -n;
        for (uvec3& t : mesh.triangles) std::swap(t.y, t.z);
    }

    void read_cone(Token entity) {
        const dvec3 base_read = tokens.point("a coordinate of the base");
        const double r_base   = tokens.real("the base radius");
        const dvec3 apex_read = tokens.point("a coordinate of the apex");
        const double r_apex   = tokens.real("the apex radius");
        if (r_base * r_apex < 0)
            tokens.fail(entity, "one radius of this cone is negative, one is not (both have one sign, or one is 0)");
        if (r_base == 0 && r_apex == 0) tokens.fail(entity, "both radii of this cone are 0");
        if (base_read == apex_read && r_base == r_apex) tokens.fail(entity, "base and apex of this cone are the same");
        const dvec3 base(reading.position(base_read)), apex(reading.position(apex_read));
        const double height = glm::length(apex - base);

        // Across the axis: any two unit vectors, right-handed with it. Coincident ends are a ring, facing +z.
        const dvec3 axis  = height > 0 ? (apex - base) / height : dvec3(0, 0, 1);
        const dvec3 other = std::abs(axis.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
        const dvec3 u     = glm::normalize(glm::cross(other, axis));
        const dvec3 v     = glm::cross(axis, u);
        const double a = std::abs(r_base), b = std::abs(r_apex), widest = std::max(a, b);
        const int n = segments_around(view, (base + apex) / 2.0, widest + height / 2, widest, is_seen_from_nearby());

        // The normal leans along the axis by the slope (a - b) / height. An end of radius 0 keeps one point a segment,
        // with the normal of the segment's middle, and no triangle there is degenerate.
        Mesh part;
        const auto add = [&](dvec3 end, double radius, double angle) {
            const dvec3 out = std::cos(angle) * u + std::sin(angle) * v;
            part.positions.emplace_back(end + radius * out);
            part.normals.emplace_back(glm::normalize(height * out + (a - b) * axis));
            return std::uint32_t(part.positions.size() - 1);
        };
        const auto row = [&](dvec3 end, double radius) {
            std::vector<std::uint32_t> ids;
            for (int i = 0; i < n; ++i) ids.push_back(add(end, radius, 2 * kPi * (i + (radius == 0 ? 0.5 : 0)) / n));
            return ids;
        };
        const auto low = row(base, a), high = row(apex, b);
        for (std::size_t i = 0; i < low.size(); ++i) {
            const std::size_t j = (i + 1) % low.size();
            if (a > 0) part.triangles.emplace_back(low[i], low[j], b > 0 ? high[j] : high[i]);
            if (b > 0) part.triangles.emplace_back(low[i], high[j], high[i]);
        }
        if (r_base < 0 || r_apex < 0) turn_inside_out(part);
        append(part);
    }

    void read_entities() {
        while (const Token entity = tokens.next()) {
            const std::string_view e = entity.text;
            if (e == "v")
                read_view();
            else if (e == "b")
                scene().background = vec3(tokens.point("a channel of the background"));
            else if (e == "l")
                read_light();
            else if (e == "f")
                read_fill(entity);
            else if (e == "p" || e == "pp")
                read_polygon(entity, e == "pp");
            else if (e == "s")
                read_sphere(entity);
            else if (e == "c")
                read_cone(entity);
            else
                tokens.fail(entity, fmt::format("unknown entity {} (known: v b l f p pp s c)", in_quotes(e)));
            if (triangles > kMaxTessellated)
                tokens.fail(entity, fmt::format("more than {} triangles with this one", kMaxTessellated));
        }
    }
};

}  // namespace

SceneFile read_nff(const std::filesystem::path& file, const Reading& reading) {
    const SourceText source = read_text(file);
    Reader reader(source, reading);
    reader.read_entities();
    Scene& scene = reader.scene();
    if (reader.triangles == 0)
        throw InputError(fmt::format("{}: holds no surfaces, expected \"p\", \"pp\", \"s\" or \"c\"", source.file));

    for (std::size_t m = 0; m < reader.meshes.size(); ++m) {
        const Mesh& mesh = reader.meshes[m];
        if (!mesh.triangles.empty())
            add_object(scene, scene.materials[m].name, mesh.positions, mesh.normals, mesh.triangles, std::uint32_t(m));
    }
    if (!reader.any_light_has_colour)
        for (Light& light : scene.lights)
            light.diffuse = light.specular = vec3(1 / std::sqrt(float(scene.lights.size())));
    scene.ambient     = vec3(0.1f);
    scene.transparent = TransparentOccluders::block;
    scene.warnings.push_back("NFF has no ambient light: I_a = 0.1 is assumed.");
    reader.normals.warn(scene.warnings);
    if (reader.self_crossing > 0)
        scene.warnings.push_back(
            fmt::format("{} polygons cross themselves: they were triangulated as fans.", reader.self_crossing));
    return std::move(reader.read);
}

}  // namespace umbra
