// Alias-free shadows: surface points binned in the light's image, every triangle against the points in its bins
// (binned_shadows.h, which names the papers).
//
//     build       the triangles that block, in groups of eight that are next to one another
//     visibility  bins the points that ask, and tests the triangles against those in the bins that they cover
#include "umbra/shadows/bins/binned_shadows.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

struct Triangles final : Built {
    Triangles(const Scene& of, const SceneFacts& its_facts) : Built(of, its_facts), shadows(of) {}
    [[nodiscard]] std::size_t memory_bytes() const override { return shadows.memory_bytes(); }

    const BinnedShadows shadows;
};

class AliasFree final : public MethodWith<NoOptions, Triangles> {
public:
    explicit AliasFree(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (!facts.hard_lights_only)
            return {How::not_at_all, "A point is in a triangle's shadow or not: no area lights."};
        return {How::exactly, "Signs in floats with a proven bound, and by exact predicates where it is too wide."};
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        as<Triangles>(aimed.built).shadows.visibility(looked.points, aimed.light, out);
    }

    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        as<Triangles>(aimed.built).shadows.blame(looked.points, aimed.light, blockers);
    }
};

}  // namespace

extern const MethodInfo alias_free{
    .name  = "alias_free",
    .title = "Alias-free shadows",
    .paper =
        "Timo Aila, Samuli Laine, Alias-Free Shadow Maps, 2004; Gregory Johnson et al., The Irregular Z-Buffer, 2005",
    .summary =
        "Bins the surface points that are asked in the light's image and tests every triangle against the points in "
        "the bins that it covers: exact, without a tree, a bias or a resolution. A sign that floats cannot tell is "
        "found by exact predicates. Where exact is the reference, it takes many points by the same bins: "
        "exact:hard_lights=segments judges without them. Limit: no area lights; every triangle is looked at for "
        "every picture.",
    .by_default = false,
    .shown      = true,
    .create     = create<AliasFree>};

}  // namespace umbra
