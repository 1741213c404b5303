// `umbra brdf`: are the reflectance functions of a scene's materials physical?
#pragma once

#include <string>

#include "umbra/bench/studies/study_report.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// Measures every material of the scene by sampling (measure_brdf, with `steps`), as the sum has it and as a function
/// that is multiplied by N.L. Returns {schema, version, command, scene, steps, materials: [{name, forms: [{form:
/// "sum" or "with_cosine", largest, reciprocity, anisotropy, energy, without_cosine}]}]}; null: not finite, which the
/// sum's form is where a highlight lasts up to the horizon.
[[nodiscard]] Json measure_materials(const Scene& scene, int steps, const std::string& command);

/// The table for people, with a verdict a form: what it breaks of reciprocity, energy, isotropy.
[[nodiscard]] StudyReport brdf_report(const Json& record);

}  // namespace umbra
