#include "umbra/shadows/exact/triangles_over.h"

namespace umbra::exact_visibility {
namespace {

constexpr std::size_t kMost = 512;  ///< triangles: where there are more, each point asks the tree

}  // namespace

void TrianglesOver::gather(const Occluders& occluders, const ExactPoint& p, dvec3 to_place, double x, double y,
                           double around) {
    origin_ = p.rounded(), place_ = to_place, x_ = x, y_ = y;
    // Places of a light in one plane differ by rounding alone.
    around_ = around + 64 * kUnit * (largest(origin_) + largest(to_place));
    triangles_.clear();
    const double slack = around_ + p.slack() + 16 * kUnit * (largest(origin_) + largest(to_place));
    occluders.triangles.visit(BoxTree::Piece{origin_, to_place, 1.0, slack}, [&](TriangleId t) {
        if (occluders.blocks(t)) triangles_.push_back(t);
        return triangles_.size() <= kMost;
    });
    known_ = triangles_.size() <= kMost;
    if (!known_) return;
    const std::size_t n = triangles_.size();
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) {
            std::vector<float>& list = corners_[c][k];
            list.resize(n);
            for (std::size_t i = 0; i < n; ++i)
                list[i] =
                    static_cast<float>(static_cast<double>(occluders.scene.vertex(triangles_[i], c)[k]) - origin_[k]);
        }
    // Segments of these points are off from this one by `around_`, and from a plane through it by twice that.
    if (!find_out(dvec3(0), to_place, 0, 2 * around_)) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (out_[i] != 0) continue;
        triangles_[kept] = triangles_[i];
        for (auto& corner : corners_)
            for (std::vector<float>& list : corner) list[kept] = list[i];
        ++kept;
    }
    triangles_.resize(kept);
}

const std::vector<TriangleId>* TrianglesOver::pick(const ExactPoint& p, dvec3 to_place, double off, double x,
                                                   double y) {
    if (!known_ || x != x_ || y != y_) return nullptr;
    const dvec3 moved = p.rounded() - origin_;
    if (!(largest(moved) <= around_) || !(largest(moved + to_place - place_) + off <= around_)) return nullptr;
    if (!find_out(moved, to_place, off, 0)) return nullptr;
    picked_.clear();
    for (std::size_t i = 0; i < triangles_.size(); ++i)
        if (out_[i] == 0) picked_.push_back(triangles_[i]);
    return &picked_;
}

/// Finds which triangles are surely not met by the segment from the origin and `moved` to `to_place`, which may be
/// `off`, or by one that differs by `beside` from it or a plane through it; false where the segment has no length.
UMBRA_FOR_EACH_PROCESSOR bool TrianglesOver::find_out(dvec3 moved, dvec3 to_place, double off, double beside) {
    // A triangle is out that lies on one side of either of two planes through the segment, or past one of its ends
    // along an axis. Floats, bounded as in SilhouetteEdges::pick.
    constexpr float kRounding = 0x1p-19f, kDenormal = 0x1p-140f;
    const dvec3 size = glm::abs(to_place);
    const int axis   = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int one = (axis + 1) % 3, other = (axis + 2) % 3;
    const double length = size[axis];
    const float forward = to_place[axis] > 0 ? 1.0f : -1.0f, end = static_cast<float>(length);
    if (!(length > 0)) return false;
    const auto one_slope   = static_cast<float>(to_place[one] / length),
               other_slope = static_cast<float>(to_place[other] / length);
    const auto end_x = static_cast<float>(to_place[one]), end_y = static_cast<float>(to_place[other]);
    const float low_x = std::min(end_x, 0.0f), high_x = std::max(end_x, 0.0f), low_y = std::min(end_y, 0.0f),
                high_y = std::max(end_y, 0.0f);
    const float tilt   = kRounding + static_cast<float>(4 * off / length);
    const float dx = float(moved[one]), dy = float(moved[other]), dz = float(moved[axis]);
    const float least = static_cast<float>(4 * off) + static_cast<float>(1.001 * beside) + kDenormal +
                        tilt * (std::abs(dx) + std::abs(dy) + std::abs(dz) + end);
    const std::size_t n = triangles_.size();
    out_.resize(n);
    const float *ax = corners_[0][one].data(), *ay = corners_[0][other].data(), *az = corners_[0][axis].data();
    const float *bx = corners_[1][one].data(), *by = corners_[1][other].data(), *bz = corners_[1][axis].data();
    const float *cx = corners_[2][one].data(), *cy = corners_[2][other].data(), *cz = corners_[2][axis].data();
    std::int32_t* out = out_.data();
    for (std::size_t i = 0; i < n; ++i) {
        const float extent = std::abs(ax[i]) + std::abs(ay[i]) + std::abs(az[i]) + std::abs(bx[i]) + std::abs(by[i]) +
                             std::abs(bz[i]) + std::abs(cx[i]) + std::abs(cy[i]) + std::abs(cz[i]);
        const float sure = tilt * extent + least;
        const float xa = ax[i] - dx, xb = bx[i] - dx, xc = cx[i] - dx;
        const float ya = ay[i] - dy, yb = by[i] - dy, yc = cy[i] - dy;
        const float za = forward * (az[i] - dz), zb = forward * (bz[i] - dz), zc = forward * (cz[i] - dz);
        const float a = xa - one_slope * za, b = xb - one_slope * zb, c = xc - one_slope * zc;
        const float d = ya - other_slope * za, e = yb - other_slope * zb, f = yc - other_slope * zc;
        out[i] = (int{a > sure} & int{b > sure} & int{c > sure}) | (int{a < -sure} & int{b < -sure} & int{c < -sure}) |
                 (int{d > sure} & int{e > sure} & int{f > sure}) | (int{d < -sure} & int{e < -sure} & int{f < -sure}) |
                 (int{xa - high_x > sure} & int{xb - high_x > sure} & int{xc - high_x > sure}) |
                 (int{xa - low_x < -sure} & int{xb - low_x < -sure} & int{xc - low_x < -sure}) |
                 (int{ya - high_y > sure} & int{yb - high_y > sure} & int{yc - high_y > sure}) |
                 (int{ya - low_y < -sure} & int{yb - low_y < -sure} & int{yc - low_y < -sure}) |
                 (int{za < -sure} & int{zb < -sure} & int{zc < -sure}) |
                 (int{za - end > sure} & int{zb - end > sure} & int{zc - end > sure});
    }
    return true;
}

}  // namespace umbra::exact_visibility
