#include "umbra/bench/studies/motion/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>

namespace umbra {
namespace {

/// A light is above the target, for this animation, where a turn would move it by less than this share of its distance.
constexpr double kAbove = 0.05;
/// How far an object moves, in its own diagonals.
constexpr double kSlide = 0.25;

int largest_coordinate(vec3 v) {
    const vec3 a = glm::abs(v);
    return a.x > a.y && a.x > a.z ? 0 : a.y >= a.z ? 1 : 2;
}

dvec3 unit_axis(int coordinate) {
    dvec3 axis(0);
    axis[coordinate] = 1;
    return axis;
}

}  // namespace

dvec3 vertical_axis(const Scene& scene) { return unit_axis(largest_coordinate(scene.camera.up)); }

std::vector<std::uint32_t> owners(const Scene& scene) {
    std::vector<std::uint32_t> owner(scene.positions.size(), kUnusedPosition);
    for (TriangleId t = 0; t < scene.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            std::uint32_t& o = owner[scene.triangles[t][k]];
            o = o == kUnusedPosition || o == scene.triangle_object[t] ? scene.triangle_object[t] : kSharedPosition;
        }
    return owner;
}

std::string_view to_string(Movement movement) {
    constexpr std::string_view kNames[]{"camera", "light", "object"};
    return kNames[static_cast<std::size_t>(movement)];
}

Animation::Animation(const Scene& start, const SceneFacts& facts, Movement movement)
    : movement_(movement), camera_(start.camera), vertical_(largest_coordinate(start.camera.up)) {
    pivot_ = dvec3(camera_.target);
    axis_  = unit_axis(vertical_);
    if (movement == Movement::camera) {
        what_ = fmt::format("the eye turns by {:g} degrees about its target", kArc);
        if (camera_.eye == camera_.target) cannot_ = "the eye is at its target";
        for (const Light& light : start.lights)
            if (light.camera_pose)
                cannot_ = fmt::format("light {} is fixed to the camera, so that it would move, too", light.name);
    } else if (movement == Movement::light) {
        if (start.lights.empty()) {
            cannot_ = "the scene has no light";
            return;
        }
        light_                = start.lights[light()];
        const dvec3 arm       = light_.kind == LightKind::directional ? dvec3(light_.direction)
                                                                      : dvec3(light_.position) - dvec3(camera_.target);
        const double sideways = glm::length(arm - axis_ * glm::dot(arm, axis_));
        if (sideways < kAbove * glm::length(arm)) axis_ = frame(camera_, 1, 1).right;
        if (glm::length(arm) == 0) cannot_ = fmt::format("light {} is at the camera's target", light_.name);
        what_ = fmt::format("light {} turns by {:g} degrees about {}", light_.name, kArc,
                            light_.kind == LightKind::directional ? "the scene" : "the camera's target");
    } else {
        choose_object(start, facts);
    }
}

void Animation::choose_object(const Scene& start, const SceneFacts& facts) {
    if (start.objects.size() < 2) {
        cannot_ = "the scene is one object: nothing in it can move apart from the rest";
        return;
    }
    std::size_t receiver = 0;
    for (std::size_t o = 1; o < start.objects.size(); ++o)
        if (facts.objects[o].area > facts.objects[receiver].area) receiver = o;
    const std::vector<std::uint32_t> owner = owners(start);
    std::vector<bool> shares(start.objects.size());
    for (TriangleId t = 0; t < start.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            if (owner[start.triangles[t][k]] == kSharedPosition) shares[start.triangle_object[t]] = true;

    std::optional<std::size_t> best;
    for (std::size_t o = 0; o < start.objects.size(); ++o) {
        const ObjectFacts& f = facts.objects[o];
        if (o == receiver || shares[o] || !(f.area > 0)) continue;
        const auto better = [&](const ObjectFacts& than) {
            return f.planar != than.planar ? !f.planar : f.area > than.area;
        };
        if (!best || better(facts.objects[*best])) best = o;
    }
    if (!best) {
        cannot_ = "every object but the largest shares vertices with another one, or has no area";
        return;
    }
    for (std::uint32_t v = 0; v < owner.size(); ++v) {
        if (owner[v] != *best) continue;
        vertices_.push_back(v);
        positions_.push_back(start.positions[v]);
        normals_.push_back(v < start.normals.size() ? start.normals[v] : vec3(0));
    }
    const Box& box      = facts.objects[*best].box;
    pivot_              = dvec3(box.centre());
    dvec3 sideways      = frame(camera_, 1, 1).right;
    sideways[vertical_] = 0;
    if (glm::length(sideways) < kAbove) sideways = unit_axis((vertical_ + 1) % 3);
    slide_ = glm::normalize(sideways) * (kSlide * static_cast<double>(box.diagonal()));
    what_  = fmt::format("object {} moves sideways by {:g} of its diagonal and turns by {:g} degrees",
                         start.objects[*best].name, kSlide, kArc);
}

void Animation::pose(Scene& scene, double time) const {
    const bool start     = time == 0;
    const dmat4 turn     = glm::rotate(dmat4(1), glm::radians(kArc) * time, axis_);
    const auto direction = [&](vec3 v) { return vec3(turn * dvec4(v, 0)); };
    const auto point     = [&](vec3 p) { return pivot_ + dvec3(turn * dvec4(dvec3(p) - pivot_, 0)); };
    switch (movement_) {
        case Movement::camera: {
            scene.camera = camera_;
            if (start) return;
            scene.camera.eye = vec3(point(camera_.eye));
            scene.camera.up  = direction(camera_.up);
            return;
        }
        case Movement::light: {
            Light& light = scene.lights[this->light()];
            light        = light_;
            if (start) return;
            light.camera_pose.reset();  // it leaves the camera
            light.along     = direction(light_.along);
            light.direction = direction(light_.direction);
            if (light.kind == LightKind::directional) return;
            light.position = vec3(point(light_.position));
            light.edge_u   = direction(light_.edge_u);
            light.edge_v   = direction(light_.edge_v);
            if (light.kind == LightKind::rectangle)
                light.direction = vec3(glm::normalize(glm::cross(dvec3(light.edge_u), dvec3(light.edge_v))));
            return;
        }
        case Movement::object:
            for (std::size_t i = 0; i < vertices_.size(); ++i) {
                vec3& position = scene.positions[vertices_[i]];
                position       = positions_[i];
                if (!start) {
                    position            = vec3(point(positions_[i]) + time * slide_);
                    position[vertical_] = positions_[i][vertical_];
                }
                if (vertices_[i] < scene.normals.size())
                    scene.normals[vertices_[i]] = start ? normals_[i] : direction(normals_[i]);
            }
            return;
    }
}

}  // namespace umbra
