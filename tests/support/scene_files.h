// Scene files made on the spot, what comes of reading them, and mutants of them.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/mutant.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {

/// The message with which a file is refused; empty if it is not.
inline std::string refusal(const std::filesystem::path& file) {
    try {
        (void)load_scene(file);
        return "";
    } catch (const InputError& e) {
        return e.what();
    }
}

inline bool warns(const Scene& scene, std::string_view part) {
    for (const std::string& w : scene.warnings)
        if (w.find(part) != std::string::npos) return true;
    return false;
}

/// What every loaded scene promises, whatever was in its file.
inline void expect_sound(const Scene& scene) {
    ASSERT_EQ(scene.normals.size(), scene.positions.size());
    ASSERT_EQ(scene.triangle_object.size(), scene.triangles.size());
    std::size_t covered = 0;
    for (const Object& o : scene.objects) {
        ASSERT_EQ(o.first_triangle, covered);
        ASSERT_LT(o.material, scene.materials.size());
        covered += o.triangle_count;
    }
    ASSERT_EQ(covered, scene.triangles.size());
    for (const uvec3& t : scene.triangles) ASSERT_LT(std::max({t.x, t.y, t.z}), scene.positions.size());
    for (const vec3 p : scene.positions)
        ASSERT_TRUE(std::abs(p.x) <= 1e18f && std::abs(p.y) <= 1e18f && std::abs(p.z) <= 1e18f);
    for (const vec3 n : scene.normals) {
        const float l = glm::length(n);
        ASSERT_TRUE(l == 0 || std::abs(l - 1) < 1e-5f) << l;
    }
    ASSERT_FALSE(scene.lights.empty());
}

/// Reads mutants of the files: each must be refused with a message that names the file, or make a sound scene.
/// UMBRA_MUTANTS sets how many of each file. The same ones every time. `assemble` makes a file of what was changed, so
/// that changes get past checksums and lengths.
inline void expect_survives_mutants(
    const std::string& ending, const std::vector<std::string>& originals,
    const std::function<std::string(std::string)>& assemble = [](const std::string& s) { return s; }) {
    const char* said  = std::getenv("UMBRA_MUTANTS");
    const int mutants = said ? std::atoi(said) : 100;
    const TemporaryFolder folder;
    int loaded = 0;
    for (std::size_t o = 0; o < originals.size(); ++o) {
        std::mt19937 random(static_cast<unsigned>(o + 1));
        for (int i = 0; i < mutants; ++i) {
            const auto file = folder.write("mutant." + ending, assemble(mutant(originals[o], random)));
            try {
                const Scene scene = load_scene(file);
                expect_sound(scene);
                ++loaded;
            } catch (const InputError& e) {
                EXPECT_EQ(std::string(e.what()).rfind(file.string(), 0), 0u) << e.what();
            } catch (const std::exception& e) {
                ADD_FAILURE() << "mutant " << i << " of file " << o << ": " << e.what();
            }
            if (::testing::Test::HasFailure()) FAIL() << "mutant " << i << " of file " << o;
        }
    }
    EXPECT_GT(loaded, 0) << "every mutant was refused, so the readers were hardly tried";
}

}  // namespace umbra
