// `umbra shading`: one scene under every shading model, with the same S_j: what the cheaper models cost in error.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/bench/studies/shading/shading_choice.h"
#include "umbra/bench/studies/study_report.h"
#include "umbra/shadows/method.h"

namespace umbra {

struct ShadingOptions {
    std::optional<MethodChoice> method;  ///< of the shadows; none: S_j = 1 where a light is in front
    int runs  = 6;                       ///< rounds, in each of which every model runs once
    int views = 1;                       ///< that errors are taken from: the scene's own, and others (view_of)
    std::vector<ShadingLimit> limits{};  ///< none: nothing is chosen
    std::string command;
};

/// The method must serve the scene. Writes into `folder`, of each model, MODEL.png and MODEL_difference.png, the
/// difference from `phong`. Returns {schema, version, command, scene, method, models: [{name, evaluations, asked, ms,
/// times_ms, rmse, flip, perceived, worst, highlight, kink, picture, difference}]}: of the sum; of S_j; the median of
/// the rounds, aim and visibility included, and all of them; two image errors against `phong`; the root mean square
/// difference from `phong`, inside of objects, of the luminance plus the size of its change along the row; the largest
/// of these three over all views; the largest value in the picture over that of `phong`; the root mean square of second
/// differences along rows, inside of objects, of the diffuse light without shadows, over that of `phong`: Mach bands.
/// `noise_bar`: how far from 1 the ratio of `phong`'s time to that of the same again may lie. `front` and, with limits,
/// `choice`: shading_choice.h. `stages`: [{name, about, picture}], as draw_stages has them. Throws InputError.
[[nodiscard]] Json compare_shading(const PreparedScene& prepared, const ShadingOptions& options,
                                   const std::filesystem::path& folder);

/// Every model beside its difference from Phong shading, and what was found, of the record of compare_shading.
[[nodiscard]] StudyReport shading_report(const Json& record);

}  // namespace umbra
