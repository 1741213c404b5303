// `umbra shading --max`: the cheapest shading model whose errors stay within limits, and the front of those that no
// other beats in both time and error.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/lab/describe.h"

namespace umbra {

/// Of the differences from `phong` in the record of a study.
inline constexpr std::array<std::string_view, 3> kShadingErrors{"rmse", "flip", "perceived"};

/// An error must not exceed `most` in any view.
struct ShadingLimit {
    std::string metric{};  ///< of kShadingErrors
    double most = 0;
};
DESCRIBE(ShadingLimit) { MEMBERS(metric, most); }
/// "METRIC=E", E at least 0. Throws UsageError.
[[nodiscard]] ShadingLimit parse_shading_limit(const std::string& text);

/// Of a model, from `phong`.
struct ShadingErrorsRecord {
    double rmse      = kUnknown;
    double flip      = kUnknown;
    double perceived = kUnknown;
};
DESCRIBE(ShadingErrorsRecord) { MEMBERS(rmse, flip, perceived); }

struct ShadingModelRecord {
    std::string name{};
    std::uint64_t evaluations = 0;
    std::uint64_t asked       = 0;
    double ms                 = kUnknown;
    std::vector<double> times_ms{};
    double rmse = kUnknown;
    ShadingErrorsRecord worst{};
    double flip      = kUnknown;
    double perceived = kUnknown;
    double highlight = kUnknown;
    double kink      = kUnknown;
    std::string picture{};
    std::string difference{};
};
DESCRIBE(ShadingModelRecord) {
    MEMBERS(name);
    of(MEMBER(evaluations), "of the sum");
    of(MEMBER(asked), "S_j");
    of(MEMBER(ms), "the median of the rounds, aim and visibility included");
    of(MEMBER(times_ms), "of all rounds");
    of(MEMBER(rmse), "from `phong`, as the next ones");
    of(MEMBER(worst), "the largest errors over all views");
    MEMBERS(flip);
    of(MEMBER(perceived),
       "root mean square, inside of objects, of the luminance plus the size of its change along the row");
    of(MEMBER(highlight), "the largest value in the picture over that of `phong`");
    of(MEMBER(kink),
       "Mach bands: the root mean square of second differences along rows, inside of objects, of the diffuse light "
       "without shadows, over that of `phong`");
    MEMBERS(picture, difference);
}

/// A paired ratio of times, and its interval.
struct ShadingRatioRecord {
    std::string model{};
    double ratio    = kUnknown;
    double low      = kUnknown;
    double high     = kUnknown;
    int rounds      = 0;
    double coverage = kUnknown;
};
DESCRIBE(ShadingRatioRecord) {
    MEMBERS(model, ratio);
    of(MEMBER(low), "null: too few rounds");
    MEMBERS(high, rounds, coverage);
}

struct NearestShadingRecord {
    std::string model{};
    double factor = kUnknown;
};
DESCRIBE(NearestShadingRecord) {
    MEMBERS(model);
    of(MEMBER(factor), "its largest error over its limit");
}

struct ShadingChoiceRecord {
    std::vector<ShadingLimit> limits{};
    std::optional<std::string> model{};
    std::optional<double> ms{};
    std::optional<ShadingRatioRecord> of_phong{};
    std::vector<std::string> tied{};
    std::optional<ShadingRatioRecord> runner_up{};
    std::optional<NearestShadingRecord> nearest{};
};
DESCRIBE(ShadingChoiceRecord) {
    MEMBERS(limits);
    of(MEMBER(model),
       "with the least median time of those whose worst errors are within the limits; none above a noise bar of 30 %");
    MEMBERS(ms, of_phong);
    of(MEMBER(tied),
       "within the limits, and as cheap as far as noise lets one see; all of them where `model` is absent");
    of(MEMBER(runner_up), "the cheapest other one within the limits that is not tied");
    of(MEMBER(nearest), "where none is within the limits: its largest error over its limit is least");
}

struct ShadingStageRecord {
    std::string name{};
    std::string about{};
    std::string picture{};
};
DESCRIBE(ShadingStageRecord) { MEMBERS(name, about, picture); }

struct ShadingRecord {
    HeadRecord head{};
    SceneRecord scene{};
    std::optional<std::string> method{};
    int views        = 0;
    double noise_bar = kUnknown;
    std::vector<ShadingModelRecord> models{};
    std::vector<std::string> front{};
    std::optional<ShadingChoiceRecord> choice{};
    std::vector<ShadingStageRecord> stages{};
    std::vector<std::string> csv{};
};
DESCRIBE(ShadingRecord) {
    of.all(&R::head);
    MEMBERS(scene);
    of(MEMBER(method), "of the shadows");
    MEMBERS(views);
    of(MEMBER(noise_bar), "how far from 1 the ratio of the time of `phong` to that of the same again may lie");
    MEMBERS(models);
    of(MEMBER(front), "no other model is both faster and closer; empty above a noise bar of 30 %");
    of.may(MEMBER(choice));
    MEMBERS(stages, csv);
}

/// Names of models by ascending time: no other has at most the median of `times_ms` and at most the `worst.rmse`, and
/// less of one.
[[nodiscard]] std::vector<std::string> shading_front(const std::vector<ShadingModelRecord>& models);

[[nodiscard]] ShadingChoiceRecord choose_shading(const ShadingRecord& record, std::span<const ShadingLimit> limits);

/// Sentences on the front and, where there is one, the choice.
[[nodiscard]] std::vector<std::string> shading_findings(const ShadingRecord& record);

}  // namespace umbra
