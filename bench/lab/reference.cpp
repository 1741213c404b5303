#include "umbra/bench/lab/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/core/base/random_bits.h"

namespace umbra {
namespace {

/// An exact point of a penumbra costs about the triangles between it and the light. Pictures of up to kWhole points
/// times triangles are answered whole, if what the method counts at kProbe of the points promises no more than
/// kWholeSteps for all of them: less than a minute of one core. Beyond, the sample has kSampled over the triangles, or
/// kSampledSteps over the steps of a point, within these limits: of 16384 points a share of 1 % is known to 0.08 %, of
/// 2048 to 0.2 %.
constexpr double kWhole = 3e9, kSampled = 1e9;
constexpr double kWholeSteps = 1.5e8, kSampledSteps = 5e7;
constexpr double kFewest = 2048, kMost = 16384;
constexpr std::uint64_t kProbe = 256;

bool has_surface(const PointBatch& points, std::size_t i) { return points.triangle[i] != kNoTriangle; }

std::uint64_t surface_points(const PointBatch& points) {
    return points.size() - static_cast<std::uint64_t>(std::ranges::count(points.triangle, kNoTriangle));
}

/// What the method counts at one of these points, for all area lights together.
double steps_of_a_point(MethodAtWork& work, const Scene& scene, const SceneFacts& facts, const PointBatch& points,
                        std::optional<LightId>* at) {
    std::atomic<std::uint64_t> steps = 0;
    work.look(points);
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        if (!is_area(scene.lights[light].kind)) continue;
        if (at != nullptr) *at = light;
        VisibilityPlane plane(points.size(), facts.has_coloured_filters);
        Visibility out = plane.out();
        out.steps      = &steps;
        work.visibility(light, out);
    }
    if (at != nullptr) at->reset();
    work.forget_look();
    return static_cast<double>(steps) / static_cast<double>(points.size());
}

/// At how many of `all` points with a surface the reference answers for area lights.
std::uint64_t affordable(MethodAtWork& work, const Scene& scene, const SceneFacts& facts, const PointBatch& points,
                         std::uint64_t all, std::optional<LightId>* at) {
    const std::uint64_t by_triangles = affordable_points(all, scene.triangles.size(), 0);
    if (by_triangles < all || all <= kProbe) return by_triangles;
    const double steps = steps_of_a_point(work, scene, facts, pick(points, stratified_sample(points, kProbe)), at);
    return affordable_points(all, scene.triangles.size(), steps);
}

/// The answers at the sample and those of the substitute method elsewhere, which are never compared.
void scatter(MethodRun& run, LightId light, const std::vector<std::uint32_t>& sample, const VisibilityPlane& stand_in,
             const PointBatch& points) {
    VisibilityPlane whole = stand_in;
    std::vector<std::uint8_t> judged(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) judged[i] = !points.asks(light, i);
    const VisibilityPlane& answers = run.planes[light];
    for (std::size_t k = 0; k < sample.size(); ++k) {
        whole.s[sample[k]]          = answers.s[k];
        whole.answer[sample[k]]     = answers.answer[k];
        whole.half_width[sample[k]] = answers.half_width[k];
        if (!whole.colour.empty()) whole.colour[sample[k]] = answers.colour[k];
        judged[sample[k]] = 1;
    }
    run.planes[light] = std::move(whole);
    run.judged[light] = std::move(judged);
}

/// The same method, answering this measure. Throws UsageError where it cannot.
MethodChoice of_measure(MethodChoice choice, Measure measure) {
    if (choice.make()->measures() == measure) return choice;
    choice.settings.set("measure", to_string(measure));
    if (choice.make()->measures() != measure)
        throw UsageError(fmt::format("{} does not measure {}", choice.info->name, to_string(measure)));
    return choice;
}

/// `why` there is no exact one: sentences, each after a space.
Reference substitute(Measure measure, const std::string& why) {
    const MethodChoice choice = of_measure(parse_method(kStandIn), measure);
    return {choice, false, fmt::format("{}: better sampled, not exact.{}", choice.info->title, why)};
}

}  // namespace

std::uint64_t affordable_points(std::uint64_t all, std::size_t triangles, double steps_of_a_point) {
    const auto points = static_cast<double>(all), each = static_cast<double>(triangles);
    double most = points;
    if (points * each > kWhole) most = std::clamp(kSampled / each, kFewest, kMost);
    if (points * steps_of_a_point > kWholeSteps)
        most = std::min(most, std::clamp(kSampledSteps / steps_of_a_point, kFewest, kMost));
    return std::min(all, static_cast<std::uint64_t>(most));
}

std::vector<std::uint32_t> stratified_sample(const PointBatch& points, std::uint64_t wanted) {
    const auto width   = static_cast<std::size_t>(points.raster->width),
               height  = static_cast<std::size_t>(points.raster->height);
    const double share = static_cast<double>(surface_points(points)) / static_cast<double>(wanted);
    const auto side    = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(std::sqrt(share))));
    std::vector<std::uint32_t> sample, tile;
    for (std::size_t top = 0; top < height; top += side)
        for (std::size_t left = 0; left < width; left += side) {
            tile.clear();
            for (std::size_t y = top; y < std::min(height, top + side); ++y)
                for (std::size_t x = left; x < std::min(width, left + side); ++x)
                    if (has_surface(points, y * width + x)) tile.push_back(static_cast<std::uint32_t>(y * width + x));
            if (!tile.empty()) sample.push_back(tile[mixed_bits(top * width + left) % tile.size()]);
        }
    return sample;
}

Reference default_reference(const SceneFacts& facts, Measure measure) {
    std::string why;
    for (const MethodInfo* info : methods()) {
        if (!info->reference) continue;
        const MethodChoice choice = of_measure(MethodChoice(*info), measure);
        const Service service     = verdict(*choice.make(), facts);
        if (service) return {choice, service.how == How::exactly, service.why};
        why += fmt::format(" {} does not serve here: {}.", info->title, service.why);
    }
    return substitute(measure, why);
}

ReferenceRun run_reference(const Reference& reference, const Scene& scene, const SceneFacts& facts,
                           const PointBatch& points, std::optional<std::uint64_t> wanted, std::optional<LightId>* at,
                           const Budget& budget, std::shared_ptr<MethodAtWork> work) {
    const bool is_shared    = work != nullptr;
    const std::uint64_t all = surface_points(points);
    const bool any_area     = std::ranges::any_of(scene.lights, [](const Light& l) { return is_area(l.kind); });
    ReferenceRun done{MethodRun{reference.choice}, all, all, {}};
    MethodRun& run = done.run;
    run            = begin_run(reference.choice, scene, facts, budget, std::move(work));
    if (!run.service)
        throw UsageError(
            fmt::format("{} cannot be the reference of this scene: {}", reference.choice.info->name, run.service.why));
    // Only the exact reference is slow: every other one answers for the whole picture, unless `wanted` says otherwise.
    if (!wanted)
        wanted =
            any_area && reference.choice.info->reference ? affordable(*run.work, scene, facts, points, all, at) : all;
    if (!is_shared) run.work->forget_build();  // of the count of steps: here it is timed
    std::optional<MethodRun> stand_in;
    if (any_area && *wanted < all)
        stand_in = run_method(of_measure(parse_method(kStandIn), run.work->method().measures()), scene, facts, points);
    if (!stand_in || !stand_in->service) {  // where nothing stands in, every point is the reference's, however long
        run_phases(run, points, scene.lights.size(), at);
    } else {
        const std::vector<std::uint32_t> sample = stratified_sample(points, std::max<std::uint64_t>(*wanted, 1));
        const PointBatch sampled                = pick(points, sample);
        run_build(run);
        run.judged.resize(scene.lights.size());
        for (LightId light = 0; light < scene.lights.size(); ++light) {
            const bool area = is_area(scene.lights[light].kind);
            if (at != nullptr) *at = light;
            run_light(run, area ? sampled : points, light);
            if (area) scatter(run, light, sample, stand_in->planes[light], points);
        }
        note_memory(run);
        run.work->forget_look();  // at points that end here
        done.judged   = sample.size();
        done.stand_in = stand_in->choice.text();
    }
    run.work->lift_limit();  // it is asked further, for others
    return done;
}

Failure failure(const MethodChoice& choice, std::optional<LightId> light) {
    try {
        throw;
    } catch (const CutShort& e) {
        return {choice.text(), light, e.what(), true};
    } catch (...) {
        return {choice.text(), light, current_message()};
    }
}

Truths::Truths(const Scene& scene, const SceneFacts& facts, const PointBatch& points, TruthOptions options)
    : scene_(scene), facts_(facts), points_(points), options_(std::move(options)) {}

const Truth& Truths::main() {
    if (main_) return *main_;
    if (!options_.reference) return main_.emplace(found(default_reference(facts_), true));
    Reference named{parse_method(*options_.reference), false, "Chosen on the command line."};
    named.exact = verdict(*named.choice.make(), facts_).how == How::exactly;
    return main_.emplace(found(std::move(named), false));
}

const Truth& Truths::of(const Method& method) {
    const Truth& here     = main();
    const Measure measure = method.measures();
    if (facts_.hard_lights_only || here.ran.run.work->method().measures() == measure) return here;
    const auto known = others_.find(measure);
    if (known != others_.end()) return known->second;
    return others_.emplace(measure, found(default_reference(facts_, measure), true)).first->second;
}

Truth Truths::found(Reference reference, bool replaceable) const {
    if (options_.progress) options_.progress("reference " + reference.choice.text());
    ReferenceRun ran{MethodRun{reference.choice}, 0, 0, {}};
    if (options_.find && options_.find(reference, ran)) {
        ran.run.work    = std::make_shared<MethodAtWork>(reference.choice, scene_, facts_);
        ran.run.service = ran.run.work->service();
        return {std::move(reference), std::move(ran)};
    }
    std::optional<LightId> at;
    try {
        ran = run_reference(reference, scene_, facts_, points_, options_.points, &at, options_.budget,
                            options_.at_work ? options_.at_work(reference.choice) : nullptr);
        if (options_.keep) options_.keep(reference, ran);
        return {std::move(reference), std::move(ran)};
    } catch (const InputError&) {  // a file that cannot be written is no fault of the method
        throw;
    } catch (...) {
        if (!replaceable) throw;
        Failure failed = failure(reference.choice, at);
        reference =
            substitute(reference.choice.make()->measures(),
                       fmt::format(" {} failed{}: {}.", reference.choice.info->title,
                                   at ? fmt::format(" at light {}", scene_.lights[*at].name) : "", failed.message));
        ran = run_reference(reference, scene_, facts_, points_, options_.points);
        return {std::move(reference), std::move(ran), std::move(failed)};
    }
}

}  // namespace umbra
