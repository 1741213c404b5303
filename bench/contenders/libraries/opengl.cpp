// OpenGL: the methods as the hardware does them. A contender as a shared library; needs libepoxy and EGL (Debian:
// libepoxy-dev, libegl-dev) and a driver of OpenGL 4.5, Mesa's llvmpipe among them.
//
// `depth_map`: a directional light has an orthographic map around the bounds of the scene, point and spot lights a
// cube map, spots too, because S_j is asked outside of their cones. A compute shader looks the points up where they
// are, and not where a raster has them: the errors are those of the map alone. Depth is that of the rasteriser, window
// z, because glPolygonOffset acts on that only.
//
// `stencil_volumes`: the reverse of Carmack, after a picture of the depths that the eye sees; needs a raster and its
// camera, and answers nothing at other points. Silhouettes come from the processor: each edge counts the triangles at
// its sides, all turned towards the light, so open and non-manifold meshes are served, too. Volumes reach to infinity,
// and depth is reversed (near / distance), so that neither end clips them.
//
// Traps: triangles between the light and the near plane occlude, too, hence GL_DEPTH_CLAMP; bias is per texel, so
// wider filters need more slope (linear comparison reaches over one texel, pcf3 over two, pcf5 over three; a slope of
// twice that covers a plane); it is the slope of the surface in the map and not of the one that asks, so grazed faces
// stay dark for a texel along their convex edges; cube maps are filtered over their edges only with
// GL_TEXTURE_CUBE_MAP_SEAMLESS, and against the depth along another axis there; coordinates are relative to the centre
// of the scene, or floats do not do; a lit surface is the near cap of its own volume, and only the same vertices in
// the same order have the same depth; a stencil has 8 bits, so 256 volumes around a point count as none; parallel rays
// of an eye never meet what is at infinity.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "opengl_context.h"
#include "umbra/contender.h"

namespace {

using namespace umbra_opengl;

enum Parameter : std::uint8_t { algorithm, size, filter, bias_slope, bias_constant, normal_offset, cull, depth_bits };
enum Filter : std::uint8_t { hardware, nearest, pcf3, pcf5 };

constexpr std::array kParameters{
    umbra_parameter{"algorithm", "depth_map", 0, 0, "depth_map|stencil_volumes",
                    "how shadows are found; only depth maps have the other parameters", "depth_map|stencil_volumes",
                    "build", UMBRA_CHOICE},
    umbra_parameter{"size", "2048", 16, 8192, nullptr, "texels along each side of the map, or of each face of the cube",
                    "512|1024|2048|4096", "aim", UMBRA_INTEGER},
    umbra_parameter{"filter", "hardware", 0, 0, "hardware|nearest|pcf3|pcf5",
                    "one look-up with linear comparison, or the nearest texel, or 3 x 3 or 5 x 5 such look-ups",
                    "hardware|nearest|pcf3|pcf5", "visibility", UMBRA_CHOICE},
    umbra_parameter{"bias_slope", "2", 0, 1000, nullptr, "factor of glPolygonOffset: depths per texel", "0|1|2|4|8",
                    "aim", UMBRA_REAL},
    umbra_parameter{"bias_constant", "4", 0, 1e7, nullptr, "units of glPolygonOffset: least differences of depth",
                    nullptr, "aim", UMBRA_REAL},
    umbra_parameter{"normal_offset", "0", 0, 100, nullptr, "shift of the point along its normal, in texels", "0|1|2",
                    "visibility", UMBRA_REAL},
    umbra_parameter{"cull", "none", 0, 0, "none|front|back", "faces that the map leaves out, as seen from the light",
                    "none|front|back", "aim", UMBRA_CHOICE},
    umbra_parameter{"depth_bits", "24", 0, 0, "16|24|32f", "format of the map", "16|24|32f", "aim", UMBRA_CHOICE}};

struct Vector {
    double x = 0, y = 0, z = 0;
};
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator*(double s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(Vector a, Vector b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
template <typename T>
Vector vector_of(const T* p) {
    return {p[0], p[1], p[2]};
}
double largest(Vector a) { return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)}); }

/// Rows of a matrix: each maps a point p to dot(v, p) + c.
struct Row {
    Vector v;
    double c = 0;
};
using Matrix = std::array<Row, 4>;

constexpr const char* kVertex   = R"(#version 450 core
layout(location = 0) in vec4 position;  // w: 1, or 0 at the far end of a volume
layout(location = 0) uniform mat4 clip;
layout(location = 1) uniform vec4 light;  // its position, 1; or where its light comes from, 0
layout(location = 2) uniform float end;  // 1 over the distance of the far end: in the world, or in that of the light
void main() {
    vec4 far = vec4(mix(end, 1, light.w) * position.xyz - (1 - light.w * end) * light.xyz, end);
    gl_Position = clip * (position.w > 0 ? position : far);
})";
constexpr const char* kFragment = "#version 450 core\nvoid main() {}";
constexpr const char* kLookUp   = R"(
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Points { float p[]; };
layout(std430, binding = 1) writeonly buffer Answers { float s[]; };
layout(location = 0) uniform mat4 clip;
layout(location = 1) uniform vec4 light;
layout(location = 2) uniform uvec2 range;
layout(location = 3) uniform vec2 depth;  // at distance m along the axis of the face: depth.x (m - depth.y) / m
layout(location = 4) uniform float texel;  // width of one, in the world; of a cube map at distance 1
layout(location = 5) uniform float shift;  // along the normal, texels
layout(location = 6) uniform int ring;
#ifdef CUBE
layout(binding = 0) uniform samplerCubeShadow map;
#else
layout(binding = 0) uniform sampler2DShadow map;
#endif
float largest(vec3 d) { return max(abs(d.x), max(abs(d.y), abs(d.z))); }
void main() {
    uint i = range.x + gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * 256u;
    if (i >= range.y) return;
    vec3 at = vec3(p[6 * i], p[6 * i + 1], p[6 * i + 2]), n = vec3(p[6 * i + 3], p[6 * i + 4], p[6 * i + 5]);
    vec3 d = light.w * at - light.xyz;  // from the light
    if (dot(n, d) > 0) n = -n;
    float sum = 0;
#ifdef CUBE
    d += shift * texel * largest(d) * n;
    float m = largest(d), r = clamp(depth.x * (m - depth.y) / m, 0, 1);
    vec3 u = vec3(1, 0, 0), v = vec3(0, 1, 0);
    if (abs(d.x) == m) u = vec3(0, 0, 1);
    else if (abs(d.y) == m) v = vec3(0, 0, 1);
    for (int k = -ring; k <= ring; ++k)
        for (int j = -ring; j <= ring; ++j) sum += texture(map, vec4(d + texel * m * (float(j) * u + float(k) * v), r));
#else
    vec3 q = (clip * vec4(at + shift * texel * n, 1)).xyz;
    q = vec3(0.5 * q.xy + 0.5, clamp(q.z, 0, 1));
    vec2 step = 1.0 / vec2(textureSize(map, 0));
    for (int k = -ring; k <= ring; ++k)
        for (int j = -ring; j <= ring; ++j) sum += texture(map, vec3(q.xy + step * vec2(j, k), q.z));
#endif
    s[i - range.x] = sum / float((2 * ring + 1) * (2 * ring + 1));
})";

struct Programs {
    GLuint draw         = program_of({{GL_VERTEX_SHADER, kVertex}, {GL_FRAGMENT_SHADER, kFragment}});
    GLuint look_up      = program_of({{GL_COMPUTE_SHADER, std::string("#version 450 core\n") + kLookUp}});
    GLuint look_up_cube = program_of({{GL_COMPUTE_SHADER, std::string("#version 450 core\n#define CUBE\n") + kLookUp}});
};
const Programs& programs() {
    static const Programs all;
    return all;
}

struct Uses {
    bool depths = false, offset = false, culled = false, stencil = false;
};
/// All state that differs between drawings.
void draw_with(Uses uses, GLenum nearer) {
    const auto set = [](GLenum what, bool on) { (on ? glEnable : glDisable)(what); };
    glUseProgram(programs().draw);
    glDepthMask(uses.depths ? GL_TRUE : GL_FALSE);
    glDepthFunc(nearer);
    set(GL_POLYGON_OFFSET_FILL, uses.offset);
    set(GL_CULL_FACE, uses.culled);
    set(GL_STENCIL_TEST, uses.stencil);
}

void set_matrix(const Matrix& rows) {
    std::array<float, 16> columns{};
    for (std::size_t r = 0; r < 4; ++r) {
        columns[r]      = static_cast<float>(rows[r].v.x);
        columns[4 + r]  = static_cast<float>(rows[r].v.y);
        columns[8 + r]  = static_cast<float>(rows[r].v.z);
        columns[12 + r] = static_cast<float>(rows[r].c);
    }
    glUniformMatrix4fv(0, 1, GL_FALSE, columns.data());
}

struct Light {
    Vector at;  ///< from the centre of the scene; directional: where its light comes from, of length 1
    bool far = false;
};
void set_light(const Light& light) {
    glUniform4f(1, static_cast<float>(light.at.x), static_cast<float>(light.at.y), static_cast<float>(light.at.z),
                light.far ? 0.f : 1.f);
}

bool wants_volumes(const umbra_question& question) { return question.settings[algorithm].number > 0; }

struct Built {
    const umbra_scene* scene = nullptr;
    Vector centre, half;       ///< of the bounds
    std::vector<Vector> at;    ///< of each vertex, from the centre, as the buffer has it
    Buffer vertices, corners;  ///< those of the triangles that block
    Named<glDeleteVertexArrays> array;
    GLsizei corner_count = 0;

    // Edges, for volumes.
    struct Blocker {
        std::uint32_t triangle = 0;
        std::array<std::uint32_t, 3> edge{};
        std::array<std::int8_t, 3> along{};  ///< 1: from the first vertex of the edge to the second, or -1
    };
    std::vector<Blocker> blockers;
    std::vector<std::array<std::uint32_t, 2>> edges;

    explicit Built(const umbra_question& question) : scene(question.scene) {
        const umbra_scene& s = *scene;
        const bool volumes   = wants_volumes(question);
        const Vector low = vector_of(s.low), high = vector_of(s.high);
        if (s.triangles > 0) centre = 0.5 * low - -0.5 * high, half = 0.5 * (high - low);
        at.reserve(s.vertices);
        std::vector<std::array<float, 4>> data;
        for (int end = 0; end < (volumes ? 2 : 1); ++end)
            for (std::size_t i = 0; i < s.vertices; ++i) {
                const Vector p = vector_of(s.positions + 3 * i) - centre;
                data.push_back(
                    {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), end == 0 ? 1.f : 0.f});
                if (end == 0) at.push_back(vector_of(data.back().data()));
            }
        std::vector<std::uint32_t> blocking;
        for (std::size_t t = 0; t < s.triangles; ++t)
            if (s.blocks[t] != 0) blocking.insert(blocking.end(), s.corners + 3 * t, s.corners + 3 * t + 3);
        corner_count = static_cast<GLsizei>(blocking.size());
        vertices.store(data);
        corners.store(blocking);
        glCreateVertexArrays(1, &array.name);
        glEnableVertexArrayAttrib(array.name, 0);
        glVertexArrayAttribFormat(array.name, 0, 4, GL_FLOAT, GL_FALSE, 0);
        glVertexArrayAttribBinding(array.name, 0, 0);
        glVertexArrayVertexBuffer(array.name, 0, vertices.name, 0, 4 * sizeof(float));
        if (volumes) connect();
    }

    /// Edges between triangles that meet at equal positions, whatever their vertices.
    void connect() {
        std::vector<std::uint32_t> order(at.size()), first(at.size());
        std::iota(order.begin(), order.end(), 0u);
        const auto key = [&](std::uint32_t i) { return std::tuple(at[i].x, at[i].y, at[i].z); };
        std::ranges::sort(order, {}, key);
        for (std::size_t i = 0; i < order.size(); ++i)
            first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];

        struct Side {
            std::array<std::uint32_t, 2> ends;
            std::uint32_t blocker, k;
        };
        std::vector<Side> sides;
        for (std::uint32_t t = 0; t < scene->triangles; ++t) {
            if (scene->blocks[t] == 0) continue;
            Blocker& blocker = blockers.emplace_back();
            blocker.triangle = t;
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t a = first[scene->corners[3 * t + k]],
                                    b = first[scene->corners[3 * t + (k + 1) % 3]];
                blocker.along[k]      = a < b ? 1 : -1;
                sides.push_back({{std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(blockers.size() - 1), k});
            }
        }
        std::ranges::sort(sides, {}, &Side::ends);
        for (const Side& side : sides) {
            if (edges.empty() || edges.back() != side.ends) edges.push_back(side.ends);
            blockers[side.blocker].edge[side.k] = static_cast<std::uint32_t>(edges.size() - 1);
        }
    }

    [[nodiscard]] Light light_of(const umbra_light& light) const {
        if (light.kind != UMBRA_DIRECTIONAL) return {vector_of(light.position) - centre, false};
        const Vector d = vector_of(light.direction);
        return {-1 / std::sqrt(dot(d, d)) * d, true};
    }
};

const Built& built_of(const umbra_question& question) { return *static_cast<const Built*>(question.built); }

struct Looked {
    Buffer points;  ///< 6 floats each: from the centre, normal
    Target eye;     ///< depths that the eye sees, and a stencil
    Matrix clip;
    bool parallel       = false;  ///< rays of the eye
    std::uint32_t width = 0, height = 0;

    explicit Looked(const umbra_question& question) {
        const Built& built    = built_of(question);
        const umbra_points& p = *question.points;
        if (wants_volumes(question)) {
            see(built, p);
            return;
        }
        std::vector<float> data;
        data.reserve(6 * p.count);
        for (std::size_t i = 0; i < p.count; ++i) {
            const Vector at = Vector{p.x[i], p.y[i], p.z[i]} - built.centre;
            for (const double x : {at.x, at.y, at.z}) data.push_back(static_cast<float>(x));
            data.insert(data.end(), {p.nx[i], p.ny[i], p.nz[i]});
        }
        points.store(data);
    }

    /// The depth pass, of objects of which a point is seen: the eye may look through others.
    void see(const Built& built, const umbra_points& p) {
        const umbra_scene& s = *built.scene;
        if (p.width == 0) return;
        width               = p.width;
        height              = p.height;
        const Vector eye_at = vector_of(p.camera.eye) - built.centre;
        const auto row      = [&](const double* v, double scale) {
            const Vector to = 1 / scale * vector_of(v);
            return Row{to, -dot(to, eye_at)};
        };
        const Row depth = row(p.camera.forward, 1);
        std::vector<bool> seen;
        double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
        for (std::size_t i = 0; i < p.count; ++i) {
            if (p.triangle[i] == UMBRA_NO_TRIANGLE) continue;
            const std::size_t object = s.object[p.triangle[i]];
            if (object >= seen.size()) seen.resize(object + 1);
            seen[object]      = true;
            const double away = dot(depth.v, Vector{p.x[i], p.y[i], p.z[i]} - built.centre) + depth.c;
            nearest           = std::min(nearest, away);
            farthest          = std::max(farthest, away);
        }
        clip = {row(p.camera.right, p.camera.half_width), row(p.camera.up, p.camera.half_height),
                Row{{}, 0.5 * std::min(nearest, 1e30)}, depth};  // depth 1/2 at the nearest point, 0 at infinity
        if (p.camera.orthographic != 0) {                        // 1 at the eye
            const double scale = 0.999 / std::max(farthest, 1e-30);
            clip[2]            = {-scale * depth.v, 1 - scale * depth.c};
            clip[3]            = {{}, 1};
            parallel           = true;
        }
        std::vector<std::uint32_t> corners;
        for (std::size_t t = 0; t < s.triangles; ++t)
            if (s.object[t] < seen.size() && seen[s.object[t]])
                corners.insert(corners.end(), s.corners + 3 * t, s.corners + 3 * t + 3);
        Buffer indices;
        indices.store(corners);
        eye.make(GL_TEXTURE_2D, GL_DEPTH32F_STENCIL8, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
        eye.attach(GL_DEPTH_STENCIL_ATTACHMENT, -1);
        draw_with({.depths = true}, GL_GREATER);
        glClearNamedFramebufferfi(eye.frame.name, GL_DEPTH_STENCIL, 0, 0, 0);
        set_matrix(clip);
        glBindVertexArray(built.array.name);
        glVertexArrayElementBuffer(built.array.name, indices.name);
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(corners.size()), GL_UNSIGNED_INT, nullptr);
    }
};

struct Aimed {
    const Built* built = nullptr;
    Light light;

    Target map;
    Matrix clip;                 ///< directional
    double scale = 0, near = 0;  ///< of a cube map: the depth at distance m is scale (m - near) / m
    double texel = 0;            ///< width in the world; of a cube map at distance 1

    struct Volumes {
        Buffer corners;
        GLsizei count = 0;
    } outward, inward;  ///< triangles that show their front outside; those that show their back

    explicit Aimed(const umbra_question& question)
        : built(&built_of(question)), light(built->light_of(*question.light)) {
        const umbra_setting* settings = question.settings;
        if (wants_volumes(question)) {
            extrude();
            return;
        }

        const auto side = static_cast<GLsizei>(settings[size].number);
        map.make(light.far ? GL_TEXTURE_2D : GL_TEXTURE_CUBE_MAP,
                 std::array<GLenum, 3>{GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT24,
                                       GL_DEPTH_COMPONENT32F}[static_cast<std::size_t>(settings[depth_bits].number)],
                 side, side);
        const std::string_view culled = settings[cull].text;
        draw_with({.depths = true, .offset = true, .culled = culled != "none"}, GL_LESS);
        glPolygonOffset(static_cast<float>(settings[bias_slope].number),
                        static_cast<float>(settings[bias_constant].number));
        glCullFace(culled == "front" ? GL_FRONT : GL_BACK);
        glBindVertexArray(built->array.name);
        glVertexArrayElementBuffer(built->array.name, built->corners.name);
        if (light.far)
            draw_window(side);
        else
            draw_cube(side);
    }

    void draw(int layer, const Matrix& to_clip) const {
        constexpr float kFar = 1;
        map.attach(GL_DEPTH_ATTACHMENT, layer);
        glClearNamedFramebufferfv(map.frame.name, GL_DEPTH, 0, &kFar);
        set_matrix(to_clip);
        glDrawElements(GL_TRIANGLES, built->corner_count, GL_UNSIGNED_INT, nullptr);
    }

    /// The orthographic map around the bounds of the scene.
    void draw_window(GLsizei side) {
        const Vector f = -1 * light.at, h = built->half;
        const Vector aside = std::abs(f.y) < 0.9 ? Vector{0, 1, 0} : Vector{1, 0, 0};
        Vector right       = cross(f, aside);
        right              = 1 / std::sqrt(dot(right, right)) * right;
        const Vector up    = cross(right, f);
        const auto reach   = [&](Vector v) {
            return std::max(std::abs(v.x) * h.x + std::abs(v.y) * h.y + std::abs(v.z) * h.z, 1e-30);
        };
        const double x = reach(right) * (1 + 2.0 / side), y = reach(up) * (1 + 2.0 / side), z = reach(f) * 1.001;
        clip  = {Row{1 / x * right}, Row{1 / y * up}, Row{0.5 / z * f, 0.5}, Row{{}, 1}};
        texel = 2 * std::max(x, y) / side;
        draw(-1, clip);
    }

    /// The faces of a cube around the light; depths from the bounds of the scene, or from a thousandth of the farthest.
    void draw_cube(GLsizei side) {
        const Vector l = light.at, h = built->half;
        const Vector beside{std::abs(l.x) - h.x, std::abs(l.y) - h.y, std::abs(l.z) - h.z};
        const double far =
            std::max(1.001 * largest({std::abs(l.x) + h.x, std::abs(l.y) + h.y, std::abs(l.z) + h.z}), 1e-30);
        near  = std::max(0.999 * std::max({beside.x, beside.y, beside.z}), 1e-3 * far);
        scale = far / (far - near);
        texel = 2.0 / side;
        struct Face {
            Vector s, t, axis;
        };
        constexpr std::array kFaces{Face{{0, 0, -1}, {0, -1, 0}, {1, 0, 0}}, Face{{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}},
                                    Face{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},   Face{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                    Face{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},  Face{{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
        for (int k = 0; k < 6; ++k) {
            const auto& [s, t, axis] = kFaces[static_cast<std::size_t>(k)];
            const double m           = -dot(axis, l);
            draw(k, {Row{s, -dot(s, l)}, Row{t, -dot(t, l)}, Row{scale * axis, scale * (m - near)}, Row{axis, m}});
        }
    }

    /// Sides and caps of the volumes. All triangles count as turned towards the light.
    void extrude() {
        const umbra_scene& s = *built->scene;
        const auto far_end   = static_cast<std::uint32_t>(s.vertices);
        std::vector<int> count(built->edges.size());
        std::vector<std::uint32_t> triangles, turned;
        for (const Built::Blocker& blocker : built->blockers) {
            const std::uint32_t* v = s.corners + 3 * std::size_t{blocker.triangle};
            const Vector a = built->at[v[0]], b = built->at[v[1]], c = built->at[v[2]];
            const bool faces = dot(cross(b - a, c - a), light.far ? light.at : light.at - a) >= 0;
            for (std::size_t k = 0; k < 3; ++k) count[blocker.edge[k]] += faces ? blocker.along[k] : -blocker.along[k];
            auto& caps = faces ? triangles : turned;
            caps.insert(caps.end(), v, v + 3);
            triangles.insert(triangles.end(), {v[0] + far_end, v[faces ? 2 : 1] + far_end, v[faces ? 1 : 2] + far_end});
        }
        for (std::size_t e = 0; e < count.size(); ++e) {
            const std::uint32_t a = built->edges[e][count[e] > 0 ? 0 : 1], b = built->edges[e][count[e] > 0 ? 1 : 0];
            for (int n = std::abs(count[e]); n > 0; --n) {
                triangles.insert(triangles.end(), {b, a, a + far_end, b, a + far_end, b + far_end});
            }
        }
        for (auto& [from, to] : {std::pair(&triangles, &outward), std::pair(&turned, &inward)}) {
            to->corners.store(*from);
            to->count = static_cast<GLsizei>(from->size());
        }
    }
};

void look_up(const umbra_question& question, std::size_t begin, std::size_t end, float* s) {
    const auto& aimed             = *static_cast<const Aimed*>(question.aimed);
    const auto& looked            = *static_cast<const Looked*>(question.looked);
    const umbra_setting* settings = question.settings;
    const auto how                = static_cast<Filter>(settings[filter].number);
    const std::size_t todo = end - begin, groups = (todo + 255) / 256, columns = std::min<std::size_t>(groups, 65535);
    Buffer answers;
    glCreateBuffers(1, &answers.name);
    glNamedBufferStorage(answers.name, static_cast<GLsizeiptr>(todo * sizeof(float)), nullptr, GL_MAP_READ_BIT);
    glUseProgram(aimed.light.far ? programs().look_up : programs().look_up_cube);
    glBindTextureUnit(0, aimed.map.texture.name);
    glBindSampler(0, how == nearest ? context().nearest : context().linear);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, looked.points.name);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, answers.name);
    if (aimed.light.far)
        set_matrix(aimed.clip);
    else
        glUniform2f(3, static_cast<float>(aimed.scale), static_cast<float>(aimed.near));
    set_light(aimed.light);
    glUniform2ui(2, static_cast<GLuint>(begin), static_cast<GLuint>(end));
    glUniform1f(4, static_cast<float>(aimed.texel));
    glUniform1f(5, static_cast<float>(settings[normal_offset].number));
    glUniform1i(6, how == pcf5 ? 2 : how == pcf3 ? 1 : 0);
    glDispatchCompute(static_cast<GLuint>(columns), static_cast<GLuint>((groups + columns - 1) / columns), 1);
    glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    finish();
    const auto* found = static_cast<const float*>(
        glMapNamedBufferRange(answers.name, 0, static_cast<GLsizeiptr>(todo * sizeof(float)), GL_MAP_READ_BIT));
    if (found == nullptr) throw std::runtime_error("OpenGL does not hand back the answers");
    for (std::size_t i = begin; i < end; ++i)
        if (question.asked[i] != 0) s[i] = found[i - begin];
    glUnmapNamedBuffer(answers.name);
}

void count_volumes(const umbra_question& question, std::size_t begin, std::size_t end, float* s) {
    const Built& built = built_of(question);
    const auto& aimed  = *static_cast<const Aimed*>(question.aimed);
    const auto& looked = *static_cast<const Looked*>(question.looked);
    if (looked.width == 0) {  // points of no picture
        std::fill(s + begin, s + end, std::numeric_limits<float>::quiet_NaN());
        return;
    }
    const auto width = static_cast<GLsizei>(looked.width), height = static_cast<GLsizei>(looked.height);
    glBindFramebuffer(GL_FRAMEBUFFER, looked.eye.frame.name);
    glViewport(0, 0, width, height);
    draw_with({.stencil = true}, GL_GREATER);  // fails behind the surface and on it
    glStencilFunc(GL_ALWAYS, 0, ~0u);
    glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_DECR_WRAP, GL_KEEP);
    glStencilOpSeparate(GL_BACK, GL_KEEP, GL_INCR_WRAP, GL_KEEP);
    constexpr GLint kNone = 0;
    glClearNamedFramebufferiv(looked.eye.frame.name, GL_STENCIL, 0, &kNone);
    set_matrix(looked.clip);
    set_light(aimed.light);
    // Parallel rays do not meet the cap at infinity; that at a hundred times the size of the scene hides nothing less.
    const double distance = aimed.light.far ? 100 * std::max(largest(built.half), 1e-30) : 1e5;
    glUniform1f(2, looked.parallel ? static_cast<float>(1 / distance) : 0.f);
    glBindVertexArray(built.array.name);
    for (const auto* volumes : {&aimed.outward, &aimed.inward}) {
        glFrontFace(volumes == &aimed.outward ? GL_CCW : GL_CW);
        glVertexArrayElementBuffer(built.array.name, volumes->corners.name);
        glDrawElements(GL_TRIANGLES, volumes->count, GL_UNSIGNED_INT, nullptr);
    }
    glFrontFace(GL_CCW);
    std::vector<std::uint8_t> inside(std::size_t{looked.width} * looked.height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_STENCIL_INDEX, GL_UNSIGNED_BYTE, inside.data());
    finish();
    for (std::size_t i = begin; i < end; ++i)
        if (question.asked[i] != 0)
            s[i] = inside[(looked.height - 1 - i / looked.width) * looked.width + i % looked.width] == 0 ? 1.f : 0.f;
}

int guarded(char* why, const std::function<void()>& work) {
    try {
        if (!context().fault.empty()) return umbra_fail(why, context().fault.c_str());
        const Current current;
        for (int k = 0; k < 8 && glGetError() != GL_NO_ERROR; ++k) {
        }  // those of a failure before
        work();
        return 1;
    } catch (const std::exception& e) {
        return umbra_fail(why, e.what());
    }
}

template <typename T>
int make(const umbra_question* question, void** made, char* why) {
    return guarded(why, [&] {
        auto value = std::make_unique<T>(*question);
        finish();
        *made = value.release();
    });
}
template <typename T>
void drop(void* value) {
    std::array<char, UMBRA_WHY> why{};
    guarded(why.data(), [&] { delete static_cast<T*>(value); });
}

int visibility(const umbra_question* question, std::size_t begin, std::size_t end, float* s, char* why) {
    return guarded(why, [&] {
        if (begin < end) (wants_volumes(*question) ? count_volumes : look_up)(*question, begin, end, s);
    });
}

}  // namespace

const umbra_contender_info* umbra_contender() {
    std::array<char, UMBRA_WHY> why{};
    guarded(why.data(), [] { programs(); });  // compiled before a clock runs; `build` says of a failure
    static const umbra_contender_info info{UMBRA_CONTENDER_VERSION,
                                           UMBRA_HARD,
                                           0,
                                           kParameters.size(),
                                           kParameters.data(),
                                           "opengl",
                                           "OpenGL",
                                           context().release.c_str(),
                                           "Depth maps and stencil volumes as the graphics hardware does them.",
                                           nullptr,
                                           make<Built>,
                                           make<Aimed>,
                                           make<Looked>,
                                           visibility,
                                           drop<Built>,
                                           drop<Aimed>,
                                           drop<Looked>};
    return &info;
}
