// `umbra energy`: what S_j is used for beside pictures: the light that arrives at each object and each face, frame by
// frame, as simulations of heating and of solar cells need it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"
#include "umbra/core/base/math.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/method.h"

namespace umbra {

struct EnergyOptions {
    std::optional<MethodChoice> method;  ///< none: S_j = 1 where a light is in front
    std::uint64_t points = 100'000;      ///< on all faces together; each face has one at least
    std::string command;
    std::function<void(const std::string&)> progress;  ///< may be empty
};

/// A side of faces: the one that their winding names, or the other. A face has another where its material is lit on
/// both sides, and its object does not close around what is behind it.
enum class FaceSide { winding, other };

/// A face, or an object: all of its faces. One side of it; all is 0 where that side is none.
struct ReceivedEnergy {
    double area       = 0;
    double irradiance = 0;  ///< mean over the area of sum_j S_j f_att,j I_j max(N.L_j, 0), I_j by its luminance, where
                            ///< the method answers for light j; 0 elsewhere
    dvec3 colour{0};        ///< the same of red, green and blue: its luminance is `irradiance`
    double unshadowed = 0;  ///< the same with S_j = 1 where the light is in front
    double asked      = 0;  ///< the same wherever a light is in front, whether the method answers or not

    /// Whether the method answers any point that a light reaches, or no light reaches any: the sums mean something.
    [[nodiscard]] bool answered() const { return unshadowed > 0 || asked == 0; }
};

/// One a triangle: what arrives there, from points that are spread evenly over it, the more the larger it is. Points
/// whose S_j the method leaves undefined are neither lit nor dark: they are in `asked` alone. The method must serve the
/// scene. Throws what it throws.
[[nodiscard]] std::vector<ReceivedEnergy> received_by_faces(const Scene& scene, const SceneFacts& facts,
                                                            const EnergyOptions& options,
                                                            FaceSide side = FaceSide::winding);

/// One an object, from its faces.
[[nodiscard]] std::vector<ReceivedEnergy> received_by_objects(const Scene& scene,
                                                              std::span<const ReceivedEnergy> faces);

/// Scenes or frames of one, in their order: all have the same objects. Writes faces.csv and objects.csv into `folder`,
/// one row a face (or object) and frame, and returns the record: by frame and object, area, irradiance, unshadowed,
/// their quotient, and the coverage, unshadowed over asked; `irradiance_rgb`: by channel; `back`: of the other side;
/// `mean`: of all frames; `unit`: of irradiances. null, in CSV an empty field: the method answers nothing there, no
/// light arrives, or there is no other side. Throws InputError, and UsageError where a scene is not served or
/// has other objects than the first.
[[nodiscard]] Json measure_energy(std::span<const std::filesystem::path> scenes, const EnergyOptions& options,
                                  const std::filesystem::path& folder);

/// The table for people: objects, and other sides of objects that light reaches, with the means of the frames.
[[nodiscard]] std::string energy_text(const Json& record);

}  // namespace umbra
