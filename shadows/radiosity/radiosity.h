// The class of radiosity; radiosity.cpp has the recipe.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "umbra/shadows/method.h"
#include "umbra/shadows/radiosity/elements.h"
#include "umbra/shadows/radiosity/patches.h"
#include "umbra/shadows/radiosity/sight.h"

namespace umbra {

struct RadiosityOptions {
    enum class Interpolation : std::uint8_t { linear, constant };

    double size                 = 0.03125;
    int levels                  = 4;
    double threshold            = 0.05;
    int samples                 = 16;
    Interpolation interpolation = Interpolation::linear;
};

class Radiosity final : public MethodWith<RadiosityOptions> {
public:
    [[nodiscard]] Measure measures() const override { return Measure::irradiance; }
    [[nodiscard]] Service serves(const SceneFacts& facts) const override;
    void build(const Scene& scene, const SceneFacts& facts) override;
    void aim(LightId light) override;
    void visibility(const PointBatch& points, LightId light, Visibility out) const override;
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override;
    [[nodiscard]] std::size_t memory_bytes() const override;

    /// After aim: the element that a point lies in, of its side.
    struct ElementId {
        radiosity_detail::PatchId patch = 0;
        std::uint32_t leaf              = 0;
    };
    [[nodiscard]] ElementId element(const PointBatch& points, std::size_t i) const;
    /// Of both sides of all patches.
    [[nodiscard]] std::size_t elements() const;

private:
    [[nodiscard]] radiosity_detail::SurfacePoint place(radiosity_detail::PatchId patch, bool flipped, dvec2 at) const;
    void grow(radiosity_detail::PatchId patch, bool flipped, radiosity_detail::Elements& elements) const;

    const Scene* scene_ = nullptr;
    const Light* light_ = nullptr;
    double diagonal_    = 0;  ///< of the scene
    std::optional<radiosity_detail::Sight> sight_;
    radiosity_detail::Patches patches_;
    /// One a patch: of the side that its winding faces, and of the other.
    std::array<std::vector<radiosity_detail::Elements>, 2> elements_;
};

}  // namespace umbra
