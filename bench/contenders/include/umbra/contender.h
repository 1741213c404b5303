/* A contender as a shared library, in C: which fraction S_j of a light do these surface points see?
 *
 * The library exports one function, umbra_contender(), whose answer says what it is and which functions serve each phase.
 * docs/contenders.md, "A library", follows one from the first line to the first table; this file needs nothing else.
 *
 * Memory. What the host hands over (scene, light, points, settings) is the host's own, without copies: it lives and does
 * not move until the value that was made of it is dropped (the struct umbra_question alone ends with the call). What the
 * library keeps stands behind the pointers that build, aim and look give; the host hands them back, and drops them when it
 * needs them no more. A value serves several questions: a light is aimed at once, and asked for several pictures.
 *
 * Threads. One call at a time, whatever the thread; with UMBRA_THREADS, `visibility` is called by several threads at once,
 * each for points of its own.
 *
 * Failures. A function that cannot serve writes why into `why` (umbra_fail) and returns 0; that costs this cell of the
 * table. What crashes takes the whole program with it. */
#ifndef UMBRA_CONTENDER_H
#define UMBRA_CONTENDER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Of this file: structs gain members at their ends, and then only with another version. */
#define UMBRA_CONTENDER_VERSION 1

#define UMBRA_NO_TRIANGLE 4294967295u /* of a point where the eye sees no surface; it is never asked */
#define UMBRA_WHY 256                 /* bytes of the text of a failure, its end included */

/* Kinds of lights, as bits. */
enum {
    UMBRA_DIRECTIONAL = 1,
    UMBRA_POINT       = 2,
    UMBRA_SPOT        = 4,
    UMBRA_RECTANGLE   = 8,
    UMBRA_DISK        = 16,
    UMBRA_SPHERE      = 32,
    UMBRA_HARD        = 7 /* those without an area */
};

/* Bits of umbra_contender_info::flags. */
enum {
    UMBRA_IRRADIANCE = 1, /* it answers shares of the irradiance of area lights; else of their area */
    UMBRA_THREADS    = 2  /* visibility may be called by several threads at once */
};

/* A triangle mesh in world space, right-handed, y up. */
typedef struct umbra_scene {
    size_t vertices, triangles;
    const float* positions;  /* 3 a vertex */
    const uint32_t* corners; /* 3 a triangle: vertices, anticlockwise seen from outside */
    const uint32_t* object;  /* 1 a triangle: the object that it belongs to */
    const uint8_t* blocks;   /* 1 a triangle: 1 where it takes all light that meets it; 0: leave it out */
    float low[3], high[3];   /* bounds of all triangles */
} umbra_scene;

/* World space. Members that the kind does not have are 0. Neither intensity nor a spot's cone matters to S_j. */
typedef struct umbra_light {
    uint32_t kind;      /* one of the bits above */
    float position[3];  /* all but directional; of area lights the centre */
    float direction[3]; /* directional: where the light travels to, any length; spot: its axis; disk: its normal */
    float edge_u[3];    /* rectangle: position + s edge_u + t edge_v, s and t from -1/2 to 1/2 */
    float edge_v[3];
    float radius; /* disk, sphere */
    float cutoff; /* spot: half angle of the cone, radians */
} umbra_light;

/* Pixel centres at (column + 1/2, row + 1/2), rows from the top. The ray of a picture's place (x, y), each from -1 to 1, right
 * and up, is eye + t (forward + x half_width right + y half_height up); where orthographic is 1 it is
 * eye + x half_width right + y half_height up + t forward. */
typedef struct umbra_camera {
    double eye[3], forward[3], right[3], up[3]; /* world space, of unit length but for eye */
    double half_width, half_height;
    int orthographic;
} umbra_camera;

/* Surface points, structure of arrays. Point i is (1 - u - v) a + u b + v c of its triangle, exactly; x, y, z is that rounded to
 * float. Normals are geometric, of unit length, towards the eye where the material is two-sided. */
typedef struct umbra_points {
    size_t count;
    const uint32_t* triangle; /* or UMBRA_NO_TRIANGLE */
    const float *u, *v;
    const float *x, *y, *z;
    const float *nx, *ny, *nz;
    const size_t* number; /* what random numbers of a point depend on; NULL: its place here */
    /* Of a picture whose point i is pixel (i % width, i / width), rows from the top; 0: of none. */
    uint32_t width, height;
    umbra_camera camera; /* of that picture */
} umbra_points;

/* The value of one parameter; settings have one for each parameter, in the order of umbra_contender_info::parameters. */
typedef struct umbra_setting {
    double number;    /* real, integer; boolean: 0 or 1; choice: the place in its list */
    const char* text; /* choice, text; else "" */
} umbra_setting;

enum { UMBRA_INTEGER = 0, UMBRA_REAL = 1, UMBRA_CHOICE = 2, UMBRA_BOOLEAN = 3, UMBRA_TEXT = 4 };

/* A parameter as a user sets it: --methods NAME:samples=64. Members that are 0 or NULL are not given. */
typedef struct umbra_parameter {
    const char* name;     /* letters, digits, underscores */
    const char* fallback; /* as typed: "16", "pcf", "true"; needed */
    double min, max;      /* integer, real; both 0: no limits */
    const char* choices;  /* choice: "a|b|c" */
    const char* doc;      /* one sentence */
    const char* sweep;    /* values that a sweep tries: "1|4|16" */
    const char* phase;    /* the first phase that depends on it: "build", "aim", "look", "visibility" (where NULL) */
    uint32_t type;        /* UMBRA_INTEGER, ... */
} umbra_parameter;

/* What is asked, as far as a phase knows it: build has scene and settings; aim also built and light; look built and points; visibility
 * all. Others are NULL. */
typedef struct umbra_question {
    const umbra_scene* scene;
    const umbra_light* light;
    const umbra_points* points;
    const umbra_setting* settings;      /* one a parameter */
    const void *built, *aimed, *looked; /* what the phases before have made */
    const uint8_t* asked; /* 1 a point: 1 where its answer counts: some of the light is in front of its triangle */
} umbra_question;

/* All members that are pointers may be NULL, but for those that are marked. Functions return 1, or 0 after umbra_fail. */
typedef struct umbra_contender_info {
    uint32_t version; /* UMBRA_CONTENDER_VERSION */
    uint32_t lights;  /* bits of the kinds that it serves; not 0 */
    uint32_t flags;
    uint32_t parameter_count;
    const umbra_parameter* parameters;
    const char* name;    /* needed: what --methods calls it: letters, digits, underscores */
    const char* title;   /* needed: what people call it */
    const char* release; /* needed: its own version, "2.1" */
    const char* summary; /* one sentence */
    const char* seed;    /* the parameter that seeds its noise; NULL: the same question has the same answer */

    /* Make what depends on geometry alone; on one light; on the surface points, for all lights. Each is timed apart. */
    int (*build)(const umbra_question* question, void** built, char* why);
    int (*aim)(const umbra_question* question, void** aimed, char* why);
    int (*look)(const umbra_question* question, void** looked, char* why);
    /* Needed. Writes s[i] for i from `begin` to before `end` where asked[i] is 1: the fraction of the light that point i sees,
     * 0 to 1; NaN where it cannot tell. */
    int (*visibility)(const umbra_question* question, size_t begin, size_t end, float* s, char* why);
    /* Called once for each value that was made, not NULL; aimed and looked before their built. */
    void (*drop_built)(void* built);
    void (*drop_aimed)(void* aimed);
    void (*drop_looked)(void* looked);
} umbra_contender_info;

/* What the library exports. The answer lives as long as the library. */
#if defined(_WIN32)
__declspec(dllexport)
#else
__attribute__((visibility("default")))
#endif
    const umbra_contender_info* umbra_contender(void);

/* Says why, and returns 0. */
static inline int umbra_fail(char* why, const char* text) {
    size_t i = 0;
    for (; text[i] != '\0' && i + 1 < UMBRA_WHY; ++i) why[i] = text[i];
    why[i] = '\0';
    return 0;
}

#ifdef __cplusplus
}
#endif

#endif
