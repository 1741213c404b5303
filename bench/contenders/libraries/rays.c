/* Rays: a contender as a shared library in C, to start from. Segments from each point to the light against all
 * triangles, in double precision; no packages, no hierarchy: points x samples x triangles, 5 to 10 ns each.
 *
 *     cc -std=c11 -O2 -shared -fPIC -I bench/contenders/include bench/contenders/libraries/rays.c -lm -o librays.so
 *     ./umbra contender check --plugin ./librays.so rays
 *
 * The test is that of Moeller and Trumbore (Fast, Minimum Storage Ray/Triangle Intersection, 1997).
 *
 * Traps: a point's own triangle and what the segment meets at its two ends do not occlude it; edges belong to the
 * triangles at both sides, or light leaks between them; the part of a light behind the point's plane is not seen,
 * though the share is of the whole light; random numbers come of seed and point, not of the order of calls. */
#include <math.h>

#include "umbra/contender.h"

#define END 1e-9   /* of a segment */
#define EDGE 1e-12 /* of a triangle */

typedef struct vec {
    double x, y, z;
} vec;

static vec vec_of(const float* p) { return (vec){p[0], p[1], p[2]}; }
static vec plus(vec a, double s, vec b) { return (vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z}; } /* a + s b */
static double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross(vec a, vec b) { return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
static vec unit(vec a) { return plus((vec){0, 0, 0}, 1 / sqrt(dot(a, a)), a); }

/* A corner of a triangle, 0 to 2. */
static vec corner(const umbra_scene* scene, size_t triangle, int k) {
    return vec_of(scene->positions + 3 * (size_t)scene->corners[3 * triangle + (size_t)k]);
}

static vec point(const umbra_scene* scene, const umbra_points* points, size_t i) {
    const size_t own = points->triangle[i];
    const double u = points->u[i], v = points->v[i];
    const vec a = corner(scene, own, 0), b = corner(scene, own, 1), c = corner(scene, own, 2);
    return plus(plus(plus((vec){0, 0, 0}, 1 - u - v, a), u, b), v, c);
}

/* Whether the triangle lies between p and p + d; d is infinitely long where there is no light at its end. */
static int occludes(const umbra_scene* scene, size_t triangle, vec p, vec d, int endless) {
    const vec a = corner(scene, triangle, 0);
    const vec e = plus(corner(scene, triangle, 1), -1, a), f = plus(corner(scene, triangle, 2), -1, a);
    const vec o = plus(p, -1, a), h = cross(d, f), q = cross(o, e);
    const double det = dot(e, h); /* 0 where it is seen edge-on: what follows is infinite or NaN, which is no hit */
    const double u = dot(o, h) / det, v = dot(d, q) / det, t = dot(f, q) / det;
    return u >= -EDGE && v >= -EDGE && u + v <= 1 + EDGE && t > END && (endless || t < 1 - END);
}

/* A random number from 0 to 1 (splitmix64), and the next state. */
static double next_random(uint64_t* state) {
    uint64_t x = *state += 0x9e3779b97f4a7c15u;
    x          = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x          = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

/* From p to the point of the light that (x, y) of the unit square stands for. */
static vec to_light(const umbra_light* light, vec p, double x, double y) {
    if (light->kind == UMBRA_DIRECTIONAL) return plus((vec){0, 0, 0}, -1, vec_of(light->direction));
    vec d = plus(vec_of(light->position), -1, p);
    if (light->kind == UMBRA_RECTANGLE) {
        d = plus(plus(d, x - 0.5, vec_of(light->edge_u)), y - 0.5, vec_of(light->edge_v));
    } else if (light->kind == UMBRA_DISK) {
        const vec axis = unit(vec_of(light->direction));
        const vec s = unit(cross(axis, fabs(axis.x) < 0.6 ? (vec){1, 0, 0} : (vec){0, 1, 0})), t = cross(axis, s);
        const double r = light->radius * sqrt(x), angle = 2 * 3.14159265358979323846 * y;
        d = plus(plus(d, r * cos(angle), s), r * sin(angle), t);
    }
    return d;
}

enum { SAMPLES, SEED }; /* places of parameters and settings */

static int visibility(const umbra_question* question, size_t begin, size_t end, float* s, char* why) {
    const umbra_scene* scene   = question->scene;
    const umbra_light* light   = question->light;
    const umbra_points* points = question->points;
    const umbra_setting* set   = question->settings;
    const int side             = light->kind & UMBRA_HARD ? 1 : (int)sqrt(set[SAMPLES].number);
    (void)why; /* where umbra_fail would say what went wrong */
    for (size_t i = begin; i < end; ++i) {
        if (!question->asked[i]) continue;
        const size_t own = points->triangle[i];
        const vec p      = point(scene, points, i);
        const vec n      = {points->nx[i], points->ny[i], points->nz[i]};
        uint64_t state =
            ((uint64_t)set[SEED].number << 40) + ((uint64_t)(points->number ? points->number[i] : i) << 16);
        int seen = 0;
        for (int k = 0; k < side * side; ++k) { /* one sample in each of side x side strata */
            const double x = (k % side + next_random(&state)) / side, y = (k / side + next_random(&state)) / side;
            const vec d  = to_light(light, p, x, y);
            int occluded = dot(d, n) <= 0; /* behind the point's plane */
            for (size_t t = 0; t < scene->triangles && !occluded; ++t)
                occluded = t != own && scene->blocks[t] && occludes(scene, t, p, d, light->kind == UMBRA_DIRECTIONAL);
            seen += !occluded;
        }
        s[i] = (float)seen / (float)(side * side);
    }
    return 1;
}

static const umbra_parameter parameters[] = {
    [SAMPLES] = {.name     = "samples",
                 .type     = UMBRA_INTEGER,
                 .fallback = "16",
                 .min      = 1,
                 .max      = 4096,
                 .sweep    = "4|16|64",
                 .doc      = "Segments from a point to an area light: 16 are 4 x 4 strata."},
    [SEED]    = {.name     = "seed",
                 .type     = UMBRA_INTEGER,
                 .fallback = "1",
                 .max      = 1000000,
                 .doc      = "Picks the place of each sample in its stratum."},
};

const umbra_contender_info* umbra_contender(void) {
    static const umbra_contender_info info = {
        .version         = UMBRA_CONTENDER_VERSION,
        .lights          = UMBRA_HARD | UMBRA_RECTANGLE | UMBRA_DISK,
        .flags           = UMBRA_THREADS,
        .parameter_count = sizeof parameters / sizeof *parameters,
        .parameters      = parameters,
        .name            = "rays",
        .title           = "Rays in C",
        .release         = "1",
        .summary         = "Segments against all triangles, in double precision; stratified samples of area lights.",
        .seed            = "seed",
        .visibility      = visibility,
    };
    return &info;
}
