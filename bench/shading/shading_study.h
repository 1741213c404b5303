// `umbra shading`: one scene under every shading model, with the same S_j: what the cheaper models cost in error.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/shadows/method.h"

namespace umbra {

struct ShadingOptions {
    std::optional<MethodChoice> method;  ///< of the shadows; none: S_j = 1 where a light is in front
    int runs = 3;                        ///< of each model, for its time
    std::string command;
};

/// The method must serve the scene. Writes into `folder`, of each model, MODEL.png and MODEL_difference.png, the
/// difference from `phong`. Returns {schema, version, command, scene, method, models: [{name, evaluations, asked, ms,
/// rmse, flip, perceived, highlight, kink, picture, difference}]}: of the sum; of S_j; least of the runs, aim and
/// visibility included; two image errors against `phong`; the root mean square difference from `phong`, inside of
/// objects, of the luminance plus the size of its change along the row; the largest value in the picture over that of
/// `phong`; the root mean square of second differences along rows, inside of objects, of the diffuse light without
/// shadows, over that of `phong`: Mach bands. `stages`: [{name, about, picture}], as draw_stages has them. Throws
/// InputError.
[[nodiscard]] Json compare_shading(const PreparedScene& prepared, const ShadingOptions& options,
                                   const std::filesystem::path& folder);

/// The table for people.
[[nodiscard]] std::string shading_text(const Json& record);

}  // namespace umbra
