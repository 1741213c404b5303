// The first answer of `umbra recommend`: the cheapest setting that was found within the limits in a few seconds, on a
// picture of few points. Provisional: it is to use until the search of all settings has ended.
#pragma once

#include <optional>
#include <vector>

#include "umbra/bench/sweep/recommend/recommend.h"

namespace umbra {

/// Bounds are those of upper_bound, in the order of the limits; the cost is by one run on the whole picture, or by one
/// at few points where that takes over half a second.
struct FirstAnswer : FirstAnswerRecord {
    MethodChoice choice;
};

/// How many views the first answer is from.
inline constexpr int kFirstViews = 3;

/// The picture that a first answer is from: as many points as it takes to know that an error of 0 is within the limits,
/// and at least 60,000, so that most limits share their pictures; the whole one where that is no more, or where a limit
/// is of a metric that depends on the size, as all do but mean errors of S_j and of the linear picture.
[[nodiscard]] Size first_size(const Size& whole, std::span<const Limit> limits);

/// `coarse` is the scene of `whole` at first_size; costs are those of `whole`. The reference is looked at first, then
/// of all families the settings from the cheapest on, always where the one before was cheapest; a family ends with one
/// that is within the limits, or dearer than the cheapest that is. Where settings that earlier questions have looked at
/// are within the limits, the answer is the cheapest of those, by its cost in small pictures; those that would take long
/// to look at again are left out, and where the limit is tighter, what held in smaller pictures is looked at first. A
/// setting whose run takes long is left out. Begins with nothing after `seconds`. Nothing where no setting is within the
/// limits.
[[nodiscard]] std::optional<FirstAnswer> first_answer(SceneLab& coarse, SceneLab& whole,
                                                      const RecommendOptions& options, double seconds);

/// "ray_traced: about 3.1 ms a frame ...", two lines.
[[nodiscard]] std::string first_answer_text(const FirstAnswer& answer, const RecommendOptions& options);

}  // namespace umbra
