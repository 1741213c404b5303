#include "umbra/bench/sweep/content_key.h"
#include "umbra/bench/contenders/contender.h"

#include <fmt/format.h>

#include <xxhash.h>

#include <stdexcept>
#include <type_traits>

#include "umbra/bench/base/files.h"
#include "umbra/shadows/plugin.h"

#include "code_versions.h"  // made by bench/sweep/code_versions.cmake

namespace umbra {
namespace {

/// Takes values one by one; lists and texts with their lengths, so that no two sequences look alike.
class Hasher {
public:
    Hasher() : state_(XXH3_createState()) {
        if (state_ == nullptr) throw std::bad_alloc();
        XXH3_128bits_reset(state_);
    }
    ~Hasher() { XXH3_freeState(state_); }
    Hasher(const Hasher&)            = delete;
    Hasher& operator=(const Hasher&) = delete;

    template <class T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) Hasher& operator<<(T value) {
        return bytes(&value, sizeof value);
    }
    Hasher& operator<<(std::string_view text) {
        *this << text.size();
        return bytes(text.data(), text.size());
    }
    Hasher& operator<<(vec3 v) { return *this << v.x << v.y << v.z; }
    /// Of types without padding.
    template <class T>
    Hasher& list(const std::vector<T>& values) {
        static_assert(sizeof(T) % 4 == 0 && std::is_trivially_copyable_v<T>);
        *this << values.size();
        return bytes(values.data(), values.size() * sizeof(T));
    }
    [[nodiscard]] std::string digits() const {
        const XXH128_hash_t hash = XXH3_128bits_digest(state_);
        return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
    }

private:
    Hasher& bytes(const void* data, std::size_t size) {
        XXH3_128bits_update(state_, data, size);
        return *this;
    }
    XXH3_state_t* state_;
};

// A member that is added to one of these structs has to be added below, too, unless no answer depends on it (source,
// origin).
#if defined(__GLIBCXX__) && defined(__x86_64__)
static_assert(sizeof(Scene) == 488 && sizeof(Fog) == 40 && sizeof(Camera) == 48 && sizeof(Light) == 280 &&
              sizeof(LightPose) == 60 && sizeof(Photometry) == 80 && sizeof(Material) == 184 &&
              sizeof(LafortuneLobe) == 52 && sizeof(Object) == 48);
#endif

Hasher& operator<<(Hasher& h, const Camera& c) {
    return h << c.projection << c.eye << c.target << c.up << c.fov_y << c.height;
}

Hasher& operator<<(Hasher& h, const Object& o) {
    return h << o.name << o.first_triangle << o.triangle_count << o.material << o.switches.casts_shadows
             << o.switches.receives_shadows << o.switches.seen_by_camera;
}

Hasher& operator<<(Hasher& h, const Material& m) {
    h << m.lobes.size();
    for (const LafortuneLobe& lobe : m.lobes)
        h << lobe.rows[0] << lobe.rows[1] << lobe.rows[2] << lobe.k_s << lobe.shininess;
    return h << m.name << m.k_a << m.k_d << m.k_s << m.O_d << m.O_s << m.emission << m.shininess << m.lobe
             << m.two_sided << m.cutout << m.opacity << m.reflect << m.transmit << m.transmit_colour
             << m.index_of_refraction << m.tangent;
}

Hasher& operator<<(Hasher& h, const Light& l) {
    h << l.name << l.kind << l.position << l.direction << l.edge_u << l.edge_v << l.radius << l.range;
    h << l.ambient << l.diffuse << l.specular;
    h << l.attenuation.c1 << l.attenuation.c2 << l.attenuation.c3 << l.attenuation.clamp;
    h << l.spot.falloff << l.spot.exponent << l.spot.cutoff << l.spot.inner;
    h << (l.photometry != nullptr);
    if (l.photometry)
        (h << l.photometry->type)
            .list(l.photometry->vertical)
            .list(l.photometry->horizontal)
            .list(l.photometry->candela);
    h << l.along << l.except.size();
    for (const std::string& name : l.except) h << name;
    h << l.camera_pose.has_value();
    if (l.camera_pose)
        h << l.camera_pose->position << l.camera_pose->direction << l.camera_pose->edge_u << l.camera_pose->edge_v
          << l.camera_pose->along;
    return h;
}

Hasher& operator<<(Hasher& h, const Fog& f) {
    return h << f.law << f.distance << f.colour << f.density << f.start << f.end << f.near_share << f.far_share
             << f.dims_lights;
}

template <class T>
Hasher& each(Hasher& h, const std::vector<T>& values) {
    h << values.size();
    for (const T& value : values) h << value;
    return h;
}

}  // namespace

std::string scene_key(const Scene& scene) {
    Hasher h;
    h << scene.name << scene.title << scene.shows;
    h.list(scene.positions).list(scene.normals).list(scene.triangles).list(scene.triangle_object);
    each(h, scene.objects);
    each(h, scene.materials);
    each(h, scene.lights);
    h << scene.camera << scene.width << scene.height << scene.ambient << scene.background << scene.tone
      << scene.exposure << scene.local_viewer << scene.light_ambient << scene.specular_colour
      << scene.ambient_coefficient << scene.transparent << scene.fog;
    return h.digits();
}

std::string code_key(const MethodInfo& method) {
    for (const auto& [name, key] : kCodeVersions)
        if (name == method.name) return std::string(key);
    if (const std::string file = plugin_file(method); !file.empty()) return combined_key({"plugin", bytes_of(file)});
    if (const std::string text = text_of_outside(method); !text.empty()) return combined_key({"outside", text});
    throw std::logic_error(fmt::format("{} has no line in methods.def", method.name));
}

std::string combined_key(std::initializer_list<std::string_view> parts) {
    Hasher h;
    h << parts.size();
    for (const std::string_view part : parts) h << part;
    return h.digits();
}

}  // namespace umbra
