// How many triangles lie over each sample of a light, less a number that is the same for all of them.
//
//       +---------------+     A sample's layers are those at the left of the lowest row, plus the steps of all edges
//      >|----.   * *    |     that a line from there to the sample crosses: first up along the left side, where edges
//       | *   \     *   |     come in, then along its row. Any first number does: samples without
//       |   *  \  *     |     layers are those with the least, if any.
//       +-------\-------+
#pragma once

#include <cstdint>
#include <vector>

#include "umbra/shadows/light_rays/light_rays.h"
#include "umbra/shadows/soft/light_view.h"

namespace umbra::soft {

/// The samples of one point in rows from low to high y, so that an edge looks at those beside it alone. Memory is kept
/// from point to point. For one thread.
class SampleLayers {
public:
    /// `count`: of samples. With `doubts` false no sample is ever in doubt.
    SampleLayers(int count, bool doubts);

    /// Takes the samples of a point; none has layers, or is in doubt.
    void take(const rays::LightRays& light, PointKey key);
    /// `change`: LightEdges::change_at.
    void add(const FlatEdge& edge, int change);
    /// Leaves out the samples that are not in front of the point's plane; those whose rays start after `latest` become
    /// doubtful. After all edges.
    void leave_out_behind(const rays::LightRays& light, const rays::SeenLight& seen, const rays::Starts& starts,
                          int lane, float latest);

    /// The samples with the fewest layers of those that are not in doubt: how many, and one of them.
    struct Fewest {
        int count = 0;
        vec2 sample{0};
    };
    [[nodiscard]] Fewest fewest() const;
    /// Calls body(sample) for each one in doubt.
    template <class Body>
    void for_each_doubtful(const Body& body) const {
        for (std::size_t k = 0; k < count_; ++k)
            if (doubt_[k] != 0) body(vec2(x_[k], y_[k]));
    }

private:
    template <class Body>
    void for_each_block(std::size_t first, std::size_t end, const Body& body);
    [[nodiscard]] std::size_t row_of(float y) const;

    std::size_t count_;
    bool doubts_;
    std::size_t rows_;
    std::int32_t last_row_;
    std::vector<vec2> unsorted_;  ///< and their rows
    std::vector<std::int32_t> row_;
    std::vector<float> x_, y_;  ///< sorted by row, filled up to a multiple of eight above all edges
    std::vector<std::int32_t> layers_, doubt_;
    std::vector<std::uint32_t> begin_;  ///< of each row, and the end
};

}  // namespace umbra::soft
