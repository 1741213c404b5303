#include "umbra/bench/view/posed_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/studies/motion/animation.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/view_facts.h"

namespace umbra {
namespace {

vec3 vector_of(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

void place_light(Light& light, const Light& start, const PlacedLight& placed) {
    light              = start;
    light.position     = vector_of(placed.position);
    const vec3 towards = vector_of(placed.direction);
    const float length = glm::length(towards);
    const auto factor  = static_cast<float>(placed.size);
    light.radius       = start.radius * factor;
    const bool turns   = light.kind == LightKind::directional || light.kind == LightKind::spot ||
                       light.kind == LightKind::disk || light.kind == LightKind::rectangle;
    if (turns && !(length > 0)) throw UsageError(fmt::format("light {}: a direction of length 0", light.name));
    if (light.kind == LightKind::directional)
        light.direction = towards;
    else if (turns)
        light.direction = towards / length;
    if (light.kind == LightKind::rectangle) {
        // The least turn that takes the file's normal to the one asked for.
        const dvec3 from = glm::normalize(dvec3(start.direction)), to = glm::normalize(dvec3(light.direction));
        const dvec3 axis  = glm::cross(from, to);
        const double sine = glm::length(axis), cosine = glm::dot(from, to);
        const dvec3 about =
            sine > 1e-9 ? axis / sine : glm::normalize(dvec3(start.edge_u));  // half a turn keeps an edge
        const dmat4 turn = glm::rotate(dmat4(1), sine > 1e-9 || cosine < 0 ? std::atan2(sine, cosine) : 0.0, about);
        light.edge_u     = vec3(turn * dvec4(dvec3(start.edge_u), 0)) * factor;
        light.edge_v     = vec3(turn * dvec4(dvec3(start.edge_v), 0)) * factor;
    }
    light.camera_pose.reset();  // it stays where the hand has put it
}

}  // namespace

PosedScene::PosedScene(std::filesystem::path file) : file_(std::move(file)) { load(0); }

std::filesystem::path PosedScene::file_of(std::uint64_t frame) const {
    return frame == 0 ? file_ : std::filesystem::path(fmt::format("{}@{}", split_frame(file_.string()).file, frame));
}

void PosedScene::load(std::uint64_t frame) {
    Scene loaded = load_scene(file_of(frame));
    std::error_code none;
    written_                               = std::filesystem::last_write_time(split_frame(file_.string()).file, none);
    start_                                 = std::move(loaded);
    scene_                                 = start_;
    const std::vector<std::uint32_t> owner = owners(scene_);
    movable_.assign(scene_.objects.size(), true);
    vertices_.assign(scene_.objects.size(), {});
    for (std::uint32_t p = 0; p < owner.size(); ++p)
        if (owner[p] < kSharedPosition) vertices_[owner[p]].push_back(p);
    for (TriangleId t = 0; t < scene_.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            if (owner[scene_.triangles[t][k]] == kSharedPosition) movable_[scene_.triangle_object[t]] = false;
    facts_ms_  = timed_ms([&] { facts_ = find_facts(scene_); });
    now_       = {};
    now_.frame = frame;
    rays_.emplace(scene_);
}

dvec3 PosedScene::middle(std::size_t o) const {
    dvec3 low(kInfinity), high(-kInfinity);
    for (const std::uint32_t p : vertices_[o])
        low = glm::min(low, dvec3(start_.positions[p])), high = glm::max(high, dvec3(start_.positions[p]));
    return 0.5 * (low + high);
}

void PosedScene::place_object(const PlacedObject& placed) {
    const dvec3 centre = middle(placed.object), move(placed.move[0], placed.move[1], placed.move[2]);
    const dmat4 turn   = glm::rotate(dmat4(1), glm::radians(placed.turn), vertical_axis(start_));
    for (const std::uint32_t p : vertices_[placed.object]) {
        const dvec3 from = dvec3(start_.positions[p]);
        scene_.positions[p] =
            placed.turn == 0 ? vec3(from + move) : vec3(dvec3(turn * dvec4(from - centre, 0)) + centre + move);
        scene_.normals[p] = placed.turn == 0 ? start_.normals[p] : vec3(turn * dvec4(dvec3(start_.normals[p]), 0));
    }
}

Moved PosedScene::place(const ViewRequest& request) {
    Moved moved;
    std::error_code none;
    const auto written = std::filesystem::last_write_time(split_frame(file_.string()).file, none);
    if (request.frame != now_.frame || (!none && written != written_)) {
        if (request.frame > 0 && request.frame >= static_cast<std::uint64_t>(start_.frames))
            throw UsageError(fmt::format("frame {}, expected 0 to {}", request.frame, std::max(0, start_.frames - 1)));
        load(request.frame);
        moved.all = true;
    }
    if (request.light >= std::max<std::size_t>(start_.lights.size(), 1))
        throw UsageError(fmt::format("light {}, of which there are {}", request.light, start_.lights.size()));
    for (const PlacedLight& light : request.lights)
        if (light.light >= start_.lights.size())
            throw UsageError(fmt::format("light {}, of which there are {}", light.light, start_.lights.size()));
    for (const PlacedObject& object : request.objects)
        if (object.object >= start_.objects.size() || !movable_[object.object])
            throw UsageError(fmt::format("object {} cannot be moved", object.object));
    const bool first = moved.all || now_.width == 0;
    moved.all        = first;
    moved.lights.assign(scene_.lights.size(), first);
    moved.objects = first || request.objects != now_.objects;
    moved.camera  = first || request.eye != now_.eye || request.target != now_.target || request.width != now_.width ||
                   request.height != now_.height;

    // A light that nobody places stands as the file has it, or as the camera carries it.
    std::vector<Light> lights = start_.lights;
    for (const PlacedLight& placed : request.lights)
        place_light(lights[placed.light], start_.lights[placed.light], placed);
    if (vector_of(request.eye) == vector_of(request.target))
        throw UsageError("the eye is at its target, expected another place");
    now_.width = 0;                    // what throws from here on leaves a state of which nothing is known
    std::swap(scene_.lights, lights);  // `lights` has the poses before
    scene_.camera.eye = vector_of(request.eye), scene_.camera.target = vector_of(request.target);
    place_fixed_lights(scene_);
    for (std::size_t j = 0; j < lights.size(); ++j) {
        const Light &a = lights[j], &b = scene_.lights[j];
        moved.lights[j] = first || a.position != b.position || a.direction != b.direction || a.radius != b.radius ||
                          a.edge_u != b.edge_u || a.edge_v != b.edge_v;
    }
    if (moved.objects) {
        scene_.positions = start_.positions;
        scene_.normals   = start_.normals;
        for (const PlacedObject& placed : request.objects) place_object(placed);
    }
    facts_ms_                 = timed_ms([&] {
        if (moved.objects)
            facts_ = find_facts(scene_);
        else if (moved.camera || std::ranges::find(moved.lights, true) != moved.lights.end())
            update_view_facts(scene_, facts_);
    });
    points_ms_                = timed_ms([&] {
        if (moved.objects) rays_.emplace(scene_);
        if (moved.camera || moved.objects)
            primary_points(*rays_, scene_, scene_.camera, static_cast<int>(request.width),
                                          static_cast<int>(request.height), points_);
        else
            for (LightId j = 0; j < scene_.lights.size(); ++j)
                if (moved.lights[j]) face_light(points_, scene_, j);
    });
    const std::uint64_t frame = now_.frame;
    now_                      = request;
    now_.frame                = frame;
    return moved;
}

}  // namespace umbra
