#include "umbra/core/io/native/materials.h"

#include "umbra/core/io/scene_terms.h"

namespace umbra {

void NativeMaterials::read_all(const JsonValue& v) {
    for (const JsonMember& m : json_.object(v, "materials")) {
        if (m.key.empty()) json_.source().fail(m.offset, "a material has an empty name");
        by_name_[m.key] = read(m.value, m.key);
    }
}

std::uint32_t NativeMaterials::of_object(const JsonFields& f, const std::string& object) {
    const JsonValue* v = f.find("material");
    if (v && std::holds_alternative<JsonObject>(v->data)) return read(*v, object);
    if (v) {
        const std::string& name = json_.string(*v, "material");
        const auto found        = by_name_.find(name);
        if (found != by_name_.end()) return found->second;
        std::vector<std::string_view> known;
        for (const auto& [known_name, index] : by_name_) known.push_back(known_name);
        json_.unknown(v->offset, "material", name, known);
    }
    if (!default_) {
        default_ = static_cast<std::uint32_t>(scene_.materials.size());
        scene_.materials.push_back({.name = "default"});
    }
    return *default_;
}

std::uint32_t NativeMaterials::read(const JsonValue& v, const std::string& name) {
    Material m;
    m.name = name;
    apply_material_terms(json_, JsonFields(json_, v, "a material", material_keys()), m);
    scene_.materials.push_back(std::move(m));
    return static_cast<std::uint32_t>(scene_.materials.size() - 1);
}

}  // namespace umbra
