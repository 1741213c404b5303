// What a method's phases made, to be asked by other settings of the method.
#pragma once

#include <memory>

#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/scene/facts.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// What a method is asked: all must outlive the values.
struct PhaseInput {
    const Scene& scene;
    const SceneFacts& facts;
    const PointBatch& points;
    LightId light = 0;
};

/// A value that is empty was not made.
struct PhaseValues {
    std::unique_ptr<const Built> built{};
    std::unique_ptr<const Aimed> aimed{};
    std::unique_ptr<const Looked> looked{};
};

/// All phases from `first` on by this method; the others stay empty, and are `kept`'s.
[[nodiscard]] inline PhaseValues make_values(const Method& method, const PhaseInput& in, Phase first = Phase::build,
                                             const PhaseValues& kept = {}) {
    PhaseValues made;
    if (first <= Phase::build) {
        method.warm_up(in.scene, in.facts);
        made.built = method.build(in.scene, in.facts);
    }
    const Built& built = made.built ? *made.built : *kept.built;
    if (first <= Phase::aim) made.aimed = method.aim(built, in.light);
    if (first <= Phase::look) made.looked = method.look(built, in.points);
    return made;
}

struct PhaseAnswer {
    VisibilityPlane plane;
    std::size_t memory_bytes = 0;  ///< of build and aim
};

/// The answer of `to`, which repeats the phases from `first` on, and takes the values of those before from `kept`.
[[nodiscard]] inline PhaseAnswer answer_from(const MethodChoice& to, const PhaseInput& in, Phase first = Phase::build,
                                             const PhaseValues& kept = {}) {
    const auto method      = to.make();
    const PhaseValues made = make_values(*method, in, first, kept);
    const Built& built     = made.built ? *made.built : *kept.built;
    const Aimed& aimed     = made.aimed ? *made.aimed : *kept.aimed;
    const Looked& looked   = made.looked ? *made.looked : *kept.looked;
    PhaseAnswer answer{VisibilityPlane(in.points.size()), built.memory_bytes() + aimed.memory_bytes()};
    write_decided(in.scene, in.points, in.light, answer.plane.out());
    method->visibility(aimed, looked, answer.plane.out());
    return answer;
}

}  // namespace umbra
