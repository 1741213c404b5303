// `umbra brdf`: are the reflectance functions of a scene's materials physical?
#pragma once

#include <string>
#include <vector>

#include "umbra/bench/studies/study_report.h"
#include "umbra/core/render/brdf.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

DESCRIBE(BrdfFigures) {
    MEMBERS(largest, reciprocity, anisotropy);
    of(MEMBER(energy), "null where a highlight lasts up to the horizon");
    MEMBERS(without_cosine);
}

struct BrdfFormRecord {
    std::string form{};
    BrdfFigures figures{};
};
DESCRIBE(BrdfFormRecord) {
    of(MEMBER(form), "", one_of({"sum", "with_cosine"}));
    of.all(&R::figures);
}

struct MaterialFormsRecord {
    std::string name{};
    std::vector<BrdfFormRecord> forms{};
};
DESCRIBE(MaterialFormsRecord) { MEMBERS(name, forms); }

struct BrdfRecord {
    HeadRecord head{};
    SceneRecord scene{};
    int steps = 0;
    std::vector<MaterialFormsRecord> materials{};
};
DESCRIBE(BrdfRecord) {
    of.all(&R::head);
    MEMBERS(scene);
    of(MEMBER(steps), "angles from the normal that are sampled");
    MEMBERS(materials);
}

/// Measures every material of the scene by sampling (measure_brdf, with `steps`), as the sum has it and as a function
/// that is multiplied by N.L.
[[nodiscard]] BrdfRecord measure_materials(const Scene& scene, int steps, const std::string& command);

/// The table for people, with a verdict a form: what it breaks of reciprocity, energy, isotropy.
[[nodiscard]] StudyReport brdf_report(const BrdfRecord& record);

}  // namespace umbra
