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

#include <utility>

namespace umbra {
SceneFile read_native(const std::filesystem::path& file, const Reading& reading) {
    const JsonText json(reading.text != nullptr ? SourceText{file.string(), *reading.text}
                                                : read_text(file, kMaxNativeFile));
    const JsonFields f(json, json.root(), "a scene",
                       {"$schema",
                        "title",
                        "shows",
                        "size",
                        "origin",
                        "camera",
                        "ambient",
                        "background",
                        "tone",
                        "exposure",
                        "viewer",
                        "light_ambient",
                        "specular_colour",
                        "ambient_coefficient",
                        "transparent_occluders",
                        "fog",
                        "materials",
                        "lights",
                        "objects",
                        "animation"});
    SceneFile read;
    Scene& scene = read.scene;
    scene.title  = f.string("title", "");
    scene.shows  = f.string("shows", "");
    if (const JsonValue* size = f.find("size")) read_picture_size(json, *size, scene);
    if (const JsonValue* origin = f.find("origin")) {
        scene.origin    = json.vector(*origin, "origin", kAnyNumber);
        read.has_origin = true;
    }
    apply_picture_terms(json, f, scene);
    NativeMaterials materials(json, scene);
    if (const JsonValue* v = f.find("materials")) materials.read_all(*v);
    MeshFiles files(json, file.parent_path(), scene);
    NativeObjects objects(json, files, materials, reading.origin, scene);
    if (const JsonValue* v = f.find("objects"))
        for (const JsonValue& object : json.array(*v, "objects", "a list of objects")) objects.read(object);
    read.at_rest = bounds(scene);
    // Before the scene is moved, floats may take the eye for its target.
    const bool moves = !read.has_origin && reading.origin == dvec3(0) && local_origin(read.at_rest) != dvec3(0);
    if (moves) return read;

    if (const JsonValue* camera = f.find("camera")) {
        scene.camera    = read_native_camera(json, *camera, reading.origin);
        read.has_camera = true;
    }
    if (const JsonValue* v = f.find("lights")) {
        std::vector<std::string> of_objects = std::exchange(scene.warnings, {});
        read_native_lights(json, *v, file.parent_path(), reading.origin, scene.lights, scene.warnings);
        scene.warnings.insert(scene.warnings.end(), of_objects.begin(), of_objects.end());
        read.may_be_dark = true;  // an empty list says that no light is meant
        check_exceptions(json, *v, scene.objects);
    }
    if (const JsonValue* v = f.find("animation"))
        apply_animation(json, *v, reading, scene);
    else if (reading.frame > 0)
        json.fail(json.root(), fmt::format("frame {} is asked for, but the scene has no \"animation\"", reading.frame));
    return read;
}

}  // namespace umbra
