// What `umbra bias` found, as a record: counts of wrong points over the grid of biases.
#pragma once

#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/studies/bias/bias_study.h"

namespace umbra {

template <class Fields>
void describe(Fields& of, Is<BiasErrors>) {
    of("false_shadow", &BiasErrors::false_shadow, "");
    of("false_light", &BiasErrors::false_light, "");
}
template <class Fields>
void describe(Fields& of, Is<BiasCell>) {
    of.all(&BiasCell::errors);
    of("constant", &BiasCell::constant, "");
    of("slope", &BiasCell::slope, "");
    of("normal_offset", &BiasCell::normal_offset, "");
}

struct BiasSliceRecord {
    double normal_offset = 0;
    std::vector<std::vector<BiasErrors>> rows{};
};
template <class Fields>
void describe(Fields& of, Is<BiasSliceRecord>) {
    of("normal_offset", &BiasSliceRecord::normal_offset, "");
    of("rows", &BiasSliceRecord::rows, "one a slope, with an entry a constant");
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
template <class Fields>
void describe(Fields& of, Is<BiasSceneRecord>) {
    of("scene", &BiasSceneRecord::scene, "");
    of("title", &BiasSceneRecord::title, "");
    of("lights", &BiasSceneRecord::lights, "");
    of("points", &BiasSceneRecord::points, "judged, over all lights");
    of("automatic", &BiasSceneRecord::automatic, "bias=auto");
    of("receiver_plane", &BiasSceneRecord::receiver_plane, "bias=receiver_plane");
    of("best_manual", &BiasSceneRecord::best_manual, "bias=manual with the fewest wrong interior points");
    of("settings", &BiasSceneRecord::settings, "");
    of("settings_better_than_automatic", &BiasSceneRecord::settings_better_than_automatic, "");
    of("slices", &BiasSceneRecord::slices, "one a normal offset");
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
template <class Fields>
void describe(Fields& of, Is<BiasGrid>) {
    of("constants", &BiasGrid::constants, "widths of a sample");
    of("slopes", &BiasGrid::slopes, "depth gradients a sample");
    of("normal_offsets", &BiasGrid::normal_offsets, "widths of a sample");
}
template <class Fields>
void describe(Fields& of, Is<BiasRecord>) {
    of.all(&BiasRecord::head);
    of("machine", &BiasRecord::machine, "");
    of("size", &BiasRecord::size, "");
    of("map", &BiasRecord::map, "settings of shadow_zbuffer, as typed");
    of.all(&BiasRecord::grid);
    of("bias", &BiasRecord::bias, "all scenes added up, where there are several, and each of them");
    of("failed", &BiasRecord::failed, "");
    of("csv", &BiasRecord::csv, "");
}

}  // namespace umbra
