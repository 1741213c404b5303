#include "umbra/bench/sweep/views.h"

#include <glm/gtc/quaternion.hpp>

#include <cmath>

#include "umbra/core/base/random_bits.h"
#include "umbra/core/render/ray.h"

namespace umbra {
namespace {

/// Numbers in [-1, 1), a sequence a view.
class Draw {
public:
    explicit Draw(int view) : state_(mixed_bits(static_cast<std::uint64_t>(view))) {}
    double next() {
        state_ = mixed_bits(state_);
        return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
    }

private:
    std::uint64_t state_;
};

dvec3 turned(dvec3 v, dvec3 axis, double degrees) {
    return glm::angleAxis(glm::radians(degrees), glm::normalize(axis)) * v;
}

/// Some vector across `d`.
dvec3 across(dvec3 d) {
    const dvec3 other = std::abs(d.x) < std::abs(d.y) ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    return glm::normalize(glm::cross(d, other));
}

/// Whether the segment meets no triangle.
bool is_free(const RayScene& rays, vec3 from, vec3 to) {
    const vec3 origin = rays.space().point(from);
    const vec3 path   = rays.space().vector(dvec3(to) - dvec3(from));
    ShadowPacket packet;
    packet.org_x[0] = origin.x, packet.org_y[0] = origin.y, packet.org_z[0] = origin.z;
    packet.dir_x[0] = path.x, packet.dir_y[0] = path.y, packet.dir_z[0] = path.z;
    packet.tnear[0] = 0, packet.tfar[0] = 1.001f;
    packet.id[0]    = kNoTriangle;
    packet.valid[0] = -1;
    const FlushDenormals flush;
    rays.occluded(packet);
    return packet.tfar[0] >= 0;
}

/// The farthest of the places `at(1)`, `at(1/2)`, ... that can be reached from `from`; `from` where none can.
template <class Path>
vec3 reachable(const RayScene& rays, vec3 from, const Path& at) {
    for (double share = 1; share > 0.05; share /= 2)
        if (const vec3 to = vec3(at(share)); is_free(rays, from, to)) return to;
    return from;
}

void move_camera(Camera& camera, const RayScene& rays, Draw& draw) {
    const double yaw = kJitterYaw * draw.next(), pitch = kJitterPitch * draw.next();
    const dvec3 target(camera.target), arm             = dvec3(camera.eye) - target;
    const dvec3 up(camera.up);
    const dvec3 side = glm::cross(up, arm);
    if (glm::dot(side, side) == 0) return;  // looks along its up vector
    camera.eye = reachable(rays, camera.eye, [&](double share) {
        return target + turned(turned(arm, side, pitch * share), up, yaw * share);
    });
}

void move_light(Light& light, dvec3 middle, const RayScene& rays, Draw& draw) {
    const double a = draw.next(), b = draw.next(), c = draw.next();
    if (light.kind == LightKind::directional || light.kind == LightKind::spot) {
        const dvec3 d(light.direction), side = across(d);
        light.direction = vec3(turned(turned(d, side, kJitterSun * a), d, 180 * b));
        if (light.kind == LightKind::spot) light.direction = glm::normalize(light.direction);
    }
    if (light.kind == LightKind::directional) return;
    const double reach = kJitterLight * glm::length(dvec3(light.position) - middle);
    light.position     = reachable(rays, light.position,
                                   [&](double share) { return dvec3(light.position) + reach * share * dvec3(a, b, c); });
}

}  // namespace

Scene view_of(const Scene& scene, int view, const RayScene* rays) {
    Scene moved = scene;
    if (view == 0) return moved;
    if (rays == nullptr) {
        const RayScene own(scene);
        return view_of(scene, view, &own);
    }
    const Box box      = bounds(scene);
    const dvec3 middle = 0.5 * (dvec3(box.min) + dvec3(box.max));
    Draw draw(view);
    move_camera(moved.camera, *rays, draw);
    place_fixed_lights(moved);
    for (Light& light : moved.lights)
        if (!light.camera_pose) move_light(light, middle, *rays, draw);
    return moved;
}

}  // namespace umbra
