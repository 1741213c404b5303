#include "umbra/shadows/atherton/outlines.h"

namespace umbra::atherton {

std::vector<OutlineEdge> find_outlines(const Scene& scene, const Topology& topology,
                                       const std::vector<std::int8_t>& lights) {
    std::vector<OutlineEdge> outlines;
    for (const Edge& edge : topology.edges) {
        int change = 0;
        for (std::uint32_t k = 0; k < edge.count; ++k) {
            const EdgeUse& use = topology.uses[edge.first + k];
            change += use.forward ? lights[use.triangle] : -lights[use.triangle];
        }
        if (change != 0)
            outlines.push_back(
                {scene.positions[topology.position[edge.a]], scene.positions[topology.position[edge.b]], change});
    }
    return outlines;
}

}  // namespace umbra::atherton
