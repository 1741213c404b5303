// A break shown again: a small scene with it, and what it looks like.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/lab/results.h"
#include "umbra/bench/ladders/ladder_run.h"

namespace umbra {

/// What a break is shown by: files in the folder of breaks, the size of the scene, and the errors on it.
struct BreakRecord {
    std::string scene{}, visibility{}, truth{}, classes{}, light{};
    std::uint64_t width = 0, height = 0, triangles = 0, triangles_before = 0, points = 0, interior = 0;
    std::string reference{};
    std::vector<ExplainedPointRecord> explained{};
};
DESCRIBE(BreakRecord) {
    of.name("break");
    of.must(MEMBER(scene), "a reduced scene that reproduces the break, which the pictures show");
    of.must(MEMBER(visibility));
    of.must(MEMBER(truth));
    of.must(MEMBER(classes));
    MEMBERS(light, width, height, triangles, triangles_before, points, interior);
    of.may(MEMBER(reference), "as typed");
    of.may(MEMBER(explained), "of each class of interior errors the most telling point");
}

/// Reduces the scene of the rung where the method broke, and writes NAME.json (a native scene), and the S of the
/// method, of the truth, and the classes of the errors as PNGs into `folder`. Explains the points that show the errors
/// best.
BreakRecord write_break(const std::filesystem::path& folder, const std::string& name, const Ladder& ladder,
                        double value, const MethodChoice& method);

/// A part of the scene for which `still` holds as it does for the whole: lights, objects and triangles without which it
/// holds, too, are dropped, until none can go or `trials` scenes have been asked.
/// [Andreas Zeller, Ralf Hildebrandt, Simplifying and Isolating Failure-Inducing Input, 2002]
[[nodiscard]] Scene minimal_scene(Scene scene, const std::function<bool(const Scene&)>& still, int trials);

}  // namespace umbra
