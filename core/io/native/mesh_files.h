// The mesh files that objects of a native scene file name. Internal to core.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
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

    /// The objects of the member "file", with the axis that the member "up" names upright, named `name` or
    /// "name/OBJECT" where it has several. Its warnings are added to the scene, and, unless the object has a material
    /// of its own, so are its materials.
    [[nodiscard]] std::vector<NativePart> read(const JsonFields& f, const std::string& name, bool own_material);

private:
    const SceneFile& file(const JsonFields& f);

    const JsonText& json_;
    std::filesystem::path folder_;
    Scene& scene_;
    /// By path as written and axis: a file that is placed twice is read once.
    std::map<std::pair<std::string, UpAxis>, SceneFile> files_;
};

}  // namespace umbra
