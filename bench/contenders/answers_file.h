// S_j that was made elsewhere, read from a file.
#pragma once

#include <filesystem>
#include <string>

#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// How far an answer may lie outside of [0, 1] by its own rounding.
inline constexpr float kAnswerSlack = 1e-3f;

/// Answers that have a name: a file of them, or a folder.
struct NamedAnswers {
    std::string name;
    std::filesystem::path where;
    Measure measure = Measure::area;
};
/// "NAME=PATH" or "NAME=PATH:measure=irradiance". Throws UsageError.
[[nodiscard]] NamedAnswers parse_answers(const std::string& text);

/// Writes `values`, one a point, into `out` where they are asked for: NaN is `undefined`, values within kAnswerSlack of
/// [0, 1] are clamped. Throws InputError for others; `from` names their source.
void take_answers(std::span<const float> values, const PointBatch& points, LightId light, const std::string& from,
                  const Visibility& out);

/// The same of the answers of one light in a file. `.npy`: a value a point; or
/// over the raster height x width; or lights x either. Other endings: a picture, whose channel is `S.<light>`; or, where
/// it has none of these and the scene one light (or `only` says that the file is of this one), its only channel or R.
/// Throws InputError: the file, what was found, what is expected.
void read_answers(const std::filesystem::path& file, const Scene& scene, const PointBatch& points, LightId light,
                  bool only, const Visibility& out);

}  // namespace umbra
