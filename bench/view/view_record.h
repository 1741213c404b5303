// What `umbra view` answers to its pages, as records.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/point_answer.h"

namespace umbra {

struct ViewedLightRecord {
    std::string name{}, kind{};
    std::vector<double> position{}, direction{};
    double extent = 0;
    bool fixed    = false;
};
DESCRIBE(ViewedLightRecord) {
    MEMBERS(name, kind);
    of(MEMBER(position), "", kThreeNumbers);
    of(MEMBER(direction), "", kThreeNumbers);
    of(MEMBER(extent), "radius, or half of the longer edge; 0 for lights without an area");
    of(MEMBER(fixed), "to the camera");
}

struct ViewedObjectRecord {
    std::string name{};
    bool movable = false;
    std::vector<double> middle{};
};
DESCRIBE(ViewedObjectRecord) {
    MEMBERS(name, movable);
    of(MEMBER(middle), "of its box", kThreeNumbers);
}

/// The scene as its file has it, and the methods that there are.
struct ViewedSceneRecord {
    std::string name{}, title{}, shows{};
    std::uint64_t width = 0, height = 0, frames = 0, triangles = 0;
    std::vector<double> eye{}, target{}, up{}, low{}, high{};
    bool orthographic = false;
    double half_width = 0, half_height = 0;
    std::vector<ViewedLightRecord> lights{};
    std::vector<ViewedObjectRecord> objects{};
    std::vector<MethodInfoRecord> methods{};
    std::vector<std::string> chosen{}, warnings{};
    std::string command{};
};
DESCRIBE(ViewedSceneRecord) {
    MEMBERS(name, title, shows);
    of(MEMBER(width), "pixels");
    of(MEMBER(height), "pixels");
    of(MEMBER(frames), "of its animation; 0: it has none");
    MEMBERS(triangles);
    of(MEMBER(eye), "", kThreeNumbers);
    of(MEMBER(target), "", kThreeNumbers);
    of(MEMBER(up), "", kThreeNumbers);
    of(MEMBER(low), "corner of the box of all triangles", kThreeNumbers);
    of(MEMBER(high), "", kThreeNumbers);
    MEMBERS(orthographic);
    of(MEMBER(half_width), "of the view at distance 1, or of its window, in the file's shape");
    MEMBERS(half_height, lights, objects, methods);
    of(MEMBER(chosen), "the methods that are shown first, as typed");
    MEMBERS(warnings);
    of(MEMBER(command), "compares the scene as its file has it");
}

/// Milliseconds of a phase, and whether the last movement repeated it.
struct PhaseRecord {
    std::string phase{};
    double ms     = 0;
    bool repeated = false;
};
DESCRIBE(PhaseRecord) {
    of(MEMBER(phase), "", one_of({"build", "aim", "look", "visibility"}));
    of(MEMBER(ms), "all lights together");
    MEMBERS(repeated);
}

struct ClassCountRecord {
    std::string key{}, name{}, colour{};
    std::uint64_t points = 0;
    bool interior        = false;
};
DESCRIBE(ClassCountRecord) {
    of("class", &R::key);
    MEMBERS(name);
    of(MEMBER(colour), "#rrggbb");
    MEMBERS(points, interior);
}

/// Errors of one light against the truth.
struct SideErrorRecord {
    std::uint64_t points = 0, undefined = 0, on_boundary = 0, wrong_interior = 0;
    double rmse = kUnknown, flip = kUnknown;
    std::vector<ClassCountRecord> classes{};
};
DESCRIBE(SideErrorRecord) {
    of(MEMBER(points), "compared");
    MEMBERS(undefined, on_boundary, wrong_interior, rmse);
    of(MEMBER(flip), "mean FLIP of the final pictures; null where its layer is not shown");
    of(MEMBER(classes), "of wrong points, those that there are");
}

struct SideRecord {
    std::string method{}, title{};
    ServiceRecord serves{};
    std::string failed{};
    std::vector<PhaseRecord> phases{};
    std::uint64_t memory_bytes = 0;
    std::string layer{};
    std::optional<SideErrorRecord> errors{};
};
DESCRIBE(SideRecord) {
    of(MEMBER(method), "as typed");
    MEMBERS(title, serves);
    of.may(MEMBER(failed), "the message of what it threw");
    MEMBERS(phases, memory_bytes);
    of(MEMBER(layer), "that the picture shows");
    of(MEMBER(errors), "null where there is no truth");
}

struct ViewTruthRecord {
    std::string method{}, note{}, failed{};
    bool exact           = false;
    std::uint64_t judged = 0, of = 0;
    double ms = kUnknown;
};
DESCRIBE(ViewTruthRecord) {
    MEMBERS(method, exact, note);
    of.may(MEMBER(failed));
    of(MEMBER(judged), "points");
    of(MEMBER(of), "points with a surface");
    MEMBERS(ms);
}

struct ViewRecord {
    std::uint64_t width = 0, height = 0;
    double facts_ms = 0, points_ms = 0, pictures_ms = 0;
    bool camera_moved = false, object_moved = false;
    std::vector<std::string> lights_moved{};
    std::vector<SideRecord> sides{};
    std::optional<ViewTruthRecord> truth{};
};
DESCRIBE(ViewRecord) {
    of(MEMBER(width), "pixels");
    of(MEMBER(height), "pixels");
    of(MEMBER(facts_ms), "of the scene, in no method's time");
    of(MEMBER(points_ms), "of the surface points, in no method's time");
    MEMBERS(pictures_ms, camera_moved, object_moved, lights_moved);
    of(MEMBER(sides), "one or two: one a picture; the truth alone may be the second");
    MEMBERS(truth);
}

/// An answer, and the blocker's corners for drawing it.
struct AnswerHereRecord {
    AnswerRecord answer{};
    std::string sentence{};
    std::vector<std::vector<double>> blocker_corners{};
};
DESCRIBE(AnswerHereRecord) {
    of.all(&R::answer);
    MEMBERS(sentence);
    of(MEMBER(blocker_corners), "world space");
}

/// The light as the point sees it, at a grid of places: in the light's plane, or the circle of a sphere that is seen.
struct SeenLightRecord {
    static constexpr int kLit = -1, kNoLight = -2, kBehind = -3;
    std::uint64_t side = 0;
    double aspect = 1, fraction = kUnknown;
    std::vector<int> cells{};
    std::vector<std::vector<double>> frame{};
};
DESCRIBE(SeenLightRecord) {
    of(MEMBER(side), "places along each side");
    of(MEMBER(aspect), "width over height");
    of(MEMBER(fraction), "lit, of those on the light");
    of(MEMBER(cells),
       "row by row: -1 lit, -2 not on the light, -3 behind the point's plane, else the object that blocks");
    of(MEMBER(frame), "the picture's middle, and from there its right and its upper edge, world space");
}

struct WhyHereRecord {
    TriangleRecord on{};
    std::vector<double> position{};
    std::string light{}, decided{};
    std::vector<AnswerHereRecord> answers{};
    std::optional<SeenLightRecord> seen{};
};
DESCRIBE(WhyHereRecord) {
    of.all(&R::on);
    of(MEMBER(position), "world space", kThreeNumbers);
    MEMBERS(light);
    of.may(MEMBER(decided), "why no method is asked");
    MEMBERS(answers);
    of(MEMBER(seen), "null for lights without an area");
}

}  // namespace umbra
