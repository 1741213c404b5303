// `umbra brdf`: its record and its table, of materials whose reflectance is known.
#include "umbra/bench/studies/brdf/brdf_table.h"

#include <gtest/gtest.h>

#include <sstream>

namespace umbra {
namespace {

Scene two_materials() {
    Scene scene;
    scene.name = "two";
    scene.materials.resize(2);
    scene.materials[0].name = "matt", scene.materials[0].k_d = vec3(0.75f);
    scene.materials[1].name = "shiny", scene.materials[1].k_d = vec3(0), scene.materials[1].k_s = vec3(1);
    scene.materials[1].shininess = 5;
    return scene;
}

/// 2.9: the closed form of docs/photometry.md for 89 degrees.
TEST(BrdfTable, LambertIsPhysicalAndTheSumsHighlightIsNot) {
    const BrdfRecord record = measure_materials(two_materials(), 64, "umbra brdf two");
    ASSERT_EQ(record.materials.size(), 2u);
    const MaterialFormsRecord& matt = record.materials[0];
    EXPECT_EQ(matt.name, "matt");
    for (const BrdfFormRecord& form : matt.forms) {
        EXPECT_NEAR(form.figures.energy, 0.75, 1e-3) << form.form;
        EXPECT_NEAR(form.figures.without_cosine, 1.5, 1e-3);
        EXPECT_LT(form.figures.reciprocity, 1e-9);
    }
    const BrdfFormRecord &sum = record.materials[1].forms[0], &with_cosine = record.materials[1].forms[1];
    EXPECT_EQ(sum.form, "sum");
    EXPECT_NEAR(sum.figures.energy, 2.9, 0.1);
    EXPECT_GT(sum.figures.reciprocity, 0.1);
    EXPECT_EQ(with_cosine.form, "with_cosine");
    EXPECT_NEAR(with_cosine.figures.energy, 1, 5e-3);
    EXPECT_LT(with_cosine.figures.reciprocity, 1e-9);
}

TEST(BrdfTable, SaysWhatEachFormBreaks) {
    std::istringstream lines(study_text(brdf_report(measure_materials(two_materials(), 16, ""))));
    std::vector<std::string> endings;
    for (std::string line; std::getline(lines, line);) endings.push_back(line.substr(line.rfind("  ") + 2));
    EXPECT_EQ(endings,
              (std::vector<std::string>{"verdict", "physical", "physical", "breaks reciprocity, energy", "physical"}));
}

}  // namespace
}  // namespace umbra
