#include "umbra/core/io/native/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>

#include "umbra/core/io/native/directions.h"

namespace umbra {
namespace {

constexpr int kMostFrames = 100000;

/// The keys of one thing that moves.
class Track {
public:
    /// The member "keys" of `fields`: at least one key, in the order of their frames.
    Track(const JsonText& json, const JsonFields& fields, int frames, std::vector<std::string_view> known)
        : json_(json), known_(std::move(known)) {
        const JsonValue& list = fields.require("keys");
        for (const JsonValue& key : json.array(list, "keys", "a list of keys")) {
            const JsonFields f(json, key, "a key", known_);
            const JsonValue& at = f.require("frame");
            const int frame     = json.integer(at, "frame", 0, frames - 1);
            if (!keys_.empty() && frame <= keys_.back().frame)
                json.fail(at, fmt::format("frame {} after frame {}, expected keys in the order of their frames", frame,
                                          keys_.back().frame));
            keys_.push_back({frame, &key});
        }
        if (keys_.empty()) json.fail(list, "no key, expected at least one");
    }

    /// The value of a member at a frame, between the keys around it that have the member; of keys that lack it,
    /// `missing` is the value, if there is one. None where no key has a value.
    template <class Value, class Read, class Between>
    [[nodiscard]] std::optional<Value> at(int frame, std::string_view member, std::optional<Value> missing,
                                          const Read& read, const Between& between) const {
        std::optional<Value> before, after;
        int from = 0, to = 0;
        for (const Key& key : keys_) {
            const JsonFields f(json_, *key.value, "a key", known_);
            const JsonValue* v = f.find(member);
            if (v == nullptr && !missing) continue;
            const Value value = v != nullptr ? Value(read(*v)) : *missing;
            if (key.frame <= frame) before = value, from = key.frame;
            if (key.frame >= frame && !after) after = value, to = key.frame;
        }
        if (!before || !after || to == from) return before ? before : after;
        return between(*before, *after, double(frame - from) / double(to - from));
    }

    /// Relative to `origin`.
    [[nodiscard]] std::optional<dvec3> point(int frame, std::string_view member, const dvec3& origin,
                                             std::optional<dvec3> missing = std::nullopt) const {
        return at<dvec3>(
            frame, member, missing, [&](const JsonValue& v) { return json_.vector(v, member, kAnyNumber) - origin; },
            [](dvec3 a, dvec3 b, double t) { return a + t * (b - a); });
    }

    /// Unit.
    [[nodiscard]] std::optional<dvec3> direction(int frame, std::string_view member) const {
        return at<dvec3>(
            frame, member, std::nullopt,
            [&](const JsonValue& v) { return glm::normalize(dvec3(read_direction(json_, v, member))); },
            [](dvec3 a, dvec3 b, double t) {
                const dvec3 axis   = glm::cross(a, b);
                const double angle = std::atan2(glm::length(axis), glm::dot(a, b));
                if (!(glm::length(axis) > 0)) return a;
                return dvec3(glm::rotate(dmat4(1), t * angle, glm::normalize(axis)) * dvec4(a, 0));
            });
    }

    /// That of the last key up to the frame which has it.
    [[nodiscard]] bool state(int frame, std::string_view member, bool fallback) const {
        for (const Key& key : keys_) {
            const JsonFields f(json_, *key.value, "a key", known_);
            if (key.frame <= frame) fallback = f.boolean(member, fallback);
        }
        return fallback;
    }

    [[nodiscard]] double number(int frame, std::string_view member, double missing) const {
        return *at<double>(
            frame, member, missing, [&](const JsonValue& v) { return json_.number(v, member, kRotation); },
            [](double a, double b, double t) { return a + t * (b - a); });
    }

private:
    struct Key {
        int frame;
        const JsonValue* value;
    };
    const JsonText& json_;
    std::vector<std::string_view> known_;
    std::vector<Key> keys_;
};

void move_camera(const JsonText& json, const JsonValue& v, const Reading& reading, Scene& scene) {
    const int frame = reading.frame;
    const Track track(json, JsonFields(json, v, "the camera's track", {"keys"}), scene.frames,
                      {"frame", "eye", "target"});
    Camera& camera = scene.camera;
    camera.eye     = vec3(track.point(frame, "eye", reading.origin).value_or(dvec3(camera.eye)));
    camera.target  = vec3(track.point(frame, "target", reading.origin).value_or(dvec3(camera.target)));
    if (camera.eye == camera.target) json.fail(v, fmt::format("in frame {} the eye is at its target", frame));
    if (is_parallel(dvec3(camera.up), dvec3(camera.target) - dvec3(camera.eye)))
        json.fail(v, fmt::format("in frame {} the view is along the camera's up", frame));
}

/// Whether the light is on.
bool move_light(const JsonText& json, const JsonMember& member, const Reading& reading, Scene& scene) {
    const int frame  = reading.frame;
    const auto light = std::ranges::find_if(scene.lights, [&](const Light& l) { return l.name == member.key; });
    if (light == scene.lights.end())
        json.source().fail(member.offset, fmt::format("no light that is on is named \"{}\"", member.key));
    if (light->camera_pose)
        json.source().fail(member.offset, fmt::format("light \"{}\" is fixed to the camera", member.key));
    const bool turns =
        light->kind == LightKind::directional || light->kind == LightKind::spot || light->kind == LightKind::disk;
    std::vector<std::string_view> keys{"frame", "on"};
    if (turns) keys.emplace_back("direction");
    if (light->kind != LightKind::directional) keys.emplace_back("position");
    const Track track(json, JsonFields(json, member.value, "a light's track", {"keys"}), scene.frames, keys);
    if (light->kind != LightKind::directional)
        light->position = vec3(track.point(frame, "position", reading.origin).value_or(dvec3(light->position)));
    if (turns)
        if (const auto direction = track.direction(frame, "direction")) light->direction = vec3(*direction);
    return track.state(frame, "on", true);
}

void move_lights(const JsonText& json, const JsonValue& v, const Reading& reading, Scene& scene) {
    std::vector<std::string> off;
    for (const JsonMember& light : json.object(v, "lights"))
        if (!move_light(json, light, reading, scene)) off.push_back(light.key);
    std::erase_if(scene.lights, [&](const Light& light) { return std::ranges::find(off, light.name) != off.end(); });
}

/// All parts of an object turn about one axis, through the middle of their common box.
void move_object(const JsonText& json, const JsonMember& member, int frame, Scene& scene) {
    const JsonFields fields(json, member.value, "an object's track", {"keys", "axis"});
    const Track track(json, fields, scene.frames, {"frame", "move", "turn"});
    const auto is_part = [&](const Object& object) {
        return object.name == member.key || object.name.starts_with(member.key + "/");
    };
    Box box;
    std::vector<std::uint32_t> moved;  // positions
    for (const Object& object : scene.objects) {
        if (!is_part(object)) continue;
        for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
            for (int k = 0; k < 3; ++k) {
                moved.push_back(scene.triangles[t][k]);
                box = extend(box, scene.vertex(t, k));
            }
    }
    if (moved.empty()) json.source().fail(member.offset, fmt::format("no object is named \"{}\"", member.key));
    std::ranges::sort(moved);
    moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
    const JsonValue* axis = fields.find("axis");
    const dvec3 about = axis != nullptr ? glm::normalize(dvec3(read_direction(json, *axis, "axis"))) : dvec3(0, 1, 0);
    const dvec3 move  = *track.point(frame, "move", dvec3(0), dvec3(0));
    const double turn = track.number(frame, "turn", 0);
    if (move == dvec3(0) && turn == 0) return;
    const dmat4 rotation = glm::rotate(dmat4(1), glm::radians(turn), about);
    const dvec3 pivot(box.centre());
    for (const std::uint32_t p : moved) {
        const dvec3 arm    = turn == 0 ? dvec3(0) : dvec3(scene.positions[p]) - pivot;
        const dvec3 turned = turn == 0 ? dvec3(scene.positions[p]) : pivot + dvec3(rotation * dvec4(arm, 0));
        scene.positions[p] = vec3(turned + move);
        scene.normals[p]   = vec3(rotation * dvec4(dvec3(scene.normals[p]), 0));
    }
}

}  // namespace

void apply_animation(const JsonText& json, const JsonValue& v, const Reading& reading, Scene& scene) {
    const int frame = reading.frame;
    const JsonFields f(json, v, "the animation", {"frames", "camera", "lights", "objects"});
    scene.frames = json.integer(f.require("frames"), "frames", 1, kMostFrames);
    if (frame >= scene.frames)
        json.fail(v, fmt::format("frame {} is asked for, expected 0 to {}", frame, scene.frames - 1));
    scene.frame = frame;
    if (const JsonValue* camera = f.find("camera")) move_camera(json, *camera, reading, scene);
    if (const JsonValue* lights = f.find("lights")) move_lights(json, *lights, reading, scene);
    if (const JsonValue* objects = f.find("objects"))
        for (const JsonMember& object : json.object(*objects, "objects")) move_object(json, object, frame, scene);
}

}  // namespace umbra
