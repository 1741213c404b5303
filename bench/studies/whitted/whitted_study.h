// `umbra whitted`: one scene by recursive ray tracing: what each depth adds, how many rays of which kind, where the
// time goes, and what it cannot see.
//
// This work is based on:
// Turner Whitted. An Improved Illumination Model for Shaded Display. 1980
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/studies/light/bodies.h"
#include "umbra/bench/studies/light/ray_tree.h"
#include "umbra/bench/studies/study_report.h"
#include "umbra/bench/studies/whitted/whitted_record.h"
#include "umbra/shadows/method.h"

namespace umbra {

struct WhittedOptions {
    std::optional<MethodChoice> method;  ///< of the shadows; none: S_j = 1 where a light is in front
    int depth = 5;                       ///< rays on a path, the eye ray included; >= 1
    /// Rays of less weight are not traced. By default those whose light, if it is 1 or less, changes an 8-bit sRGB
    /// value by less than one step, 1 / (255 * 12.92).
    double least_weight = 0.0003;
    int pixel_samples   = 4;                   ///< eye rays a pixel: 1, 4, 9, ... 64
    EyePlaces places    = EyePlaces::regular;  ///< of the eye rays in a pixel
    bool glossy         = false;               ///< see TreeOptions
    int runs            = 1;                   ///< of each way to trace; the fastest counts
    std::optional<Bodies> bodies{};            ///< of the scene: a second picture meets them by formula
    std::string command;
    std::function<void(const std::string&)> progress{};
};

/// Takes the warnings away that are not true of this command: that mirrors and glass are not computed.
void correct_warnings(Scene& scene);

/// Why the method cannot answer for what mirrors show; empty where it can, for all that is known before it runs.
[[nodiscard]] std::string refusal_of(const MethodInfo& method);

/// The method must serve the scene, and points off a raster. Writes into `folder`: whitted.png, the picture;
/// depth_D.png, the picture if rays stopped at depth D; rays.png, brighter where a pixel has more rays; blind.png,
/// where light arrives by way of a plane mirror; kept_K.png, the picture from an eye that moved aside whose mirrors show
/// what they mirrored before, and moved.png, the last of them as it should be; screen_door.png, the picture with Transparency::screen_door, where a
/// surface is seen through; formula.png, where bodies are given, the picture in which rays meet these by formula;
/// single.png, one of the eye rays of each pixel alone, where there are more.
/// Throws InputError, UsageError.
[[nodiscard]] WhittedRecord trace_whitted(const PreparedScene& prepared, const WhittedOptions& options,
                                          const std::filesystem::path& folder);

/// The picture by depth, rays by kind, times, and what ray tracing does not see, of the record of trace_whitted.
[[nodiscard]] StudyReport whitted_report(const WhittedRecord& record);

}  // namespace umbra
