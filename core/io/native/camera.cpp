#include "umbra/core/io/native/camera.h"

#include <fmt/format.h>

#include "umbra/core/io/native/directions.h"
#include "umbra/core/io/vector_text.h"

namespace umbra {

Camera read_native_camera(const JsonText& json, const JsonValue& v, const dvec3& origin) {
    const JsonFields f(json, v, "the camera", {"eye", "target", "up", "fov", "height"});
    Camera camera;
    camera.eye    = vec3(json.vector(f.require("eye"), "eye", kAnyNumber) - origin);
    camera.target = vec3(json.vector(f.require("target"), "target", kAnyNumber) - origin);
    if (camera.eye == camera.target)
        json.fail(*f.find("target"), "target is the same point as eye, expected another point");
    const JsonValue* up = f.find("up");
    if (up) camera.up = read_direction(json, *up, "up");
    if (is_parallel(dvec3(camera.up), dvec3(camera.target) - dvec3(camera.eye)))
        json.fail(up ? *up : v, fmt::format("up {} is parallel to the view from eye to target, expected a direction "
                                            "across it, such as [0, 0, -1] for a view from above",
                                            vector_text(camera.up)));
    f.exclude("fov", "height");
    camera.fov_y = static_cast<float>(f.number("fov", kFieldOfView, double(camera.fov_y)));
    if (f.find("height")) camera.projection = Projection::orthographic;
    camera.height = static_cast<float>(f.number("height", kPositive, double(camera.height)));
    return camera;
}

}  // namespace umbra
