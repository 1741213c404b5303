// One page of `umbra view`: its scene, its methods with what they have made, and the truth where it has been found.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/reference.h"
#include "umbra/bench/studies/motion/kept_method.h"
#include "umbra/bench/view/posed_scene.h"
#include "umbra/bench/view/view_record.h"
#include "umbra/core/image/image.h"

namespace umbra {

/// The answer to a request: figures, and one picture a side.
struct ViewReply {
    ViewRecord record;
    std::vector<std::uint8_t> pictures;  ///< R G B of each side in turn, row by row from the top
};

/// One caller at a time.
class ViewSession {
public:
    /// Throws InputError.
    explicit ViewSession(const std::filesystem::path& file) : posed_(file) {}

    /// Repeats the phases that depend on what has moved since the last request. A method that throws, or takes longer
    /// than `most`, has its message in the record. Throws what PosedScene::place throws, and UsageError for a method
    /// or a light that there is not.
    [[nodiscard]] ViewReply show(const ViewRequest& request, const Budget& most);

    /// Why the methods, and the reference, answer as they do at the pixel of the request, for its light.
    [[nodiscard]] WhyHereRecord why(const ViewRequest& request, const Budget& most);

    /// The scene as the last request has placed it, as a native file.
    [[nodiscard]] std::string scene_text() const;

    [[nodiscard]] ViewedSceneRecord scene_record() const;

private:
    struct Side {
        std::unique_ptr<KeptMethod> method;
        FrameWork due{};     ///< the work that movements since its last run ask for
        std::string failed;  ///< its last run
        RunTimes times{};
        FrameWork done{};  ///< of its last run
    };
    Moved place(const ViewRequest& request);
    /// Nothing where no phase is due and the last run went well, unless `again`.
    void run(Side& side, const MethodChoice& choice, const Budget& most, bool again);
    [[nodiscard]] SideRecord side_record(const Side& side) const;
    void find_truth(const ViewRequest& request, const Budget& most);
    /// The errors of a side, and the picture of the layer, where that is one of the errors.
    std::optional<Image> add_errors(const Side& side, const ViewRequest& request, SideRecord& record) const;

    /// By rays to a grid of places on the area light.
    [[nodiscard]] SeenLightRecord seen_light(std::size_t i, const Light& light);

    PosedScene posed_;
    std::optional<RayScene> rays_;  ///< of what blocks; none until it is needed
    std::vector<Side> sides_;
    std::uint64_t truth_level_ = 0;  ///< of truth_, as in the request; 0: there is none of this state
    std::optional<Reference> reference_;
    std::optional<ReferenceRun> truth_;
    std::string truth_failed_;
    double truth_ms_ = 0;
};

}  // namespace umbra
