// The animation of a native scene file: keyframes of the camera, of lights and of objects. Internal to core.
#pragma once

#include "umbra/core/io/json_text.h"
#include "umbra/core/io/reading.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// Moves the camera, lights and objects that the animation names to their positions in the frame of `reading`, relative
/// to its origin, and sets Scene::frame and Scene::frames. Between two keys points move along a straight line and
/// directions turn evenly; before the first key and after the last nothing moves. Called after camera, lights and
/// objects of the same file are read. Fails where the animation has no such frame.
void apply_animation(const JsonText& json, const JsonValue& v, const Reading& reading, Scene& scene);

}  // namespace umbra
