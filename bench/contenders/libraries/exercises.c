/* Ten shadow methods that are wrong in one known way each, for students to find out how (docs/exercises.md). Number 0 is the
 * right one: the segments of rays.c, in which the faults are planted. What each number does wrong is in
 * docs/exercises_solutions.md and below, so hand out the library, not this file.
 *
 *     cc -std=c11 -O2 -shared -fPIC -I bench/contenders/include bench/contenders/libraries/exercises.c -lm -o libexercises.so
 *     ./umbra compare stairs --plugin ./libexercises.so --methods exercise:number=1 -o out */
#include "umbra/contender.h" /* before its entry gets another name, or the library does not export its own */

#define umbra_contender rays_contender
#include "rays.c"
#undef umbra_contender

enum { NUMBER, EXERCISE_SAMPLES, EXERCISE_SEED };

enum fault {
    NONE,
    ONE_TRIANGLE_IN_THREE,
    BIAS_TOO_LARGE,
    ONE_SEED_FOR_ALL,
    NEAR_PLANE_TOO_FAR,
    CENTRE_OF_THE_LIGHT,
    BIAS_OF_THE_WRONG_SIGN,
    LIGHT_TOO_SMALL,
    NO_END_AT_THE_LIGHT,
    COARSE_MAP,
    NORMALS_NOT_TRANSFORMED
};
static const enum fault faults[] = {
    NONE,           NO_END_AT_THE_LIGHT,   ONE_SEED_FOR_ALL,        BIAS_OF_THE_WRONG_SIGN,
    COARSE_MAP,     ONE_TRIANGLE_IN_THREE, NORMALS_NOT_TRANSFORMED, CENTRE_OF_THE_LIGHT,
    BIAS_TOO_LARGE, LIGHT_TOO_SMALL,       NEAR_PLANE_TOO_FAR};

static double length(vec a) { return sqrt(dot(a, a)); }

/* The point as a map of few texels has it: moved across the way to the light, on its own plane, to the texel's centre. */
static vec in_coarse_map(vec p, vec n, vec d, double texel) {
    const vec w = unit(d), s = unit(cross(w, fabs(w.x) < 0.6 ? (vec){1, 0, 0} : (vec){0, 1, 0})), t = cross(s, w);
    const double x = dot(p, s), y = dot(p, t);
    const vec moved = plus(plus(p, (floor(x / texel) + 0.5) * texel - x, s), (floor(y / texel) + 0.5) * texel - y, t);
    const double slope = dot(n, w);
    return fabs(slope) < 0.05 ? p : plus(moved, dot(n, plus(p, -1, moved)) / slope, w);
}

static int is_occluded(enum fault fault, const umbra_scene* scene, size_t own, vec p, vec n, vec d, int endless) {
    const double diagonal = length(plus(vec_of(scene->high), -1, vec_of(scene->low)));
    if (fault == NORMALS_NOT_TRANSFORMED) n.z = -n.z;
    if (dot(d, n) <= 0) return 1;
    double from = 0, to = endless ? 1e30 : 1;
    if (fault == BIAS_OF_THE_WRONG_SIGN) from = -0.002 * diagonal / length(d);
    if (fault == BIAS_TOO_LARGE) from = 0.1 * diagonal / length(d);
    if (fault == NO_END_AT_THE_LIGHT) endless = 1;
    if (fault == NEAR_PLANE_TOO_FAR) to = endless ? 1e30 : 1 - 0.28 * diagonal / length(d);
    if (fault == COARSE_MAP) p = in_coarse_map(p, n, d, diagonal / 128);
    if (from >= to) return 0; /* the segment begins behind its end */
    p = plus(p, from, d);
    d = endless ? d : plus((vec){0, 0, 0}, to - from, d);
    for (size_t t = 0; t < scene->triangles; ++t) {
        if ((t == own && fault != BIAS_OF_THE_WRONG_SIGN) || !scene->blocks[t]) continue;
        if (fault == ONE_TRIANGLE_IN_THREE && t % 3 != 0) continue;
        if (occludes(scene, t, p, d, endless)) return 1;
    }
    return 0;
}

static int faulty_visibility(const umbra_question* question, size_t begin, size_t end, float* s, char* why) {
    const umbra_scene* scene   = question->scene;
    const umbra_points* points = question->points;
    const umbra_setting* set   = question->settings;
    const enum fault fault     = faults[(int)set[NUMBER].number];
    const int hard             = question->light->kind & UMBRA_HARD;
    const int side             = hard ? 1 : (int)sqrt(set[EXERCISE_SAMPLES].number);
    (void)why;
    for (size_t i = begin; i < end; ++i) {
        if (!question->asked[i]) continue;
        const size_t own      = points->triangle[i];
        const vec p           = point(scene, points, i);
        const vec n           = {points->nx[i], points->ny[i], points->nz[i]};
        const uint64_t number = fault == ONE_SEED_FOR_ALL ? 0 : (uint64_t)(points->number ? points->number[i] : i);
        uint64_t state        = ((uint64_t)set[EXERCISE_SEED].number << 40) + (number << 16);
        int seen              = 0;
        for (int k = 0; k < side * side; ++k) {
            double x = next_random(&state), y = next_random(&state);
            x = (k % side + x) / side, y = (k / side + y) / side;
            if (fault == CENTRE_OF_THE_LIGHT && !hard) x = y = question->light->kind == UMBRA_DISK ? 0 : 0.5;
            if (fault == LIGHT_TOO_SMALL && question->light->kind == UMBRA_RECTANGLE)
                x = 0.25 + x / 2, y = 0.25 + y / 2;
            if (fault == LIGHT_TOO_SMALL && question->light->kind == UMBRA_DISK) x /= 4; /* half of the radius */
            const vec d = to_light(question->light, p, x, y);
            seen += !is_occluded(fault, scene, own, p, n, d, question->light->kind == UMBRA_DIRECTIONAL);
        }
        s[i] = (float)seen / (float)(side * side);
    }
    return 1;
}

const umbra_contender_info* umbra_contender(void) {
    static umbra_parameter all[]           = {[NUMBER]        = {.name     = "number",
                                                                 .type     = UMBRA_INTEGER,
                                                                 .fallback = "0",
                                                                 .max      = 10,
                                                                 .doc      = "Number of the exercise, 1 to 10."},
                                              [EXERCISE_SEED] = {.name = ""}};
    all[EXERCISE_SAMPLES]                  = parameters[SAMPLES];
    all[EXERCISE_SEED]                     = parameters[SEED];
    static const umbra_contender_info info = {
        .version         = UMBRA_CONTENDER_VERSION,
        .lights          = UMBRA_HARD | UMBRA_RECTANGLE | UMBRA_DISK,
        .flags           = UMBRA_THREADS,
        .parameter_count = sizeof all / sizeof *all,
        .parameters      = all,
        .name            = "exercise",
        .title           = "Exercise",
        .release         = "1",
        .summary         = "A shadow method that is wrong in one way. Which?",
        .seed            = "seed",
        .visibility      = faulty_visibility,
    };
    return &info;
}
