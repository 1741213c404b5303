#include "umbra/core/io/native/objects.h"

#include <algorithm>

#include <fmt/format.h>

#include "umbra/core/io/native/shapes.h"
#include "umbra/core/io/native/transforms.h"
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
    const auto shape = std::find_if(shapes().begin(), shapes().end(), [&](const Shape& s) { return s.type == type; });
    if (shape != shapes().end()) {
        keys.insert(keys.end(), shape->keys.begin(), shape->keys.end());
    } else if (type == kMeshFile) {
        keys.emplace_back("file");
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
        parts                   = files_.read(f.require("file"), name, own_material);
        if (!own_material) return parts;
    } else {
        const auto shape =
            std::find_if(shapes().begin(), shapes().end(), [&](const Shape& s) { return s.type == type; });
        parts.push_back({name, shape->read(json_, f)});
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
    if (v)
        for (NativePart& part : parts) part.mesh = transformed(std::move(part.mesh), mat4(m));
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
    for (const NativePart& part : parts) {
        if (scene_.triangles.size() + part.mesh.triangles.size() > kMaxTriangles)
            json_.fail(v, fmt::format("more than {} triangles in one scene", kMaxTriangles));
        add_object(scene_, part.name, part.mesh.positions, part.mesh.normals, part.mesh.triangles, part.material);
    }
}

}  // namespace umbra
