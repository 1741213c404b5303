#include "umbra/shadows/volumes/silhouettes.h"

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/facing.h"

namespace umbra {

SilhouetteMeshes::SilhouetteMeshes(const Scene& scene, std::span<const ObjectFacts> facts) {
    triangles_.reserve(scene.triangles.size());
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        const Object& object    = scene.objects[o];
        Topology topology       = find_topology(scene, object.first_triangle, object.triangle_count);
        const auto first_vertex = static_cast<std::uint32_t>(vertices_.size());
        for (const std::uint32_t p : topology.position) vertices_.push_back(scene.positions[p]);
        for (const uvec3 t : topology.triangles) triangles_.push_back(t + first_vertex);

        ObjectMesh& mesh    = objects_.emplace_back();
        mesh.first_triangle = object.first_triangle;
        mesh.triangle_count = object.triangle_count;
        if (facts[o].manifold) {
            mesh.closed.emplace(scene, topology, first_vertex);
            continue;
        }
        for (Edge& e : topology.edges) e.a += first_vertex, e.b += first_vertex;
        for (EdgeUse& use : topology.uses) use.triangle += object.first_triangle;
        mesh.soup = {std::move(topology.edges), std::move(topology.uses)};
    }
}

std::vector<std::int8_t> SilhouetteMeshes::facing(const Light& light) const {
    std::vector<std::int8_t> facing(triangles_.size());
    for (std::size_t o = 0; o < objects_.size(); ++o) {
        if (objects_[o].closed) {
            objects_[o].closed->find_facing(light, facing);
            continue;
        }
        const std::size_t first = objects_[o].first_triangle;
        parallel_ranges(objects_[o].triangle_count, 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = first + begin; t < first + end; ++t) {
                const uvec3 v = triangles_[t];
                facing[t] =
                    static_cast<std::int8_t>(side_of_light(light, vertices_[v[0]], vertices_[v[1]], vertices_[v[2]]));
            }
        });
    }
    return facing;
}

std::vector<SilhouetteEdge> SilhouetteMeshes::edges(std::span<const std::int8_t> orientation) const {
    std::vector<SilhouetteEdge> silhouette;
    for (const ObjectMesh& mesh : objects_) {
        if (mesh.closed) mesh.closed->append_silhouette(orientation, silhouette);
        for (const Edge& e : mesh.soup.edges) {
            std::int32_t weight = 0;
            for (std::uint32_t k = e.first; k < e.first + e.count; ++k) {
                const EdgeUse& use = mesh.soup.uses[k];
                weight += use.forward ? orientation[use.triangle] : -orientation[use.triangle];
            }
            if (weight != 0) silhouette.push_back({e.a, e.b, weight});
        }
    }
    return silhouette;
}

std::size_t SilhouetteMeshes::memory_bytes() const {
    std::size_t bytes = triangles_.capacity() * sizeof(uvec3) + vertices_.capacity() * sizeof(vec3);
    for (const ObjectMesh& m : objects_)
        bytes += (m.closed ? m.closed->memory_bytes() : 0) + m.soup.edges.capacity() * sizeof(Edge) +
                 m.soup.uses.capacity() * sizeof(EdgeUse);
    return bytes;
}

}  // namespace umbra
