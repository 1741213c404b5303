// Alias-free shadows: surface points binned in the light's image, every triangle against the points in its bins
// (binned_shadows.h).
//
// This work is based on:
// Timo Aila, Samuli Laine. Alias-Free Shadow Maps. 2004
// Gregory Johnson, Juhyun Lee, Christopher Burns, William Mark. The Irregular Z-Buffer. 2005
#include "umbra/shadows/method.h"
#include "umbra/shadows/shared/binned_shadows.h"

namespace umbra {
namespace {

class AliasFree final : public Method {
public:
    void configure(const Settings&) override {}  // it has no parameters

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (!facts.hard_lights_only)
            return {How::not_at_all, "A point is in a triangle's shadow or not: no area lights."};
        return {How::exactly, "Signs in floats with a proven bound, and by exact predicates where it is too wide."};
    }

    void build(const Scene& scene, const SceneFacts&) override { shadows_ = BinnedShadows(scene); }

    void aim(LightId) override {}

    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        shadows_.visibility(points, light, out);
    }

    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override {
        shadows_.blame(points, light, blockers);
    }

    [[nodiscard]] std::size_t memory_bytes() const override { return shadows_.memory_bytes(); }

private:
    BinnedShadows shadows_;
};

}  // namespace

extern const MethodInfo alias_free;
const MethodInfo alias_free{
    .name  = "alias_free",
    .title = "Alias-free shadows",
    .paper =
        "Timo Aila, Samuli Laine, Alias-Free Shadow Maps, 2004; Gregory Johnson et al., The Irregular Z-Buffer, 2005",
    .summary =
        "Bins the surface points that are asked in the light's image and tests every triangle against the points in "
        "the "
        "bins that it covers: exact, without a tree, a bias or a resolution. A sign that floats cannot tell is found "
        "by "
        "exact predicates. Where exact is the reference, it takes many points by the same bins: "
        "exact:hard_lights=segments judges without them. Limit: no area lights; every triangle is looked at for every "
        "picture.",
    .by_default = false,
    .shown_on   = {"sun_on_plane", "stairs", "interpenetrating", "self_shadow"},
    .create     = create<AliasFree>};

}  // namespace umbra
