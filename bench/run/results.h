// results.json of one scene, as a value: several shadow methods, compared with a reference.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/point_answer.h"

namespace umbra {

struct LightFilesRecord {
    FileName visibility{}, difference{}, classes{};
};
template <class Fields>
void describe(Fields& of, Is<LightFilesRecord>) {
    of("visibility", &LightFilesRecord::visibility, "");
    of.may("difference", &LightFilesRecord::difference, "");
    of.may("classes", &LightFilesRecord::classes, "picture of the classes of the wrong points, by colour");
}

/// Pictures of a method or a reference.
struct FilesRecord {
    FileName exr{}, png{}, flip{};
    Members<LightFilesRecord> lights{};
};
template <class Fields>
void describe(Fields& of, Is<FilesRecord>) {
    of.name("files", "relative to the folder of the record");
    of("exr", &FilesRecord::exr, "");
    of("png", &FilesRecord::png, "");
    of("lights", &FilesRecord::lights, "");
    of.may("flip", &FilesRecord::flip, "the map of FLIP; not there for the reference");
}

/// A kind of wrong points. Null: no point is compared, or the reference does not tell.
struct WrongRecord {
    std::optional<std::uint64_t> interior{}, edge{};
};

struct FalseShadowRecord : WrongRecord {
    std::optional<std::uint64_t> acne{};
};
template <class Fields>
void describe(Fields& of, Is<FalseShadowRecord>) {
    of("interior", &FalseShadowRecord::interior, "");
    of("edge", &FalseShadowRecord::edge, "");
    of("acne", &FalseShadowRecord::acne, "");
}

struct FalseLightRecord : WrongRecord {
    std::optional<std::uint64_t> detachment{}, leak{};
};
template <class Fields>
void describe(Fields& of, Is<FalseLightRecord>) {
    of("interior", &FalseLightRecord::interior, "");
    of("edge", &FalseLightRecord::edge, "");
    of("detachment", &FalseLightRecord::detachment, "null where the reference names no occluder");
    of("leak", &FalseLightRecord::leak, "null where the reference names no occluder");
}

struct InteriorRecord {
    std::optional<std::uint64_t> lit{}, umbra{}, penumbra{};
};
template <class Fields>
void describe(Fields& of, Is<InteriorRecord>) {
    of("lit", &InteriorRecord::lit, "");
    of("umbra", &InteriorRecord::umbra, "");
    of("penumbra", &InteriorRecord::penumbra, "");
}

struct DirectionRecord {
    std::uint64_t false_shadow = 0, false_light = 0;
};
template <class Fields>
void describe(Fields& of, Is<DirectionRecord>) {
    of("false_shadow", &DirectionRecord::false_shadow, "");
    of("false_light", &DirectionRecord::false_light, "");
}

struct TerminatorRecord {
    std::uint64_t facet_away = 0, normal_away = 0, wrong = 0;
};
template <class Fields>
void describe(Fields& of, Is<TerminatorRecord>) {
    of("facet_away", &TerminatorRecord::facet_away, "the shading normal faces the light, the triangle does not");
    of("normal_away", &TerminatorRecord::normal_away, "the triangle faces the light, the shading normal does not");
    of("wrong", &TerminatorRecord::wrong,
       "the wrong points among normal_away, which are not counted as false shadow or false light");
}

struct BracketRecord {
    double max_half_width = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<BracketRecord>) {
    of("max_half_width", &BracketRecord::max_half_width, "");
}

struct NoiseRecord {
    std::uint64_t runs = 0;
    double noise_rmse = kUnknown, bias_rmse = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<NoiseRecord>) {
    of("runs", &NoiseRecord::runs, "", at_least(2));
    of("noise_rmse", &NoiseRecord::noise_rmse, "the standard deviation of one run");
    of("bias_rmse", &NoiseRecord::bias_rmse, "of the mean of many runs");
}

struct DisplacementRecord {
    double mean = kUnknown, p95 = kUnknown, max = kUnknown;
    std::uint64_t pieces = 0, unmatched = 0;
    double reach = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<DisplacementRecord>) {
    of("mean", &DisplacementRecord::mean, "null where no piece is matched");
    of("p95", &DisplacementRecord::p95, "null where no piece is matched");
    of("max", &DisplacementRecord::max, "null where no piece is matched");
    of("pieces", &DisplacementRecord::pieces, "");
    of("unmatched", &DisplacementRecord::unmatched, "");
    of("reach", &DisplacementRecord::reach,
       "pixels: a piece whose nearest boundary of the method is farther than this is unmatched and part of no mean");
}

struct PenumbraRecord {
    double method = kUnknown, reference = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<PenumbraRecord>) {
    of("method", &PenumbraRecord::method, "");
    of("reference", &PenumbraRecord::reference, "");
}

/// The point that shows the errors of a class best, and why the method and the truth answer as they do there. Polygons
/// are in pixels of the picture, from its top left corner.
struct ExplainedPointRecord {
    std::string error_class{};
    std::vector<int> pixel{};
    TriangleRecord on{};
    AnswerRecord method{}, truth{};
    std::vector<std::vector<double>> segment{}, method_blocker{}, truth_blocker{}, texel{};
};
template <class Fields>
void describe(Fields& of, Is<ExplainedPointRecord>) {
    of.name("explained_point", "the point with the largest error of a class");
    of("class", &ExplainedPointRecord::error_class, "");
    of("pixel", &ExplainedPointRecord::pixel, "column and row, from 0 at the top left");
    of("on", &ExplainedPointRecord::on, "the triangle that the point lies on");
    of("method", &ExplainedPointRecord::method, "");
    of("truth", &ExplainedPointRecord::truth, "");
    of("segment", &ExplainedPointRecord::segment,
       "the truth's, pixels; without what is behind the eye, like the others");
    of("method_blocker", &ExplainedPointRecord::method_blocker, "");
    of("truth_blocker", &ExplainedPointRecord::truth_blocker, "");
    of("texel", &ExplainedPointRecord::texel, "of the method's map, on the plane of the point");
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
template <class Fields>
void describe(Fields& of, Is<ErrorRecord>) {
    of.name("error", "differences of one method from the truth, at one light");
    of("light", &ErrorRecord::light, "");
    of("points", &ErrorRecord::points, "that are compared");
    of("undefined", &ErrorRecord::undefined, "");
    of("away", &ErrorRecord::away, "");
    of("on_boundary", &ErrorRecord::on_boundary, "");
    of("not_judged", &ErrorRecord::not_judged, "points where the reference was not evaluated, because it is too slow");
    of("lit", &ErrorRecord::lit, "");
    of("umbra", &ErrorRecord::umbra, "");
    of("penumbra", &ErrorRecord::penumbra, "");
    of("false_shadow", &ErrorRecord::false_shadow, "counts are null where no point is compared");
    of("false_light", &ErrorRecord::false_light, "counts are null where no point is compared");
    of("interior", &ErrorRecord::interior, "interior errors of both kinds, by the value of the reference there");
    of("penumbra_error", &ErrorRecord::penumbra_error,
       "area lights: interior errors of either kind in the penumbra of the reference that are not explained by noise; "
       "never acne, detachment or leak");
    of("noise_error", &ErrorRecord::noise_error,
       "area lights, methods with a seed: interior errors of either kind at points where the mean of runs with other "
       "seeds is correct");
    of("terminator", &ErrorRecord::terminator, "");
    of("bracket", &ErrorRecord::bracket, "the reference's half widths; null where its answers have no bracket");
    of("mae", &ErrorRecord::mae, "");
    of("rmse", &ErrorRecord::rmse, "");
    of("max", &ErrorRecord::max, "");
    of("bias", &ErrorRecord::bias, "");
    of("noise", &ErrorRecord::noise, "sampled methods under area lights; null where all runs are equal");
    of("edge_displacement_px", &ErrorRecord::edge_displacement_px,
       "from the reference's boundary (area lights: S = 1/2) to the method's; null where the reference has no boundary. "
       "Lights without an area: the mean is up to 10 % low where the boundary is oblique to the pixels");
    of("penumbra_width_px", &ErrorRecord::penumbra_width_px,
       "effective widths over the line S = 1/2 of the reference; null for lights without an area");
    of.may(
        "unshadowed", &ErrorRecord::unshadowed,
        "points that face the light and whose objects receive no shadows, or that lie in a sphere light: S is 1 for every "
        "method. Only where there are some");
    of.may("explained", &ErrorRecord::explained, "a point of each class of interior errors that there are");
}

struct ReferenceFailureRecord {
    FailureRecord failure{};
    std::string method{};
};
template <class Fields>
void describe(Fields& of, Is<ReferenceFailureRecord>) {
    of.all(&ReferenceFailureRecord::failure);
    of("method", &ReferenceFailureRecord::method, "");
}

struct LightTimesRecord {
    std::string light{};
    TimingRecord aim_ms{}, visibility_ms{};
};
template <class Fields>
void describe(Fields& of, Is<LightTimesRecord>) {
    of("light", &LightTimesRecord::light, "");
    of("aim_ms", &LightTimesRecord::aim_ms, "");
    of("visibility_ms", &LightTimesRecord::visibility_ms, "");
}

/// How far a picture is from the reference's.
struct ImageRecord {
    std::optional<double> rmse{}, psnr{}, ssim{}, flip{}, flip_hdr{};
};
template <class Fields>
void describe(Fields& of, Is<ImageRecord>) {
    of("rmse", &ImageRecord::rmse, "");
    of("psnr", &ImageRecord::psnr, "");
    of("ssim", &ImageRecord::ssim, "");
    of("flip", &ImageRecord::flip, "");
    of("flip_hdr", &ImageRecord::flip_hdr, "");
}

/// What a program from outside says its phases took: medians, milliseconds, aim and visibility summed over the lights.
struct OwnTimesRecord {
    double build_ms = kUnknown, aim_ms = kUnknown, look_ms = kUnknown, visibility_ms = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<OwnTimesRecord>) {
    of.name("own_times", "what a program from outside says its phases took: medians; null where it says nothing");
    of("build_ms", &OwnTimesRecord::build_ms, "");
    of("aim_ms", &OwnTimesRecord::aim_ms, "of all lights");
    of("look_ms", &OwnTimesRecord::look_ms, "");
    of("visibility_ms", &OwnTimesRecord::visibility_ms, "of all lights");
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
template <class Fields>
void describe(Fields& of, Is<MethodRecord>) {
    of.name("method", "a method with its settings, and what it answered");
    of("id", &MethodRecord::id, "what its files are named by");
    of.must("name", &MethodRecord::name, "");
    of("title", &MethodRecord::title, "");
    of("paper", &MethodRecord::paper, "");
    of("summary", &MethodRecord::summary, "");
    of("text", &MethodRecord::text, "method and settings, as typed");
    of("parameters", &MethodRecord::parameters, "all of them, by name");
    of("serves", &MethodRecord::serves, "");
    of.may("outside", &MethodRecord::outside, "what a method from outside is; absent of those of this program",
           one_of({"program", "library", "file of answers"}));
    of.may("times", &MethodRecord::times, "of the program's own clock; absent of a file of answers");
    of.may("own_times", &MethodRecord::own_times, "");
    of.where(&MethodRecord::ran, "light_times", &MethodRecord::light_times, "");
    of.may("memory_bytes", &MethodRecord::memory_bytes,
           "of geometry and of the last light; absent of methods from outside");
    of.may("points_bytes", &MethodRecord::points_bytes, "of the surface points, for all lights");
    of.may("device_bytes", &MethodRecord::device_bytes, "in the memory of a device; absent where there is none");
    of.where(&MethodRecord::ran, "coverage", &MethodRecord::coverage,
             "the fraction of the asked points that it answers; null where no point asks for S_j",
             {.least = 0, .most = 1});
    of.may("measures", &MethodRecord::measures, "which visible fraction of an area light the method measures",
           one_of({"area", "irradiance"}));
    of.may("compared_with", &MethodRecord::compared_with,
           "the method, as typed, with whose answers `errors` compares: the reference, or one that measures the same "
           "fraction as this method");
    of.where(&MethodRecord::ran, "errors", &MethodRecord::errors, "one a light");
    of.may("image", &MethodRecord::image, "differences of its picture from the reference's");
    of.may("files", &MethodRecord::files, "");
    of.may("failed", &MethodRecord::failed,
           "the method threw or broke its contract: it then serves `not` and has no times, errors, image or files");
}

struct ControlRecord {
    std::string text{};
    TurnTimesRecord again{};
};
template <class Fields>
void describe(Fields& of, Is<ControlRecord>) {
    of("text", &ControlRecord::text, "the method, as typed");
    of("again", &ControlRecord::again, "");
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
template <class Fields>
void describe(Fields& of, Is<TurnsRecord>) {
    of.name("turns", "what concerns the times of all methods");
    of("rounds", &TurnsRecord::rounds, "");
    of("seed", &TurnsRecord::seed, "of the order within rounds");
    of("threads", &TurnsRecord::threads, "", at_least(1));
    of("processors", &TurnsRecord::processors, "that the process may run on", at_least(1));
    of("pinned", &TurnsRecord::pinned, "each thread stayed on one processor");
    of("load_average", &TurnsRecord::load_average, "of the last minute, before the first round and after the last");
    of("calibration_ms", &TurnsRecord::calibration_ms,
       "a fixed amount of work at the begin of each round: how fast the machine was");
    of("noise_bar", &TurnsRecord::noise_bar,
       "how far the ratio of a method's time to its own lies from 1; null without a control", at_least(0));
    of("control", &TurnsRecord::control, "the method that ran a second time in each round, and the times of that run");
}

struct JudgedRecord {
    std::uint64_t points = 0, of = 0;
    std::string guess{};
};
template <class Fields>
void describe(Fields& of, Is<JudgedRecord>) {
    of("points", &JudgedRecord::points, "at which area lights are compared");
    of("of", &JudgedRecord::of, "");
    of("guess", &JudgedRecord::guess, "the method whose values fill the other points");
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
template <class Fields>
void describe(Fields& of, Is<ReferenceRecord>) {
    of.name("reference", "the method that the others are compared with");
    of("name", &ReferenceRecord::name, "");
    of("title", &ReferenceRecord::title, "");
    of("text", &ReferenceRecord::text, "method and settings, as typed");
    of("parameters", &ReferenceRecord::parameters, "");
    of("exact", &ReferenceRecord::exact, "");
    of("note", &ReferenceRecord::note, "");
    of("judged", &ReferenceRecord::judged, "null where every point of the picture is compared");
    of.may("times", &ReferenceRecord::times, "absent in records of sweep");
    of.may("failed", &ReferenceRecord::failed, "the exact reference threw: another method replaces it");
    of.may("files", &ReferenceRecord::files, "");
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
template <class Fields>
void describe(Fields& of, Is<Results>) {
    of.all(&Results::head);
    of("machine", &Results::machine, "");
    of("scene", &Results::scene, "");
    of("facts", &Results::facts, "");
    of("size", &Results::size, "");
    of("lights", &Results::lights, "");
    of("times", &Results::times, "of what all methods share, milliseconds");
    of("turns", &Results::turns, "");
    of("reference", &Results::reference, "");
    of("methods", &Results::methods, "");
    of.may("values", &Results::values, "a script with S_j and classes, which the page of the scene loads");
    of.may("budget", &Results::budget, "");
}

/// What a method is called on pages: its title, with the settings that are not the defaults.
[[nodiscard]] std::string label_of(const MethodRecord& method);

[[nodiscard]] std::string record_text(const Results& results);  ///< as results.json holds it
[[nodiscard]] Json results_schema();                            ///< JSON Schema, draft 4

}  // namespace umbra
