/* Embree: the bare loop over rtcOccluded1 that most programs have, in float. What its precision costs is what this
 * contender is for; the method `ray_traced` uses Embree, too, but leaves the point's own triangle out and repairs what
 * float decides wrongly.
 *
 * Needs Embree 3 or 4 (Debian: libembree-dev).
 *
 * Traps: Embree reads 16 bytes of the last vertex, so the host's buffer cannot be shared, and is copied into one of
 * Embree's; without `robust` light may leak through edges; triangles that do not block are left out. */
#if __has_include(<embree4/rtcore.h>) /* the order of CMakeLists.txt */
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <stdlib.h>
#include <string.h>

#include "ray_loop.h"

typedef struct tree {
    ray_tree loop;
    RTCDevice device;
    RTCScene scene;
} tree;

static int occluded(const ray_tree* loop, const ray_segment* r) {
    struct RTCRay ray = {.org_x = r->from.x,
                         .org_y = r->from.y,
                         .org_z = r->from.z,
                         .tnear = r->start,
                         .dir_x = r->direction.x,
                         .dir_y = r->direction.y,
                         .dir_z = r->direction.z,
                         .tfar  = r->end,
                         .mask  = ~0u};
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded1(((const tree*)loop)->scene, &ray, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(((const tree*)loop)->scene, &context, &ray);
#endif
    return ray.tfar < 0;
}

static void drop_built(void* built) {
    tree* t = built;
    rtcReleaseScene(t->scene);
    rtcReleaseDevice(t->device);
    free(t);
}

static int build(const umbra_question* question, void** built, char* why) {
    const umbra_scene* scene = question->scene;
    const int robust         = question->settings[RAY_PARAMETERS].number != 0;
    tree* t                  = calloc(1, sizeof *t);
    if (t == NULL) return umbra_fail(why, "out of memory");
    t->loop.occluded     = occluded;
    t->device            = rtcNewDevice(NULL);
    t->scene             = rtcNewScene(t->device);
    RTCGeometry geometry = rtcNewGeometry(t->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float* positions     = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                   3 * sizeof(float), scene->vertices);
    size_t kept          = 0;
    for (size_t i = 0; i < scene->triangles; ++i) kept += scene->blocks[i];
    uint32_t* corners =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), kept);
    if (positions != NULL && corners != NULL) {
        memcpy(positions, scene->positions, 3 * sizeof(float) * scene->vertices);
        for (size_t i = 0; i < scene->triangles; ++i)
            if (scene->blocks[i]) memcpy(corners, scene->corners + 3 * i, 3 * sizeof(uint32_t)), corners += 3;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(t->scene, geometry);
    }
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(t->scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcCommitScene(t->scene);
    if (rtcGetDeviceError(t->device) != RTC_ERROR_NONE) {
        drop_built(t);
        return umbra_fail(why, "Embree could not build its tree");
    }
    *built = t;
    return 1;
}

static const umbra_parameter parameters[] = {
    RAY_LOOP_PARAMETERS,
    {"robust", "false", 0, 0, NULL, "RTC_SCENE_FLAG_ROBUST: no light leaks through edges.", "false|true", "build",
     UMBRA_BOOLEAN},
};

const umbra_contender_info* umbra_contender(void) {
    static const umbra_contender_info info = {
        .version         = UMBRA_CONTENDER_VERSION,
        .lights          = UMBRA_HARD | UMBRA_RECTANGLE | UMBRA_DISK | UMBRA_SPHERE,
        .flags           = UMBRA_THREADS,
        .parameter_count = sizeof parameters / sizeof *parameters,
        .parameters      = parameters,
        .name            = "embree",
        .title           = "Embree, bare",
        .release         = RTC_VERSION_STRING,
        .summary         = "rtcOccluded1 for each ray, in float, with an epsilon.",
        .seed            = "seed",
        .build           = build,
        .visibility      = ray_visibility,
        .drop_built      = drop_built,
    };
    return &info;
}
