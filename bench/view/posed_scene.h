// A scene of which camera, lights and objects are placed by hand, and which knows what each new placing has moved.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "umbra/bench/view/view_request.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/ray.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// What is to be computed again.
struct Moved {
    bool all    = false;  ///< another scene: the file, or another frame of it
    bool camera = false;
    std::vector<bool> lights;  ///< [light]
    bool objects = false;
};

class PosedScene {
public:
    /// Loads the file, whose animation is at its first frame. Throws InputError.
    explicit PosedScene(std::filesystem::path file);

    /// Brings scene, facts and points to the state that is asked for. Reads the file again where it has changed.
    /// Throws InputError, and UsageError where the request places lights or objects that there are not; then all is as
    /// it was.
    Moved place(const ViewRequest& request);

    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] const Scene& as_in_file() const { return start_; }
    [[nodiscard]] const SceneFacts& facts() const { return facts_; }
    [[nodiscard]] const PointBatch& points() const { return points_; }
    /// Milliseconds of the last `place`.
    [[nodiscard]] double facts_ms() const { return facts_ms_; }
    [[nodiscard]] double points_ms() const { return points_ms_; }
    /// Whether object `o` may be placed: it shares no position with another.
    [[nodiscard]] bool is_movable(std::size_t o) const { return movable_[o]; }
    /// Middle of the object's box in the file's scene.
    [[nodiscard]] dvec3 middle(std::size_t o) const;

private:
    void load(std::uint64_t frame);
    void place_object(const PlacedObject& placed);
    [[nodiscard]] std::filesystem::path file_of(std::uint64_t frame) const;

    std::filesystem::path file_;
    std::filesystem::file_time_type written_{};
    Scene start_, scene_;
    SceneFacts facts_;
    std::optional<RayScene> rays_;
    PointBatch points_;
    std::vector<bool> movable_;                         ///< [object]
    std::vector<std::vector<std::uint32_t>> vertices_;  ///< [object]: positions that it uses
    ViewRequest now_;                                   ///< the state that all is in; no page has asked: width 0
    double facts_ms_ = 0, points_ms_ = 0;
};

}  // namespace umbra
