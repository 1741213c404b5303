#include "umbra/shadows/exact/triangles_over.h"

namespace umbra::exact_detail {
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
    occluders.triangles->visit(BoxTree::Piece{origin_, to_place, 1.0, slack}, [&](TriangleId t) {
        if (occluders.casts_nothing[t] == 0) triangles_.push_back(t);
        return triangles_.size() <= kMost;
    });
    const std::size_t n = triangles_.size();
    known_              = n <= kMost;
    if (!known_) return;
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) {
            std::vector<float>& list = corners_[c][k];
            list.resize(n);
            for (std::size_t i = 0; i < n; ++i)
                list[i] =
                    static_cast<float>(static_cast<double>(occluders.scene->vertex(triangles_[i], c)[k]) - origin_[k]);
        }
}

const std::vector<TriangleId>* TrianglesOver::pick(const ExactPoint& p, dvec3 to_place, double off, double x,
                                                   double y) {
    if (!known_ || x != x_ || y != y_) return nullptr;
    const dvec3 moved = p.rounded() - origin_;
    if (!(largest(moved) <= around_) || !(largest(moved + to_place - place_) + off <= around_)) return nullptr;
    // A triangle is out that lies on one side of either of two planes through the segment, or past one of its ends
    // along its longest axis. Floats, bounded as in SilhouetteEdges::pick.
    constexpr float kRounding = 0x1p-19f, kDenormal = 0x1p-140f;
    const dvec3 size = glm::abs(to_place);
    const int axis   = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int one = (axis + 1) % 3, other = (axis + 2) % 3;
    const double length = size[axis];
    const float forward = to_place[axis] > 0 ? 1.0f : -1.0f, end = static_cast<float>(length);
    if (!(length > 0)) return nullptr;
    const auto one_slope   = static_cast<float>(to_place[one] / length),
               other_slope = static_cast<float>(to_place[other] / length);
    const float tilt       = kRounding + static_cast<float>(4 * off / length);
    const float dx = float(moved[one]), dy = float(moved[other]), dz = float(moved[axis]);
    const float least =
        static_cast<float>(4 * off) + kDenormal + tilt * (std::abs(dx) + std::abs(dy) + std::abs(dz) + end);
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
        const float za = forward * (az[i] - dz), zb = forward * (bz[i] - dz), zc = forward * (cz[i] - dz);
        const float a = ax[i] - dx - one_slope * za, b = bx[i] - dx - one_slope * zb, c = cx[i] - dx - one_slope * zc;
        const float d = ay[i] - dy - other_slope * za, e = by[i] - dy - other_slope * zb,
                    f = cy[i] - dy - other_slope * zc;
        out[i] = (int{a > sure} & int{b > sure} & int{c > sure}) | (int{a < -sure} & int{b < -sure} & int{c < -sure}) |
                 (int{d > sure} & int{e > sure} & int{f > sure}) | (int{d < -sure} & int{e < -sure} & int{f < -sure}) |
                 (int{za < -sure} & int{zb < -sure} & int{zc < -sure}) |
                 (int{za - end > sure} & int{zb - end > sure} & int{zc - end > sure});
    }
    picked_.clear();
    for (std::size_t i = 0; i < n; ++i)
        if (out[i] == 0) picked_.push_back(triangles_[i]);
    return &picked_;
}

}  // namespace umbra::exact_detail
