// The objects of a native scene file. Internal to core.
#pragma once

#include "umbra/core/io/native/materials.h"
#include "umbra/core/io/native/mesh_files.h"

namespace umbra {

class NativeObjects {
public:
    /// All arguments must outlive this object; objects are added to the scene.
    /// They become relative to `origin`, which is in the file's numbers.
    NativeObjects(const JsonText& json, MeshFiles& files, NativeMaterials& materials, const dvec3& origin, Scene& scene)
        : json_(json), files_(files), materials_(materials), origin_(origin), scene_(scene) {}

    void read(const JsonValue& v);

private:
    [[nodiscard]] std::vector<NativePart> read_parts(const JsonFields& f, const std::string& type,
                                                     const std::string& name);
    void apply_shading(const JsonFields& f, std::vector<NativePart>& parts) const;
    void apply_transform(const JsonFields& f, const dmat4& m, std::vector<NativePart>& parts) const;

    const JsonText& json_;
    MeshFiles& files_;
    NativeMaterials& materials_;
    dvec3 origin_;
    Scene& scene_;
};

}  // namespace umbra
