// The sum at one point: I = I_e + I_a k_a O_d + sum_j S_j f_att,j I_j ( k_d O_d (N.L_j) + k_s O_s (R_j.V)^n ).
//
// This work is based on:
// Bui Tuong Phong. Illumination for Computer Generated Pictures. 1975
// James Blinn. Models of Light Reflection for Computer Synthesized Pictures. 1977
//
// A scene may choose variants: see LightAmbient, SpecularColour and AmbientCoefficient. Materials may add Lafortune's
// lobes to the specular term.
#pragma once

#include <span>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"

namespace umbra {

/// How often each term was evaluated. Counts of terms that a scene does not ask for stay 0.
struct SumCounts {
    std::uint64_t sums     = 0;  ///< points
    std::uint64_t diffuse  = 0;  ///< pairs of a point and a light that reaches it, in front of it
    std::uint64_t specular = 0;  ///< of these, where material and light have a specular term
    std::uint64_t lobes    = 0;  ///< of these, where the material has Lafortune's lobes
    std::uint64_t ambient  = 0;  ///< ambient terms of lights that f_att acts on: pairs of a point and a light
    std::uint64_t fog      = 0;  ///< points seen through fog
};

/// f_att,j of the sum at p: `falloff`, dimmed by the scene's fog where that dims lights.
[[nodiscard]] double arriving_share(const Scene& scene, const Light& light, vec3 p);

/// The angles of the sum for one light at one point, as something cheaper than directions may give them.
struct LightCosines {
    double diffuse = 0;  ///< N.L
    double lobe    = 0;  ///< R.V or N.H, as the material has it; 0 where no highlight is
};

class PhongSum {
public:
    /// The sum for a picture by this camera. The scene must outlive this object.
    PhongSum(const Scene& scene, const CameraFrame& camera);

    /// R G B, scene-linear, at point i of a batch, which has a surface, with the unit normal n. `visibility`: one plane
    /// a light, as long as the batch; undefined points count as lit. Terms that no material or light asks for are not
    /// computed. Seen through the scene's fog. From any number of threads.
    [[nodiscard]] dvec3 at(const PointBatch& points, std::size_t i, dvec3 n,
                           std::span<const VisibilityPlane> visibility) const;

    /// The same without fog, as it leaves the point in the direction `v`, unit.
    [[nodiscard]] dvec3 leaving(const PointBatch& points, std::size_t i, dvec3 n, dvec3 v,
                                std::span<const VisibilityPlane> visibility) const;

    /// `at` with these angles, one pair a light, in place of those that normal and positions give. Lafortune's lobes,
    /// which need directions, are left out.
    [[nodiscard]] dvec3 with_cosines(const PointBatch& points, std::size_t i, std::span<const LightCosines> cosines,
                                     std::span<const VisibilityPlane> visibility) const;

    /// Whether `at_eight` can serve: no fog, no Lafortune lobes, no ambient terms that f_att acts on, and planes of S_j
    /// without colour.
    [[nodiscard]] bool has_lanes(std::span<const VisibilityPlane> visibility) const;

    /// `at` for the points first + k, k < 8, whose bit k of `which` is set, with interpolated normals (shading_normal):
    /// the same bits in a quarter of the time. Writes R G B of point i to rgb[3 i], as floats of at most the largest;
    /// of a point without a surface the scene's background. From any number of threads.
    void at_eight(const PointBatch& points, std::size_t first, unsigned which,
                  std::span<const VisibilityPlane> visibility, float* rgb) const;

    /// Counts the terms that `at` evaluates at point i.
    void count(const PointBatch& points, std::size_t i, dvec3 n, std::span<const VisibilityPlane> visibility,
               SumCounts& counts) const;

    /// The light that arrives at the eye, through the scene's fog, of `light` that leaves p.
    [[nodiscard]] dvec3 at_the_eye(dvec3 light, vec3 p) const;

    /// V at point i of a batch, unit: to the eye, or against the view direction where that is constant.
    [[nodiscard]] dvec3 to_viewer(const PointBatch& points, std::size_t i) const {
        return to_viewer_from(points, dvec3(points.position(i)));
    }
    /// The same at another position of the batch's picture.
    [[nodiscard]] dvec3 to_viewer_from(const PointBatch& points, dvec3 p) const;

    /// Without directions and distances: I_e + I_a k_a O_d + sum_j I_j k_d O_d cosine. The light of a surface where all
    /// lights are at the eye and nothing is far away.
    [[nodiscard]] dvec3 from_the_eye(TriangleId t, double cosine) const;

private:
    /// Terms that are the same at all points of an object.
    struct Terms {
        dvec3 unshadowed;  ///< I_e + I_a k_a O_d: no light can be blocked from it. I_a has those of the lights that
                           ///< light the object, where these are not attenuated
        dvec3 ambient;     ///< k_a O_d
        dvec3 diffuse;     ///< k_d O_d
        dvec3 specular;    ///< k_s O_s
        bool is_specular;
    };
    /// `unblocked_by(j)`: f_att,j I_j (...), the contribution of light j if nothing blocked it.
    template <class Unblocked, class Count>
    dvec3 add_up(const PointBatch& points, std::size_t i, std::span<const VisibilityPlane> visibility,
                 const Unblocked& unblocked_by, const Count& count) const;
    template <class Count>
    dvec3 add_up(const PointBatch& points, std::size_t i, dvec3 n, dvec3 v, std::span<const VisibilityPlane> visibility,
                 const Count& count) const;
    struct Eight;
    void load_surfaces(const PointBatch& points, std::size_t first, Eight& eight) const;
    bool load_visibility(std::size_t j, const PointBatch& points, std::size_t first, const VisibilityPlane& visibility,
                         const Eight& eight, double (&s)[8]) const;
    void add_light(std::size_t j, const PointBatch& points, std::size_t first, const VisibilityPlane& visibility,
                   Eight& eight) const;
    template <class AddSpecular, class Count>
    dvec3 unblocked(const Light& light, const Terms& terms, vec3 p, double cosine, const AddSpecular& add_specular,
                    const Count& count) const;
    template <class Count>
    dvec3 unblocked(const Light& light, const Material& material, const Terms& terms, vec3 p, dvec3 n, dvec3 v,
                    const Count& count) const;
    /// Whether light j lights an object.
    [[nodiscard]] bool lights(std::size_t j, std::uint32_t object) const {
        return left_out_.empty() || !left_out_[object * scene_->lights.size() + j];
    }

    const Scene* scene_;
    std::vector<Terms> terms_;    ///< one an object
    std::vector<bool> left_out_;  ///< one an object and light; empty where every light lights every object
    dvec3 eye_, backward_;        ///< the latter against the view direction
    bool orthographic_;
    bool attenuated_ambient_;  ///< some light has an ambient term that its f_att acts on
    bool constant_v_;          ///< an eye at infinity sees every point from the same side
};

}  // namespace umbra
