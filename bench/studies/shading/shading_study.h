// `umbra shading`: one scene under every shading model, with the same S_j: what the cheaper models cost in error.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/prepare.h"
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
/// difference from `phong`, and stages as draw_stages has them. Throws InputError.
[[nodiscard]] ShadingRecord compare_shading(const PreparedScene& prepared, const ShadingOptions& options,
                                            const std::filesystem::path& folder);

/// Every model beside its difference from Phong shading, and what was found.
[[nodiscard]] StudyReport shading_report(const ShadingRecord& record);

}  // namespace umbra
