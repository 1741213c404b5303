// Light that diffuse surfaces send to one another: progressive refinement. The side of a patch that has the most power
// to send sends it to all others, again and again; what is lit directly comes first.
//
// Every side of every patch has one value, that of its centre, in units of the sum: I = I_e + sum_j S_j f_att,j I_j k_d
// O_d (N.L_j) + k_d O_d sum_i F_i I_i, where F_i is the form factor from the centre to patch i times the seen fraction
// of it. No specular light, and no ambient light, which stands for the light that is computed here.
//
// This work is based on:
// Johann Lambert. Photometria. 1760
// Cindy Goral, Kenneth Torrance, Donald Greenberg, Bennett Battaile. Modeling the Interaction of Light between Diffuse
// Surfaces. 1984
// Michael Cohen, Shenchang Chen, John Wallace, Donald Greenberg. A Progressive Refinement Approach to Fast Radiosity
// Image Generation. 1988
#pragma once

#include <array>
#include <span>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/shadows/radiosity/patches.h"
#include "umbra/shadows/radiosity/sight.h"

namespace umbra {

namespace patches {

/// The form factor from a point p of a surface with the unit normal n to a plane polygon, of whichever winding, that
/// nothing hides: the integral of cos(a) cos(b) / (pi r^2) over the part of it that is in front of p, in [0, 1].
/// Lambert's contour integral, in double. 0 where p lies in the polygon's plane. At most 14 corners.
[[nodiscard]] double form_factor(dvec3 p, dvec3 n, std::span<const dvec3> polygon);

}  // namespace patches

class Exchange {
public:
    struct Options {
        double size       = 0.03125;  ///< longest edge of a patch, scene diagonals
        int light_samples = 16;       ///< rays from a centre to an area light
    };
    using SideId = std::uint32_t;  ///< 2 patch, or 2 patch + 1 for the side that its winding does not face

    /// Finds the direct light. `scene` must outlive this object.
    Exchange(const Scene& scene, const Options& options);

    [[nodiscard]] std::size_t patches() const { return patches_.size(); }
    [[nodiscard]] std::size_t sides() const { return sides_.size(); }

    /// Power left to send, as a fraction of that of all sides at first; 0 where that is 0. Power is I times area, the
    /// mean of R, G and B.
    [[nodiscard]] double unshot() const;

    /// The side that has the most power to send sends it. Returns which. Parallel, the same bits for any number of
    /// threads.
    SideId shoot();

    /// The arrived fraction of all power that was sent; the rest has left the scene. 1 where none was sent.
    [[nodiscard]] double arrived() const { return sent_ > 0 ? arrived_ / sent_ : 1; }

    [[nodiscard]] dvec3 direct(SideId side) const { return sides_[side].direct; }
    [[nodiscard]] dvec3 indirect(SideId side) const { return sides_[side].indirect; }

    /// From the centre of a side to a patch's side, times the seen fraction of it; 0 to itself.
    [[nodiscard]] double form_factor(SideId from, SideId to) const;

    [[nodiscard]] SideId side_at(const PointBatch& points, std::size_t i) const;

    /// Values of the indirect light at the points of a batch: linear over patches between corners, each of which has
    /// the mean of the patches that meet there in one plane. Points without a surface have 0.
    [[nodiscard]] std::vector<vec3> indirect_at(const PointBatch& points) const;

private:
    struct PatchSide {
        patches::SurfacePoint centre;
        double area = 0;  ///< 0: it sends and receives nothing
        dvec3 reflects{0}, direct{0}, indirect{0}, unshot{0};
    };
    void place(patches::PatchId patch);
    [[nodiscard]] dvec3 find_direct(const PatchSide& side, const Material& material) const;
    [[nodiscard]] double form_factor(const PatchSide& from, const std::array<dvec3, 3>& polygon,
                                     const PatchSide& to) const;
    [[nodiscard]] std::array<dvec3, 3> polygon(patches::PatchId patch) const;

    const Scene* scene_ = nullptr;
    Options options_;
    patches::Sight sight_;
    patches::Patches patches_;
    std::vector<PatchSide> sides_;
    double first_ = 0, sent_ = 0, arrived_ = 0;
};

}  // namespace umbra
