// What `umbra view` answers to its pages, as records.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/point_answer.h"

namespace umbra {

struct ViewedLightRecord {
    std::string name{}, kind{};
    std::vector<double> position{}, direction{};
    double extent = 0;
    bool fixed    = false;
};
template <class Fields>
void describe(Fields& of, Is<ViewedLightRecord>) {
    of("name", &ViewedLightRecord::name, "");
    of("kind", &ViewedLightRecord::kind, "");
    of("position", &ViewedLightRecord::position, "", kThreeNumbers);
    of("direction", &ViewedLightRecord::direction, "", kThreeNumbers);
    of("extent", &ViewedLightRecord::extent, "radius, or half of the longer edge; 0 for lights without an area");
    of("fixed", &ViewedLightRecord::fixed, "to the camera");
}

struct ViewedObjectRecord {
    std::string name{};
    bool movable = false;
    std::vector<double> middle{};
};
template <class Fields>
void describe(Fields& of, Is<ViewedObjectRecord>) {
    of("name", &ViewedObjectRecord::name, "");
    of("movable", &ViewedObjectRecord::movable, "");
    of("middle", &ViewedObjectRecord::middle, "of its box", kThreeNumbers);
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
template <class Fields>
void describe(Fields& of, Is<ViewedSceneRecord>) {
    of("name", &ViewedSceneRecord::name, "");
    of("title", &ViewedSceneRecord::title, "");
    of("shows", &ViewedSceneRecord::shows, "");
    of("width", &ViewedSceneRecord::width, "pixels");
    of("height", &ViewedSceneRecord::height, "pixels");
    of("frames", &ViewedSceneRecord::frames, "of its animation; 0: it has none");
    of("triangles", &ViewedSceneRecord::triangles, "");
    of("eye", &ViewedSceneRecord::eye, "", kThreeNumbers);
    of("target", &ViewedSceneRecord::target, "", kThreeNumbers);
    of("up", &ViewedSceneRecord::up, "", kThreeNumbers);
    of("low", &ViewedSceneRecord::low, "corner of the box of all triangles", kThreeNumbers);
    of("high", &ViewedSceneRecord::high, "", kThreeNumbers);
    of("orthographic", &ViewedSceneRecord::orthographic, "");
    of("half_width", &ViewedSceneRecord::half_width,
       "of the view at distance 1, or of its window, in the file's shape");
    of("half_height", &ViewedSceneRecord::half_height, "");
    of("lights", &ViewedSceneRecord::lights, "");
    of("objects", &ViewedSceneRecord::objects, "");
    of("methods", &ViewedSceneRecord::methods, "");
    of("chosen", &ViewedSceneRecord::chosen, "the methods that are shown first, as typed");
    of("warnings", &ViewedSceneRecord::warnings, "");
    of("command", &ViewedSceneRecord::command, "compares the scene as its file has it");
}

/// Milliseconds of a phase, and whether the last movement repeated it.
struct PhaseRecord {
    std::string phase{};
    double ms     = 0;
    bool repeated = false;
};
template <class Fields>
void describe(Fields& of, Is<PhaseRecord>) {
    of("phase", &PhaseRecord::phase, "", one_of({"build", "aim", "look", "visibility"}));
    of("ms", &PhaseRecord::ms, "all lights together");
    of("repeated", &PhaseRecord::repeated, "");
}

struct ClassCountRecord {
    std::string key{}, name{}, colour{};
    std::uint64_t points = 0;
    bool interior        = false;
};
template <class Fields>
void describe(Fields& of, Is<ClassCountRecord>) {
    of("class", &ClassCountRecord::key, "");
    of("name", &ClassCountRecord::name, "");
    of("colour", &ClassCountRecord::colour, "#rrggbb");
    of("points", &ClassCountRecord::points, "");
    of("interior", &ClassCountRecord::interior, "");
}

/// Errors of one light against the truth.
struct SideErrorRecord {
    std::uint64_t points = 0, undefined = 0, on_boundary = 0, wrong_interior = 0;
    double rmse = kUnknown, flip = kUnknown;
    std::vector<ClassCountRecord> classes{};
};
template <class Fields>
void describe(Fields& of, Is<SideErrorRecord>) {
    of("points", &SideErrorRecord::points, "compared");
    of("undefined", &SideErrorRecord::undefined, "");
    of("on_boundary", &SideErrorRecord::on_boundary, "");
    of("wrong_interior", &SideErrorRecord::wrong_interior, "");
    of("rmse", &SideErrorRecord::rmse, "");
    of("flip", &SideErrorRecord::flip, "mean FLIP of the final pictures; null where its layer is not shown");
    of("classes", &SideErrorRecord::classes, "of wrong points, those that there are");
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
template <class Fields>
void describe(Fields& of, Is<SideRecord>) {
    of("method", &SideRecord::method, "as typed");
    of("title", &SideRecord::title, "");
    of("serves", &SideRecord::serves, "");
    of.may("failed", &SideRecord::failed, "the message of what it threw");
    of("phases", &SideRecord::phases, "");
    of("memory_bytes", &SideRecord::memory_bytes, "");
    of("layer", &SideRecord::layer, "that the picture shows");
    of("errors", &SideRecord::errors, "null where there is no truth");
}

struct ViewTruthRecord {
    std::string method{}, note{}, failed{};
    bool exact           = false;
    std::uint64_t judged = 0, of = 0;
    double ms = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<ViewTruthRecord>) {
    of("method", &ViewTruthRecord::method, "");
    of("exact", &ViewTruthRecord::exact, "");
    of("note", &ViewTruthRecord::note, "");
    of.may("failed", &ViewTruthRecord::failed, "");
    of("judged", &ViewTruthRecord::judged, "points");
    of("of", &ViewTruthRecord::of, "points with a surface");
    of("ms", &ViewTruthRecord::ms, "");
}

struct ViewRecord {
    std::uint64_t width = 0, height = 0;
    double facts_ms = 0, points_ms = 0, pictures_ms = 0;
    bool camera_moved = false, object_moved = false;
    std::vector<std::string> lights_moved{};
    std::vector<SideRecord> sides{};
    std::optional<ViewTruthRecord> truth{};
};
template <class Fields>
void describe(Fields& of, Is<ViewRecord>) {
    of("width", &ViewRecord::width, "pixels");
    of("height", &ViewRecord::height, "pixels");
    of("facts_ms", &ViewRecord::facts_ms, "of the scene, in no method's time");
    of("points_ms", &ViewRecord::points_ms, "of the surface points, in no method's time");
    of("pictures_ms", &ViewRecord::pictures_ms, "");
    of("camera_moved", &ViewRecord::camera_moved, "");
    of("object_moved", &ViewRecord::object_moved, "");
    of("lights_moved", &ViewRecord::lights_moved, "");
    of("sides", &ViewRecord::sides, "one or two: one a picture; the truth alone may be the second");
    of("truth", &ViewRecord::truth, "");
}

/// An answer, and the blocker's corners for drawing it.
struct AnswerHereRecord {
    AnswerRecord answer{};
    std::string sentence{};
    std::vector<std::vector<double>> blocker_corners{};
};
template <class Fields>
void describe(Fields& of, Is<AnswerHereRecord>) {
    of.all(&AnswerHereRecord::answer);
    of("sentence", &AnswerHereRecord::sentence, "");
    of("blocker_corners", &AnswerHereRecord::blocker_corners, "world space");
}

/// The light as the point sees it, at a grid of places: in the light's plane, or the circle of a sphere that is seen.
struct SeenLightRecord {
    static constexpr int kLit = -1, kNoLight = -2, kBehind = -3;
    std::uint64_t side = 0;
    double aspect = 1, fraction = kUnknown;
    std::vector<int> cells{};
    std::vector<std::vector<double>> frame{};
};
template <class Fields>
void describe(Fields& of, Is<SeenLightRecord>) {
    of("side", &SeenLightRecord::side, "places along each side");
    of("aspect", &SeenLightRecord::aspect, "width over height");
    of("fraction", &SeenLightRecord::fraction, "lit, of those on the light");
    of("cells", &SeenLightRecord::cells,
       "row by row: -1 lit, -2 not on the light, -3 behind the point's plane, else the object that blocks");
    of("frame", &SeenLightRecord::frame,
       "the picture's middle, and from there its right and its upper edge, world space");
}

struct WhyHereRecord {
    TriangleRecord on{};
    std::vector<double> position{};
    std::string light{}, decided{};
    std::vector<AnswerHereRecord> answers{};
    std::optional<SeenLightRecord> seen{};
};
template <class Fields>
void describe(Fields& of, Is<WhyHereRecord>) {
    of.all(&WhyHereRecord::on);
    of("position", &WhyHereRecord::position, "world space", kThreeNumbers);
    of("light", &WhyHereRecord::light, "");
    of.may("decided", &WhyHereRecord::decided, "why no method is asked");
    of("answers", &WhyHereRecord::answers, "");
    of("seen", &WhyHereRecord::seen, "null for lights without an area");
}

}  // namespace umbra
