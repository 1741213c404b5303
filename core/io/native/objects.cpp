#include "umbra/core/io/native/objects.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "umbra/core/io/native/shapes.h"
#include "umbra/core/io/native/transforms.h"
#include "umbra/core/io/scene_terms.h"
#include "umbra/core/io/vector_text.h"

namespace umbra {
namespace {

constexpr std::string_view kMeshFile = "mesh";  ///< the type of an object that a file describes

/// The members of an object, by its type.
JsonFields fields_of(const JsonText& json, const JsonValue& v) {
    const auto& members = json.object(v, "an object");
    const auto given =
        std::find_if(members.begin(), members.end(), [](const JsonMember& m) { return m.key == "type"; });
    if (given == members.end()) json.fail(v, "an object has no \"type\"");
    const std::string& type = json.string(given->value, "object type");

    std::vector<std::string_view> keys{"type", "name", "material", "transform", "shading", "crease", "weights"};
    for (const ObjectSwitch& each : kObjectSwitches) keys.push_back(each.key);
    const auto shape = std::find_if(shapes().begin(), shapes().end(), [&](const Shape& s) { return s.type == type; });
    if (shape != shapes().end()) {
        keys.insert(keys.end(), shape->keys.begin(), shape->keys.end());
    } else if (type == kMeshFile) {
        keys.insert(keys.end(), {"file", "up"});
    } else {
        std::vector<std::string_view> types;
        for (const Shape& s : shapes()) types.push_back(s.type);
        types.push_back(kMeshFile);
        json.unknown(given->value.offset, "object type", type, types);
    }
    return {json, v, fmt::format("a {}", type), keys};
}

}  // namespace

std::vector<NativePart> NativeObjects::read_parts(const JsonFields& f, const std::string& type,
                                                  const std::string& name) {
    std::vector<NativePart> parts;
    if (type == kMeshFile) {
        const bool own_material = f.find("material") != nullptr;
        parts                   = files_.read(f, name, own_material);
        if (!own_material) return parts;
    } else {
        const auto shape =
            std::find_if(shapes().begin(), shapes().end(), [&](const Shape& s) { return s.type == type; });
        NativePart part{name, {}, 0, origin_};
        part.mesh = shape->read(json_, f, part.origin);
        parts.push_back(std::move(part));
    }
    const std::uint32_t material = materials_.of_object(f, name);
    for (NativePart& part : parts) part.material = material;
    return parts;
}

void NativeObjects::apply_shading(const JsonFields& f, std::vector<NativePart>& parts) const {
    enum Shading : std::uint8_t { given, flat, averaged };
    const JsonValue* v = f.find("shading");
    const auto shading = v ? json_.choice(*v, "shading", {"given", "flat", "averaged"}) : std::size_t{given};
    for (const std::string_view key : {"crease", "weights"})
        if (const JsonValue* given = f.find(key); given && shading != averaged)
            json_.fail(*given, fmt::format("{} is for \"shading\": \"averaged\" only", key));
    const JsonValue* w = f.find("weights");
    const auto weights = w ? json_.choice<NormalWeights>(*w, "weights") : NormalWeights::angle;
    const auto crease  = static_cast<float>(f.number("crease", kCrease, 180));
    for (NativePart& part : parts) {
        if (shading == flat) part.mesh.normals.clear();
        if (shading == averaged) part.mesh = with_averaged_normals(part.mesh, crease, weights);
    }
}

void NativeObjects::apply_transform(const JsonFields& f, const dmat4& m, std::vector<NativePart>& parts) const {
    const JsonValue* v = f.find("transform");
    for (NativePart& part : parts) {
        if (!v && part.origin == origin_) continue;
        dmat4 placed = part.origin == dvec3(0) ? m : glm::translate(m, part.origin);
        placed[3] -= dvec4(origin_, 0);
        part.mesh = transformed(std::move(part.mesh), mat4(placed));
    }
    for (const NativePart& part : parts)
        for (const vec3 p : part.mesh.positions)
            if (!(kAnyNumber.holds(p.x) && kAnyNumber.holds(p.y) && kAnyNumber.holds(p.z)))
                json_.fail(v ? *v : f.value(), fmt::format("puts a vertex at {}, expected numbers from {:g} to {:g}",
                                                           vector_text(p), kAnyNumber.min, kAnyNumber.max));
}

void NativeObjects::read(const JsonValue& v) {
    const JsonFields f(fields_of(json_, v));
    const std::string type        = f.string("type", "");
    const std::string name        = f.string("name", type);
    std::vector<NativePart> parts = read_parts(f, type, name);
    const JsonValue* transform    = f.find("transform");
    const dmat4 m                 = transform ? read_transform(json_, *transform, parts) : dmat4(1);
    apply_shading(f, parts);
    apply_transform(f, m, parts);
    for (NativePart& part : parts) {
        apply_object_switches(f, part.switches);
        if (scene_.triangles.size() + part.mesh.triangles.size() > kMaxTriangles)
            json_.fail(v, fmt::format("more than {} triangles in one scene", kMaxTriangles));
        const auto added =
            add_object(scene_, part.name, part.mesh.positions, part.mesh.normals, part.mesh.triangles, part.material);
        scene_.objects[added].switches = part.switches;
    }
}

}  // namespace umbra
