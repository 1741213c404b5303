// The mesh files that objects of a native scene file name. Internal to core.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "umbra/core/io/json_text.h"
#include "umbra/core/io/native/parts.h"
#include "umbra/core/io/scene_readers.h"

namespace umbra {

class MeshFiles {
public:
    /// Files are looked for from `folder`; both other arguments must outlive this object.
    MeshFiles(const JsonText& json, std::filesystem::path folder, Scene& scene)
        : json_(json), folder_(std::move(folder)), scene_(scene) {}

    /// The file's objects, named `name` or "name/OBJECT" where it has several. Its warnings are added to the scene,
    /// and, unless the object has a material of its own, so are its materials.
    [[nodiscard]] std::vector<NativePart> read(const JsonValue& v, const std::string& name, bool own_material);

private:
    const SceneFile& file(const JsonValue& v);

    const JsonText& json_;
    std::filesystem::path folder_;
    Scene& scene_;
    std::map<std::string, SceneFile> files_;  ///< by path as written: a file that is placed twice is read once
};

}  // namespace umbra
