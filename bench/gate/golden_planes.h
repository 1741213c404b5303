// S_j planes as images that keep every bit, what differs between two of them, and that as pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/image/image.h"

namespace umbra {

/// The method's answer is an estimate that depends on a seed.
[[nodiscard]] bool is_sampled(const MethodChoice& choice, const Light& light);

/// Each phase once.
[[nodiscard]] MethodRun run_once(const MethodChoice& choice, const PreparedScene& prepared);

/// A channel S.<light> for each light: S_j, NaN where undefined, -1 on a shadow boundary. Lights whose answers are
/// sampled have none, unless `sampled_too`.
[[nodiscard]] Image coded_planes(const PreparedScene& prepared, const MethodRun& run, bool sampled_too = false);

/// The plane of one channel, as methods write it.
[[nodiscard]] VisibilityPlane decoded_plane(const Image& image, std::size_t channel);

/// Equal, or both NaN.
[[nodiscard]] bool same_value(float a, float b);

struct ChangedPlane {
    LightId light           = 0;
    std::size_t old_channel = 0, new_channel = 0;
};

struct Changes {
    std::vector<std::string> lines;
    std::vector<ChangedPlane> planes;
    bool at_edges_alone = true;
    void add(std::string line, bool at_edges) {
        lines.push_back(std::move(line));
        at_edges_alone &= at_edges;
    }
};

[[nodiscard]] Changes plane_changes(const Image& before, const Image& now, const PreparedScene& prepared);

/// Replaces PICTURES/SCENE.GOLDEN: reference.S.<light>.png, result.S.<light>.png and difference.S.<light>.png of each
/// changed plane, four pixels a point, and both images as EXR. Returns that folder; nothing is written, and the path is
/// empty, where `pictures` is or no plane changed. Throws InputError.
std::filesystem::path leave_pictures(const std::filesystem::path& pictures, const std::string& golden,
                                     const PreparedScene& prepared, const Image& before, const Image& now,
                                     const std::vector<ChangedPlane>& changed);

}  // namespace umbra
