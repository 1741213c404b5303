// The materials of a native scene file, by name. Internal to core.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

class NativeMaterials {
public:
    /// Both must outlive this object; materials are added to the scene.
    NativeMaterials(const JsonText& json, Scene& scene) : json_(json), scene_(scene) {}

    /// The object "materials" of the file.
    void read_all(const JsonValue& v);
    /// The material that an object's key "material" names or describes, or the default one; an index into
    /// Scene::materials. A material that is described there is named `object`.
    [[nodiscard]] std::uint32_t of_object(const JsonFields& f, const std::string& object);

private:
    std::uint32_t read(const JsonValue& v, const std::string& name);

    const JsonText& json_;
    Scene& scene_;
    std::map<std::string, std::uint32_t> by_name_;
    std::optional<std::uint32_t> default_;  ///< there once an object asked for it
};

}  // namespace umbra
