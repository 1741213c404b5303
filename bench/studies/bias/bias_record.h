// What `umbra bias` found, as a record: counts of wrong points over the grid of biases.
#pragma once

#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/studies/bias/bias_study.h"
#include "umbra/bench/studies/study_report.h"

namespace umbra {

DESCRIBE(BiasErrors) { MEMBERS(false_shadow, false_light); }
DESCRIBE(BiasCell) {
    of.all(&R::errors);
    MEMBERS(constant, slope, normal_offset);
}

struct BiasSliceRecord {
    double normal_offset = 0;
    std::vector<std::vector<BiasErrors>> rows{};
};
DESCRIBE(BiasSliceRecord) {
    MEMBERS(normal_offset);
    of(MEMBER(rows), "one a slope, with an entry a constant");
}

struct BiasSceneRecord {
    std::string scene{}, title{};
    std::vector<std::string> lights{};
    std::uint64_t points = 0;
    BiasErrors automatic{}, receiver_plane{};
    BiasCell best_manual{};
    std::uint64_t settings = 0, settings_better_than_automatic = 0;
    std::vector<BiasSliceRecord> slices{};
};
DESCRIBE(BiasSceneRecord) {
    MEMBERS(scene, title, lights);
    of(MEMBER(points), "judged, over all lights");
    of(MEMBER(automatic), "bias=auto");
    of(MEMBER(receiver_plane), "bias=receiver_plane");
    of(MEMBER(best_manual), "bias=manual with the fewest wrong interior points");
    MEMBERS(settings, settings_better_than_automatic);
    of(MEMBER(slices), "one a normal offset");
}

struct BiasRecord {
    HeadRecord head{};
    MachineRecord machine{};
    SizeRecord size{};
    std::string map{};
    BiasGrid grid{};
    std::vector<BiasSceneRecord> bias{};
    std::vector<ListedFailureRecord> failed{};
    std::vector<std::string> csv{};
};
DESCRIBE(BiasGrid) {
    of(MEMBER(constants), "widths of a sample");
    of(MEMBER(slopes), "depth gradients a sample");
    of(MEMBER(normal_offsets), "widths of a sample");
}
DESCRIBE(BiasRecord) {
    of.all(&R::head);
    MEMBERS(machine, size);
    of(MEMBER(map), "settings of shadow_zbuffer, as typed");
    of.all(&R::grid);
    of(MEMBER(bias), "all scenes added up, where there are several, and each of them");
    MEMBERS(failed, csv);
}

/// Of the record of `umbra bias` alone.
[[nodiscard]] StudyReport bias_report(const BiasRecord& record);

}  // namespace umbra
