// results.json of one scene, as a value: several shadow methods, compared with a reference.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/point_answer.h"

namespace umbra {

struct LightFilesRecord {
    FileName visibility{}, difference{}, classes{};
};
DESCRIBE(LightFilesRecord) {
    MEMBERS(visibility);
    of.may(MEMBER(difference));
    of.may(MEMBER(classes), "picture of the classes of the wrong points, by colour");
}

/// Pictures of a method or a reference.
struct FilesRecord {
    FileName exr{}, png{}, flip{};
    Members<LightFilesRecord> lights{};
};
DESCRIBE(FilesRecord) {
    of.name("files", "relative to the folder of the record");
    MEMBERS(exr, png, lights);
    of.may(MEMBER(flip), "the map of FLIP; not there for the reference");
}

/// A kind of wrong points. Null: no point is compared, or the reference does not tell.
struct WrongRecord {
    std::optional<std::uint64_t> interior{}, edge{};
};

struct FalseShadowRecord : WrongRecord {
    std::optional<std::uint64_t> acne{};
};
DESCRIBE(FalseShadowRecord) { MEMBERS(interior, edge, acne); }

struct FalseLightRecord : WrongRecord {
    std::optional<std::uint64_t> detachment{}, leak{};
};
DESCRIBE(FalseLightRecord) {
    MEMBERS(interior, edge);
    of(MEMBER(detachment), "null where the reference names no occluder");
    of(MEMBER(leak), "null where the reference names no occluder");
}

struct InteriorRecord {
    std::optional<std::uint64_t> lit{}, umbra{}, penumbra{};
};
DESCRIBE(InteriorRecord) { MEMBERS(lit, umbra, penumbra); }

struct DirectionRecord {
    std::uint64_t false_shadow = 0, false_light = 0;
};
DESCRIBE(DirectionRecord) { MEMBERS(false_shadow, false_light); }

struct TerminatorRecord {
    std::uint64_t facet_away = 0, normal_away = 0, wrong = 0;
};
DESCRIBE(TerminatorRecord) {
    of(MEMBER(facet_away), "the shading normal faces the light, the triangle does not");
    of(MEMBER(normal_away), "the triangle faces the light, the shading normal does not");
    of(MEMBER(wrong), "the wrong points among normal_away, which are not counted as false shadow or false light");
}

struct BracketRecord {
    double max_half_width = kUnknown;
};
DESCRIBE(BracketRecord) { MEMBERS(max_half_width); }

struct NoiseRecord {
    std::uint64_t runs = 0;
    double noise_rmse = kUnknown, bias_rmse = kUnknown;
};
DESCRIBE(NoiseRecord) {
    of(MEMBER(runs), "", at_least(2));
    of(MEMBER(noise_rmse), "the standard deviation of one run");
    of(MEMBER(bias_rmse), "of the mean of many runs");
}

struct DisplacementRecord {
    double mean = kUnknown, p95 = kUnknown, max = kUnknown;
    std::uint64_t pieces = 0, unmatched = 0;
    double reach = kUnknown;
};
DESCRIBE(DisplacementRecord) {
    of(MEMBER(mean), "null where no piece is matched");
    of(MEMBER(p95), "null where no piece is matched");
    of(MEMBER(max), "null where no piece is matched");
    MEMBERS(pieces, unmatched);
    of(MEMBER(reach),
       "pixels: a piece whose nearest boundary of the method is farther than this is unmatched and part of no mean");
}

struct PenumbraRecord {
    double method = kUnknown, reference = kUnknown;
};
DESCRIBE(PenumbraRecord) { MEMBERS(method, reference); }

/// The point that shows the errors of a class best, and why the method and the truth answer as they do there. Polygons
/// are in pixels of the picture, from its top left corner.
struct ExplainedPointRecord {
    std::string error_class{};
    std::vector<int> pixel{};
    TriangleRecord on{};
    AnswerRecord method{}, truth{};
    std::vector<std::vector<double>> segment{}, method_blocker{}, truth_blocker{}, texel{};
};
DESCRIBE(ExplainedPointRecord) {
    of.name("explained_point", "the point with the largest error of a class");
    of("class", &R::error_class);
    of(MEMBER(pixel), "column and row, from 0 at the top left");
    of(MEMBER(on), "the triangle that the point lies on");
    MEMBERS(method, truth);
    of(MEMBER(segment), "the truth's, pixels; without what is behind the eye, like the others");
    MEMBERS(method_blocker, truth_blocker);
    of(MEMBER(texel), "of the method's map, on the plane of the point");
}

/// Differences of one method from the truth, at one light.
struct ErrorRecord {
    std::string light{};
    std::optional<std::uint64_t> points{};
    std::uint64_t undefined = 0, away = 0, on_boundary = 0, not_judged = 0, lit = 0, umbra = 0, penumbra = 0;
    std::optional<FalseShadowRecord> false_shadow{};
    std::optional<FalseLightRecord> false_light{};
    InteriorRecord interior{};
    DirectionRecord penumbra_error{}, noise_error{};
    TerminatorRecord terminator{};
    std::optional<BracketRecord> bracket{};
    std::optional<double> mae{}, rmse{}, max{}, bias{};
    std::optional<NoiseRecord> noise{};
    std::optional<DisplacementRecord> edge_displacement_px{};
    std::optional<PenumbraRecord> penumbra_width_px{};
    std::uint64_t unshadowed = 0;
    std::vector<ExplainedPointRecord> explained{};
};
DESCRIBE(ErrorRecord) {
    of.name("error", "differences of one method from the truth, at one light");
    MEMBERS(light);
    of(MEMBER(points), "that are compared");
    MEMBERS(undefined, away, on_boundary);
    of(MEMBER(not_judged), "points where the reference was not evaluated, because it is too slow");
    MEMBERS(lit, umbra, penumbra);
    of(MEMBER(false_shadow), "counts are null where no point is compared");
    of(MEMBER(false_light), "counts are null where no point is compared");
    of(MEMBER(interior), "interior errors of both kinds, by the value of the reference there");
    of(MEMBER(penumbra_error),
       "area lights: interior errors of either kind in the penumbra of the reference that are not explained by noise; "
       "never acne, detachment or leak");
    of(MEMBER(noise_error),
       "area lights, methods with a seed: interior errors of either kind at points where the mean of runs with other "
       "seeds is correct");
    MEMBERS(terminator);
    of(MEMBER(bracket), "the reference's half widths; null where its answers have no bracket");
    MEMBERS(mae, rmse, max, bias);
    of(MEMBER(noise), "sampled methods under area lights; null where all runs are equal");
    of(MEMBER(edge_displacement_px),
       "from the reference's boundary (area lights: S = 1/2) to the method's; null where the reference has no boundary. "
       "Lights without an area: the mean is up to 10 % low where the boundary is oblique to the pixels");
    of(MEMBER(penumbra_width_px),
       "effective widths over the line S = 1/2 of the reference; null for lights without an area");
    of.may(
        MEMBER(unshadowed),
        "points that face the light and whose objects receive no shadows, or that lie in a sphere light: S is 1 for every "
        "method. Only where there are some");
    of.may(MEMBER(explained), "a point of each class of interior errors that there are");
}

struct ReferenceFailureRecord {
    FailureRecord failure{};
    std::string method{};
};
DESCRIBE(ReferenceFailureRecord) {
    of.all(&R::failure);
    MEMBERS(method);
}

struct LightTimesRecord {
    std::string light{};
    TimingRecord aim_ms{}, visibility_ms{};
};
DESCRIBE(LightTimesRecord) { MEMBERS(light, aim_ms, visibility_ms); }

/// How far a picture is from the reference's.
struct ImageRecord {
    std::optional<double> rmse{}, psnr{}, ssim{}, flip{}, flip_hdr{};
};
DESCRIBE(ImageRecord) { MEMBERS(rmse, psnr, ssim, flip, flip_hdr); }

/// What a program from outside says its phases took: medians, milliseconds, aim and visibility summed over the lights.
struct OwnTimesRecord {
    double build_ms = kUnknown, aim_ms = kUnknown, look_ms = kUnknown, visibility_ms = kUnknown;
};
DESCRIBE(OwnTimesRecord) {
    of.name("own_times", "what a program from outside says its phases took: medians; null where it says nothing");
    MEMBERS(build_ms);
    of(MEMBER(aim_ms), "of all lights");
    MEMBERS(look_ms);
    of(MEMBER(visibility_ms), "of all lights");
}

/// A method with its settings, and what it answered.
struct MethodRecord {
    std::string id{}, name{}, title{}, paper{}, summary{}, text{};
    Members<Scalar> parameters{};
    ServiceRecord serves{};
    std::string outside{};
    std::optional<TurnTimesRecord> times{};
    std::optional<OwnTimesRecord> own_times{};
    std::vector<LightTimesRecord> light_times{};
    std::optional<std::uint64_t> memory_bytes{}, points_bytes{}, device_bytes{};
    std::optional<double> coverage{};
    std::string measures{}, compared_with{};
    std::vector<ErrorRecord> errors{};
    std::optional<ImageRecord> image{};
    std::optional<FilesRecord> files{};
    std::optional<FailureRecord> failed{};
    bool ran = false;  ///< it has answers
};
DESCRIBE(MethodRecord) {
    of.name("method", "a method with its settings, and what it answered");
    of(MEMBER(id), "what its files are named by");
    of.must(MEMBER(name));
    MEMBERS(title, paper, summary);
    of(MEMBER(text), "method and settings, as typed");
    of(MEMBER(parameters), "all of them, by name");
    MEMBERS(serves);
    of.may(MEMBER(outside), "what a method from outside is; absent of those of this program",
           one_of({"program", "library", "file of answers"}));
    of.may(MEMBER(times), "of the program's own clock; absent of a file of answers");
    of.may(MEMBER(own_times));
    of.where(&R::ran, MEMBER(light_times));
    of.may(MEMBER(memory_bytes), "of geometry and of the last light; absent of methods from outside");
    of.may(MEMBER(points_bytes), "of the surface points, for all lights");
    of.may(MEMBER(device_bytes), "in the memory of a device; absent where there is none");
    of.where(&R::ran, MEMBER(coverage),
             "the fraction of the asked points that it answers; null where no point asks for S_j",
             {.least = 0, .most = 1});
    of.may(MEMBER(measures), "which visible fraction of an area light the method measures",
           one_of({"area", "irradiance"}));
    of.may(MEMBER(compared_with),
           "the method, as typed, with whose answers `errors` compares: the reference, or one that measures the same "
           "fraction as this method");
    of.where(&R::ran, MEMBER(errors), "one a light");
    of.may(MEMBER(image), "differences of its picture from the reference's");
    of.may(MEMBER(files));
    of.may(MEMBER(failed),
           "the method threw or broke its contract: it then serves `not` and has no times, errors, image or files");
}

struct ControlRecord {
    std::string text{};
    TurnTimesRecord again{};
};
DESCRIBE(ControlRecord) {
    of(MEMBER(text), "the method, as typed");
    MEMBERS(again);
}

/// What concerns the times of all methods.
struct TurnsRecord {
    std::uint64_t rounds = 0, seed = 0, threads = 0, processors = 0;
    bool pinned = false;
    LoadRecord load_average{};
    std::vector<double> calibration_ms{};
    std::optional<double> noise_bar{};
    std::optional<ControlRecord> control{};
};
DESCRIBE(TurnsRecord) {
    of.name("turns", "what concerns the times of all methods");
    MEMBERS(rounds);
    of(MEMBER(seed), "of the order within rounds");
    of(MEMBER(threads), "", at_least(1));
    of(MEMBER(processors), "that the process may run on", at_least(1));
    of(MEMBER(pinned), "each thread stayed on one processor");
    of(MEMBER(load_average), "of the last minute, before the first round and after the last");
    of(MEMBER(calibration_ms), "a fixed amount of work at the begin of each round: how fast the machine was");
    of(MEMBER(noise_bar), "how far the ratio of a method's time to its own lies from 1; null without a control",
       at_least(0));
    of(MEMBER(control), "the method that ran a second time in each round, and the times of that run");
}

struct JudgedRecord {
    std::uint64_t points = 0, of = 0;
    std::string guess{};
};
DESCRIBE(JudgedRecord) {
    of(MEMBER(points), "at which area lights are compared");
    MEMBERS(of);
    of(MEMBER(guess), "the method whose values fill the other points");
}

struct ReferenceRecord {
    std::string name{}, title{}, text{};
    Members<Scalar> parameters{};
    bool exact = false;
    std::string note{};
    std::optional<JudgedRecord> judged{};
    std::optional<TimesRecord> times{};
    std::optional<FilesRecord> files{};
    std::optional<ReferenceFailureRecord> failed{};
};
DESCRIBE(ReferenceRecord) {
    of.name("reference", "the method that the others are compared with");
    MEMBERS(name, title);
    of(MEMBER(text), "method and settings, as typed");
    MEMBERS(parameters, exact, note);
    of(MEMBER(judged), "null where every point of the picture is compared");
    of.may(MEMBER(times), "absent in records of sweep");
    of.may(MEMBER(failed), "the exact reference threw: another method replaces it");
    of.may(MEMBER(files));
}

struct Results {
    HeadRecord head{};
    MachineRecord machine{};
    SceneRecord scene{};
    FactsRecord facts{};
    SizeRecord size{};
    std::vector<LightRecord> lights{};
    Members<double> times{};
    std::optional<TurnsRecord> turns{};
    ReferenceRecord reference{};
    std::vector<MethodRecord> methods{};
    FileName values{};
    std::optional<BudgetRecord> budget{};
};
DESCRIBE(Results) {
    of.all(&R::head);
    MEMBERS(machine, scene, facts, size, lights);
    of(MEMBER(times), "of what all methods share, milliseconds");
    MEMBERS(turns, reference, methods);
    of.may(MEMBER(values), "a script with S_j and classes, which the page of the scene loads");
    of.may(MEMBER(budget));
}

/// What a method is called on pages: its title, with the settings that are not the defaults.
[[nodiscard]] std::string label_of(const MethodRecord& method);

[[nodiscard]] std::string record_text(const Results& results);  ///< as results.json holds it
[[nodiscard]] Json results_schema();                            ///< JSON Schema, draft 4

}  // namespace umbra
