#include "umbra/shadows/exact/occluders.h"

namespace umbra::exact_visibility {

Occluders::Occluders(const Scene& of, const BoxTree& tree)
    : scene(of),
      triangles(tree),
      topology(find_topology(of, 0, static_cast<std::uint32_t>(of.triangles.size()))),
      casts_nothing(topology.degenerate) {
    for (TriangleId t = 0; t < casts_nothing.size(); ++t)
        if (!scene.blocks(t)) casts_nothing[t] = 1;
}

std::size_t Occluders::memory_bytes() const {
    const auto bytes = [](const auto& list) { return list.size() * sizeof(list[0]); };
    return bytes(topology.triangles) + bytes(topology.position) + bytes(topology.edges) + bytes(topology.uses) +
           bytes(topology.degenerate) + bytes(casts_nothing);
}

}  // namespace umbra::exact_visibility
