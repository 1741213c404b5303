// The points of a shadow method that was handed in, from its comparisons: by cause of error, with a sentence for each
// point that is lost.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/results.h"
#include "umbra/bench/report/course/rubric.h"

namespace umbra {

/// What an item found on one scene.
struct GradedSceneRecord {
    std::string scene{}, light{}, why{};
    std::optional<double> figure{};
    double credit   = kUnknown;
    bool unanswered = false;
};
DESCRIBE(GradedSceneRecord) {
    of.name("graded_scene", "what an item found on one scene");
    of(MEMBER(scene), "its folder");
    of.may(MEMBER(light), "the one with the largest figure");
    of(MEMBER(figure), "of the rubric's kind; a part of 1 where that is of points; null: none");
    of(MEMBER(credit), "null: nothing on this scene asks for it, and it does not count", kFraction);
    of.may(MEMBER(why), "why there is no figure");
    of.may(MEMBER(unanswered), "true: it failed there, or has no answers");
}

struct GradedItemRecord {
    std::string name{}, about{}, of{}, sentence{};
    double points = kUnknown, max = kUnknown;
    std::vector<GradedSceneRecord> scenes{};
};
DESCRIBE(GradedItemRecord) {
    of.name("graded_item", "points for one cause of error");
    of.must(MEMBER(name));
    of.may(MEMBER(about));
    of(MEMBER(of), "the figure");
    MEMBERS(points, max);
    of(MEMBER(sentence), "what was found, and why points are lost");
    MEMBERS(scenes);
}

/// What kept a program apart while it ran.
struct ApartRecord {
    std::string by{};
    bool network      = false;
    double memory_mib = kUnknown, answer_s = kUnknown, scene_s = kUnknown;
};
DESCRIBE(ApartRecord) {
    of.name("apart", "what kept the program apart");
    of(MEMBER(by), "what kept files and network from it", one_of({"bwrap", "nothing"}));
    of(MEMBER(network), "true: it could use the network");
    of(MEMBER(memory_mib), "null: any");
    MEMBERS(answer_s, scene_s);
}

struct GradeRecord {
    HeadRecord head{};
    std::string rubric{}, handed_in{}, method{}, failed{}, key{};
    double points = kUnknown, max = kUnknown, seconds = kUnknown;
    std::optional<ApartRecord> apart{};
    std::vector<GradedItemRecord> items{};
    std::vector<std::string> scenes{}, not_compared{}, files{};
};
DESCRIBE(GradeRecord) {
    of.all(&R::head);
    of(MEMBER(rubric), "its title");
    of(MEMBER(handed_in), "the folder's name, or the method");
    of(MEMBER(method), "what its records call it");
    of.may(MEMBER(failed), "why nothing could be asked of it");
    MEMBERS(points, max);
    of(MEMBER(seconds), "that judging it took");
    of.may(MEMBER(apart), "of a program");
    MEMBERS(items);
    of(MEMBER(scenes), "folders that hold the results.json of each scene");
    of.may(MEMBER(not_compared), "scenes that could not be read, in words");
    of(MEMBER(files), "beside this record");
    of.may(MEMBER(key), "equal keys: nothing that the points depend on has changed");
}

/// A scene's comparison, in which the method handed in is the one of this id.
struct Compared {
    std::string asked;  ///< as the rubric names it
    std::string folder;
    Results results{};
    std::string method{};  ///< empty: it has no answers here
    std::string why{};     ///< why not

    [[nodiscard]] const MethodRecord* record() const;  ///< null where it has no answers
    /// What it threw, why it does not serve the scene, or why it has no answers.
    [[nodiscard]] std::string why_not() const;
};

/// The figure that a rubric names, under the light where it is largest; nothing where no light tells. `against`: of time.
struct Figure {
    double value = 0;
    std::string light{};
};
[[nodiscard]] std::optional<Figure> figure_of(const Results& results, const MethodRecord& method, const std::string& of,
                                              const std::string& against);

/// "1.3 %", "2 px", "0.012", "3.1 times": a figure as sentences have it.
[[nodiscard]] std::string figure_in_words(const std::string& of, double figure);

/// Items, points and sentences. `failed`: why there are no comparisons; all points are lost then. The credit of a scene
/// falls evenly from `full` to `none`; a scene that is not answered has none; an item's points are those of the mean over
/// the scenes that tell, in steps of the rubric, and all where nothing on the scenes asks for it.
void grade(GradeRecord& record, const RubricRecord& rubric, const std::vector<Compared>& scenes);

}  // namespace umbra
