#include "umbra/bench/contenders/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/scratch_folder.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/base/error.h"
#include "umbra/core/errors/visibility_error.h"
#include "umbra/core/image/image.h"

namespace umbra {
namespace {

constexpr double kMostWrong = 0.01, kMostWrongArea = 0.1, kMostMean = 0.05, kMostBias = 0.02, kLeastAnswered = 0.5,
                 kWorthAReason = 0.02;
constexpr Size kRaster{96, 64};

struct Question {
    std::string name;
    std::string lights, objects;  ///< of the native scene
};

constexpr std::string_view kFloor = R"({"type": "plane", "name": "floor", "size": 12})";
constexpr std::string_view kBox =
    R"({"type": "box", "name": "box", "size": [2, 1, 1.5], "transform": [{"translate": [0, 1.5, 0]}]})";
constexpr std::string_view kBoard =
    R"({"type": "plane", "name": "board", "size": [6, 12], "transform": [{"translate": [3, 1.5, 0]}]})";

/// A light of this kind above the scene, to the one side or to the other.
std::string light_text(std::string_view kind, bool other_side) {
    const double x        = other_side ? -2.3 : 1.1;
    const std::string at  = fmt::format(R"("position": [{}, 5, 1.3])", x);
    const std::string to  = fmt::format(R"("direction": [{}, -5, -1.3])", -x);
    const std::string top = fmt::format(R"("type": "{}", "name": "{}{}")", kind, kind, other_side ? "_2" : "");
    if (kind == "directional") return fmt::format("{{{}, {}}}", top, to);
    if (kind == "spot")
        return fmt::format(R"({{{}, {}, {}, "falloff": "smooth", "cutoff": 70, "inner": 60}})", top, at, to);
    const std::string low = R"("position": [0, 3, 0])";  // over the edge of the board, which halves it
    if (kind == "rectangle") return fmt::format(R"({{{}, {}, "edge_u": [5, 0, 0], "edge_v": [0, 0, 2]}})", top, low);
    if (kind == "disk") return fmt::format(R"({{{}, {}, "direction": [0, -1, 0], "radius": 2}})", top, low);
    if (kind == "sphere") return fmt::format(R"({{{}, {}, "radius": 1.2}})", top, low);
    return fmt::format("{{{}, {}}}", top, at);
}

std::string scene_text(const Question& q) {
    return fmt::format(
        R"({{"camera": {{"eye": [-4, 8, 7], "target": [0, 0, 0], "fov": 40}}, "lights": [{}], "objects": [{}]}})",
        q.lights, q.objects);
}

bool is_area_kind(std::string_view kind) { return kind == "rectangle" || kind == "disk" || kind == "sphere"; }

std::vector<Question> questions(std::span<const std::string_view> kinds) {
    std::vector<Question> all;
    std::string first_hard;
    const std::string box = fmt::format("{}, {}", kFloor, kBox), board = fmt::format("{}, {}", kFloor, kBoard);
    for (const std::string_view kind : kinds)
        if (!is_area_kind(kind)) {
            if (first_hard.empty()) first_hard = kind;
            all.push_back({fmt::format("a box under a {} light", kind), light_text(kind, false), box});
        }
    const std::string_view any = first_hard.empty() ? kinds.front() : std::string_view(first_hard);
    all.push_back({fmt::format("a floor alone under a {} light", any), light_text(any, false), std::string(kFloor)});
    if (!first_hard.empty())
        all.push_back({fmt::format("a box under two {} lights", any),
                       light_text(any, false) + ", " + light_text(any, true), box});
    for (const std::string_view kind : kinds)
        if (is_area_kind(kind))
            all.push_back({fmt::format("half a {} light behind a board", kind), light_text(kind, false), board});
    return all;
}

double rmse(const PointBatch& points, LightId light, const VisibilityPlane& truth,
            const std::function<std::optional<float>(std::size_t)>& answer) {
    double sum    = 0;
    std::size_t n = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points.asks(light, i) || truth.answer[i] != Answer::given) continue;
        const std::optional<float> s = answer(i);
        if (!s) continue;
        sum += (static_cast<double>(*s) - truth.s[i]) * (static_cast<double>(*s) - truth.s[i]);
        ++n;
    }
    return n == 0 ? HUGE_VAL : std::sqrt(sum / static_cast<double>(n));
}

/// One scene, what the method answers there, and the truth.
struct Asked {
    const PreparedScene& prepared;
    const MethodRun& run;
    std::vector<VisibilityPlane> truth;  ///< [light], of the method's measure
    const Method& method;

    /// The answer at point i, or at another point of the raster; nothing where there is none.
    [[nodiscard]] std::optional<float> answer(LightId light, std::size_t i) const {
        const bool there = prepared.points.asks(light, i) && run.planes[light].defined(i);
        return there ? std::optional(run.planes[light].s[i]) : std::nullopt;
    }
    [[nodiscard]] std::optional<float> answer_at(LightId light, std::ptrdiff_t x, std::ptrdiff_t y) const {
        const CameraFrame& raster = *prepared.points.raster;
        if (x < 0 || y < 0 || x >= raster.width || y >= raster.height) return std::nullopt;
        return answer(light, static_cast<std::size_t>(y * raster.width + x));
    }
    [[nodiscard]] double error(LightId light) const {
        return rmse(prepared.points, light, truth[light], [&](std::size_t i) { return answer(light, i); });
    }
};

VisibilityPlane truth_of(const PreparedScene& prepared, LightId light, Measure measure) {
    const Reference reference = default_reference(prepared.facts, measure);
    ReferenceRun ran =
        run_reference(reference, prepared.scene, prepared.facts, prepared.points, prepared.points.size());
    return std::move(ran.run.planes[light]);
}

/// A fault that would explain the answers: undone, it leaves at most this share of the error.
struct Guess {
    std::string why;
    std::function<std::optional<float>(std::size_t)> undone;
    double share = 0.4;
};

std::string reason(const Asked& asked, LightId light) {
    const PointBatch& points = asked.prepared.points;
    std::size_t answered = 0, lit = 0, dark = 0, of_lit = 0, shadowed = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (const auto s = asked.answer(light, i)) {
            ++answered, lit += *s >= 1, dark += *s <= 0;
            if (asked.truth[light].s[i] >= 1) ++of_lit, shadowed += *s < 0.9f;
        }
    if (2 * shadowed > of_lit && dark == answered)
        return "no point is lit: does the surface that a point lies on block its light?";
    if (lit == answered)
        return "every point is lit: are both pictures, with and without shadow, the same? Renderers may keep the shadows "
               "of the render before";
    const double error = asked.error(light);
    const auto same    = [&](std::size_t i) { return asked.answer(light, i); };
    if (is_area(asked.prepared.scene.lights[light].kind)) {
        const Measure other = asked.method.measures() == Measure::area ? Measure::irradiance : Measure::area;
        if (rmse(points, light, truth_of(asked.prepared, light, other), same) < 0.5 * error)
            return fmt::format("these are shares of {}: its introduction must say \"measure\": \"{}\"",
                               other == Measure::area ? "the light's area" : "irradiance", to_string(other));
    }
    for (LightId other = 0; other < asked.truth.size(); ++other)
        if (other != light && rmse(points, light, asked.truth[other], same) < 0.4 * error)
            return "these are the answers of the other light";
    const std::ptrdiff_t width = points.raster->width, height = points.raster->height;
    const auto elsewhere = [&](std::ptrdiff_t x0, std::ptrdiff_t dx, std::ptrdiff_t y0, std::ptrdiff_t dy) {
        return [=, &asked](std::size_t i) {
            const auto k = static_cast<std::ptrdiff_t>(i);
            return asked.answer_at(light, x0 + dx * (k % width), y0 + dy * (k / width));
        };
    };
    const auto changed = [&](const auto& change) {
        return [&asked, light, change](std::size_t i) {
            const auto s = asked.answer(light, i);
            return s ? std::optional<float>(change(*s, i)) : std::nullopt;
        };
    };
    std::vector<Guess> guesses{
        {"0 and 1 are exchanged: 1 is lit", changed([](float s, std::size_t) { return 1 - s; })},
        {"the values are encoded as sRGB: the ratio must be of linear light",
         changed([](float s, std::size_t) { return linear_from_srgb(s); })},
        {"the rows are upside down: they count from the top", elsewhere(0, 1, height - 1, -1)},
        {"left and right are exchanged", elsewhere(width - 1, -1, 0, 1)},
    };
    if (asked.truth.size() == 2)
        guesses.push_back({"these are the answers of both lights together",
                           changed([&](float s, std::size_t i) { return 2 * s - asked.truth[1 - light].s[i]; })});
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
        guesses.push_back({"the answers lie a pixel beside the points", elsewhere(dx, 1, dy, 1), 0.3});
    for (const Guess& guess : guesses)
        if (rmse(points, light, asked.truth[light], guess.undone) < guess.share * error) return guess.why;
    if (2 * shadowed > of_lit)
        return "most lit points are shadowed: does the surface that a point lies on block its light?";
    return "";
}

GateRow judge(const Asked& asked, const std::string& question) {
    const PreparedScene& prepared = asked.prepared;
    GateRow row{question, ""};
    for (LightId light = 0; light < prepared.scene.lights.size(); ++light) {
        const VisibilityPlane& plane = asked.run.planes[light];
        const bool area              = is_area(prepared.scene.lights[light].kind);
        const VisibilityError e = visibility_error(prepared.points, light, plane, asked.truth[light], kAreaTolerance);
        const auto asked_points = static_cast<double>(e.points + e.undefined);
        const double wrong      = static_cast<double>(e.false_shadow.interior + e.false_light.interior) /
                             static_cast<double>(std::max<std::uint64_t>(e.points, 1));
        std::string found = fmt::format("{} points answered, {:.2g} % wrong away from edges", e.points, 100 * wrong);
        if (area) found += fmt::format(", mean error {:.3f}, bias {:+.3f}", e.mae, e.bias);
        if (e.undefined > 0) found += fmt::format(", {} undefined", e.undefined);
        const bool few = static_cast<double>(e.points) < kLeastAnswered * asked_points || e.points == 0;
        bool bad       = wrong > (area ? kMostWrongArea : kMostWrong) ||
                   (area && (e.mae > kMostMean || std::abs(e.bias) > kMostBias));
        if (few) found += ": too few are answered";
        if (e.points > 0 && (bad || asked.error(light) > kWorthAReason))
            if (const std::string why = reason(asked, light); !why.empty()) {
                bad = true;
                found += ": " + why;
            }
        row.passed = row.passed && !few && !bad;
        row.found += (row.found.empty() ? "" : "; ") + found;
    }
    return row;
}

/// The same questions again, and of other points than a raster's.
GateRow ask_again(const MethodInfo& info, const MethodRun& run, const PreparedScene& prepared,
                  const std::string& question) {
    GateRow row{question + ", again", "the same answers"};
    const VisibilityPlane& before = run.planes[0];
    const auto has_answer         = [&](std::size_t i) { return prepared.points.asks(0, i) && before.defined(i); };
    std::vector<std::uint32_t> all(prepared.points.size()), some;
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    if (std::ranges::none_of(all, has_answer)) return {row.question, "no answers to compare", false};
    const auto differing = [&](const VisibilityPlane& now, const std::vector<std::uint32_t>& which) {
        std::size_t n = 0;
        for (std::size_t k = 0; k < which.size(); ++k) n += has_answer(which[k]) && now.s[k] != before.s[which[k]];
        return n;
    };
    VisibilityPlane again(prepared.points.size());
    run.work->visibility(0, again.out());
    if (const std::size_t n = differing(again, all); n > 0) {
        row.passed = false;
        row.found = fmt::format("{} of {} answers differ, though no parameter is named as its \"seed\"", n, all.size());
        return row;
    }
    if (info.needs_raster) return row;
    for (std::uint32_t i = static_cast<std::uint32_t>(all.size()); i-- > 0;)
        if (i % 7 == 3 && prepared.points.triangle[i] != kNoTriangle) some.push_back(i);
    const PointBatch points   = pick(prepared.points, some);
    const VisibilityPlane few = run.work->ask(points, 0);
    row.found += ", also at some of the points in another order";
    if (const std::size_t n = differing(few, some); n > 0 && info.seed.empty()) {
        row.passed = false;
        row.found  = fmt::format(
             "{} of {} answers differ where only some of the points are asked, in another order: the "
              "answers must be of the points in the file",
             n, some.size());
    }
    return row;
}

}  // namespace

std::vector<GateRow> gate(const MethodInfo& info, const std::function<void(const std::string&)>& progress) {
    const MethodChoice choice(info);
    const auto method = choice.make();
    std::vector<std::string_view> kinds;
    SceneFacts facts;
    for (const LightKind kind : {LightKind::point, LightKind::directional, LightKind::spot, LightKind::rectangle,
                                 LightKind::disk, LightKind::sphere}) {
        facts.lights = {{"light", kind}};
        if (method->serves(facts)) kinds.push_back(to_string(kind));
    }
    std::vector<GateRow> rows;
    if (kinds.empty()) return {{"its lights", "it serves no kind of light", false}};
    const ScratchFolder folder;
    for (const Question& question : questions(kinds)) {
        if (progress) progress(question.name);
        const auto file = folder.path() / "gate.json";
        write_text(file, scene_text(question));
        const PreparedScene prepared = prepare_scene(file, kRaster);
        try {
            const MethodRun run = run_method(choice, prepared.scene, prepared.facts, prepared.points);
            Asked asked{prepared, run, {}, *method};
            for (LightId j = 0; j < prepared.scene.lights.size(); ++j)
                asked.truth.push_back(truth_of(prepared, j, method->measures()));
            rows.push_back(judge(asked, question.name));
            if (rows.size() == 1) rows.push_back(ask_again(info, run, prepared, question.name));
        } catch (const std::exception& e) {
            rows.push_back({question.name, e.what(), false});
        }
    }
    return rows;
}

}  // namespace umbra
