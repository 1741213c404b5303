// The bias study of the shadow z-buffer: false shadow (acne) against false light (detachment) over what bias can be.
//
// Settings of the visibility phase alone reuse the maps that are there; the truth is the default reference.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/bench/run/run.h"
#include "umbra/core/errors/visibility_error.h"

namespace umbra {

/// Wrong points over all lights of a scene.
struct BiasErrors {
    VisibilityError::Kind false_shadow, false_light;
    [[nodiscard]] std::uint64_t interior() const { return false_shadow.interior + false_light.interior; }
    [[nodiscard]] std::uint64_t edge() const { return false_shadow.edge + false_light.edge; }
    BiasErrors& operator+=(const BiasErrors& other);
};

/// One setting of bias=manual, and what it costs.
struct BiasCell {
    double constant = 0, slope = 0, normal_offset = 0;
    BiasErrors errors;
};

struct BiasGrid {
    /// 0, then twice as much each time: widths of a sample, depth gradients a sample, widths of a sample.
    std::vector<double> constants, slopes, normal_offsets;
};
[[nodiscard]] BiasGrid default_bias_grid();

struct BiasStudy {
    std::string name, title;  ///< of the scene
    std::vector<std::string> lights;
    std::uint64_t points = 0;              ///< judged, over all lights
    BiasErrors automatic, receiver_plane;  ///< bias=auto, bias=receiver_plane
    std::vector<BiasCell> cells;           ///< constants fastest, then slopes, then normal offsets
};

/// Fewest interior errors; of equal ones fewest at edges, then the smaller bias.
[[nodiscard]] const BiasCell& best_cell(const BiasStudy& study);
/// How many cells have fewer interior errors than the automatic bias.
[[nodiscard]] std::size_t better_cells(const BiasStudy& study);

/// All scenes' counts added up, as a study called "all".
[[nodiscard]] BiasStudy add_up(const std::vector<BiasStudy>& studies);

/// Throws UsageError where the settings are wrong, set a bias, or exclude one of the grid.
void check_bias_map(const std::string& settings, const BiasGrid& grid);

/// Runs shadow_zbuffer with `settings` ("k=v,k=v", none of them about bias; may be empty) over the grid. Area lights
/// are taken for points in their centres, as the method takes them: the study is of bias, not of penumbrae. Throws
/// UsageError where the settings are wrong or set a bias.
[[nodiscard]] BiasStudy study_bias(PreparedScene prepared, const std::string& settings, const BiasGrid& grid,
                                   const std::function<void(const std::string&)>& progress);

}  // namespace umbra
