// What a course asks of a shadow method: scenes, methods to stand beside, limits, and points by cause of error.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/lab/prepare.h"

namespace umbra {

/// What a figure of a rubric is, and how a sentence says it.
struct Cause {
    std::string_view name;      ///< as rubrics have it: "acne"
    std::string_view unit;      ///< "%": a fraction; "px"; "": a plain number; "x": a ratio
    std::string_view says;      ///< "{} of the points are acne"
    std::string_view metric{};  ///< of a light (bench/sweep/metrics.h); empty where no metric is the figure
};
/// All that a rubric may ask for.
[[nodiscard]] const std::vector<Cause>& causes();

struct RubricItemRecord {
    std::string name{}, about{}, of{}, against{};
    double points = kUnknown, full = kUnknown, none = kUnknown;
    std::vector<std::string> scenes{};
};
DESCRIBE(RubricItemRecord) {
    of.name("rubric_item", "points for one cause of error");
    of.must(MEMBER(name));
    of.may(MEMBER(about), "a sentence for the student");
    of.must(MEMBER(of), "the figure: acne, leak, time, ... (docs/course.md)");
    of.may(MEMBER(against), "time: the method whose time is 1");
    of(MEMBER(points), "", at_least(0));
    of.may(MEMBER(full), "up to this figure all points are given; 0", at_least(0));
    of.may(MEMBER(none), "from this figure on none; failed and refused: 1");
    of.may(MEMBER(scenes), "those of the rubric that count here; all");
}

struct LimitsRecord {
    double answer_s = kUnknown, scene_s = kUnknown, memory_mib = kUnknown;
    bool network = false;
};
DESCRIBE(LimitsRecord) {
    of.name("limits", "of a program that was handed in");
    of.may(MEMBER(answer_s), "seconds an answer; 60", at_least(0));
    of.may(MEMBER(scene_s), "seconds a scene; 300", at_least(0));
    of.may(MEMBER(memory_mib), "MiB of address space of each of its processes; 4096; 0: any", at_least(0));
    of.may(MEMBER(network), "true: it may use the network");
}

struct RubricRecord {
    std::string title{}, text{}, size{};
    std::vector<std::string> scenes{}, methods{}, run{};
    LimitsRecord limits{};
    double step = kUnknown;
    std::vector<RubricItemRecord> items{};
};
DESCRIBE(RubricRecord) {
    of.name("rubric", "what a course asks of a shadow method");
    of.must(MEMBER(title));
    of.may(MEMBER(text), "a sentence for students");
    of(MEMBER(scenes), "names of scenes, or files beside the rubric");
    of.may(MEMBER(size), "WIDTHxHEIGHT of all scenes; their own");
    of.may(MEMBER(methods), "methods of ours that stand beside");
    of.may(MEMBER(run), "the command of a program, started in the folder that is handed in; ./run");
    MEMBERS(limits);
    of.may(MEMBER(step), "points are rounded to multiples of this; 0.1");
    MEMBERS(items);
}

struct Rubric {
    RubricRecord record{};
    std::string text{};  ///< its bytes
    std::vector<std::filesystem::path> scenes{};
    Size size{};
};

/// The files of a list of names. Throws InputError with its position.
[[nodiscard]] std::vector<std::filesystem::path> scenes_beside(const Field& names, const std::filesystem::path& file,
                                                               const FindScene& find);

/// Throws InputError with the position of a name that is no method's.
void check_methods(const Field& names);

/// "WIDTHxHEIGHT", or the scenes' own where it is not there. Throws InputError with its position.
[[nodiscard]] Size size_of(const Field& size);

/// Reads and checks it: names of figures, methods and scenes, ranges, what an item needs. Throws InputError with the
/// file and the position.
[[nodiscard]] Rubric read_rubric(const std::filesystem::path& file, const FindScene& find);

/// Without points: these scenes, beside the z-buffer and rays.
[[nodiscard]] Rubric rubric_of(std::vector<std::filesystem::path> scenes);

}  // namespace umbra
