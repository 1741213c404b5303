// `umbra brdf`: are the reflectance functions of a scene's materials physical?
#pragma once

#include <string>
#include <vector>

#include "umbra/bench/studies/study_report.h"
#include "umbra/core/render/brdf.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

template <class Fields>
void describe(Fields& of, Is<BrdfFigures>) {
    of("largest", &BrdfFigures::largest, "");
    of("reciprocity", &BrdfFigures::reciprocity, "");
    of("anisotropy", &BrdfFigures::anisotropy, "");
    of("energy", &BrdfFigures::energy, "null where a highlight lasts up to the horizon");
    of("without_cosine", &BrdfFigures::without_cosine, "");
}

struct BrdfFormRecord {
    std::string form{};
    BrdfFigures figures{};
};
template <class Fields>
void describe(Fields& of, Is<BrdfFormRecord>) {
    of("form", &BrdfFormRecord::form, "", one_of({"sum", "with_cosine"}));
    of.all(&BrdfFormRecord::figures);
}

struct MaterialFormsRecord {
    std::string name{};
    std::vector<BrdfFormRecord> forms{};
};
template <class Fields>
void describe(Fields& of, Is<MaterialFormsRecord>) {
    of("name", &MaterialFormsRecord::name, "");
    of("forms", &MaterialFormsRecord::forms, "");
}

struct BrdfRecord {
    HeadRecord head{};
    SceneRecord scene{};
    int steps = 0;
    std::vector<MaterialFormsRecord> materials{};
};
template <class Fields>
void describe(Fields& of, Is<BrdfRecord>) {
    of.all(&BrdfRecord::head);
    of("scene", &BrdfRecord::scene, "");
    of("steps", &BrdfRecord::steps, "angles from the normal that are sampled");
    of("materials", &BrdfRecord::materials, "");
}

/// Measures every material of the scene by sampling (measure_brdf, with `steps`), as the sum has it and as a function
/// that is multiplied by N.L.
[[nodiscard]] BrdfRecord measure_materials(const Scene& scene, int steps, const std::string& command);

/// The table for people, with a verdict a form: what it breaks of reciprocity, energy, isotropy.
[[nodiscard]] StudyReport brdf_report(const BrdfRecord& record);

}  // namespace umbra
