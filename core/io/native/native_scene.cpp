// The native scene format: JSON written by hand. scenes/README.md describes every key; this file follows its order.
#include "umbra/core/io/native/animation.h"
#include "umbra/core/io/native/camera.h"
#include "umbra/core/io/native/lights.h"
#include "umbra/core/io/native/materials.h"
#include "umbra/core/io/native/mesh_files.h"
#include "umbra/core/io/native/objects.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/io/scene_terms.h"

#include <fmt/format.h>

namespace umbra {
SceneFile read_native(const std::filesystem::path& file) { return read_native(file, 0); }

SceneFile read_native(const std::filesystem::path& file, int frame) {
    const JsonText json(read_text(file, kMaxNativeFile));
    const JsonFields f(json, json.root(), "a scene",
                       {"$schema", "title", "shows", "size", "camera", "ambient", "background", "tone", "exposure",
                        "viewer", "light_ambient", "specular_colour", "ambient_coefficient", "transparent_occluders",
                        "fog", "materials", "lights", "objects", "animation"});
    SceneFile read;
    Scene& scene = read.scene;
    scene.title  = f.string("title", "");
    scene.shows  = f.string("shows", "");
    if (const JsonValue* size = f.find("size")) read_picture_size(json, *size, scene);
    if (const JsonValue* camera = f.find("camera")) {
        scene.camera    = read_native_camera(json, *camera);
        read.has_camera = true;
    }
    apply_picture_terms(json, f, scene);
    NativeMaterials materials(json, scene);
    if (const JsonValue* v = f.find("materials")) materials.read_all(*v);
    if (const JsonValue* v = f.find("lights")) {
        read_native_lights(json, *v, file.parent_path(), scene.lights, scene.warnings);
        read.may_be_dark = true;  // an empty list says that no light is meant
    }
    MeshFiles files(json, file.parent_path(), scene);
    NativeObjects objects(json, files, materials, scene);
    if (const JsonValue* v = f.find("objects"))
        for (const JsonValue& object : json.array(*v, "objects", "a list of objects")) objects.read(object);
    if (const JsonValue* v = f.find("lights")) check_exceptions(json, *v, scene.objects);
    if (const JsonValue* v = f.find("animation"))
        apply_animation(json, *v, frame, scene);
    else if (frame > 0)
        json.fail(json.root(), fmt::format("frame {} is asked for, but the scene has no \"animation\"", frame));
    return read;
}

}  // namespace umbra
