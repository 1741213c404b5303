/* What loops over shadow rays in float have in common, whatever the tree: the parameters, the samples of lights, the
 * epsilons. A library brings a ray_tree, made by its build, and the parameters that it has besides; aim and look have
 * nothing to do.
 *
 * A ray leaves the point as the host has rounded it to float, `offset` above its triangle, and sees what lies farther
 * than `tnear` from there and farther than `tnear` from the light; both are fractions of the scene's diagonal. No
 * triangle is left out, not even the point's own: that is the usual loop of renderers, and its errors are what is
 * measured here. */
#ifndef RAY_LOOP_H
#define RAY_LOOP_H

#include <math.h>

#include "umbra/contender.h"

typedef struct ray_vec {
    float x, y, z;
} ray_vec;

typedef struct ray_segment {
    ray_vec from, direction; /* of unit length */
    float start, end;        /* distances between which it is occluded */
} ray_segment;

/* The first member of what build makes. */
typedef struct ray_tree {
    int (*occluded)(const struct ray_tree* tree, const ray_segment* r);
} ray_tree;

enum { RAY_SAMPLES, RAY_SEED, RAY_TNEAR, RAY_OFFSET, RAY_PARAMETERS };

/* First in a list of umbra_parameter. */
/* clang-format off */
#define RAY_LOOP_PARAMETERS \
    {"samples", "16", 1, 65536, NULL, "Rays from a point to an area light: 16 are 4 x 4 strata.", "1|4|16|64", NULL, \
     UMBRA_INTEGER}, \
    {"seed", "1", 0, 1000000, NULL, "Picks the place of each sample in its stratum.", NULL, NULL, UMBRA_INTEGER}, \
    {"tnear", "1e-4", 0, 1, NULL, "How far a ray goes before anything occludes it, in diagonals of the scene.", \
     "0|1e-6|1e-5|1e-4|1e-3", NULL, UMBRA_REAL}, \
    {"offset", "0", 0, 1, NULL, "How far above its triangle a ray starts, in diagonals of the scene.", \
     "0|1e-6|1e-5|1e-4|1e-3", NULL, UMBRA_REAL}
/* clang-format on */

static inline ray_vec ray_vec_of(const float* p) {
    const ray_vec v = {p[0], p[1], p[2]};
    return v;
}

static inline ray_vec ray_plus(ray_vec a, float s, ray_vec b) { /* a + s b */
    const ray_vec v = {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
    return v;
}

static inline ray_vec ray_cross(ray_vec a, ray_vec b) {
    const ray_vec v = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return v;
}

static inline float ray_dot(ray_vec a, ray_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline float ray_length(ray_vec a) { return sqrtf(ray_dot(a, a)); }

static inline ray_vec ray_scaled(float s, ray_vec a) {
    const ray_vec v = {s * a.x, s * a.y, s * a.z};
    return v;
}

/* Mixes the bits of a number. */
static inline uint32_t ray_hash(uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

static inline float ray_random(uint32_t* state) { /* from 0 to below 1 */
    *state += 0x9e3779b9u;
    return (float)(ray_hash(*state) >> 8) * 0x1p-24f;
}

/* From p to the point of the light that (x, y) of the unit square stands for. */
static inline ray_vec ray_to_light(const umbra_light* light, ray_vec p, float x, float y) {
    if (light->kind == UMBRA_DIRECTIONAL) return ray_scaled(-1, ray_vec_of(light->direction));
    ray_vec d = ray_plus(ray_vec_of(light->position), -1, p);
    if (light->kind & UMBRA_HARD) return d;
    if (light->kind == UMBRA_RECTANGLE)
        return ray_plus(ray_plus(d, x - 0.5f, ray_vec_of(light->edge_u)), y - 0.5f, ray_vec_of(light->edge_v));
    ray_vec axis = ray_vec_of(light->direction);
    float radius = light->radius;
    if (light->kind == UMBRA_SPHERE) { /* the disk in which the cone of tangents touches it */
        const float share = radius * radius / ray_dot(d, d);
        axis              = d;
        d                 = ray_scaled(1 - share, d);
        radius *= sqrtf(1 - share);
    }
    axis                = ray_scaled(1 / ray_length(axis), axis);
    const ray_vec other = {fabsf(axis.x) < 0.6f ? 1.0f : 0.0f, fabsf(axis.x) < 0.6f ? 0.0f : 1.0f, 0};
    ray_vec s           = ray_cross(axis, other);
    s                   = ray_scaled(1 / ray_length(s), s);
    const float r = radius * sqrtf(x), angle = 6.2831853f * y;
    return ray_plus(ray_plus(d, r * cosf(angle), s), r * sinf(angle), ray_cross(axis, s));
}

static inline int ray_visibility(const umbra_question* question, size_t begin, size_t end, float* s, char* why) {
    const umbra_scene* scene   = question->scene;
    const umbra_light* light   = question->light;
    const umbra_points* points = question->points;
    const umbra_setting* set   = question->settings;
    const ray_tree* tree       = (const ray_tree*)question->built;
    const int side             = light->kind & UMBRA_HARD ? 1 : (int)sqrt(set[RAY_SAMPLES].number);
    const float diagonal       = ray_length(ray_plus(ray_vec_of(scene->high), -1, ray_vec_of(scene->low)));
    const float tnear = diagonal * (float)set[RAY_TNEAR].number, offset = diagonal * (float)set[RAY_OFFSET].number;
    (void)why;
    for (size_t i = begin; i < end; ++i) {
        if (!question->asked[i]) continue;
        const ray_vec n = {points->nx[i], points->ny[i], points->nz[i]};
        const ray_vec p = {points->x[i], points->y[i], points->z[i]};
        ray_segment r   = {ray_plus(p, offset, n), n, tnear, 0};
        uint32_t state  = ray_hash((uint32_t)(points->number ? points->number[i] : i) + 1);
        state           = ray_hash(state + (uint32_t)set[RAY_SEED].number);
        int seen        = 0;
        for (int k = 0; k < side * side; ++k) {
            const float x      = ((float)(k % side) + ray_random(&state)) / (float)side;
            const float y      = ((float)(k / side) + ray_random(&state)) / (float)side;
            const ray_vec d    = ray_to_light(light, r.from, x, y);
            const float length = ray_length(d);
            if (side > 1 && ray_dot(d, n) <= 0) continue; /* this part of the light is behind the point's plane */
            r.direction = ray_scaled(1 / length, d);
            r.end       = light->kind == UMBRA_DIRECTIONAL ? 1e30f : length - tnear;
            seen += !tree->occluded(tree, &r);
        }
        s[i] = (float)seen / (float)(side * side);
    }
    return 1;
}

#endif
